// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/robot_map_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <limits>

#include "adit/core/rng.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/packed_cloud.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Pose random_pose(Rng& rng) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = rng.uniform(-2.0, 2.0);
  return Pose::exp(xi);
}

PointCloud random_cloud(Rng& rng, std::size_t size) {
  PointCloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.points.emplace_back(Vector3(rng.normal(), rng.normal(), rng.normal()).cast<float>());
    cloud.intensities.push_back(static_cast<float>(rng.uniform()));
  }
  return cloud;
}

RobotMap random_map() {
  Rng rng(5);
  RobotMap map;
  map.id = {3};
  map.name = "robot_3";
  map.scan_context.max_radius_m = 30.0;
  map.num_degenerate = 4;
  map.num_refused = 1;
  for (std::uint32_t k = 0; k < 5; ++k) {
    const Stamp stamp{1'600'000'000'000'000'001 + static_cast<std::int64_t>(k)};
    const PointCloud cloud = random_cloud(rng, 20 * k);  // The first one is empty.
    map.odometry.push_back({stamp, random_pose(rng)});
    map.keyframes.push_back(
        {{map.id, k}, stamp, random_pose(rng), std::make_shared<const PointCloud>(cloud)});
    map.step_covariances.push_back(Matrix6::Identity() * rng.uniform());
    map.pose_noise.push_back(Matrix6::Identity() * rng.uniform());
    map.places.push_back(describe(cloud, {}));
    map.searchable.push_back(k % 3 == 0);
    map.unconfirmed.push_back(0.01F * static_cast<float>(k));
  }
  return map;
}

TEST(RobotMapFile, ReadsBackBitForBit) {
  const RobotMap map = random_map();
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_robot_map(folder / "a.map", map));
  const Result<RobotMap> again = read_robot_map(folder / "a.map");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(robot_map_bytes(*again), robot_map_bytes(map));
  EXPECT_EQ(again->name, map.name);
  EXPECT_EQ(again->scan_context.max_radius_m, 30.0);
  ASSERT_EQ(again->keyframes.size(), 5U);
  EXPECT_EQ(again->keyframes[4].id, map.keyframes[4].id);
  EXPECT_EQ(again->keyframes[4].stamp, map.keyframes[4].stamp);
  EXPECT_TRUE(again->keyframes[4].cloud->points == map.keyframes[4].cloud->points);
  EXPECT_TRUE(again->places[3].unit_columns == map.places[3].unit_columns);
  EXPECT_TRUE(again->keyframes[2].T_odom_base.matrix() == map.keyframes[2].T_odom_base.matrix());
  EXPECT_EQ(again->searchable, map.searchable);
}

TEST(RobotMapFile, AScanThatWasNotJudgedIsReadAsSuch) {
  RobotMap map = random_map();
  map.unconfirmed[1].reset();
  const Result<RobotMap> again = parse_robot_map(robot_map_bytes(map));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->unconfirmed, map.unconfirmed);
}

TEST(RobotMapFile, DamageAndOtherVersionsAreRefused) {
  const std::string bytes = robot_map_bytes(random_map());
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_FALSE(parse_robot_map(std::string_view(bytes).substr(0, size))) << size;
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    const Result<RobotMap> parsed = parse_robot_map(damaged);
    // Bits of the packing may mean nothing.
    EXPECT_TRUE(!parsed || robot_map_bytes(*parsed) == bytes) << at;
  }
  std::string other = bytes;
  other[9] = '0';
  EXPECT_ERROR(parse_robot_map(other), "before layout 7");
  EXPECT_ERROR(read_robot_map("/nonexistent.map"), "nonexistent");
}

/// What the bytes of a map pack, changed by `edit`, with the right size and sum.
template <class Edit>
std::string edited(const RobotMap& map, const Edit& edit) {
  const std::string bytes = robot_map_bytes(map);
  const std::size_t magic = bytes.find('\n') + 1;
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + magic, sizeof(size));
  std::string plain = decompress(std::string_view(bytes).substr(magic + 12), "zstd", size).value();
  edit(plain);
  std::string out = bytes.substr(0, magic);
  append_little_endian(out, static_cast<std::uint64_t>(plain.size()));
  append_little_endian(out, crc32(plain));
  return out + compress_zstd(plain);
}

