// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/joint_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/robot/scan_loop.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;

constexpr double kRadius = 0.15;
constexpr double kTrack = 0.6;

JointDriveConfig two_wheels() {
  JointDriveConfig drive;
  drive.left = "left_wheel";
  drive.right = "right_wheel";
  drive.wheel_radius = kRadius;
  drive.track_width = kTrack;
  return drive;
}

Stamp at(int index) { return {1'700'000'000'000'000'000 + 20'000'000LL * index}; }

struct Wheel {
  double left = 0.0;
  double right = 0.0;
};

/// The angles of two wheels whose speeds change at random, and the drive by fine steps of the definition of
/// the motion: forward by v dt, then turned by w dt.
struct Drive {
  std::vector<Wheel> angles;
  std::vector<Pose> poses;
};
Drive random_drive(int num, double speed) {
  Rng rng(7);
  Drive drive{{{0.3, -1.2}}, {Pose()}};
  for (int i = 1; i < num; ++i) {
    const double left = 0.02 * speed * rng.uniform(-0.2, 1.0);
    const double right = 0.02 * speed * rng.uniform(-0.2, 1.0);
    drive.angles.push_back({drive.angles.back().left + left, drive.angles.back().right + right});
    constexpr int kFine = 20'000;
    const double forward = kRadius * (left + right) / 2.0 / kFine;
    const double turn = kRadius * (right - left) / kTrack / kFine;
    double x = 0.0;
    double y = 0.0;
    for (int k = 0; k < kFine; ++k) {
      x += forward * std::cos((k + 0.5) * turn);
      y += forward * std::sin((k + 0.5) * turn);
    }
    drive.poses.push_back(drive.poses.back() * Pose::planar(x, y, kFine * turn));
  }
  return drive;
}

ros::JointStateMessage message_of(int index, double left, double right) {
  return {at(index), {"arm", "right_wheel", "left_wheel"}, {0.5, right, left}, {}};
}

Result<JointTrack> track_of(const std::vector<ros::JointStateMessage>& messages,
                            const JointDriveConfig& drive) {
  Result<JointOdometry> odometry = JointOdometry::create(drive);
  if (!odometry) return tl::unexpected(odometry.error());
  for (const ros::JointStateMessage& message : messages)
    if (odometry->has_wheels(message)) odometry->add(message);
  return std::move(*odometry).finish();
}

void expect_poses(const JointTrack& track, const std::vector<Pose>& poses, double tolerance) {
  ASSERT_EQ(track.poses.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(track.poses[i].stamp, at(static_cast<int>(i)));
    EXPECT_LT((poses[i].inverse() * track.poses[i].T_world_body).log().norm(), tolerance) << i;
  }
}

TEST(JointOdometry, AnglesOfTwoWheelsAreTheDriveThatTheirMotionDefines) {
  const Drive drive = random_drive(50, 12.0);
  std::vector<ros::JointStateMessage> messages;
  for (std::size_t i = 0; i < drive.angles.size(); ++i) {
    messages.push_back(message_of(static_cast<int>(i), drive.angles[i].left, drive.angles[i].right));
    messages.push_back({at(static_cast<int>(i)), {"arm"}, {1.0}, {}});  // of another driver
  }
  const Result<JointTrack> track = track_of(messages, two_wheels());
  ASSERT_TRUE(track) << track.error().message;
  expect_poses(*track, drive.poses, 1e-8);
  EXPECT_TRUE(track->warnings.empty());
}

TEST(JointOdometry, AnglesWithinOneTurnAreCountedOn) {
  const Drive drive = random_drive(400, 12.0);
  std::vector<ros::JointStateMessage> whole;
  std::vector<ros::JointStateMessage> wrapped;
  for (std::size_t i = 0; i < drive.angles.size(); ++i) {
    const auto [left, right] = drive.angles[i];
    constexpr double kTurn = 2.0 * std::numbers::pi;
    whole.push_back(message_of(static_cast<int>(i), left, right));
    wrapped.push_back(message_of(static_cast<int>(i), std::remainder(left, kTurn),
                                 right - kTurn * std::floor(right / kTurn)));
  }
  ASSERT_GT(drive.angles.back().left, 20.0);
  const Result<JointTrack> expected = track_of(whole, two_wheels());
  const Result<JointTrack> track = track_of(wrapped, two_wheels());
  ASSERT_TRUE(expected && track);
  EXPECT_TRUE(track->warnings.empty());
  for (std::size_t i = 0; i < expected->poses.size(); ++i)
    EXPECT_LT((expected->poses[i].T_world_body.inverse() * track->poses[i].T_world_body).log().norm(), 1e-9);
}

