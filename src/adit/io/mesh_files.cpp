// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mesh_files.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <numeric>
#include <tuple>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/ply.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent;

/// Geometry alone is wanted: everything else costs time and memory and keeps equal vertices apart.
void configure(Assimp::Importer& importer) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                  aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find_first_of("\r\n")); }

/// assimp hands out DAE (whatever its up axis) and glTF scenes y up.
bool is_y_up(const std::string& extension) {
  return extension == "dae" || extension == "glb" || extension == "gltf";
}

void append(TriangleMesh& mesh, const aiMesh& part, const aiMatrix4x4& T_world_part) {
  const auto first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D v = T_world_part * part.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const auto corner = [&](unsigned k) { return first + static_cast<int>(face.mIndices[k]); };
    mesh.triangles.emplace_back(corner(0), corner(1), corner(2));
  }
}

void append(TriangleMesh& mesh, const aiScene& scene, const aiNode& node, const aiMatrix4x4& T_world_parent) {
  const aiMatrix4x4 T_world_node = T_world_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) append(mesh, *scene.mMeshes[node.mMeshes[i]], T_world_node);
  for (unsigned i = 0; i < node.mNumChildren; ++i) append(mesh, scene, *node.mChildren[i], T_world_node);
}

/// Makes vertices of equal coordinates one, in the order of their first appearance, and drops triangles that
/// lose a corner by it.
TriangleMesh weld(const TriangleMesh& soup) {
  const auto key = [&](int i) {
    const Eigen::Vector3f& v = soup.vertices[static_cast<std::size_t>(i)];
    return std::make_tuple(v.x(), v.y(), v.z(), i);
  };
  std::vector<int> order(soup.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, key);
  std::vector<int> representative(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto i = static_cast<std::size_t>(order[k]);
    const bool is_equal = k > 0 && soup.vertices[i] == soup.vertices[static_cast<std::size_t>(order[k - 1])];
    representative[i] = is_equal ? representative[static_cast<std::size_t>(order[k - 1])] : order[k];
  }
  TriangleMesh mesh;
  std::vector<int> index(order.size());
  for (std::size_t i = 0; i < index.size(); ++i) {
    const bool is_first = representative[i] == static_cast<int>(i);
    index[i] = is_first ? static_cast<int>(mesh.vertices.size())
                        : index[static_cast<std::size_t>(representative[i])];
    if (is_first) mesh.vertices.push_back(soup.vertices[i]);
  }
  for (const Eigen::Vector3i& triangle : soup.triangles) {
    const Eigen::Vector3i t = triangle.unaryExpr([&](int i) { return index[static_cast<std::size_t>(i)]; });
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

/// The triangles of all nodes of the scene, as they stand in the file, z up.
Result<TriangleMesh> soup_of(const Assimp::Importer& importer, const aiScene* scene,
                             const std::string& extension) {
  // Names the reason that assimp gives, in one line.
  if (scene == nullptr) return fail("cannot be read: " + first_line(importer.GetErrorString()));
  if (scene->mRootNode == nullptr) return fail("holds no scene");
  TriangleMesh soup;
  append(soup, *scene, *scene->mRootNode, aiMatrix4x4());
  if (is_y_up(extension)) {
    for (Eigen::Vector3f& v : soup.vertices) v = Eigen::Vector3f(v.x(), -v.z(), v.y());
  }
  return soup;
}

Result<TriangleMesh> checked(const TriangleMesh& soup) {
  if (soup.triangles.empty())
    return fail("the mesh has no triangles; a world needs them, and a point cloud has none");
  // Before welding, which sorts: NaN has no place in an order.
  return check_mesh(soup)
      .map([&] { return weld(soup); })
      .and_then([](TriangleMesh mesh) -> Result<TriangleMesh> {
        if (mesh.empty()) return fail("all triangles of the mesh have zero size");
        return mesh;
      });
}

Result<std::string> known_extension(const std::string& extension) {
  static constexpr std::string_view kKnown[] = {"ply", "obj", "stl", "dae", "glb", "gltf"};
  std::string lower = lower_case(extension);
  if (lower.starts_with('.')) lower.erase(0, 1);
  if (std::ranges::find(kKnown, lower) != std::end(kKnown)) return lower;
  return fail(format("'{}' is not an extension of meshes; .ply, .obj, .stl, .dae and .glb are", extension));
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::filesystem::path& path) {
  const auto read = [&](const std::string& extension) -> Result<TriangleMesh> {
    if (extension == "ply") return read_bytes(path).and_then(read_ply_mesh);
    // Not through memory: a glTF or OBJ file may refer to others beside it.
    Assimp::Importer importer;
    configure(importer);
    return soup_of(importer, importer.ReadFile(path.string(), kSteps), extension);
  };
  std::error_code ignored;
  Result<std::string> extension = known_extension(path.extension().string());
  if (extension && !std::filesystem::is_regular_file(path, ignored)) extension = fail("no such file");
  Result<TriangleMesh> mesh = extension.and_then(read).and_then(checked);
  if (!mesh) return fail(path.string(), mesh.error());
  return mesh;
}

Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& extension) {
  const auto read = [&](const std::string& known) -> Result<TriangleMesh> {
    if (bytes.empty()) return fail("the file is empty");
    if (known == "ply") return read_ply_mesh(bytes);
    Assimp::Importer importer;
    configure(importer);
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), kSteps, known.c_str());
    return soup_of(importer, scene, known);
  };
  return known_extension(extension).and_then(read).and_then(checked);
}

bool is_ply_mesh(const std::filesystem::path& path) {
  if (lower_case(path.extension().string()) != ".ply") return false;
  const Result<std::string> bytes = read_bytes(path);
  return bytes && ply_has_faces(*bytes);
}

Result<> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const std::string& comment) {
  if (Result<> checked = check_mesh(mesh); !checked) return fail(path.string(), checked.error());
  if (lower_case(path.extension().string()) != ".ply")
    return fail(path.string() + ": meshes are written as .ply");
  return write_bytes(path, write_ply(mesh, comment));
}

}  // namespace adit
