// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "adit/simulation/floor_line.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

const Eigen::AlignedBox2d kField(Eigen::Vector2d(-10, -10), Eigen::Vector2d(60, 60));

Raycaster caster_of(const TriangleMesh& mesh) { return Raycaster::build(mesh, EdgeRule::watertight).value(); }
TriangleMesh flat() {
  return test::floor_of(kField, 5.0, [](double, double) { return 0.0; });
}
Route route_of(std::vector<Vector3> waypoints, double speed = 1.87) {
  return {"robot_0", speed, std::move(waypoints)};
}
Trajectory driven(const TriangleMesh& mesh, const Route& route, const DriveConfig& config = {}) {
  return drive(caster_of(mesh), route, config, Stamp{}).value();
}
double mean_speed(const Trajectory& t, const DriveConfig& config = {}) {
  return path_length(t) / (to_seconds(t.back().stamp - t.front().stamp) - config.stand_time);
}
// Body twist between two neighbouring poses, per second.
Vector6 twist(const Trajectory& t, std::size_t i) {
  return (t[i - 1].T_world_body.inverse() * t[i].T_world_body).log() /
         to_seconds(t[i].stamp - t[i - 1].stamp);
}

TEST(Drive, goes_straight_at_the_mean_speed_after_a_stand) {
  const DriveConfig config;
  const Trajectory t = driven(flat(), route_of({{0, 0, 0}, {20, 0, 0}, {50, 0, 0}}));
  EXPECT_LT((t.front().T_world_body.translation() - Vector3::Zero()).norm(), 1e-6);
  EXPECT_LT((t.back().T_world_body.translation() - Vector3(50, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(path_length(t), 50.0, 1e-6);
  EXPECT_NEAR(mean_speed(t), 1.87, 0.01 * 1.87);
  for (const StampedPose& p : t) {
    EXPECT_LT(p.T_world_body.angle(), 1e-6);
    if (to_seconds(p.stamp - t.front().stamp) <= config.stand_time) {
      EXPECT_LT(p.T_world_body.translation().norm(), 1e-6);
    }
  }
  for (std::size_t i = 2; i < t.size(); ++i) {  // no jerk beyond the nominal acceleration and its scaling
    EXPECT_LT((twist(t, i) - twist(t, i - 1)).norm() * config.sample_rate_hz, 1.3 * config.acceleration);
  }
}

TEST(Drive, rounds_a_corner_smoothly_and_slows_down_in_it) {
  const Trajectory t = driven(flat(), route_of({{0, 0, 0}, {20, 0, 0}, {20, 20, 0}}));
  EXPECT_NEAR(mean_speed(t), 1.87, 0.01 * 1.87);
  EXPECT_NEAR(t.front().T_world_body.yaw(), 0.0, 1e-6);
  EXPECT_NEAR(t.back().T_world_body.yaw(), 0.5 * std::numbers::pi, 1e-6);
  double slowest = 10.0;
  for (std::size_t i = 2; i < t.size(); ++i) {
    const Vector6 now = twist(t, i);
    EXPECT_NEAR(now[1], 0.0, 1e-2);                                 // no sideways motion
    EXPECT_LT(std::abs(now[5] - twist(t, i - 1)[5]) * 100.0, 6.0);  // the turn rate has no jumps
    EXPECT_LT(std::abs(now[5] * now[0]), 1.5);                      // lateral acceleration
    const Vector3& p = t[i].T_world_body.translation();
    EXPECT_TRUE(p.x() < 20.0 + 1e-6 && p.y() > -1e-6);  // cuts the corner, never swings out
    if (std::abs(p.x() - 19.5) < 0.5 && std::abs(p.y() - 0.5) < 0.5) slowest = std::min(slowest, now[0]);
  }
  EXPECT_LT(slowest, 1.6);
}

TEST(Drive, mean_speed_holds_on_short_fast_and_winding_routes) {
  std::vector<Vector3> winding;
  for (int i = 0; i <= 50; ++i) winding.emplace_back(i, 3.0 * std::sin(0.7 * i), 0.0);
  for (const Route& route : {route_of(winding), route_of({{0, 0, 0}, {0.4, 0, 0}}), route_of(winding, 6.0),
                             route_of({{0, 0, 0}, {50, 0, 0}}, 0.2)}) {
    const Trajectory t = driven(flat(), route);
    EXPECT_NEAR(mean_speed(t), route.speed_mps, 0.03 * route.speed_mps);
    EXPECT_LT(path_length(t), length_of(route) + 1e-6);
    EXPECT_GT(path_length(t), 0.85 * length_of(route));
  }
}

TEST(Drive, the_body_lies_on_a_ramp) {
  const double slope = std::tan(0.3);
  const auto ramp = [&](double x, double) { return slope * std::clamp(x - 10.0, 0.0, 20.0); };
  const TriangleMesh mesh = test::floor_of(kField, 5.0, ramp);
  const Trajectory t =
      driven(mesh, route_of({{0, 0, 0}, {10, 0, 0}, {30, 0, slope * 20.0}, {50, 0, slope * 20.0}}));
  EXPECT_NEAR(path_length(t), 30.0 + 20.0 / std::cos(0.3), 0.05);
  for (const StampedPose& p : t) {
    const Vector3& at = p.T_world_body.translation();
    EXPECT_NEAR(at.z(), ramp(at.x(), at.y()), 0.08);
    if (at.x() < 11.0 || at.x() > 29.0) continue;
    EXPECT_NEAR(at.z(), ramp(at.x(), at.y()), 1e-4);
    EXPECT_NEAR((p.T_world_body.rotation() * Vector3::UnitX()).z(), std::sin(0.3), 1e-4);  // nose up
  }
}

TEST(Drive, the_body_rolls_with_a_floor_that_falls_to_the_side) {
  const TriangleMesh mesh = test::floor_of(kField, 5.0, [](double, double y) { return 0.1 * y; });
  const Trajectory t = driven(mesh, route_of({{0, 0, 0}, {30, 0, 0}}));
  const Vector3 left = t[t.size() / 2].T_world_body.rotation() * Vector3::UnitY();
  EXPECT_NEAR(left.z() / left.y(), 0.1, 1e-4);
}

TEST(Drive, a_step_under_one_wheel_is_softened) {
  const TriangleMesh mesh =
      test::floor_of(kField, 0.25, [](double x, double y) { return x > 15.1 && y > 0.1 ? 0.1 : 0.0; });
  const Trajectory t = driven(mesh, route_of({{0, 0, 0}, {30, 0, 0}}));
  for (std::size_t i = 2; i < t.size(); ++i)
    EXPECT_LT((twist(t, i) - twist(t, i - 1)).tail<3>().norm() * 100.0, 10.0);
  const Vector3 left = t.back().T_world_body.rotation() * Vector3::UnitY();
  EXPECT_NEAR(std::asin(left.z()), std::atan(0.1 / 0.6), 1e-3);
}

TEST(Drive, keeps_to_its_own_level_and_to_the_floor_under_waypoints_that_float) {
  TriangleMesh mesh = flat();
  append(mesh, test::floor_of(kField, 5.0, [](double, double) { return 2.5; }));
  append(mesh, test::floor_of(kField, 5.0, [](double, double) { return 5.0; }));
  const Trajectory upper = driven(mesh, route_of({{0, 0, 3.1}, {10, 0, 2.9}, {20, 0, 2.3}, {30, 0, 2.5}}));
  for (const StampedPose& p : upper) EXPECT_NEAR(p.T_world_body.translation().z(), 2.5, 1e-5);
  const Trajectory lower = driven(mesh, route_of({{0, 0, 0.6}, {10, 0, -0.4}, {30, 0, 0.9}}));
  for (const StampedPose& p : lower) EXPECT_NEAR(p.T_world_body.translation().z(), 0.0, 1e-5);
}

TEST(Drive, crosses_a_hole_between_waypoints) {
  TriangleMesh mesh = test::floor_of({Eigen::Vector2d(-5, -5), Eigen::Vector2d(10, 5)}, 5.0,
                                     [](double, double) { return 0.0; });
  append(mesh, test::floor_of({Eigen::Vector2d(12, -5), Eigen::Vector2d(32, 5)}, 5.0,
                              [](double, double) { return 0.0; }));
  for (const StampedPose& p : driven(mesh, route_of({{0, 0, 0}, {9, 0, 0}, {13, 0, 0}, {30, 0, 0}}))) {
    EXPECT_NEAR(p.T_world_body.translation().z(), 0.0, 1e-6);
  }
}

TEST(Drive, waypoints_that_repeat_change_nothing) {
  const Trajectory once = driven(flat(), route_of({{0, 0, 0}, {20, 0, 0}, {20, 20, 0}}));
  const Trajectory twice =
      driven(flat(), route_of({{0, 0, 0}, {0, 0, 0}, {20, 0, 0}, {20, 0, 0}, {20, 20, 0}, {20, 20, 0}}));
  ASSERT_EQ(once.size(), twice.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_LT((once[i].T_world_body.inverse() * twice[i].T_world_body).log().norm(), 1e-6);
  }
}

std::string error_of(const TriangleMesh& mesh, const Route& route) {
  const Result<Trajectory> t = drive(caster_of(mesh), route, DriveConfig(), Stamp{});
  return t ? "" : t.error().message;
}
void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
}

TEST(Drive, refuses_routes_without_extent_or_speed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_words(error_of(flat(), route_of({})), {"robot_0", "0 waypoints"});
  expect_words(error_of(flat(), route_of({{1, 2, 0}})), {"robot_0", "1 waypoints"});
  expect_words(error_of(flat(), route_of({{1, 2, 0}, {1, 2, 0}, {1, 2, 0}})), {"robot_0", "3 waypoints"});
  expect_words(error_of(flat(), route_of({{1, 2, 0}, {1, nan, 0}})), {"robot_0", "waypoint 1", "not finite"});
  expect_words(error_of(flat(), route_of({{1, 2, 0}, {5, 2, 0}}, 0.0)), {"robot_0", "speed"});
  expect_words(error_of(flat(), route_of({{1, 2, 0}, {5, 2, 0}}, nan)), {"robot_0", "speed"});
}

TEST(Drive, names_the_waypoint_without_floor) {
  expect_words(error_of(flat(), route_of({{0, 0, 0}, {5, 0, 0}, {-30, 4, 0.5}})),
               {"robot_0", "waypoint 2", "(-30.00, 4.00, 0.50)", "no floor"});
  expect_words(error_of(flat(), route_of({{0, 0, 3.5}, {5, 0, 0}})), {"waypoint 0", "no floor"});
  expect_words(error_of(flat(), route_of({{0, 0, -2.0}, {5, 0, 0}})), {"waypoint 0", "no floor"});
}

TEST(Drive, names_the_waypoint_before_a_wall) {
  TriangleMesh mesh = flat();
  test::add_quad(mesh, {7.3, -5, 0}, {7.3, 5, 0}, {7.3, 5, 3}, {7.3, -5, 3});
  expect_words(error_of(mesh, route_of({{0, 0, 0}, {5, 0, 0}, {20, 0, 0}})),
               {"robot_0", "waypoint 1", "wall"});
  EXPECT_EQ(error_of(mesh, route_of({{0, 0, 0}, {5, 0, 0}, {5, 10, 0}, {20, 10, 0}})), "");
}

TEST(Drive, sees_a_wall_that_stands_exactly_on_a_waypoint) {
  TriangleMesh mesh = flat();
  test::add_quad(mesh, {10, -5, 0}, {10, 5, 0}, {10, 5, 3}, {10, -5, 3});
  expect_words(error_of(mesh, route_of({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}})), {"robot_0", "wall"});
}

TEST(Drive, refuses_to_reverse) {
  expect_words(error_of(flat(), route_of({{0, 0, 0}, {10, 0, 0}, {0, 0, 0}})),
               {"robot_0", "reverses its direction"});
}

TEST(FloorHeight, finds_the_nearest_surface_within_reach) {
  TriangleMesh mesh = flat();
  append(mesh, test::floor_of(kField, 5.0, [](double, double) { return 1.2; }));
  const Raycaster raycaster = caster_of(mesh);
  EXPECT_NEAR(floor_height(raycaster, {1, 1, 0.5}).value(), 0.0, 1e-6);
  EXPECT_NEAR(floor_height(raycaster, {1, 1, 0.7}).value(), 1.2, 1e-6);
  EXPECT_NEAR(floor_height(raycaster, {1, 1, 4.1}).value(), 1.2, 1e-6);
  EXPECT_FALSE(floor_height(raycaster, {1, 1, 4.3}).has_value());
  EXPECT_FALSE(floor_height(raycaster, {1, 1, -1.6}).has_value());
  EXPECT_FALSE(floor_height(raycaster, {100, 1, 0}).has_value());
}

}  // namespace
}  // namespace adit
