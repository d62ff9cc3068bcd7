// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Wheel odometry in recordings of other programs.
#include <gtest/gtest.h>

#include <limits>

#include "adit/io/bag_recording.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;

ForeignFile file_with_links() {
  return ForeignFile().clouds("/points").links({{"base_link", "os_lidar", {{5}, test::T_base_ouster}}});
}

TEST(McapWheel, OneOfSeveralTopicsCanBeChosenOrNone) {
  ForeignFile file = file_with_links();
  file.odometry("/wheels/odom").odometry("/fused/odom");
  EXPECT_ERROR(file.read(),
               "several topics of wheel odometry; give one of them, the likeliest first: --wheel "
               "/wheels/odom (3 messages) or --wheel /fused/odom (3 messages)");
  EXPECT_ERROR(file.read({.wheel = "/left"}),
               "no topic of wheel odometry '/left'; there are: /wheels/odom, /fused/odom");
  EXPECT_EQ(file.read({.wheel = "/fused/odom"})->wheel.size(), 3U);
  const Result<Recording> none = file.read({.wheel = "none"});
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->wheel.empty());
}

TEST(McapWheel, WheelsThatAreNotUsedStillNameTheRobotsFrame) {
  // Two frames lie above the LiDAR's; only the wheels tell which of them is the robot's.
  ForeignFile file;
  file.clouds("/points")
      .odometry("/odom", "base_link")
      .links({{"base_footprint", "base_link", {{5}, Pose::translation_of(0, 0, 9)}},
              {"base_link", "os_lidar", {{5}, test::T_base_ouster}}});
  const Result<Recording> with = file.read();
  const Result<Recording> without = file.read({.wheel = "none"});
  ASSERT_TRUE(with && without);
  EXPECT_TRUE(without->wheel.empty());
  EXPECT_EQ(without->T_base_lidar.translation(), with->T_base_lidar.translation());
  EXPECT_EQ(without->mount_source, "/tf_static: base_link -> os_lidar");
}

TEST(McapWheel, CovariancesAreThoseOfTheFirstMessageOrOfTheFirstThatCannotBe) {
  WheelCovariance usual;
  usual.pose = Matrix6::Identity() * 1e-3;
  usual.twist = Matrix6::Identity() * 2e-3;
  const Recording sound = file_with_links().odometry("/odom", "base_link", usual).read().value();
  EXPECT_EQ(sound.wheel_covariance.pose, usual.pose);
  EXPECT_EQ(sound.wheel_covariance.twist, usual.twist);
  WheelCovariance broken = usual;
  broken.twist(0, 0) = std::numeric_limits<double>::quiet_NaN();
  ForeignFile late = file_with_links();
  late.odometry("/odom", "base_link", {usual, usual, broken});
  const Recording spoilt = late.read().value();
  EXPECT_EQ(spoilt.wheel_covariance.pose, usual.pose);
  EXPECT_FALSE(spoilt.wheel_covariance.twist.allFinite());
  EXPECT_EQ(spoilt.wheel.size(), 3U);
  EXPECT_TRUE(file_with_links().odometry("/odom").read()->wheel_covariance.pose.isZero(0.0));
}

}  // namespace
}  // namespace adit
