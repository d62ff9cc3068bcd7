// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Wheel odometry in recordings of other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "adit/io/bag_recording.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;

ForeignFile file_with_links() {
  return ForeignFile().clouds("/points").links({{"base_link", "os_lidar", {{5}, test::T_base_ouster}}});
}

TEST(McapWheel, AClockThatJumpsAheadSilencesNothingElse) {
  const auto at = [](double seconds) { return test::make_scan(0, 0).stamp + from_seconds(seconds); };
  ForeignFile file = file_with_links();
  file.odometry_stamped("/odom", {at(0.0), at(0.05), at(3600.0), at(3600.05), at(0.2), at(0.25), at(0.3)});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->wheel.size(), 5U);
  EXPECT_EQ(recording->wheel.back().stamp, at(0.3));
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_TRUE(recording->warnings.front().starts_with("/odom: 2 of 7 messages are left out"))
      << recording->warnings.front();
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

// Half a circle of 2 m radius at a constant twist.
TEST(McapWheel, ATwistThatTheWheelsMeasuredIsAddedUpWhereItIsAskedFor) {
  constexpr double kTurnRate = 0.5;
  std::vector<ros::TwistMessage> twists;
  const int num = 1 + static_cast<int>(std::numbers::pi / kTurnRate / 0.05);
  for (int i = 0; i < num; ++i)
    twists.push_back({Stamp{5'000'000'000 + 50'000'000LL * i}, "base_link",
                      (Vector6() << 2.0 * kTurnRate, 0, 0, 0, 0, kTurnRate).finished()});
  ForeignFile file = file_with_links();
  file.twists("/wheel_twist", twists).twists("/cmd_vel", twists);
  const Result<Recording> recording = file.read({.wheel = "/wheel_twist"});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->wheel.size(), twists.size());
  EXPECT_TRUE(recording->warnings.empty());
  const double angle = kTurnRate * 0.05 * (num - 1);
  const Pose expected = Pose::planar(2.0 * std::sin(angle), 2.0 * (1.0 - std::cos(angle)), angle);
  EXPECT_LT((expected.inverse() * recording->wheel.back().T_world_body).log().norm(), 1e-9);
  EXPECT_EQ(recording->mount_source, "/tf_static: base_link -> os_lidar");

  // Nobody knows which of them was measured.
  const Result<Recording> unasked = file.read();
  ASSERT_TRUE(unasked) << unasked.error().message;
  EXPECT_TRUE(unasked->wheel.empty());
  ASSERT_EQ(unasked->warnings.size(), 1U);
  EXPECT_NE(unasked->warnings[0].find("--wheel /wheel_twist"), std::string::npos);
  EXPECT_ERROR(file.read({.wheel = "/whel_twist"}),
               "no topic of wheel odometry '/whel_twist'; there are: /wheel_twist, /cmd_vel");
  EXPECT_TRUE(file.read({.wheel = "none"})->wheel.empty());

  twists.erase(twists.begin() + 10, twists.begin() + 30);
  const Result<Recording> with_gap = file_with_links().twists("/t", twists).read({.wheel = "/t"});
  ASSERT_TRUE(with_gap);
  ASSERT_EQ(with_gap->warnings.size(), 1U);
  EXPECT_NE(with_gap->warnings[0].find("a gap of 1.1 s"), std::string::npos) << with_gap->warnings[0];
  twists[3].stamp = twists[2].stamp;
  const Result<Recording> repeated = file_with_links().twists("/t", twists).read({.wheel = "/t"});
  ASSERT_TRUE(repeated) << repeated.error().message;
  EXPECT_EQ(repeated->wheel.size(), twists.size() - 1);
  EXPECT_NE(repeated->warnings.back().find("1 of"), std::string::npos);
  twists[2].twist[5] = 1e300;
  const Result<Recording> too_fast = file_with_links().twists("/t", twists).read({.wheel = "/t"});
  ASSERT_TRUE(too_fast) << too_fast.error().message;
  EXPECT_NE(too_fast->warnings.back().find("left out; the first, 2: no robot is faster"), std::string::npos)
      << too_fast->warnings.back();
  for (ros::TwistMessage& twist : twists) twist.twist[0] = std::numeric_limits<double>::infinity();
  EXPECT_ERROR(file_with_links().twists("/t", twists).read({.wheel = "/t"}), "/t: ");
}

}  // namespace
}  // namespace adit
