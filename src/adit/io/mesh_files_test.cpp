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

TEST(MeshFiles, ObjWithAQuadAndALine) {
  expect_ramp(
      read_mesh("v 0 0 0\nv 4 0 0\nv 4 2 1\nv 0 2 1\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nl 1 3\n", "obj"));
}

TEST(MeshFiles, StlCornersAreWelded) {
  const std::string ascii =
      "solid ramp\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 4 2 "
      "1\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 2 1\nvertex 0 2 1\nendloop\nendfacet\nendsolid "
      "ramp\n";
  expect_ramp(read_mesh(ascii, ".STL"));
  std::string binary(80, ' ');
  append_little_endian(binary, std::uint32_t{2});
  for (const Eigen::Vector3i& triangle : ramp().triangles) {
    for (int k = -1; k < 3; ++k) {
      const Eigen::Vector3f v =
          k < 0 ? Eigen::Vector3f(0, 0, 1) : ramp().vertices[static_cast<std::size_t>(triangle[k])];
      for (int axis = 0; axis < 3; ++axis) append_little_endian(binary, v[axis]);
    }
    append_little_endian(binary, std::uint16_t{0});
  }
  expect_ramp(read_mesh(binary, "stl"));
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

TEST(MeshFiles, DaeComesOutZUpWhateverItsUpAxis) {
  const char* identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  expect_ramp(read_mesh(dae("Z_UP", "0 0 0 4 0 0 4 2 1 0 2 1", identity), "dae"));
  // Up is y: (x, y, z) of the world is (x, z, -y) of the file.
  expect_ramp(read_mesh(dae("Y_UP", "0 0 0 4 0 0 4 1 -2 0 1 -2", identity), "dae"));
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
  EXPECT_ERROR(read_mesh("x", "fbx"), "no extension of a mesh");
  EXPECT_ERROR(read_mesh(folder / "absent.ply"), "absent.ply: no such file");
  EXPECT_FALSE(read_mesh("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "obj"));
  EXPECT_FALSE(write_mesh(folder / "a.ply", {}));
  EXPECT_ERROR(write_mesh(folder / "a.obj", ramp()), "written as .ply");
  const std::string bytes = write_ply(ramp());
  for (std::size_t size = 0; size < bytes.size(); size += 3)
    static_cast<void>(read_mesh(bytes.substr(0, size), "ply"));
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
