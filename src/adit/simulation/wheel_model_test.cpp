// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/wheel_model.hpp"

#include <gtest/gtest.h>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"

namespace adit {
namespace {

WheelConfig perfect_wheels() {
  WheelConfig c;
  c.tick = c.scale_sigma = c.yaw_drift_deg = c.yaw_walk_deg = c.turn_scale_sigma = c.slip_sigma = 0.0;
  return c;
}

// A constant body twist (metres and radians per second) for some seconds, 100 poses per second.
Trajectory steady(double speed, double turn_rate, double seconds) {
  Trajectory truth;
  const Pose start = Pose::planar(5.0, -3.0, 0.7, 2.0);
  for (int i = 0; i <= std::lround(100.0 * seconds); ++i) {
    const double t = 0.01 * i;
    truth.push_back({Stamp{1'000'000'000} + from_seconds(t),
                     start * Pose::exp((Vector6() << speed * t, 0, 0, 0, 0, turn_rate * t).finished())});
  }
  return truth;
}

Pose motion(const Trajectory& trajectory) {
  return trajectory.front().T_world_body.inverse() * trajectory.back().T_world_body;
}

double difference(const Pose& a, const Pose& b) { return (a.inverse() * b).log().norm(); }

TEST(WheelModel, without_errors_it_is_the_true_motion_in_the_plane) {
  for (const double turn_rate : {0.0, 0.1, -1.5}) {
    for (const double speed : {0.0, 1.87, -0.5}) {
      const Trajectory truth = steady(speed, turn_rate, 12.34);
      const Trajectory wheel = wheel_odometry(truth, perfect_wheels(), 1);
      EXPECT_LT(difference(wheel.front().T_world_body, Pose()), 1e-12);
      EXPECT_LT(difference(motion(wheel), motion(truth)), 1e-9) << speed << " " << turn_rate;
    }
  }
}

TEST(WheelModel, stamps_span_the_truth_at_the_given_rate) {
  const Trajectory truth = steady(1.0, 0.0, 2.005);
  const Trajectory wheel = wheel_odometry(truth, WheelConfig(), 1);
  EXPECT_EQ(wheel.front().stamp, truth.front().stamp);
  EXPECT_EQ(wheel.back().stamp, truth.back().stamp);
  for (std::size_t i = 1; i < wheel.size(); ++i) {
    EXPECT_GT(wheel[i].stamp, wheel[i - 1].stamp);
    EXPECT_LE(wheel[i].stamp - wheel[i - 1].stamp, from_seconds(0.02));
  }
}

TEST(WheelModel, standing_wheels_count_nothing) {
  const Trajectory wheel = wheel_odometry(steady(0.0, 0.0, 5.0), WheelConfig(), 1);
  for (const StampedPose& p : wheel) EXPECT_EQ(difference(p.T_world_body, Pose()), 0.0);
}

TEST(WheelModel, one_pose_of_truth_gives_one_pose) {
  const Trajectory wheel = wheel_odometry({{Stamp{7}, Pose()}}, WheelConfig(), 1);
  ASSERT_EQ(wheel.size(), 1U);
  EXPECT_EQ(wheel.front().stamp, Stamp{7});
  EXPECT_THROW(static_cast<void>(wheel_odometry({}, WheelConfig(), 1)), ContractViolation);
}

TEST(WheelModel, ticks_cost_less_than_a_tick_however_far_it_drives) {
  WheelConfig c = perfect_wheels();
  c.tick = 0.01;
  const Trajectory truth = steady(1.87, 0.0, 60.0);
  const Pose error = motion(wheel_odometry(truth, c, 1)).inverse() * motion(truth);
  EXPECT_LT(error.translation().norm(), 0.01);
  EXPECT_LT(error.angle(), 0.01 / c.effective_track);
}

TEST(WheelModel, climbing_counts_the_path_along_the_slope_and_stays_in_the_plane) {
  Trajectory truth;
  const Pose climbing(Eigen::Quaterniond(Eigen::AngleAxisd(-0.3, Vector3::UnitY())), Vector3::Zero());
  for (int i = 0; i <= 1000; ++i) {
    truth.push_back({Stamp{10'000'000LL * i}, climbing * Pose::translation_of(0.01 * i, 0, 0)});
  }
  const Pose driven = motion(wheel_odometry(truth, perfect_wheels(), 1));
  EXPECT_LT((driven.translation() - Vector3(10.0, 0.0, 0.0)).norm(), 1e-9);
}

struct Spread {
  double mean_end_error = 0.0;
  double sigma_yaw_deg = 0.0;
  double sigma_length = 0.0;
};

// Over many robots that drive 400 m straight ahead.
Spread spread_of(const WheelConfig& config) {
  const Trajectory truth = steady(2.0, 0.0, 200.0);
  constexpr int kRobots = 60;
  Spread spread;
  for (std::uint64_t seed = 0; seed < kRobots; ++seed) {
    const Trajectory wheel = wheel_odometry(truth, config, seed);
    const Pose error = motion(truth).inverse() * motion(wheel);
    const double yaw = error.yaw() / kDegree;
    const double length = path_length(wheel) / 400.0 - 1.0;
    spread.mean_end_error += error.translation().norm() / kRobots;
    spread.sigma_yaw_deg += yaw * yaw / kRobots;
    spread.sigma_length += length * length / kRobots;
  }
  spread.sigma_yaw_deg = std::sqrt(spread.sigma_yaw_deg);
  spread.sigma_length = std::sqrt(spread.sigma_length);
  return spread;
}

TEST(WheelModel, drifts_by_one_or_two_percent_and_a_few_degrees) {
  const WheelConfig config;
  const Spread spread = spread_of(config);
  // Over 400 m the drift grows with the distance and the walk with its root; bounds are three standard errors
  // of 60 robots.
  const double expected_yaw_deg = std::hypot(4.0 * config.yaw_drift_deg, 2.0 * config.yaw_walk_deg);
  EXPECT_NEAR(spread.sigma_yaw_deg, expected_yaw_deg, 3.0 * expected_yaw_deg / std::sqrt(2.0 * 60.0));
  // The end is off to the side by half the drift's angle times the distance, and by the integrated walk.
  const double aside =
      400.0 * kDegree *
      std::hypot(0.5 * 4.0 * config.yaw_drift_deg, 2.0 * config.yaw_walk_deg / std::sqrt(3.0));
  EXPECT_GT(spread.mean_end_error, 0.6 * aside);
  EXPECT_LT(spread.mean_end_error, 1.1 * aside);
}

TEST(WheelModel, each_error_has_the_size_that_its_field_says) {
  WheelConfig scale = perfect_wheels();
  scale.scale_sigma = 0.01;
  EXPECT_NEAR(spread_of(scale).sigma_length, 0.01, 0.003);
  EXPECT_LT(spread_of(scale).sigma_yaw_deg, 1e-6);
  WheelConfig drift = perfect_wheels();
  drift.yaw_drift_deg = 1.0;
  EXPECT_NEAR(spread_of(drift).sigma_yaw_deg, 4.0, 1.2);
  WheelConfig walk = perfect_wheels();
  walk.yaw_walk_deg = 1.0;
  EXPECT_NEAR(spread_of(walk).sigma_yaw_deg, 2.0, 0.6);  // grows with the root of the distance
  WheelConfig slip = perfect_wheels();
  slip.slip_sigma = 0.05;
  EXPECT_NEAR(spread_of(slip).sigma_length, 0.05 * std::sqrt(2.0 * slip.slip_time / 200.0), 0.0015);
}

TEST(WheelModel, turns_are_wrong_by_a_constant_share) {
  WheelConfig c = perfect_wheels();
  c.turn_scale_sigma = 0.02;
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const double left = motion(wheel_odometry(steady(0.0, 0.5, 2.0), c, seed)).yaw();
    const double right = motion(wheel_odometry(steady(1.0, -0.5, 2.0), c, seed)).yaw();
    EXPECT_NEAR(left, -right, 1e-9);
    EXPECT_GT(std::abs(left - 1.0), 1e-4);
    EXPECT_LT(std::abs(left - 1.0), 0.08);
  }
}

WheelConfig with_faults(const std::string& faults) {
  WheelConfig c = perfect_wheels();
  c.faults = faults;
  return c;
}

/// Metres ahead from `begin` to `end`, seconds after the start of a steady drive.
double travelled(const Trajectory& wheel, double begin, double end) {
  const Stamp start{1'000'000'000};
  return (pose_at(wheel, start + from_seconds(begin)).value().inverse() *
          pose_at(wheel, start + from_seconds(end)).value())
      .translation()
      .x();
}

TEST(WheelModel, faults_last_as_long_as_they_are_said_to) {
  const Trajectory truth = steady(1.0, 0.0, 10.0);
  const auto drive = [&](const std::string& faults) { return wheel_odometry(truth, with_faults(faults), 1); };
  const Trajectory slip = drive("slip 2:4 0.5");
  EXPECT_NEAR(travelled(slip, 0, 2), 2.0, 1e-9);
  EXPECT_NEAR(travelled(slip, 2, 4), 3.0, 1e-9);
  EXPECT_NEAR(travelled(slip, 4, 10), 6.0, 1e-9);
  EXPECT_NEAR(travelled(drive("spin 2:4 0.7"), 2, 4), 3.4, 1e-9);
  const Trajectory lift = drive("lift 2:4");
  EXPECT_EQ(travelled(lift, 2, 4), 0.0);
  EXPECT_NEAR(travelled(lift, 0, 10), 8.0, 1e-9);
  const Trajectory freeze = drive("freeze 2:4");
  EXPECT_EQ(travelled(freeze, 2, 3.9), 0.0);
  EXPECT_NEAR(travelled(freeze, 0, 10), 10.0, 1e-9);  // the wheels counted on
  const Trajectory jump = drive("jump 5:8 1.5");
  EXPECT_NEAR(travelled(jump, 0, 4.98), 4.98, 1e-9);
  EXPECT_NEAR(travelled(jump, 0, 6), 7.5, 1e-9);
  EXPECT_NEAR(travelled(jump, 0, 10), 10.0, 1e-9);
}

TEST(WheelModel, spins_in_place_while_the_robot_stands) {
  const Trajectory wheel = wheel_odometry(steady(0.0, 0.0, 5.0), with_faults("spin 1:3 0.8"), 1);
  EXPECT_NEAR(travelled(wheel, 0, 5), 1.6, 1e-9);
}

TEST(WheelModel, silence_leaves_a_gap_and_nothing_else) {
  const Trajectory truth = steady(1.0, 0.1, 10.0);
  WheelConfig c;
  const Trajectory whole = wheel_odometry(truth, c, 1);
  c.faults = "silent 2:4";
  const Trajectory wheel = wheel_odometry(truth, c, 1);
  EXPECT_EQ(wheel.size() + 100, whole.size());
  EXPECT_EQ(difference(wheel.back().T_world_body, whole.back().T_world_body), 0.0);
}

TEST(WheelModel, sign_scale_and_time_offset) {
  const Trajectory truth = steady(1.0, 0.2, 10.0);
  const Pose right = motion(wheel_odometry(truth, perfect_wheels(), 1));
  WheelConfig c = perfect_wheels();
  c.sign = WheelSign::reversed;
  EXPECT_LT(difference(motion(wheel_odometry(truth, c, 1)).inverse(), Pose::exp(right.log())), 1e-9);
  c.sign = WheelSign::swapped;
  const Pose swapped = motion(wheel_odometry(truth, c, 1));
  EXPECT_NEAR(swapped.yaw(), -right.yaw(), 1e-9);
  EXPECT_NEAR(swapped.translation().x(), right.translation().x(), 1e-9);
  c = perfect_wheels();
  c.scale = 1.1;
  EXPECT_LT((motion(wheel_odometry(truth, c, 1)).log() - 1.1 * right.log()).norm(), 1e-9);
  c = perfect_wheels();
  c.time_offset = 0.1;
  const Trajectory late = wheel_odometry(truth, c, 1);
  EXPECT_EQ(late.front().stamp, truth.front().stamp + from_seconds(0.1));
  EXPECT_EQ(difference(motion(late), right), 0.0);
}

TEST(WheelModel, bursts_come_as_often_as_asked_and_their_truth_is_kept) {
  const Trajectory truth = steady(1.0, 0.0, 1200.0);
  WheelConfig c = perfect_wheels();
  c.burst_rate = 3.0;
  const std::vector<SensorFault> bursts = wheel_faults(truth, c, 1);
  EXPECT_NEAR(static_cast<double>(bursts.size()), 55.0, 20.0);  // 20 minutes, less the bursts themselves
  double extra = 0.0;
  for (const SensorFault& burst : bursts) {
    EXPECT_EQ(burst.kind, "slip");
    EXPECT_GE(burst.amount, 0.3);
    EXPECT_LE(burst.amount, 1.0);
    EXPECT_GE(to_seconds(burst.end - burst.begin), 1.0);
    EXPECT_LE(to_seconds(burst.end - burst.begin), 3.0);
    extra += burst.amount * to_seconds(std::min(burst.end, truth.back().stamp) - burst.begin);
  }
  EXPECT_NEAR(path_length(wheel_odometry(truth, c, 1)), 1200.0 + extra, 1.0);
  EXPECT_NE(wheel_faults(truth, c, 2).front().begin, bursts.front().begin);
  EXPECT_TRUE(wheel_faults(truth, WheelConfig(), 1).empty());
}

TEST(WheelModel, faults_change_no_other_error) {
  const Trajectory truth = steady(1.0, 0.1, 20.0);
  WheelConfig c;
  c.tick = 0.0;
  const Trajectory whole = wheel_odometry(truth, c, 1);
  c.faults = "slip 10:12 0.5";
  const Trajectory wheel = wheel_odometry(truth, c, 1);
  for (std::size_t i = 0; i <= 500; ++i)
    EXPECT_EQ(difference(wheel[i].T_world_body, whole[i].T_world_body), 0.0);
  const auto after = [](const Trajectory& t) {
    return t[650].T_world_body.inverse() * t.back().T_world_body;
  };
  EXPECT_LT(difference(after(wheel), after(whole)), 1e-9);
}

TEST(WheelModel, bad_configurations_are_refused) {
  EXPECT_TRUE(check_wheels(with_faults("lift 1:2, jump 3:4 -1")));
  EXPECT_FALSE(check_wheels(with_faults("lift 1:2 3")));
  WheelConfig c;
  c.burst_min = 2.0;
  EXPECT_FALSE(check_wheels(c));
}

TEST(WheelModel, the_seed_decides) {
  const Trajectory truth = steady(1.8, 0.05, 30.0);
  const Pose first = motion(wheel_odometry(truth, WheelConfig(), 1));
  EXPECT_EQ(difference(first, motion(wheel_odometry(truth, WheelConfig(), 1))), 0.0);
  EXPECT_GT(difference(first, motion(wheel_odometry(truth, WheelConfig(), 2))), 1e-3);
}

}  // namespace
}  // namespace adit