TEST(JointOdometry, AJumpIsASilence) {
  std::vector<ros::JointStateMessage> messages;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.1 * i + (i < 100 ? 0.0 : -5000.0);  // a driver that was started again
    messages.push_back(message_of(i, angle, angle));
  }
  const Result<JointTrack> track = track_of(messages, two_wheels());
  ASSERT_TRUE(track) << track.error().message;
  ASSERT_EQ(track->warnings.size(), 1U);
  EXPECT_NE(track->warnings[0].find("1 jumps"), std::string::npos) << track->warnings[0];
  Recording recording;
  recording.wheel = track->poses;
  recording.scan_stamps = {at(50), at(98), at(105), at(160), at(170)};
  EXPECT_TRUE(sensed_before(recording, 1).wheel);
  EXPECT_FALSE(sensed_before(recording, 2).wheel);
  EXPECT_FALSE(sensed_before(recording, 3).wheel);
  ASSERT_TRUE(sensed_before(recording, 4).wheel);
  EXPECT_NEAR(sensed_before(recording, 4).wheel->T_base0_base1.translation().x(), 10 * 0.1 * kRadius, 1e-9);
}

TEST(JointOdometry, VelocitiesServeWhereAnglesAreAbsentOrStay) {
  for (const bool has_angles : {false, true}) {
    std::vector<ros::JointStateMessage> messages;
    for (int i = 0; i < 100; ++i) {
      ros::JointStateMessage message{at(i), {"left_wheel", "right_wheel"}, {}, {0.1 * i, 0.1 * i + 1.0}};
      if (has_angles) message.positions = {0.0, 0.0};
      messages.push_back(message);
    }
    const Result<JointTrack> track = track_of(messages, two_wheels());
    ASSERT_TRUE(track) << track.error().message;
    const double time = 0.02 * 99;
    const Pose& last = track->poses.back().T_world_body;
    EXPECT_NEAR(last.angle(), kRadius * 1.0 * time / kTrack, 1e-9);
    EXPECT_NEAR(path_length(track->poses), kRadius * (0.1 * 99 / 2.0 + 0.5) * time, 2e-3);
  }
}

TEST(JointOdometry, SidesAreMeansAndAMinusTurnsAWheelRound) {
  JointDriveConfig drive = two_wheels();
  drive.left = "fl, rl";
  drive.right = "-fr,-rr";
  std::vector<ros::JointStateMessage> messages;
  for (int i = 0; i < 10; ++i)
    messages.push_back({at(i), {"fl", "fr", "rl", "rr"}, {0.1 * i, -0.1 * i, 0.3 * i, -0.3 * i}, {}});
  const Result<JointTrack> track = track_of(messages, drive);
  ASSERT_TRUE(track) << track.error().message;
  const Pose straight = Pose::translation_of(0.2 * 9 * kRadius, 0, 0);
  EXPECT_LT((straight.inverse() * track->poses.back().T_world_body).log().norm(), 1e-9);
}

// Rear wheels and two steered wheels that point at one centre, 5 m to the left of the rear axle.
TEST(JointOdometry, AckermannSteeringFollowsTheCircleOfItsWheels) {
  constexpr double kCircle = 5.0;
  constexpr double kBase = 1.8;
  constexpr double kWidth = 1.2;
  JointDriveConfig drive;
  drive.left = "rl";
  drive.right = "rr";
  drive.steering = "sl,sr";
  drive.wheel_radius = kRadius;
  drive.wheelbase = kBase;
  drive.axle_x = -0.9;
  std::vector<ros::JointStateMessage> messages;
  for (int i = 0; i < 100; ++i) {
    const double turned = 0.01 * i;
    messages.push_back(
        {at(i),
         {"rl", "rr", "sl", "sr"},
         {turned * (kCircle - kWidth / 2) / kRadius, turned * (kCircle + kWidth / 2) / kRadius,
          std::atan(kBase / (kCircle - kWidth / 2)), std::atan(kBase / (kCircle + kWidth / 2))},
         {}});
  }
  const Result<JointTrack> track = track_of(messages, drive);
  ASSERT_TRUE(track) << track.error().message;
  // The robot's frame turns about the centre, which stands beside the axle.
  const Pose T_base_centre = Pose::translation_of(drive.axle_x, kCircle, 0);
  const Pose expected = T_base_centre * Pose::planar(0, 0, 0.99) * T_base_centre.inverse();
  EXPECT_LT((expected.inverse() * track->poses.back().T_world_body).log().norm(), 1e-9);
}

