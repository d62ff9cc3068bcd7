// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/map_cloud.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "adit/io/cloud_files.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

MapCloud two_points() {
  MapCloud map;
  map.cloud.points = {{1.0F, 2.0F, 3.0F}, {-4.0F, 5.5F, 0.25F}};
  map.cloud.intensities = {7.0F, 80.0F};
  map.robots = {1, 300};
  map.normals = {{0.0F, 0.0F, 1.0F}, {0.0F, -1.0F, 0.0F}};
  return map;
}

TEST(MapCloud, IsReadBackAsACloud) {
  const test::TemporaryFolder folder;
  for (const char* name : {"map.ply", "map.pcd"}) {
    const MapCloud map = two_points();
    ASSERT_TRUE(write_map_cloud(folder / name, map, "of a test"));
    const Result<PointCloud> read = read_cloud(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->points, map.cloud.points);
    EXPECT_EQ(read->intensities, map.cloud.intensities);
    EXPECT_NE(test::get_file(folder / name).find("of a test"), std::string::npos);
  }
}

TEST(MapCloud, RowsAreAsTheHeaderSays) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_map_cloud(folder / "map.ply", two_points()));
  const std::string ply = test::get_file(folder / "map.ply");
  EXPECT_NE(ply.find("property float intensity\nproperty float nx\nproperty float ny\nproperty float nz\n"
                     "property ushort robot\nend_header\n"),
            std::string::npos);
  ASSERT_TRUE(write_map_cloud(folder / "map.pcd", two_points()));
  const std::string pcd = test::get_file(folder / "map.pcd");
  EXPECT_NE(pcd.find("FIELDS x y z intensity normal_x normal_y normal_z robot\nSIZE 4 4 4 4 4 4 4 2\n"
                     "TYPE F F F F F F F U\nCOUNT 1 1 1 1 1 1 1 1\n"),
            std::string::npos);
  constexpr std::size_t kNormalY = 20;  // bytes from the start of a row
  constexpr std::size_t kRobot = 28;
  constexpr std::size_t kRow = kRobot + 2;
  for (const std::string& bytes : {ply, pcd}) {
    const std::string last = bytes.substr(bytes.size() - kRow);
    float normal_y = 0.0F;
    std::memcpy(&normal_y, &last[kNormalY], 4);
    EXPECT_EQ(normal_y, -1.0F);
    std::uint16_t robot = 0;
    std::memcpy(&robot, &last[kRobot], 2);
    EXPECT_EQ(robot, 300);
  }
}

TEST(MapCloud, WithoutIntensitiesAndNormalsTheyAreLeftOut) {
  const test::TemporaryFolder folder;
  MapCloud map = two_points();
  map.cloud.intensities.clear();
  map.normals.clear();
  ASSERT_TRUE(write_map_cloud(folder / "map.pcd", map));
  EXPECT_NE(test::get_file(folder / "map.pcd").find("FIELDS x y z robot\n"), std::string::npos);
  EXPECT_FALSE(write_map_cloud(folder / "map.las", map));
  EXPECT_FALSE(write_map_cloud(folder / "map.ply", {}));
}

}  // namespace
}  // namespace adit
