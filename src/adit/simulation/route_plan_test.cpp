// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/route_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "adit/core/parallel.hpp"
#include "adit/simulation/drivable_floor.hpp"
#include "adit/simulation/trajectory.hpp"
#include "adit/simulation/world.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

RoutePlan plan_of(const TriangleMesh& mesh, std::size_t robots, const RouteConfig& config = {}) {
  Result<RoutePlan> plan = plan_routes(mesh, robots, config);
  EXPECT_TRUE(plan) << plan.error().message;
  return plan.value_or(RoutePlan{});
}

/// Two levels of a hall, 60 x 6 m and 3 m high each, one above the other, and a ramp beside them that joins
/// them: from (50, 9, 0) to (10, 9, 5).
TriangleMesh two_levels() {
  const auto quad = [](TriangleMesh& mesh, const Vector3& a, const Vector3& b, const Vector3& c,
                       const Vector3& d) { test::add_quad(mesh, a, b, c, d); };
  TriangleMesh mesh;
  for (const double z : {0.0, 5.0}) {
    const double door = z == 0.0 ? 50.0 : 4.0;  // of 6 m, in the wall at y = 6
    quad(mesh, {0, 0, z}, {60, 0, z}, {60, 6, z}, {0, 6, z});
    quad(mesh, {0, 0, z + 3}, {0, 6, z + 3}, {60, 6, z + 3}, {60, 0, z + 3});
    quad(mesh, {0, 0, z}, {0, 0, z + 3}, {60, 0, z + 3}, {60, 0, z});
    quad(mesh, {0, 0, z}, {0, 6, z}, {0, 6, z + 3}, {0, 0, z + 3});
    quad(mesh, {60, 0, z}, {60, 0, z + 3}, {60, 6, z + 3}, {60, 6, z});
    quad(mesh, {0, 6, z}, {door, 6, z}, {door, 6, z + 3}, {0, 6, z + 3});
    quad(mesh, {door + 6, 6, z}, {60, 6, z}, {60, 6, z + 3}, {door + 6, 6, z + 3});
  }
  // The ramp's tunnel: level before the lower door, then 40 m of ramp, then level before the upper door.
  const auto stretch = [&](double x0, double z0, double x1, double z1) {
    quad(mesh, {x0, 6, z0}, {x0, 12, z0}, {x1, 12, z1}, {x1, 6, z1});
    quad(mesh, {x0, 6, z0 + 3}, {x1, 6, z1 + 3}, {x1, 12, z1 + 3}, {x0, 12, z0 + 3});
    quad(mesh, {x0, 12, z0}, {x0, 12, z0 + 3}, {x1, 12, z1 + 3}, {x1, 12, z1});
  };
  stretch(56, 0, 50, 0);
  stretch(50, 0, 10, 5);
  stretch(10, 5, 4, 5);
  quad(mesh, {56, 6, 0}, {56, 6, 3}, {56, 12, 3}, {56, 12, 0});
  quad(mesh, {4, 6, 5}, {4, 12, 5}, {4, 12, 8}, {4, 6, 8});
  quad(mesh, {50, 6, 0}, {50, 6, 3}, {10, 6, 8}, {10, 6, 5});  // its wall towards the halls
  return mesh;
}

/// A room without what is level at `height`.
TriangleMesh room_without(double height) {
  TriangleMesh mesh = test::room({0, 0, 0}, {40, 10, 5});
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
    return std::ranges::all_of(t, [&](int corner) {
      return mesh.vertices[static_cast<std::size_t>(corner)].z() == static_cast<float>(height);
    });
  });
  return mesh;
}

