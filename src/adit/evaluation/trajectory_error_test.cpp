// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Association, ATE and RPE together: they share their made-up trajectories.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/evaluation/associate.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/rpe.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Stamp at(double seconds) { return Stamp{} + from_seconds(1.6e9) + from_seconds(seconds); }

/// A winding drive at 2 m/s, ten poses per second.
Trajectory winding(int n, double y = 0.0) {
  Trajectory trajectory;
  for (int i = 0; i < n; ++i) {
    const double s = 0.2 * i;
    trajectory.push_back(
        {at(0.1 * i), Pose::planar(s, y + 5.0 * std::sin(0.1 * s), 0.5 * std::cos(0.1 * s), 0.01 * s)});
  }
  return trajectory;
}

Trajectory moved(const Pose& T, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_body = T * pose.T_world_body;
  return trajectory;
}

const Pose kElsewhere =
    Pose::planar(-40.0, 12.0, 2.5, 3.0) * Pose(so3::exp({0.1, -0.2, 0.0}), Vector3::Zero());

TEST(Associate, InterpolatesTheTruthAndCountsWhatHasNone) {
  const Trajectory truth = {
      {at(0.0), Pose()}, {at(0.5), Pose::planar(1.0, 0.0, 0.0)}, {at(5.0), Pose::planar(9.0, 0.0, 0.0)}};
  Trajectory estimate;
  for (const double s : {-1.0, 0.0, 0.25, 0.5, 2.0, 5.0, 5.1}) estimate.push_back({at(s), Pose()});
  const AssociatedPoses pairs = associate(estimate, truth).value();
  ASSERT_EQ(pairs.size(), 4U);  // 2.0 lies in a gap of 4.5 s
  EXPECT_EQ(pairs.num_unmatched, 3U);
  EXPECT_NEAR(pairs.truth[1].translation().x(), 0.5, 1e-12);
  EXPECT_NEAR(pairs.truth[3].translation().x(), 9.0, 1e-12);
}

TEST(Associate, NoOverlapNamesBothSpans) {
  const Trajectory truth = {{at(10.0), Pose()}, {at(11.0), Pose()}};
  const Result<AssociatedPoses> pairs = associate(winding(5), truth);
  ASSERT_FALSE(pairs);
  EXPECT_NE(pairs.error().message.find("1600000010.000"), std::string::npos);
  EXPECT_NE(pairs.error().message.find("1600000000.400"), std::string::npos);
  EXPECT_FALSE(associate({}, truth));
  EXPECT_FALSE(associate(truth, {}));
}

TEST(Ate, IsZeroInAnyFrame) {
  const Trajectory truth = winding(300);
  const AteResult result = ate(moved(kElsewhere, truth), truth).value();
  EXPECT_LT(result.max_m, 1e-9);
  EXPECT_LT((result.T_world_estimate * kElsewhere).log().norm(), 1e-9);
  EXPECT_EQ(result.errors_m.size(), 300U);
}

TEST(Ate, HandMadeErrors) {
  // Four corners of a square; the estimate has one of them 4 m too high and its opposite too, the others 4 m
  // too low: no rigid motion reduces that, so each error is 4 m (to second order: the square is 1 km wide).
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 4; ++i) {
    const double angle = i * std::numbers::pi / 2.0;
    const Vector3 corner(1000.0 * std::cos(angle), 1000.0 * std::sin(angle), 0.0);
    truth.push_back({at(i), Pose(Eigen::Quaterniond::Identity(), corner)});
    estimate.push_back(
        {at(i), Pose(Eigen::Quaterniond::Identity(), corner + Vector3(0, 0, i % 2 == 0 ? 4.0 : -4.0))});
  }
  const AteResult result = ate(estimate, truth).value();
  EXPECT_NEAR(result.max_m, 4.0, 1e-9);
  EXPECT_NEAR(result.rmse_m, 4.0, 1e-9);
  EXPECT_NEAR(result.mean_m, 4.0, 1e-9);
  EXPECT_NEAR(result.median_m, 4.0, 1e-9);
}

TEST(Ate, IsDefinedForAStraightDrive) {
  Trajectory truth;
  for (int i = 0; i < 50; ++i) truth.push_back({at(i), Pose::planar(i, 0.0, 0.0)});
  Trajectory stretched = truth;  // odometry that reads 2 % too long
  for (StampedPose& p : stretched)
    p.T_world_body = Pose::planar(1.02 * p.T_world_body.translation().x(), 0.0, 0.0);
  EXPECT_NEAR(ate(stretched, truth).value().max_m, 0.02 * 49.0 / 2.0, 1e-9);
}

TEST(JointAte, AWrongMergeShowsAlthoughEachRobotIsPerfect) {
  const std::vector<Trajectory> truths = {winding(300), winding(300, 40.0)};
  const std::vector<Trajectory> merged = {moved(kElsewhere, truths[0]), moved(kElsewhere, truths[1])};
  const std::vector<AteResult> right = joint_ate(merged, truths).value();
  for (const AteResult& robot : right) EXPECT_LT(robot.max_m, 1e-9);

  // The second robot's map lies one cross passage (25 m) too far along the tunnel.
  const Pose shifted = kElsewhere * Pose::translation_of(25.0, 0.0, 0.0);
  const std::vector<Trajectory> wrong = {moved(kElsewhere, truths[0]), moved(shifted, truths[1])};
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(ate(wrong[i], truths[i]).value().max_m, 1e-9);
  const std::vector<AteResult> joint = joint_ate(wrong, truths).value();
  EXPECT_GT(joint[0].max_m, 5.0);
  EXPECT_GT(joint[1].max_m, 5.0);
  EXPECT_NEAR(joint[0].T_world_estimate.angle(), joint[1].T_world_estimate.angle(), 1e-15);
}

