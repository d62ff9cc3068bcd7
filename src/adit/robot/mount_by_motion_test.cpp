// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/mount_by_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "adit/core/angles.hpp"
#include "support/files.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

const Pose kTrueMount = Pose::translation_of(0.0, 0.0, 0.9);

/// T_world_base so many seconds after the start.
using Motion = std::function<Pose(double)>;

Pose straight(double seconds) { return Pose::translation_of(2.0 * seconds, 0.0, -2.0); }

/// Through the room at a metre a second, with turns to both sides.
Pose weaving(double seconds) {
  constexpr double kRate = 0.8;  // radians a second
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan(kRate * std::cos(kRate * seconds)), Vector3::UnitZ())),
      Vector3(seconds - 7.0, std::sin(kRate * seconds), 0.0)};
}

/// 13 s of `drive`, of which wheels count all. The mount that is stated is the true one, turned by `yaw_deg`.
Recording recording_of(const test::Scene& scene, const Motion& drive, double yaw_deg) {
  constexpr int kScans = 130;
  test::Lidar lidar{16, 900, 0.35, 100.0, 0.03};  // the noise of a VLP-16
  if (!scene.rooms.empty()) {
    lidar = {32, 256, 0.35, 100.0, 0.01};
    lidar.jitter = 0.5;
  }
  Recording recording;
  recording.name = "walker";
  for (int i = 0; i < kScans; ++i) {
    recording.scan_stamps.push_back(Stamp{lidar.period.count() * i});
    recording.wheel.push_back({recording.scan_stamps.back(), drive(0.1 * i)});
  }
  recording.read_scan = [=](std::size_t i) {
    const double end = 0.1 * static_cast<double>(i);
    return test::sweep(scene, lidar, kTrueMount, Stamp{lidar.period.count() * static_cast<std::int64_t>(i)},
                       [&](Duration offset) { return drive(end + to_seconds(offset)); });
  };
  recording.T_base_lidar = Pose::planar(0.0, 0.0, yaw_deg * kDegree) * kTrueMount;
  return recording;
}

// Its rings fit best where those of the scan before lay: scans are sure that the robot stands.
TEST(MountByMotion, ASmoothTubeNeverCertifiesAYaw) {
  for (const double yaw_deg : {6.0, 10.0})
    EXPECT_ERROR(mount_by_motion(recording_of(test::smooth_tube(), straight, yaw_deg)),
                 "the scans leave motion along the tunnel open");
}

TEST(MountByMotion, FindsAYawOfAnySize) {
  for (const double yaw_deg : {-10.0, 180.0}) {
    const Result<MountByMotion> found =
        mount_by_motion(recording_of(test::furnished_room(), weaving, yaw_deg));
    ASSERT_TRUE(found) << found.error().message;
    const double left = std::remainder(yaw_deg + found->yaw_deg, 360.0);
    EXPECT_LT(std::abs(left), 0.5) << yaw_deg << " " << found->yaw_deg;
    EXPECT_LT(std::abs(found->ahead_m), 0.1) << yaw_deg;
  }
}

TEST(MountByMotion, SaysWhyItCannotTell) {
  Recording recording = recording_of(
      test::furnished_room(), [](double) { return Pose(); }, 0.0);
  EXPECT_ERROR(mount_by_motion(recording), "moves too little");
  recording.wheel.clear();
  EXPECT_ERROR(mount_by_motion(recording), "no wheels");
}

}  // namespace
}  // namespace adit
