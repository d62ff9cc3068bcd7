// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Single messages that cannot be used, in recordings of other programs: they cost themselves.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "adit/io/bag_recording.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;

constexpr std::size_t kQuaternionBytes = 32;

/// A TFMessage ends with the quaternion of its last link.
std::string without_rotation(std::string transforms) {
  transforms.replace(transforms.size() - kQuaternionBytes, kQuaternionBytes, kQuaternionBytes, '\0');
  return transforms;
}

/// In an Odometry message 36 + 6 + 36 numbers follow the pose.
std::string odometry_without_rotation(Stamp stamp) {
  std::string odometry = ros::encode_odometry({{"odom", "base_link", {stamp, Pose()}}, {}});
  const std::size_t at = odometry.size() - 78 * sizeof(double) - kQuaternionBytes;
  odometry.replace(at, kQuaternionBytes, kQuaternionBytes, '\0');
  return odometry;
}

ForeignFile with_mount() { return ForeignFile().links({test::link("base_link", "os_lidar", Pose())}); }

/// Clouds of so many points each.
ForeignFile& add_clouds(ForeignFile& file, const std::vector<std::size_t>& sizes) {
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    Scan scan = test::make_scan(i, 4);
    scan.cloud = sizes[i] == 0 ? PointCloud() : test::make_scan(i, sizes[i]).cloud;
    clouds.emplace_back(scan.stamp, ros::encode_cloud(scan, "os_lidar"));
  }
  return file.cloud_messages("/points", clouds, Duration(5'000'000));
}

TEST(DamagedMessages, CloudsWithoutPointsAreScansWithoutPoints) {
  ForeignFile file = with_mount();
  const Result<Recording> recording = add_clouds(file, {0, 4, 0, 5}).read();
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->num_scans(), 4U);
  for (const auto& [index, size] : {std::pair{0U, 0U}, {1U, 4U}, {2U, 0U}, {3U, 5U}}) {
    const Result<Scan> scan = recording->read_scan(index);
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->cloud.size(), size);
    EXPECT_EQ(scan->stamp, recording->scan_stamps[index]);
  }
  ForeignFile empty = with_mount();
  EXPECT_ERROR(add_clouds(empty, {0, 0}).read(), "none of 2 clouds has a point");
}

TEST(DamagedMessages, ALinkThatIsNoPoseIsLeftOutAndTheOthersAreNot) {
  const std::string transforms = ros::encode_transforms(
      {test::link("base_link", "os_lidar", test::T_base_ouster), test::link("base_link", "camera", Pose())});
  ForeignFile file = ForeignFile().clouds("/points");
  file.messages_of(ros::kTransforms, "/tf_static", {without_rotation(transforms)});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->T_base_lidar.translation(), test::T_base_ouster.translation());
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_TRUE(
      recording->warnings[0].starts_with("/tf_static: 1 of 2 links are left out; the first, 0: byte "))
      << recording->warnings[0];
}

TEST(DamagedMessages, OdometryThatIsNoPoseIsLeftOutUnlessAllIs) {
  const auto stamp = [](std::size_t i) { return test::make_scan(i, 0).stamp; };
  const auto sound = [&](std::size_t i) {
    return ros::encode_odometry({{"odom", "base_link", {stamp(i), Pose()}}, {}});
  };
  ForeignFile file = with_mount().clouds("/points");
  file.messages_of(ros::kOdometry, "/odom", {odometry_without_rotation(stamp(0)), sound(1), sound(2)});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->wheel.size(), 2U);
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_TRUE(recording->warnings[0].starts_with("/odom: 1 of 3 messages are left out; the first, 0: byte "))
      << recording->warnings[0];
}

TEST(DamagedMessages, WhatLiesBeyondAMillionKilometresIsNoPose) {
  for (const double far : {1.1e9, 1.7e308, -1.1e9}) {
    const std::string message =
        ros::encode_odometry({{"odom", "base_link", {{5}, Pose::translation_of(0, far, 0)}}, {}});
    EXPECT_ERROR(ros::decode_odometry(message), "is not a coordinate in metres");
  }
  const std::string near =
      ros::encode_odometry({{"odom", "base_link", {{5}, Pose::translation_of(0, 1e9, 0)}}, {}});
  EXPECT_TRUE(ros::decode_odometry(near));
}

}  // namespace
}  // namespace adit
