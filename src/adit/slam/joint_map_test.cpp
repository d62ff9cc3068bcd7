// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/joint_map.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <set>

#include "adit/io/cloud_files.hpp"
#include "adit/io/mesh_files.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// A wall of 4 x 2 m at that x, seen from `eye`.
Keyframe wall_seen_from(std::uint32_t index, double wall_x, const Vector3& eye) {
  auto cloud = std::make_shared<PointCloud>();
  for (double y = -2.0; y <= 2.0; y += 0.05)
    for (double z = -1.0; z <= 1.0; z += 0.05)
      cloud->points.push_back((Vector3(wall_x, y, z) - eye).cast<float>());
  Keyframe keyframe;
  keyframe.id = {{0}, index};
  keyframe.stamp = Stamp{} + from_seconds(index);
  keyframe.cloud = cloud;
  return keyframe;
}

/// Both faces of a wall 0.8 m thick, of which the one at x = 0 was seen from 6 m and the other from 1 m.
JointMap both_faces() {
  const Vector3 far(-6.0, 0.0, 0.0);
  const Vector3 near(1.8, 0.0, 0.0);
  auto map = std::make_shared<RobotMap>();
  map->keyframes = {wall_seen_from(0, 0.0, far), wall_seen_from(1, 0.8, near)};
  return {{map}, {{Pose::translation_of(far.x(), 0, 0), Pose::translation_of(near.x(), 0, 0)}}, {}};
}

TEST(JointMap, NormalsOfThinWallsLookToWhereTheyWereSeenFrom) {
  const test::TemporaryFolder folder;
  const auto path = folder / "map.ply";
  MapsConfig config;
  config.normals = true;
  ASSERT_TRUE(write_joint_map(path, both_faces(), config));
  const std::string ply = test::get_file(path);
  constexpr std::size_t kRow = 6 * sizeof(float) + 2;
  std::size_t num = 0;
  for (std::size_t at = ply.find("end_header\n") + 11; at + kRow <= ply.size(); at += kRow) {
    std::array<float, 6> row{};
    std::memcpy(row.data(), &ply[at], sizeof row);
    EXPECT_GT(row[3] * (row[0] < 0.4F ? -1.0F : 1.0F), 0.9F) << row[0] << " " << row[1] << " " << row[2];
    ++num;
  }
  EXPECT_GT(num, 1000U);
}

TEST(JointMap, FacesOfThinWallsLookToWhereTheyWereSeenFrom) {
  const test::TemporaryFolder folder;
  const auto path = folder / "surface.ply";
  ASSERT_TRUE(write_joint_mesh(path, both_faces(), {}));
  const Result<TriangleMesh> mesh = read_mesh(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_GT(mesh->triangles.size(), 100U);
  for (const Eigen::Vector3i& triangle : mesh->triangles) {
    const auto corner = [&](Eigen::Index i) { return mesh->vertices[static_cast<std::size_t>(triangle[i])]; };
    const Eigen::Vector3f normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    EXPECT_GT(normal.x() * (corner(0).x() < 0.4F ? -1.0F : 1.0F), 0.5F);
  }
}

TEST(JointMap, HeadersOfCloudsSayWhomTheNumbersMean) {
  JointMap both = both_faces();
  auto second = std::make_shared<RobotMap>(*both.maps[0]);
  second->id = {2};
  second->name = "eve";
  auto first = std::make_shared<RobotMap>(*both.maps[0]);
  first->name = "ada";
  both.maps = {first, second};
  both.T_world_keyframe.push_back(both.T_world_keyframe[0]);
  const test::TemporaryFolder folder;
  for (const auto& [name, lines] :
       {std::pair{"map.ply", "\ncomment robot 1 ada\ncomment robot 3 eve\nelement"},
        std::pair{"map.pcd", "\n# robot 1 ada\n# robot 3 eve\nVERSION"}}) {
    ASSERT_TRUE(write_joint_map(folder / name, both, {}));
    EXPECT_NE(test::get_file(folder / name).find(lines), std::string::npos) << name;
    EXPECT_TRUE(read_cloud(folder / name)) << name;
  }
}

TEST(JointMap, IntensitiesStayWithTheRobotThatHasThem) {
  const auto with_wall = [](std::uint8_t robot, double wall_x, const std::vector<float>& intensities) {
    auto map = std::make_shared<RobotMap>();
    map->id = {robot};
    map->keyframes = {wall_seen_from(0, wall_x, Vector3::Zero())};
    auto cloud = std::make_shared<PointCloud>(*map->keyframes[0].cloud);
    for (std::size_t i = 0; i < cloud->size() && !intensities.empty(); ++i)
      cloud->intensities.push_back(intensities[cloud->points[i].y() < 0.0F ? 0 : 1]);
    map->keyframes[0].cloud = cloud;
    return map;
  };
  const JointMap both{{with_wall(0, 5.0, {10.0F, 200.0F}), with_wall(1, 9.0, {})}, {{Pose()}, {Pose()}}, {}};
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_joint_map(folder / "map.ply", both, {}));
  const Result<PointCloud> read = read_cloud(folder / "map.ply");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->intensities.size(), read->size());
  std::set<float> found;
  for (std::size_t i = 0; i < read->size(); ++i) {
    const Eigen::Vector3f& point = read->points[i];
    if (std::abs(point.y()) < 0.2F) continue;  // a voxel may have both
    const float expected = point.x() > 7.0F ? 0.0F : point.y() < 0.0F ? 10.0F : 200.0F;
    EXPECT_EQ(read->intensities[i], expected) << point.transpose();
    found.insert(expected);
  }
  EXPECT_EQ(found.size(), 3U);
}

}  // namespace
}  // namespace adit
