// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// IMUs in recordings of other programs.
#include <gtest/gtest.h>

#include <limits>

#include "adit/io/bag_recording.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;
using test::make_scan;

/// Three samples at the stamps of scans.
std::vector<ros::ImuMessage> imu_messages(const std::string& frame = "os_imu") {
  std::vector<ros::ImuMessage> messages(3);
  for (std::size_t i = 0; i < 3; ++i) {
    messages[i].frame = frame;
    messages[i].sample = {make_scan(i, 0).stamp, Vector3(0.1, 0, 0), Vector3(double(i), 0, 9.81)};
  }
  return messages;
}

TEST(McapImu, TheMountOfTheImuFollowsStaticTransforms) {
  const Pose os_imu = Pose::translation_of(0.006, -0.012, 0.008);
  const ForeignFile file = ForeignFile()
                               .clouds("/os/points")
                               .odometry("/odom", "base_link")
                               .imu("/os/imu", imu_messages("/os_imu"))
                               .links({test::link("base_link", "os_sensor", test::T_base_ouster),
                                       test::link("os_sensor", "os_lidar", test::T_ouster_lidar),
                                       test::link("os_sensor", "os_imu", os_imu)});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->imu.size(), 3U);
  EXPECT_EQ(recording->imu[2].specific_force, Vector3(2, 0, 9.81));
  EXPECT_LT((recording->T_base_imu.inverse() * test::T_base_ouster * os_imu).log().norm(), 1e-12);
  EXPECT_EQ(recording->imu_mount_source, "/tf_static: base_link -> os_sensor -> os_imu");
  EXPECT_TRUE(recording->assumptions.empty());
  // A mount of the LiDAR given by the user moves the IMU with it.
  const Result<Recording> moved = file.read({.mount = "1 2 3"});
  ASSERT_TRUE(moved) << moved.error().message;
  const Pose T_lidar_imu = test::T_ouster_lidar.inverse() * os_imu;
  EXPECT_LT((moved->T_base_imu.inverse() * Pose::translation_of(1, 2, 3) * T_lidar_imu).log().norm(), 1e-12);
  EXPECT_EQ(file.read({.imu_mount = "4 5 6"})->T_base_imu.translation(), Vector3(4, 5, 6));
  EXPECT_ERROR(file.read({.imu_mount = "4 5"}), "2 numbers");
}

TEST(McapImu, AnUnknownMountOfTheImuIsAnAssumptionWithARemedy) {
  const ForeignFile file = ForeignFile()
                               .clouds("/os/points")
                               .imu("/os/imu", imu_messages())
                               .links({test::link("base_link", "os_lidar", test::T_base_ouster)});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_LT((recording->T_base_imu.inverse() * test::T_base_ouster).log().norm(), 1e-12);
  ASSERT_EQ(recording->assumptions.size(), 1U);
  EXPECT_TRUE(recording->assumptions.front().starts_with(
      "mount of the IMU: the LiDAR's, as no /tf_static links 'base_link' and 'os_imu'; if"))
      << recording->assumptions.front();
  EXPECT_NE(recording->assumptions.front().find("--imu-mount"), std::string::npos);
  EXPECT_TRUE(file.read({.imu_mount = "0 0 1"})->assumptions.empty());
  // In the LiDAR's own frame nothing is assumed.
  const Result<Recording> same = ForeignFile()
                                     .clouds("/os/points")
                                     .imu("/os/imu", imu_messages("os_lidar"))
                                     .read({.mount = "0.1 0 0.5"});
  ASSERT_TRUE(same) << same.error().message;
  EXPECT_EQ(same->T_base_imu.translation(), Vector3(0.1, 0, 0.5));
  EXPECT_TRUE(same->assumptions.empty());
}

TEST(McapImu, OneOfSeveralImusCanBeChosenOrNone) {
  std::vector<ros::ImuMessage> second = imu_messages();
  second.pop_back();
  const ForeignFile file = ForeignFile()
                               .clouds("/os/points")
                               .imu("/os/imu", imu_messages())
                               .imu("/camera/imu", second)
                               .links({test::link("base", "os_lidar", test::T_base_ouster)});
  EXPECT_ERROR(file.read(),
               "several topics of IMUs; give one of them, the likeliest first: --imu /os/imu (3 messages) or "
               "--imu /camera/imu (2 messages)");
  EXPECT_ERROR(file.read({.imu = "/left"}), "no topic of IMUs '/left'; there are: /os/imu, /camera/imu");
  // All that is open is asked at once.
  ForeignFile more = file;
  more.odometry("/wheels/odom").odometry("/fused/odom");
  EXPECT_ERROR(more.read(), "several topics of wheel odometry; give one");
  EXPECT_ERROR(more.read(), "several topics of IMUs; give one");
  EXPECT_ERROR(more.read(), "; adit info prints the whole command");
  EXPECT_EQ(file.read({.imu = "/os/imu"})->imu.size(), 3U);
  EXPECT_EQ(file.read({.imu = "/camera/imu"})->imu.size(), 2U);
  const Result<Recording> none = file.read({.imu = "none"});
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->imu.empty());
  EXPECT_TRUE(none->assumptions.empty());
}

TEST(McapImu, SamplesOfTheImuThatCannotBeUsedAreLeftOut) {
  const auto read = [](const std::vector<ros::ImuMessage>& samples) {
    return ForeignFile().clouds("/os/points", "os_imu").imu("/imu", samples).read({.mount = "0 0 1"}).value();
  };
  std::vector<ros::ImuMessage> backward = imu_messages();
  backward[2].sample.stamp = backward[0].sample.stamp;
  const Recording shorter = read(backward);
  EXPECT_EQ(shorter.imu.size(), 2U);
  EXPECT_EQ(shorter.assumptions,
            std::vector<std::string>{
                "imu: 1 of 3 samples are left out, whose stamps do not ascend with the others' "
                "(check the driver's clock); the first is at 1700000000.123456789 s"});
  std::vector<ros::ImuMessage> broken = imu_messages();
  broken[1].sample.angular_velocity.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(read(broken).imu.size(), 2U);
  EXPECT_EQ(read(broken).assumptions.size(), 1U);
  std::vector<ros::ImuMessage> no_gyro = imu_messages();
  no_gyro[0].covariance.angular_velocity(0, 0) = -1;
  EXPECT_TRUE(read(no_gyro).imu.empty());
  ASSERT_EQ(read(no_gyro).assumptions.size(), 1U);
  EXPECT_NE(read(no_gyro).assumptions.front().find("angular velocity was not measured"), std::string::npos);
}

}  // namespace
}  // namespace adit
