// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/records.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

Stamp at(double seconds) { return Stamp{} + from_seconds(seconds); }

Trajectory square_drive() {
  return {
      {at(10), Pose::planar(0, 0, 0)}, {at(11), Pose::planar(2, 0, 0)}, {at(13), Pose::planar(2, 0, 1.0)}};
}

Pose random_pose(Rng& rng) {
  Vector6 xi;
  for (double& x : xi) x = rng.uniform(-1.5, 1.5);
  return Pose::exp(xi);
}

TEST(PoseAt, InterpolatesBetweenAndHitsTheEnds) {
  const Trajectory trajectory = square_drive();
  EXPECT_EQ(pose_at(trajectory, at(10))->translation(), Vector3(0, 0, 0));
  EXPECT_EQ(pose_at(trajectory, at(11))->translation(), Vector3(2, 0, 0));
  EXPECT_NEAR(pose_at(trajectory, at(13))->yaw(), 1.0, 1e-15);
  EXPECT_NEAR(pose_at(trajectory, at(10.25))->translation().x(), 0.5, 1e-12);
  EXPECT_NEAR(pose_at(trajectory, at(12))->yaw(), 0.5, 1e-12);
}

TEST(PoseAt, OutsideIsAnErrorThatNamesTheSpan) {
  const Trajectory trajectory = square_drive();
  for (const Stamp stamp : {at(10) - Duration(1), at(13) + Duration(1)}) {
    const Result<Pose> pose = pose_at(trajectory, stamp);
    ASSERT_FALSE(pose);
    EXPECT_NE(pose.error().message.find("10.000000 to 13.000000"), std::string::npos) << pose.error().message;
  }
  EXPECT_FALSE(pose_at({}, at(10)));
  const Trajectory one = {{at(5), Pose::planar(1, 2, 3)}};
  EXPECT_TRUE(pose_at(one, at(5)));
  EXPECT_FALSE(pose_at(one, at(5) + Duration(1)));
}

TEST(PoseAt, KeepsNanosecondsOfAnEpochStamp) {
  const std::int64_t epoch = 1'600'000'000'000'000'000;
  const Trajectory trajectory = {{{epoch}, {}}, {{epoch + 4}, Pose::translation_of(4, 0, 0)}};
  EXPECT_NEAR(pose_at(trajectory, {epoch + 1})->translation().x(), 1.0, 1e-12);
}

TEST(PathLength, IsThatOfThePolyline) {
  EXPECT_EQ(path_length({}), 0.0);
  EXPECT_EQ(path_length({{at(0), Pose::planar(5, 5, 5)}}), 0.0);
  EXPECT_NEAR(path_length(square_drive()), 2.0, 1e-15);
}

TEST(WheelDeltaTest, IsTheMotionInTheBaseFrame) {
  const Trajectory wheel = {{at(0), Pose::planar(5, 5, 1.2)},
                            {at(1), Pose::planar(5, 5, 1.2) * Pose::planar(2, 0.1, 0.3)}};
  const WheelDelta delta = wheel_delta(wheel, at(0), at(1)).value();
  EXPECT_LT((delta.T_base0_base1.translation() - Vector3(2, 0.1, 0)).norm(), 1e-12);
  EXPECT_NEAR(delta.T_base0_base1.yaw(), 0.3, 1e-12);
  EXPECT_EQ(delta.duration, from_seconds(1));
  EXPECT_NEAR(std::sqrt(delta.covariance(0, 0)), 0.02 * std::hypot(2, 0.1), 1e-9);
  EXPECT_GT(delta.covariance(0, 0), delta.covariance(1, 1));
}

TEST(WheelDeltaTest, StandingStillKeepsAFloorOfUncertainty) {
  const WheelDelta delta = wheel_delta({{at(0), {}}, {at(1), {}}}, at(0), at(1)).value();
  EXPECT_EQ(delta.T_base0_base1.log().norm(), 0.0);
  EXPECT_NEAR(delta.covariance(0, 0), 1e-6, 1e-12);
  EXPECT_GT(delta.covariance.diagonal().minCoeff(), 0.0);
}

TEST(WheelDeltaTest, OutsideTheOdometryIsAnError) {
  const Trajectory wheel = square_drive();
  EXPECT_FALSE(wheel_delta(wheel, at(9), at(11)));
  EXPECT_FALSE(wheel_delta(wheel, at(11), at(14)));
  EXPECT_NE(wheel_delta({}, at(0), at(1)).error().message.find("wheel odometry"), std::string::npos);
}