TEST(RoutePlan, RobotsDriveWhatIsPlannedForThemInAGeneratedMine) {
  WorldConfig world_config;
  world_config.preset = "mine";
  world_config.facet_factor = 4.0;
  const Result<World> world = make_world(world_config);
  ASSERT_TRUE(world) << world.error().message;
  RouteConfig config;
  config.length_m = 200.0;
  const RoutePlan plan = plan_of(world->mesh, 3, config);
  ASSERT_EQ(plan.robots.size(), 3U);
  const Result<Raycaster> raycaster = Raycaster::build(world->mesh, EdgeRule::watertight);
  std::set<std::string> names;
  for (const PlannedRoute& robot : plan.robots) {
    names.insert(robot.route.name);
    EXPECT_GT(length_of(robot.route), 100.0) << robot.route.name;
    EXPECT_LE(length_of(robot.route), 200.0) << robot.route.name;
    EXPECT_GE(robot.clearance_m, config.half_width_m()) << robot.route.name;
    EXPECT_LE(robot.slope_deg, config.max_slope_deg) << robot.route.name;
    for (std::size_t i = 1; i < robot.route.waypoints.size(); ++i)
      EXPECT_NEAR((robot.route.waypoints[i] - robot.route.waypoints[i - 1]).norm(), 1.0, 0.4);
    const Result<Trajectory> driven = drive(*raycaster, robot.route, {}, Stamp{0});
    EXPECT_TRUE(driven) << driven.error().message;
  }
  EXPECT_EQ(names, (std::set<std::string>{"robot_0", "robot_1", "robot_2"}));
}

TEST(RoutePlan, IsTheSameWithAnyNumberOfThreadsAndAnotherForEachSeed) {
  const TriangleMesh mesh = two_levels();
  RouteConfig config;
  const int threads_before = num_threads();
  set_num_threads(1);
  const RoutePlan one = plan_of(mesh, 2, config);
  set_num_threads(3);
  const RoutePlan three = plan_of(mesh, 2, config);
  set_num_threads(threads_before);
  config.seed = 2;
  const RoutePlan other = plan_of(mesh, 2, config);
  bool differs = false;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one.robots[i].route.waypoints, three.robots[i].route.waypoints);
    differs = differs || one.robots[i].route.waypoints != other.robots[i].route.waypoints;
  }
  EXPECT_TRUE(differs);
}

TEST(RoutePlan, LevelsAboveOneAnotherAreJoinedByTheRampAlone) {
  const TriangleMesh mesh = two_levels();
  const RoutePlan plan = plan_of(mesh, 1);
  const auto& points = plan.robots[0].route.waypoints;
  const auto [low, high] = std::ranges::minmax(points, {}, [](const Vector3& p) { return p.z(); });
  EXPECT_NEAR(low.z(), 0.0, 0.01);
  EXPECT_NEAR(high.z(), 5.0, 0.01);
  for (const Vector3& p : points) {
    const bool is_on_ramp = p.y() >= 6.0;
    EXPECT_TRUE(is_on_ramp || std::min(p.z(), 5.0 - p.z()) < 0.01)
        << "only the ramp leads up: " << p.transpose();
  }
  RouteConfig flat;
  flat.max_slope_deg = 5.0;
  flat.max_step_m = 0.0;
  const RoutePlan level = plan_of(mesh, 1, flat);
  const double height = level.robots[0].route.waypoints[0].z();
  for (const Vector3& p : level.robots[0].route.waypoints) EXPECT_NEAR(p.z(), height, 0.2);
  EXPECT_NE(level.notes.at(0).find("other parts of the floor cannot be reached"), std::string::npos);
}

TEST(DrivableFloor, KeepsAwayFromWallsAndDrops) {
  // A table in a room: nobody drives off its edge, and below it there is no headroom.
  TriangleMesh mesh = test::room({0, 0, 0}, {30, 12, 5});
  test::add_quad(mesh, {10, 4, 1}, {20, 4, 1}, {20, 8, 1}, {10, 8, 1});
  RouteConfig config;
  const Result<Raycaster> raycaster = Raycaster::build(mesh, EdgeRule::watertight);
  const Result<DrivableFloor> floor = drivable_floor(mesh, *raycaster, config);
  ASSERT_TRUE(floor) << floor.error().message;
  const double need = config.half_width_m();
  for (const FloorCell& cell : floor->cells) {
    const Vector3& p = cell.position;
    EXPECT_NEAR(p.z(), 0.0, 1e-6);
    EXPECT_GE(p.x(), need);
    EXPECT_LE(p.y(), 12.0 - need);
    EXPECT_FALSE(p.x() > 10 - need && p.x() < 20 + need && p.y() > 4 && p.y() < 8) << p.transpose();
  }
  EXPECT_NEAR(floor->area_m2(), (30 - 2 * need) * (12 - 2 * need) - (10 + 2 * need) * (4 + 2 * need), 25.0);
}