// The end of a map of five keyframes: places, searchable, unconfirmed, viewpoint.
constexpr std::size_t kViewpoint = 24;
constexpr std::size_t kUnconfirmed = 8 + 5 * 4;
constexpr std::size_t kSearchable = 8 + 5;
constexpr std::size_t kPlaces = 8 + 5 * (2 * 4 + 4 * 8 + (20 * 60 + 60 + 20 + 60) * 4);

TEST(RobotMapFile, FlagsAreZeroOrOne) {
  const RobotMap map = random_map();
  EXPECT_TRUE(parse_robot_map(edited(map, [](std::string&) {})));
  constexpr std::size_t kLastFlag = kViewpoint + kUnconfirmed + 1;  // from the end
  EXPECT_TRUE(parse_robot_map(edited(map, [&](std::string& plain) { plain[plain.size() - kLastFlag] = 1; })));
  EXPECT_ERROR(parse_robot_map(edited(map, [&](std::string& plain) { plain[plain.size() - kLastFlag] = 2; })),
               "the map is damaged; map the recording again");
}

/// The most memory that the program has had, bytes.
std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024U;
}

TEST(RobotMapFile, AFewBytesDoNotMakeMillionsOfPlaces) {
  constexpr std::uint64_t kMany = 8'000'000;
  const std::string bytes = edited(random_map(), [&](std::string& plain) {
    const std::size_t at = plain.size() - kViewpoint - kUnconfirmed - kSearchable - kPlaces;
    ASSERT_EQ(plain[at], 5);
    std::memcpy(plain.data() + at, &kMany, sizeof(kMany));
    plain.append(kMany, '\0');
  });
  const std::size_t before = peak_memory();
  EXPECT_ERROR(parse_robot_map(bytes), "the map is damaged");
  EXPECT_LT(peak_memory() - before, 400'000'000U);  // Places would take 800 MB.
}

TEST(RobotMapFile, WhatItsUsersRelyOnIsChecked) {
  const auto expect_refused = [](const auto& damage, const std::string& fault) {
    RobotMap map = random_map();
    damage(map);
    EXPECT_ERROR(parse_robot_map(robot_map_bytes(map)), "the map is damaged: " + fault);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([](RobotMap& map) { map.odometry[2].stamp = map.odometry[1].stamp; },
                 "pose 2: its stamp is not after that of the one before; map the recording again");
  expect_refused([](RobotMap& map) { map.keyframes[3].stamp = map.keyframes[1].stamp; },
                 "keyframe 3: its stamp is not after");
  expect_refused([](RobotMap& map) { map.odometry[4].stamp.ns = std::numeric_limits<std::int64_t>::max(); },
                 "pose 4: its stamp is out of range");
  expect_refused(
      [](RobotMap& map) {
        auto cloud = std::make_shared<PointCloud>(*map.keyframes[2].cloud);
        cloud->points[7].y() = std::numeric_limits<float>::infinity();
        map.keyframes[2].cloud = cloud;
      },
      "keyframe 2: a point is not finite");
  expect_refused([](RobotMap& map) { map.viewpoint.x() = kNan; }, "the position of the LiDAR is not finite");
  expect_refused([](RobotMap& map) { map.pose_noise[1](2, 3) = kNan; },
                 "keyframe 1: its pose's noise is not finite");
  for (const float share : {1.5F, std::numeric_limits<float>::quiet_NaN()})
    expect_refused([share](RobotMap& map) { map.unconfirmed[3] = share; },
                   "keyframe 3: its share of unconfirmed returns is no share");
  expect_refused([](RobotMap& map) { map.step_covariances[4] = -Matrix6::Identity(); },
                 "keyframe 4: its step's covariance is not positive definite");
  expect_refused(
      [](RobotMap& map) {
        map.scan_context.num_rings = 0;
        for (ScanContext& place : map.places)
          place = ScanContext{0, 60, {}, std::vector<float>(60), {}, std::vector<float>(60)};
      },
      "scan_context: num_rings");
  expect_refused([](RobotMap& map) { map.scan_context.num_sectors = 30; },
                 "keyframe 0: its place does not fit the grid of places");
}

}  // namespace
}  // namespace adit