std::vector<ImuSample> samples_at(const std::vector<double>& seconds) {
  std::vector<ImuSample> imu;
  for (const double s : seconds) imu.push_back({at(s), Vector3(s, 0, 0), Vector3(0, 0, 9.81)});
  return imu;
}

std::vector<Stamp> stamps_between(const std::vector<ImuSample>& imu, double begin, double end) {
  std::vector<Stamp> stamps;
  for (const ImuSample& sample : imu_between(imu, at(begin), at(end), from_seconds(0.1)))
    stamps.push_back(sample.stamp);
  return stamps;
}

TEST(ImuBetween, CoversTheIntervalAtBothEnds) {
  const std::vector<ImuSample> imu = samples_at({1.00, 1.05, 1.10, 1.15, 1.20});
  EXPECT_EQ(stamps_between(imu, 1.06, 1.14), (std::vector{at(1.05), at(1.10), at(1.15)}));
  EXPECT_EQ(stamps_between(imu, 1.05, 1.15), (std::vector{at(1.05), at(1.10), at(1.15)}));
  EXPECT_EQ(stamps_between(imu, 1.06, 1.07), (std::vector{at(1.05), at(1.10)}));
  EXPECT_EQ(stamps_between(imu, 1.00, 1.20).size(), 5U);
  EXPECT_EQ(stamps_between(imu, 1.20, 1.20), std::vector{at(1.20)});
}

TEST(ImuBetween, IsEmptyWhereTheImuDoesNotReachOrWasSilent) {
  const std::vector<ImuSample> imu = samples_at({1.00, 1.05, 1.10, 1.30, 1.35});
  EXPECT_TRUE(stamps_between({}, 1.0, 1.1).empty());
  EXPECT_TRUE(stamps_between(imu, 0.99, 1.05).empty());
  EXPECT_TRUE(stamps_between(imu, 1.30, 1.36).empty());
  EXPECT_TRUE(stamps_between(imu, 1.05, 1.30).empty());
  EXPECT_TRUE(stamps_between(imu, 1.15, 1.20).empty());  // all of it within the silence
  EXPECT_EQ(stamps_between(imu, 1.05, 1.10).size(), 2U);
  EXPECT_EQ(stamps_between(imu, 1.30, 1.35).size(), 2U);
}

LoopClosure random_loop(Rng& rng) {
  LoopClosure loop;
  loop.from = {{0}, 3};
  loop.to = {{1}, 8};
  loop.T_from_to = random_pose(rng);
  Matrix6 root;
  for (double& x : root.reshaped()) x = rng.normal();
  loop.information = root * root.transpose() + Matrix6::Identity();
  return loop;
}

TEST(Reversed, TwiceIsTheSameLoop) {
  Rng rng(1);
  const LoopClosure loop = random_loop(rng);
  const LoopClosure twice = reversed(reversed(loop));
  EXPECT_EQ(twice.from, loop.from);
  EXPECT_EQ(twice.to, loop.to);
  EXPECT_LT((twice.T_from_to.matrix() - loop.T_from_to.matrix()).norm(), 1e-13);
  EXPECT_TRUE(twice.information.isApprox(loop.information, 1e-10));
}

TEST(Reversed, KeepsTheCostOfEveryError) {
  Rng rng(2);
  for (int round = 0; round < 20; ++round) {
    const LoopClosure loop = random_loop(rng);
    const LoopClosure back = reversed(loop);
    EXPECT_EQ(back.from, loop.to);
    EXPECT_EQ(back.to, loop.from);
    Vector6 d;
    for (double& x : d) x = 1e-6 * rng.normal();
    // One and the same true pose, its error measured at either end.
    const Pose T_from_to = loop.T_from_to * Pose::exp(d);
    const Vector6 d_back = (back.T_from_to.inverse() * T_from_to.inverse()).log();
    const double cost = d.dot(loop.information * d);
    EXPECT_NEAR(d_back.dot(back.information * d_back) / cost, 1.0, 1e-4);
  }
}

TEST(Words, OfStatuses) {
  EXPECT_EQ(to_string(StepStatus::ok), "ok");
  EXPECT_EQ(to_string(StepStatus::degenerate), "degenerate");
  EXPECT_EQ(to_string(LoopVerdict::accepted), "accepted");
  EXPECT_EQ(to_string(LoopVerdict::rejected), "rejected");
}

}  // namespace
}  // namespace adit
