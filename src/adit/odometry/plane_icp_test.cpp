// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/plane_icp.hpp"

#include <gtest/gtest.h>

#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

using test::kMount;

Scan still_scan(int index) { return test::still_scan(kMount, index); }

SensedMotion wheel_of(const Pose& T_base0_base1) {
  WheelDelta wheel;
  wheel.T_base0_base1 = T_base0_base1;
  wheel.duration = std::chrono::milliseconds(100);
  return {wheel};
}

Scan still_scan_without_times(int index) {
  Scan scan = still_scan(index);
  scan.cloud.time_offsets_ns.clear();  // wheels that lie would skew it
  return scan;
}

/// Registers still scans from `first` on, as far as the robot counts as moving, until one is ok.
std::vector<StepStatus> statuses_until_ok(PlaneIcp& odometry, int first) {
  std::vector<StepStatus> statuses;
  for (int i = first; i < first + 20 && (statuses.empty() || statuses.back() != StepStatus::ok); ++i)
    statuses.push_back(
        odometry.register_scan(still_scan(i), wheel_of(Pose::translation_of(0.01, 0, 0))).status);
  return statuses;
}

PlaneIcp with_a_map_of_the_room() {
  PlaneIcp odometry(PlaneIcpConfig{}, kMount);
  for (int i = 0; i < 8; ++i)
    odometry.register_scan(still_scan(i), wheel_of(Pose::translation_of(0.01, 0, 0)));
  return odometry;
}

/// A scan of another place: nothing of it lies where the map has points.
Scan strange_scan(int index) {
  Scan scan = still_scan_without_times(index);
  for (Eigen::Vector3f& p : scan.cloud.points) p.z() += 15.0F;
  return scan;
}

TEST(PlaneIcp, ARobotThatWasCarriedAwayStartsANewMapAfterASecond) {
  PlaneIcp odometry = with_a_map_of_the_room();
  const SensedMotion creep = wheel_of(Pose::translation_of(0.01, 0, 0));
  const std::size_t num_points = odometry.map().num_points();
  double x = 0.0;
  for (int i = 8; i < 17; ++i) {
    const OdometryStep step = odometry.register_scan(strange_scan(i), creep);
    EXPECT_EQ(step.status, StepStatus::too_few_points) << i;
    EXPECT_EQ(step.information, Matrix6::Zero());
    EXPECT_GT(step.T_odom_base.translation().x(), x);
    x = step.T_odom_base.translation().x();
  }
  EXPECT_EQ(odometry.map().num_points(), num_points);
  const OdometryStep anew = odometry.register_scan(strange_scan(17), creep);
  EXPECT_EQ(anew.status, StepStatus::no_map);
  EXPECT_NEAR(anew.T_odom_base.translation().x(), x + 0.01, 0.002);
  StepStatus last = anew.status;  // planes take some scans to grow
  for (int i = 18; i < 26; ++i) last = odometry.register_scan(strange_scan(i), creep).status;
  EXPECT_EQ(last, StepStatus::ok);
}

TEST(PlaneIcp, BlindScansLeaveTheMapAsItIs) {
  PlaneIcp odometry = with_a_map_of_the_room();
  const std::size_t num_points = odometry.map().num_points();
  const Pose T_creep = Pose::translation_of(0.002, 0, 0);
  for (int i = 8; i < 30; ++i)
    EXPECT_EQ(odometry.register_scan({still_scan(i).stamp, {}}, wheel_of(T_creep)).status,
              StepStatus::too_few_points);
  EXPECT_EQ(odometry.map().num_points(), num_points);
  EXPECT_EQ(statuses_until_ok(odometry, 30).size(), 1U);
}

