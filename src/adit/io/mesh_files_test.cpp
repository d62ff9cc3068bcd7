// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mesh_files.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/ply.hpp"
#include "adit/io/routes_yaml.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// A ramp: two triangles that share an edge, different along every axis so that a swapped one shows.
TriangleMesh ramp() { return {{{0, 0, 0}, {4, 0, 0}, {4, 2, 1}, {0, 2, 1}}, {{0, 1, 2}, {0, 2, 3}}}; }

void expect_ramp(const Result<TriangleMesh>& mesh) {
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertices.size(), 4U);
  ASSERT_EQ(mesh->triangles.size(), 2U);
  const auto box = bounding_box(*mesh);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(0, 0, 0), 1e-6F)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(4, 2, 1), 1e-6F)) << box.max().transpose();
  for (const Eigen::Vector3i& t : mesh->triangles) {
    const auto corner = [&](int k) { return mesh->vertices[static_cast<std::size_t>(t[k])]; };
    EXPECT_GT((corner(1) - corner(0)).cross(corner(2) - corner(0)).z(), 0.0F) << "the winding is turned over";
  }
}

TEST(MeshFiles, OwnPlyReadsBack) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_mesh(folder / "ramp.ply", ramp()));
  const Result<TriangleMesh> back = read_mesh(folder / "ramp.ply");
  expect_ramp(back);
  EXPECT_EQ(back->vertices, ramp().vertices);
  EXPECT_EQ(back->triangles, ramp().triangles);
  // A mesh is a cloud of its vertices, too.
  const Result<CloudFile> cloud = read_ply(write_ply(ramp()));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->cloud.points, ramp().vertices);
}

std::string obj() { return "v 0 0 0\nv 4 0 0\nv 4 2 1\nv 0 2 1\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nl 1 3\n"; }

std::string ascii_stl() {
  return "solid ramp\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 4 2 "
         "1\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 2 1\nvertex 0 2 "
         "1\nendloop\nendfacet\nendsolid ramp\n";
}

std::string binary_stl() {
  std::string bytes(80, ' ');
  append_little_endian(bytes, std::uint32_t{2});
  for (const Eigen::Vector3i& triangle : ramp().triangles) {
    for (int k = -1; k < 3; ++k) {
      const Eigen::Vector3f v =
          k < 0 ? Eigen::Vector3f(0, 0, 1) : ramp().vertices[static_cast<std::size_t>(triangle[k])];
      for (int axis = 0; axis < 3; ++axis) append_little_endian(bytes, v[axis]);
    }
    append_little_endian(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST(MeshFiles, ObjWithAQuadAndALine) { expect_ramp(read_mesh(obj(), "obj")); }

TEST(MeshFiles, StlCornersAreWelded) {
  expect_ramp(read_mesh(ascii_stl(), ".STL"));
  expect_ramp(read_mesh(binary_stl(), "stl"));
}

std::string dae(std::string_view up_axis, std::string_view positions, std::string_view matrix) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
         R"(<unit meter="1" name="meter"/><up_axis>)" +
         std::string(up_axis) +
         R"(</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">)" +
         std::string(positions) +
         R"(</float_array><technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>)"
         R"(<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>)"
         R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="2">)"
         R"(<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles></mesh></geometry>)"
         R"(</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><matrix>)" +
         std::string(matrix) +
         R"(</matrix><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>)"
         R"(<instance_visual_scene url="#s"/></scene></COLLADA>)";
}

constexpr std::string_view kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

std::string z_up_dae() { return dae("Z_UP", "0 0 0 4 0 0 4 2 1 0 2 1", kIdentity); }

TEST(MeshFiles, DaeComesOutZUpWhateverItsUpAxis) {
  expect_ramp(read_mesh(z_up_dae(), "dae"));
  // Up is y: (x, y, z) of the world is (x, z, -y) of the file.
  expect_ramp(read_mesh(dae("Y_UP", "0 0 0 4 0 0 4 1 -2 0 1 -2", kIdentity), "dae"));
}

TEST(MeshFiles, DaeNodeTransformsAreApplied) {
  expect_ramp(
      read_mesh(dae("Z_UP", "0 0 -5 2 0 -5 2 1 -4.5 0 1 -4.5", "2 0 0 0 0 2 0 0 0 0 2 10 0 0 0 1"), "dae"));
}

std::string glb() {
  std::string body;
  for (const Eigen::Vector3f& v : ramp().vertices) {
    for (const float value : {v.x(), v.z(), -v.y()}) append_little_endian(body, value);
  }
  for (const Eigen::Vector3i& t : ramp().triangles) {
    for (int k = 0; k < 3; ++k) append_little_endian(body, static_cast<std::uint16_t>(t[k]));
  }
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":60}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,-2],"max":[4,1,0]},)"
      R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}]})";
  while (json.size() % 4 != 0) json += ' ';
  std::string bytes = "glTF";
  append_little_endian(bytes, std::uint32_t{2});
  append_little_endian(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + body.size()));
  append_little_endian(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_little_endian(bytes, static_cast<std::uint32_t>(body.size()));
  return bytes + std::string("BIN\0", 4) + body;
}