TEST(JointOdometry, WhatTheDescriptionLacksIsNamed) {
  EXPECT_ERROR(JointOdometry::create({}), "recording.drive.left, recording.drive.right");
  JointDriveConfig drive = two_wheels();
  drive.track_width = 0.0;
  EXPECT_ERROR(JointOdometry::create(drive), "missing: recording.drive.track_width");
  JointDriveConfig nameless = drive;
  nameless.left = ",";
  EXPECT_ERROR(JointOdometry::create(nameless), "missing: recording.drive.left, recording.drive.track_width");
  drive.steering = "s";
  EXPECT_ERROR(JointOdometry::create(drive), "missing: recording.drive.wheelbase");
  EXPECT_ERROR(
      track_of({{at(0), {"b", "a"}, {0, 0}, {}}}, two_wheels()),
      "no message has all of left_wheel, right_wheel with finite angles or velocities; its joints are a, b");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_ERROR(track_of({message_of(0, nan, 1.0)}, two_wheels()), "no message has all of");
}

TEST(JointOdometry, ARecordingHasTheWheelsThatAreAskedFor) {
  std::vector<ros::JointStateMessage> messages;
  const Stamp first = test::make_scan(0, 0).stamp;
  for (int i = 0; i < 50; ++i) {
    ros::JointStateMessage message = message_of(i, 0.1 * i, 0.1 * i);
    message.stamp = first + Duration(20'000'000LL * i);
    messages.push_back(message);
  }
  messages[20].stamp = messages[19].stamp;
  ForeignFile file;
  file.clouds("/points")
      .joints("/joint_states", messages)
      .links({test::link("base_link", "os_lidar", Pose())});
  const Result<Recording> unasked = file.read();
  ASSERT_TRUE(unasked) << unasked.error().message;
  EXPECT_TRUE(unasked->wheel.empty());
  ASSERT_EQ(unasked->warnings.size(), 1U);
  EXPECT_NE(
      unasked->warnings[0].find("give --wheel /joint_states --set recording.drive.left=left_wheel --set "
                                "recording.drive.right=right_wheel --set"),
      std::string::npos)
      << unasked->warnings[0];
  EXPECT_ERROR(file.read({.wheel = "/joint_states"}),
               "missing: recording.drive.left, recording.drive.right, recording.drive.wheel_radius, "
               "recording.drive.track_width");
  EXPECT_ERROR(file.read({.wheel = "/joint_states"}), "its joints are arm, left_wheel, right_wheel");
  EXPECT_ERROR(file.read({.wheel = "/joints"}), "there are: /joint_states");
  JointDriveConfig drive = two_wheels();
  const Result<Recording> recording = file.read({.wheel = "/joint_states", .drive = drive});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->wheel.size(), 49U);
  EXPECT_NEAR(recording->wheel.back().T_world_body.translation().x(), 4.9 * kRadius, 1e-9);
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_NE(recording->warnings[0].find("1 of 50 messages are left out"), std::string::npos);
  drive.left = "lft_wheel";
  EXPECT_ERROR(file.read({.wheel = "/joint_states", .drive = drive}),
               "/joint_states: no message has all of lft_wheel");
}

TEST(JointOdometry, EveryTruncationOfAMessageIsAnError) {
  CdrWriter writer;
  writer.number(std::int32_t{1}).number(std::uint32_t{2}).text("").number(std::uint32_t{1}).text("wheel");
  writer.number(std::uint32_t{1}).number(0.5).number(std::uint32_t{1}).number(2.5);
  const std::string message = writer.take();
  const Result<ros::JointStateMessage> joints = ros::decode_joint_state(message);
  ASSERT_TRUE(joints) << joints.error().message;
  EXPECT_EQ(joints->names, std::vector<std::string>{"wheel"});
  EXPECT_EQ(joints->positions, std::vector<double>{0.5});
  EXPECT_EQ(joints->velocities, std::vector<double>{2.5});
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_FALSE(ros::decode_joint_state(message.substr(0, size))) << size;
}

}  // namespace
}  // namespace adit