// What the wheels say after a run of scans that could not be used covers the whole run.
TEST(PlaneIcp, AScanCorrectsWheelsThatSlippedWhileNothingWasMeasured) {
  PlaneIcp odometry = with_a_map_of_the_room();
  const SensedMotion creep = wheel_of(Pose::translation_of(0.002, 0, 0));
  const double before = odometry.register_scan(still_scan(8), creep).T_odom_base.translation().x();
  const SensedMotion slip = wheel_of(Pose::translation_of(0.01, 0, 0));  // while the robot stands
  double blind = 0.0;
  for (int i = 9; i < 29; ++i)
    blind = odometry.register_scan({still_scan(i).stamp, {}}, slip).T_odom_base.translation().x();
  EXPECT_GT(blind - before, 0.1);
  const OdometryStep after = odometry.register_scan(still_scan_without_times(29), slip);
  EXPECT_EQ(after.status, StepStatus::ok);
  EXPECT_NEAR(after.T_odom_base.translation().x(), before, 0.01);
}

// After a scan that could not be registered, a poor prediction is still brought near by point-to-point ICP.
TEST(PlaneIcp, AFailureDoesNotSwitchTheRescueOff) {
  const Pose T_kerb(so3::exp({0.0, 0.2, 0.0}), Vector3(0.0, 0.0, 0.5));
  const auto tilt_after = [&](bool fails) {
    PlaneIcp odometry = with_a_map_of_the_room();
    int next = 8;
    if (fails) {
      EXPECT_EQ(
          odometry.register_scan(strange_scan(next++), wheel_of(Pose::translation_of(0.01, 0, 0))).status,
          StepStatus::too_few_points);
    }
    return odometry.register_scan(still_scan_without_times(next), wheel_of(T_kerb)).T_odom_base.angle();
  };
  EXPECT_LT(tilt_after(false), 0.005);
  EXPECT_LT(tilt_after(true), 0.005);
}

// Six seconds through the furnished room; from the second to the fourth the wheels count `factor` times what
// was driven.
struct SlippingDrive {
  double largest_error_m = 0.0;
  int num_slipping_in_the_burst = 0;
  int num_slipping_else = 0;
};

SlippingDrive drive_with_a_burst(double factor) {
  test::Drive drive;
  drive.T_world_start = Pose::planar(-4.0, 0.0, 0.0);
  drive.velocity[0] = 1.5;
  test::Lidar lidar;
  lidar.jitter = 0.5;
  PlaneIcp odometry(PlaneIcpConfig{}, kMount);
  SlippingDrive out;
  for (int i = 0; i < 60; ++i) {
    const bool burst = i >= 20 && i < 40;
    SensedMotion motion;
    if (i > 0) motion.wheel = test::wheels_of(lidar, drive, i, burst ? factor : 1.0);
    const OdometryStep step =
        odometry.register_scan(test::scan_of(test::furnished_room(), lidar, kMount, drive, i), motion);
    const Pose T_true = drive.at(0.0).inverse() * drive.at(0.1 * i);
    out.largest_error_m =
        std::max(out.largest_error_m, (T_true.inverse() * step.T_odom_base).translation().norm());
    // It takes some scans to find that a burst has begun or ended.
    if (step.slip && burst) ++out.num_slipping_in_the_burst;
    if (step.slip && (i < 20 || i > 55)) ++out.num_slipping_else;
  }
  return out;
}

TEST(PlaneIcp, BurstsOfSlipAreFoundAndBridged) {
  // Slip by a third, wheels that race, and wheels that drag.
  for (const double factor : {1.5, 3.0, 0.4}) {
    const SlippingDrive drive = drive_with_a_burst(factor);
    EXPECT_LT(drive.largest_error_m, 0.25) << factor;  // of 3 to 6 m that were counted in vain
    EXPECT_GT(drive.num_slipping_in_the_burst, 12) << factor;
    EXPECT_EQ(drive.num_slipping_else, 0) << factor;
  }
  EXPECT_EQ(drive_with_a_burst(1.0).num_slipping_in_the_burst, 0);
}

}  // namespace
}  // namespace adit