TEST(JointAte, NamesTheRobotWithoutTruth) {
  const std::vector<Trajectory> estimates = {winding(10), winding(10)};
  const std::vector<Trajectory> truths = {winding(10), {}};
  const Result<std::vector<AteResult>> joint = joint_ate(estimates, truths);
  ASSERT_FALSE(joint);
  EXPECT_NE(joint.error().message.find("trajectory 2 of 2"), std::string::npos);
  EXPECT_THROW((void)joint_ate(estimates, std::span(truths).first(1)), ContractViolation);
  EXPECT_FALSE(joint_ate({}, {}));
}

TEST(LargestDrift, IsThatFromTheWorstOfThreePlacesWhateverTheFrame) {
  const Trajectory truth = winding(500);
  EXPECT_LT(largest_drift_m(moved(kElsewhere, truth), truth).value(), 1e-9);

  Trajectory straight;
  Trajectory turning;
  for (int i = 0; i <= 100; ++i) {
    straight.push_back({at(i), Pose::planar(i, 0.0, 0.0)});
    turning.push_back({at(i), i < 90 ? Pose::planar(i, 0.0, 0.0)
                                     : Pose::planar(90.0, 0.0, 0.1) * Pose::planar(i - 90.0, 0.0, 0.0)});
  }
  // Right at the end, its heading is off by 0.1 all along the 90 m before.
  EXPECT_NEAR(largest_drift_m(moved(kElsewhere, turning), straight).value(), 2.0 * std::sin(0.05) * 90.0,
              1e-6);
  EXPECT_FALSE(largest_drift_m(straight, {}).has_value());
}

TEST(Rpe, IsZeroInAnyFrameAndSeesAConstantDrift) {
  const Trajectory truth = winding(500);
  const RpeResult perfect = rpe(moved(kElsewhere, truth), truth).value();
  EXPECT_LT(perfect.translation_rmse_m, 1e-9);
  EXPECT_LT(perfect.rotation_rmse_rad, 1e-7);

  Trajectory straight;
  Trajectory drifting;
  for (int i = 0; i <= 100; ++i) {
    straight.push_back({at(i), Pose::planar(i, 0.0, 0.0)});
    drifting.push_back({at(i), Pose::planar(1.01 * i, 0.0, 0.001 * i)});
  }
  const RpeResult drift = rpe(drifting, straight, 10.0, 0.05).value();
  EXPECT_EQ(drift.rotation_errors_rad.size(), 91U);  // segments start at 0 to 90 m
  EXPECT_NEAR(drift.rotation_rmse_rad, 0.01, 1e-9);
  EXPECT_NEAR(drift.rotation_median_rad, 0.01, 1e-9);
  EXPECT_NEAR(drift.translation_errors_m.front(), 0.1, 1e-9);
}

TEST(Rpe, ASegmentEndsAtThePoseNearestToItsLength) {
  // Stands at 4 m, and then goes on by more than the tolerance at a time.
  const std::vector<double> way = {0.0, 4.0, 4.0, 4.0, 9.4, 10.7, 14.5, 30.0};
  Trajectory truth;
  Trajectory drifting;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double t = static_cast<double>(i);
    truth.push_back({at(t), Pose::planar(way[i], 0.0, 0.0)});
    drifting.push_back({at(t), Pose::planar(way[i] + 0.001 * std::pow(2.0, t), 0.0, 0.0)});
  }
  // From 0 to 9.4, which is nearer than 10.7; from each of those at 4 to 14.5, off by 0.5; no other ends
  // well.
  const auto errors = [&](double tolerance) {
    return rpe(drifting, truth, 10.0, tolerance)->translation_errors_m;
  };
  const std::vector<double> found = errors(0.1);
  const std::vector<double> expected = {0.016 - 0.001, 0.064 - 0.002, 0.064 - 0.004, 0.064 - 0.008};
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
  EXPECT_EQ(errors(0.055).size(), 3U);
  EXPECT_NEAR(rpe(drifting, truth, 4.0, 0.0)->translation_errors_m.front(), 0.002 - 0.001, 1e-12)
      << "the first of several";
  EXPECT_ERROR(rpe(drifting, truth, 10.0, 0.0), "no two of 8 poses lie 10.0 m apart");
  EXPECT_THROW((void)rpe(drifting, truth, 10.0, -0.1), ContractViolation);
}

TEST(Rpe, RefusesAPathShorterThanASegment) {
  EXPECT_FALSE(rpe(winding(20), winding(20), 10.0));
  EXPECT_TRUE(rpe(winding(20), winding(20), 1.0, 0.2));
  EXPECT_THROW((void)rpe(winding(20), winding(20), 0.0), ContractViolation);
}

}  // namespace
}  // namespace adit