TEST(DrivableFloor, HoldsTheRoutesThatAGeneratedWorldComesWith) {
  WorldConfig world_config;
  world_config.preset = "metro";
  world_config.facet_factor = 4.0;
  const Result<World> world = make_world(world_config);
  ASSERT_TRUE(world) << world.error().message;
  const Result<Raycaster> raycaster = Raycaster::build(world->mesh, EdgeRule::watertight);
  const Result<DrivableFloor> floor = drivable_floor(world->mesh, *raycaster, {});
  ASSERT_TRUE(floor) << floor.error().message;
  for (const Route& route : world->routes)
    for (const Vector3& p : route.waypoints)
      EXPECT_TRUE(floor->cell_at(p)) << route.name << ' ' << p.transpose();
}

TEST(DrivableFloor, OfARoomFacesEitherWay) {
  TriangleMesh mesh = test::room({0, 0, 0}, {30, 6, 3});
  for (Eigen::Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_GT(plan_of(mesh, 1).floor_m2, 100.0);
}

TEST(RoutePlan, SaysWhatIsWrongWithAMesh) {
  const RouteConfig config;
  const auto flat = [](double, double) { return 0.0; };
  const Eigen::AlignedBox2d area(Eigen::Vector2d(0, 0), Eigen::Vector2d(40, 10));
  EXPECT_ERROR(plan_routes(test::floor_of(area, 5.0, flat), 1, config),
               "no roof: nothing is above the floor");
  EXPECT_ERROR(plan_routes(test::room({0, 0, 0}, {40, 10, 1}), 1, config),
               "no floor is high enough: the robot needs 1.5 m, and there are 1.00 m at");
  EXPECT_ERROR(plan_routes(room_without(5.0), 1, config), "no roof: nothing is above the floor");
  EXPECT_ERROR(plan_routes(room_without(0.0), 1, config), "no floor: what is level are roofs");
  TriangleMesh with_ledge = room_without(0.0);
  test::add_quad(with_ledge, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1});
  EXPECT_ERROR(plan_routes(with_ledge, 1, config), "no floor: what is level are roofs");
  TriangleMesh wall;
  test::add_quad(wall, {0, 0, 0}, {40, 0, 0}, {40, 0, 9}, {0, 0, 9});
  EXPECT_ERROR(plan_routes(wall, 1, config), "no floor: all surfaces are steeper than 60 degrees");
  EXPECT_ERROR(plan_routes(test::room({0, 0, 0}, {40, 1, 3}), 1, config), "no floor is wide enough");
  EXPECT_ERROR(plan_routes(test::room({0, 0, 0}, {6, 6, 3}), 1, config), "too small: the robot can drive on");
  EXPECT_ERROR(plan_routes({}, 1, config), "no triangle");
  EXPECT_ERROR(plan_routes(test::room({0, 0, 0}, {1e6, 10, 3}), 1, config), "move the mesh to the origin");
  EXPECT_ERROR(plan_routes(test::room({0, 0, 0}, {9e4, 9e4, 3}), 1, config), "is the unit metres?");
  TriangleMesh leaking;  // floor and roof without walls
  test::add_quad(leaking, {0, 0, 0}, {40, 0, 0}, {40, 10, 0}, {0, 10, 0});
  test::add_quad(leaking, {0, 0, 8}, {0, 10, 8}, {40, 10, 8}, {40, 0, 8});
  EXPECT_ERROR(plan_routes(leaking, 1, config), "the mesh is not closed");
  RouteConfig bad;
  bad.cell_m = 0.0;
  EXPECT_ERROR(plan_routes(two_levels(), 1, bad), "cell_m");
}

}  // namespace
}  // namespace adit