TEST(MeshFiles, GlbComesOutZUp) { expect_ramp(read_mesh(glb(), "glb")); }

TEST(MeshFiles, BadInput) {
  const test::TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_FALSE(read_mesh(write_ply(cloud), "ply"));
  EXPECT_FALSE(read_mesh("", "ply"));
  EXPECT_FALSE(read_mesh("garbage", "obj"));
  EXPECT_ERROR(read_mesh("x", "fbx"), "not an extension of meshes");
  EXPECT_ERROR(read_mesh(folder / "absent.ply"), "absent.ply: no such file");
  EXPECT_FALSE(read_mesh("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "obj"));
  EXPECT_FALSE(write_mesh(folder / "a.ply", {}));
  EXPECT_ERROR(write_mesh(folder / "a.obj", ramp()), "written as .ply");
}

TEST(MeshFiles, EveryTruncationOfAPlyIsAnError) {
  const std::string binary = write_ply(ramp());
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face "
      "2\nproperty list uchar int vertex_index\nend_header\n0 0 0\n4 0 0\n4 2 1\n0 2 1\n3 0 1 2\n3 0 2 3";
  for (const std::string& bytes : {binary, ascii}) {
    expect_ramp(read_mesh(bytes, "ply"));
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FALSE(read_mesh(bytes.substr(0, size), "ply")) << size << " of " << bytes.size();
  }
}

/// Text formats have no length to check against: cut between two faces, they give the faces before the cut.
TEST(MeshFiles, TruncationsOfOtherFormatsAreErrorsOrTheFacesBefore) {
  for (const auto& [extension, bytes] : {std::pair("obj", obj()),
                                         {"stl", ascii_stl()},
                                         {"stl", binary_stl()},
                                         {"dae", z_up_dae()},
                                         {"glb", glb()}}) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Result<TriangleMesh> mesh = read_mesh(bytes.substr(0, size), extension);
      if (!mesh) {
        EXPECT_EQ(mesh.error().message.find('\n'), std::string::npos) << mesh.error().message;
        continue;
      }
      EXPECT_TRUE(check_mesh(*mesh));
      EXPECT_LE(mesh->triangles.size(), 2U);
    }
  }
}

TEST(MeshFiles, PlyPolygonsBecomeFansAndOtherListsAreSteppedOver) {
  const auto ply = [](std::string_view corners) {
    return "ply\nformat ascii 1.0\nelement face 3\nproperty list uchar float texcoord\nproperty list uchar "
           "int "
           "vertex_indices\nproperty uchar red\nelement vertex 4\nproperty double x\nproperty double "
           "y\nproperty "
           "double z\nproperty float t\nend_header\n" +
           std::string(corners) + "2 0.5 1 2 0 1 7\n0 0 7\n0 0 0 1\n4 0 0 9\n4 2 1 1e5\n0 2 1 5\n";
  };
  expect_ramp(read_mesh(ply("0 4 0 1 2 3 255\n"), "ply"));
  EXPECT_ERROR(read_mesh(ply("0 4 0 1 2 4 255\n"), "ply"), "4");
  EXPECT_FALSE(read_mesh(ply("0 4 0 1 2 -3 255\n"), "ply"));
  EXPECT_FALSE(read_mesh(ply("0 4 0 1 2 nan 255\n"), "ply"));
  EXPECT_TRUE(ply_has_faces(ply("")));
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  EXPECT_FALSE(ply_has_faces(write_ply(cloud)));
}

TEST(MeshFiles, AVertexThatIsNotFiniteIsAnError) {
  TriangleMesh mesh = ramp();
  mesh.vertices[1].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_ERROR(read_mesh(write_ply(mesh), "ply"), "not finite");
}

TEST(MeshFiles, RealWorlds) {
  ADIT_NEED_DATA("worlds/pittsburgh_mine/world.ply");
  for (const char* name : {"tunnel_practice_1", "tunnel_practice_2", "pittsburgh_mine", "darpa_cave_01"}) {
    const auto folder = test::shared_data("worlds") / name;
    const Result<RoutesFile> routes = read_routes(folder / "routes.yaml");
    ASSERT_TRUE(routes) << routes.error().message;
    EXPECT_EQ(routes->routes.size(), 4U) << name;
    const Result<TriangleMesh> mesh = read_mesh(routes->world);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_GT(mesh->triangles.size(), 1000U);
    // The robots start inside the world.
    const Eigen::Vector3f start = routes->routes[0].waypoints[0].cast<float>();
    EXPECT_LT(bounding_box(*mesh).exteriorDistance(start), 1.0F) << name;
  }
}

}  // namespace
}  // namespace adit
