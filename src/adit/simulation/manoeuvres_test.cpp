// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/manoeuvres.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/simulation/trajectory.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

DriveConfig only(double stops, double reversals, double turns) {
  DriveConfig config;
  config.manoeuvres.stops_per_km = stops;
  config.manoeuvres.reversals_per_km = reversals;
  config.manoeuvres.turns_per_km = turns;
  return config;
}

Trajectory driven(const DriveConfig& config, std::uint64_t seed = 1) {
  const TriangleMesh floor = test::floor_of({Eigen::Vector2d(-10, -10), Eigen::Vector2d(120, 10)}, 5.0,
                                            [](double, double) { return 0.0; });
  return drive(Raycaster::build(floor, EdgeRule::watertight).value(),
               {"robot", 2.0, {{0, 0, 0}, {100, 0, 0}}}, config, Stamp{}, seed)
      .value();
}

double standing_time(const Trajectory& t) {
  double sum = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i)
    if ((t[i].T_world_body.translation() - t[i - 1].T_world_body.translation()).norm() < 1e-5)
      sum += to_seconds(t[i].stamp - t[i - 1].stamp);
  return sum;
}

TEST(Manoeuvres, AreDrawnApart) {
  const std::vector<Manoeuvre> all = draw_manoeuvres(only(30, 30, 30).manoeuvres, 300.0, 5);
  std::size_t num = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    num += draw_manoeuvres(only(10, 10, 10).manoeuvres, 300.0, seed).size();
  EXPECT_NEAR(static_cast<double>(num) / 40.0, 9.0, 1.4);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_GE((all[i].share - all[i - 1].share) * 300.0, 5.0);
  EXPECT_TRUE(draw_manoeuvres({}, 300.0, 5).empty());
}

TEST(Manoeuvres, AStopLastsAndTheDriveGoesOn) {
  const Trajectory plain = driven({});
  const Trajectory stopped = driven(only(30, 0, 0));
  EXPECT_NEAR(stopped.back().T_world_body.translation().x(), 100.0, 1e-6);
  EXPECT_GT(standing_time(stopped) - standing_time(plain), 2.0 - 0.1);  // each half of 4 s or more
  EXPECT_NEAR(path_length(stopped), 100.0, 1e-3);
  EXPECT_NE(driven(only(30, 0, 0), 2).size(), stopped.size());
}

TEST(Manoeuvres, AReversalGoesBackAndComesAgain) {
  const Trajectory t = driven(only(0, 20, 0));
  double back = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i)
    back += std::max(0.0, t[i - 1].T_world_body.translation().x() - t[i].T_world_body.translation().x());
  EXPECT_GT(back, 0.2);
  EXPECT_NEAR(path_length(t), 100.0 + 2.0 * back, 1e-3);
  EXPECT_NEAR(t.back().T_world_body.translation().x(), 100.0, 1e-6);
}

TEST(Manoeuvres, ATurnIsOnTheSpot) {
  const Trajectory t = driven(only(0, 0, 20));
  double most = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double yaw = std::abs(t[i].T_world_body.yaw());
    most = std::max(most, yaw);
    const double moved = (t[i].T_world_body.translation() - t[i - 1].T_world_body.translation()).norm();
    if (yaw > 0.01) {
      EXPECT_LT(moved, 0.01);
    }
  }
  EXPECT_GT(most, 45.0 * kDegree - 0.01);
  EXPECT_LT(most, 135.0 * kDegree);
  EXPECT_NEAR(t.back().T_world_body.yaw(), 0.0, 1e-6);
}

TEST(Manoeuvres, NothingJumps) {
  const Trajectory t = driven(only(20, 20, 20));
  const auto twist = [&](std::size_t i) -> Vector6 {
    return (t[i - 1].T_world_body.inverse() * t[i].T_world_body).log() /
           to_seconds(t[i].stamp - t[i - 1].stamp);
  };
  for (std::size_t i = 2; i < t.size(); ++i) {
    const Vector6 change = (twist(i) - twist(i - 1)) / to_seconds(t[i].stamp - t[i - 1].stamp);
    EXPECT_LT(change.head<3>().norm(), 3.0);  // the nominal 0.8, scaled to keep the mean speed
    EXPECT_LT(change.tail<3>().norm(), 3.0);
  }
}

TEST(Manoeuvres, BumpsShakeTheBody) {
  DriveConfig config;
  config.bump_height = 0.02;
  const Trajectory t = driven(config);
  double squares = 0.0;
  double tilt = 0.0;
  for (const StampedPose& pose : t) {
    squares += std::pow(pose.T_world_body.translation().z(), 2) / static_cast<double>(t.size());
    tilt = std::max(tilt, pose.T_world_body.angle());
  }
  EXPECT_GT(std::sqrt(squares), 0.002);  // four wheels and springs
  EXPECT_LT(std::sqrt(squares), 0.02);
  EXPECT_GT(tilt, 0.2 * kDegree);
  EXPECT_LT(tilt, 5.0 * kDegree);
}

}  // namespace
}  // namespace adit
