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

Result<MountByMotion> found_of(const Recording& recording) {
  return motion_steps(recording).and_then(
      [](const std::vector<MotionStep>& steps) { return mount_by_motion(steps); });
}

// Its rings fit best where those of the scan before lay: scans are sure that the robot stands.
TEST(MountByMotion, ASmoothTubeNeverCertifiesAYaw) {
  for (const double yaw_deg : {6.0, 10.0})
    EXPECT_ERROR(found_of(recording_of(test::smooth_tube(), straight, yaw_deg)),
                 "the scans leave motion along the tunnel open");
}

TEST(MountByMotion, FindsAYawOfAnySize) {
  for (const double yaw_deg : {-10.0, 180.0}) {
    const Result<MountByMotion> found = found_of(recording_of(test::furnished_room(), weaving, yaw_deg));
    ASSERT_TRUE(found) << found.error().message;
    const double left = std::remainder(yaw_deg + found->yaw_deg, 360.0);
    EXPECT_LT(std::abs(left), 0.5) << yaw_deg << " " << found->yaw_deg;
    EXPECT_LT(std::abs(found->ahead_m), 0.1) << yaw_deg;
  }
}

/// Steps of a robot that drives and turns to both sides, as scans see them by a mount whose axes are turned
/// so.
std::vector<MotionStep> steps_seen(const Matrix3& R_base_true, double turn_a_step) {
  std::vector<MotionStep> steps;
  for (int i = 0; i < 120; ++i) {
    const double yaw = i % 30 < 10 ? turn_a_step : (i % 30 < 20 ? -turn_a_step : 0.0);
    const Pose true_step = Pose::planar(0.2, 0.0, yaw);
    const Pose turned(Eigen::Quaterniond(R_base_true), Vector3::Zero());
    MotionStep& step = steps.emplace_back();
    step.by_wheels = true_step.translation().head<2>();
    step.turned_by_wheels = yaw;
    step.by_scans = turned * true_step * turned.inverse();
    step.covariance = 1e-6 * Matrix6::Identity();
    step.is_registered = true;
  }
  return steps;
}

Matrix3 turned_about(double deg, const Vector3& axis) {
  return Eigen::AngleAxisd(deg * kDegree, axis).toRotationMatrix();
}

double angle_deg(const Matrix3& R) { return Eigen::AngleAxisd(R).angle() / kDegree; }

TEST(TiltByMotion, PitchShowsInTheDirectionAheadAndRollInTheAxisOfTurns) {
  const Matrix3 level = Matrix3::Identity();
  EXPECT_FALSE(tilt_by_motion(steps_seen(level, 0.03)));
  EXPECT_FALSE(tilt_by_motion(steps_seen(turned_about(20.0, Vector3::UnitY()), 0.03)))
      << "the floor shows it";
  EXPECT_FALSE(tilt_by_motion(steps_seen(turned_about(90.0, Vector3::UnitZ()), 0.03))) << "a yaw is no tilt";
  for (const Vector3& axis : {Vector3(Vector3::UnitY()), Vector3(Vector3::UnitX())})
    for (const double deg : {-90.0, -45.0, 45.0, 90.0}) {
      const Matrix3 wrong = turned_about(deg, axis);
      const std::optional<TiltByMotion> tilt = tilt_by_motion(steps_seen(wrong, 0.03));
      ASSERT_TRUE(tilt) << deg << " about " << axis.transpose();
      EXPECT_NEAR(tilt->tilt_deg, std::abs(deg), 0.1);
      EXPECT_LT(angle_deg(tilt->R_level_base * wrong), 0.1);
    }
  // Both, with turns; without them the roll stays unknown.
  const Matrix3 both = turned_about(50.0, Vector3::UnitY()) * turned_about(70.0, Vector3::UnitX());
  EXPECT_LT(angle_deg(tilt_by_motion(steps_seen(both, 0.03))->R_level_base * both), 0.1);
  EXPECT_NEAR(angle_deg(tilt_by_motion(steps_seen(both, 0.0))->R_level_base * both), 70.0, 0.1);
}

TEST(TiltByMotion, IsNotToldFromMotionThatScansDoNotSee) {
  const Matrix3 wrong = turned_about(45.0, Vector3::UnitY());
  std::vector<MotionStep> steps = steps_seen(wrong, 0.03);
  for (MotionStep& step : steps) step.is_registered = false;
  EXPECT_FALSE(tilt_by_motion(steps));
  steps = steps_seen(wrong, 0.03);
  for (std::size_t i = 0; i < steps.size(); i += 2)  // now up and now down, as of scans that leave it open
    steps[i].by_scans = steps_seen(turned_about(-45.0, Vector3::UnitY()), 0.03)[i].by_scans;
  EXPECT_FALSE(tilt_by_motion(steps));
  steps = steps_seen(wrong, 0.03);
  for (MotionStep& step : steps) step.by_wheels *= 2.0;  // another way than by the scans
  EXPECT_FALSE(tilt_by_motion(steps));
  steps = steps_seen(wrong, 0.03);
  for (MotionStep& step : steps) step.by_wheels *= -1.0;  // wired backward
  ASSERT_TRUE(tilt_by_motion(steps));
  EXPECT_NEAR(tilt_by_motion(steps)->tilt_deg, 45.0, 0.1);
  steps.resize(30);
  EXPECT_FALSE(tilt_by_motion(steps)) << "too few";
}

TEST(MountByMotion, SaysWhyItCannotTell) {
  Recording recording = recording_of(
      test::furnished_room(), [](double) { return Pose(); }, 0.0);
  EXPECT_ERROR(found_of(recording), "moves too little");
  recording.wheel.clear();
  EXPECT_ERROR(found_of(recording), "no wheels");
}

}  // namespace
}  // namespace adit
