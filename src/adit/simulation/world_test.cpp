// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/world_plan.hpp"

namespace adit {
namespace {

/// The presets of one layout each; "network" has tests of its own.
const std::vector<std::string>& layouts() {
  static const std::vector<std::string> names{"zab", "mine", "metro", "tiles"};
  return names;
}

World world_of(const std::string& preset, std::uint64_t seed) {
  WorldConfig config;
  config.preset = preset;
  config.seed = seed;
  Result<World> world = make_world(config);
  EXPECT_TRUE(world);
  return std::move(*world);
}

WorldPlan plan_of(const std::string& preset, std::uint64_t seed, const std::string& routes = "meeting") {
  WorldConfig config;
  config.seed = seed;
  config.routes = routes;
  if (preset == "zab") return plan_zab(config);
  if (preset == "tiles") return plan_tiles(config);
  return preset == "mine" ? plan_mine(config) : plan_metro(config);
}

/// Smallest distance in plan from `point` to the vertices of the walls between `low` and `high` above the
/// floor.
double wall_distance(const World& world, const Vector3& point, double low, double high) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : world.mesh.vertices) {
    const Vector3 d = vertex.cast<double>() - point;
    if (d.z() > low && d.z() < high) nearest = std::min(nearest, d.head<2>().norm());
  }
  return nearest;
}

/// Where a ray first meets the mesh (Moeller and Trumbore 1997), by brute force; infinity: nowhere.
double first_hit(const TriangleMesh& mesh, const Vector3& origin, const Vector3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int k) -> Vector3 {
      return mesh.vertices[static_cast<std::size_t>(t[k])].cast<double>();
    };
    const Vector3 a = corner(0);
    const Vector3 ab = corner(1) - a;
    const Vector3 ac = corner(2) - a;
    const Vector3 p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant <= 0.0) continue;  // Seen from behind: robots drive in front of every triangle.
    const Vector3 s = origin - a;
    const double u = s.dot(p) / determinant;
    const Vector3 q = s.cross(ab);
    const double v = direction.dot(q) / determinant;
    const double distance = ac.dot(q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

struct Shared {
  double along = 0.0;     ///< Metres of the first route near the second, driven the same way.
  double opposite = 0.0;  ///< The same, driven the other way.
};

Shared shared_stretch(const Route& first, const Route& second) {
  Shared shared;
  for (std::size_t i = 1; i < first.waypoints.size(); ++i) {
    const Vector3 step = first.waypoints[i] - first.waypoints[i - 1];
    double nearest = 3.0;
    double turn = 0.0;
    for (std::size_t j = 1; j < second.waypoints.size(); ++j) {
      const double distance = (second.waypoints[j] - first.waypoints[i]).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      turn = step.dot(second.waypoints[j] - second.waypoints[j - 1]);
    }
    if (nearest < 3.0) (turn > 0.0 ? shared.along : shared.opposite) += step.norm();
  }
  return shared;
}

void expect_mesh_is_sound_and_fits_its_size(const World& world) {
  ASSERT_TRUE(check_mesh(world.mesh));
  EXPECT_LT(world.mesh.triangles.size(), 1'500'000U);
  EXPECT_GT(world.tunnel_length, 1200.0);
  EXPECT_LT(world.tunnel_length, 3000.0);
  const Eigen::Vector3f size = bounding_box(world.mesh).sizes();
  EXPECT_GT(size.x(), 300.0F);
  EXPECT_LT(size.head<2>().maxCoeff(), 600.0F);
  EXPECT_LT(size.z(), 25.0F);
}

void expect_surface_is_closed_but_for_the_portals(const World& world) {
  // The rims of the portals hold some 40 edges each, those of headings and cut slivers a few more.
  const EdgeStatistics edges = edge_statistics(world.mesh);
  EXPECT_LT(static_cast<double>(edges.num_boundary), 1e-3 * static_cast<double>(edges.num_edges));
  EXPECT_LT(static_cast<double>(edges.num_over_shared), 3e-4 * static_cast<double>(edges.num_edges));
  EXPECT_LT(edges.num_inconsistent, 20U);
}

void expect_rays_hit_something_unless_they_leave_through_a_portal(const World& world) {
  Rng rng(7);
  const Eigen::AlignedBox3d box = bounding_box(world.mesh).cast<double>();
  for (const Route& route : world.routes)
    for (int i = 0; i < 12; ++i) {
      const Vector3 origin = route.waypoints[rng.below(route.waypoints.size())] + Vector3(0, 0, 1.0);
      const Vector3 direction = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
      const double distance = first_hit(world.mesh, origin, direction);
      if (std::isfinite(distance)) {
        EXPECT_TRUE(box.contains(origin + (distance - 1e-3) * direction));
        continue;
      }
      // Only near the ends of the world and nearly level can a ray get out.
      EXPECT_LT(std::abs(direction.z()), 0.9) << origin.transpose();
      EXPECT_GT(std::abs(direction.x()), 0.1) << origin.transpose();
    }
}

void expect_routes_have_the_papers_lengths_and_speeds(const World& world) {
  ASSERT_EQ(world.routes.size(), 4U);
  for (const Route& route : world.routes) {
    EXPECT_GT(length_of(route), 390.0) << route.name;
    EXPECT_LT(length_of(route), 455.0) << route.name;
    EXPECT_GE(route.speed_mps, 1.8);
    EXPECT_LE(route.speed_mps, 1.9);
    for (std::size_t i = 1; i < route.waypoints.size(); ++i)
      EXPECT_NEAR((route.waypoints[i] - route.waypoints[i - 1]).norm(), 1.0, 0.12);
  }
}

void expect_routes_start_apart_and_every_pair_shares_a_stretch(const World& world) {
  double opposite = 0.0;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) {
      const Route& first = world.routes[a];
      const Route& second = world.routes[b];
      EXPECT_GT((first.waypoints.front() - second.waypoints.front()).norm(), 15.0);
      const Shared shared = shared_stretch(first, second);
      EXPECT_GE(shared.along + shared.opposite, 40.0) << first.name << " " << second.name;
      opposite = std::max(opposite, shared.opposite);
    }
  EXPECT_GE(opposite, 40.0);
}

void expect_routes_turn_gently(const World& world) {
  for (const Route& route : world.routes)
    for (std::size_t i = 2; i < route.waypoints.size(); ++i) {
      const Vector3 before = route.waypoints[i - 1] - route.waypoints[i - 2];
      const Vector3 after = route.waypoints[i] - route.waypoints[i - 1];
      const double angle = std::acos(std::clamp(before.normalized().dot(after.normalized()), -1.0, 1.0));
      EXPECT_LT(angle, 1.0 / 1.4) << route.name << " at waypoint " << i;
    }
}

void expect_routes_keep_clear_of_walls_and_obstacles(const World& world, const WorldPlan& plan) {
  for (const Route& route : world.routes)
    for (const Vector3& waypoint : route.waypoints) {
      const double floor = on_floor(plan.relief, waypoint).z();
      ASSERT_NEAR(waypoint.z(), floor, 1e-9);
      const Vector3 body(waypoint.x(), waypoint.y(), 1.2);  // In the world before its relief.
      EXPECT_GE(depth_inside(plan.spaces, body), 1.0) << route.name << " at " << waypoint.transpose();
      EXPECT_GE(distance_to(plan.obstacles, body), 1.0) << route.name << " at " << waypoint.transpose();
    }
  for (const Route& route : world.routes)
    for (std::size_t i = 0; i < route.waypoints.size(); i += 20)
      EXPECT_GE(wall_distance(world, route.waypoints[i], 0.5, 1.6), 0.8)
          << route.name << " at waypoint " << i;
}

class WorldOf : public testing::TestWithParam<std::tuple<std::string, std::uint64_t>> {};

// One test for all properties: making the world is what costs.
TEST_P(WorldOf, IsSoundAndDrivable) {
  const auto& [preset, seed] = GetParam();
  const World world = world_of(preset, seed);
  expect_mesh_is_sound_and_fits_its_size(world);
  expect_surface_is_closed_but_for_the_portals(world);
  expect_rays_hit_something_unless_they_leave_through_a_portal(world);
  expect_routes_have_the_papers_lengths_and_speeds(world);
  expect_routes_start_apart_and_every_pair_shares_a_stretch(world);
  expect_routes_turn_gently(world);
  expect_routes_keep_clear_of_walls_and_obstacles(world, plan_of(preset, seed));
}

INSTANTIATE_TEST_SUITE_P(Presets, WorldOf,
                         testing::Combine(testing::Values("zab", "mine", "metro", "tiles"),
                                          testing::Values<std::uint64_t>(1, 2)),
                         [](const auto& suite) {
                           return std::get<0>(suite.param) + std::to_string(std::get<1>(suite.param));
                         });

TEST(World, EverySeedGivesDrivableRoutesApart) {
  for (const std::string& preset : layouts())
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
      const WorldPlan plan = plan_of(preset, seed, "apart");
      for (const Drive& drive : plan.drives)
        for (const Vector3& waypoint : route_of(drive).waypoints) {
          const Vector3 body(waypoint.x(), waypoint.y(), 1.2);
          ASSERT_GE(depth_inside(plan.spaces, body), 1.0) << preset << seed << " " << waypoint.transpose();
          ASSERT_GE(distance_to(plan.obstacles, body), 1.0) << preset << seed << " " << waypoint.transpose();
        }
    }
}

TEST(World, EverySeedGivesDrivableRoutes) {
  for (const std::string& preset : layouts())
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const WorldPlan plan = plan_of(preset, seed);
      std::vector<Route> routes;
      for (const Drive& drive : plan.drives) routes.push_back(route_of(drive));
      for (const Route& route : routes)
        for (const Vector3& waypoint : route.waypoints) {
          const Vector3 body(waypoint.x(), waypoint.y(), 1.2);
          ASSERT_GE(depth_inside(plan.spaces, body), 1.0) << preset << seed << " " << waypoint.transpose();
          ASSERT_GE(distance_to(plan.obstacles, body), 1.0) << preset << seed << " " << waypoint.transpose();
        }
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) {
          const Shared shared = shared_stretch(routes[a], routes[b]);
          ASSERT_GE(shared.along + shared.opposite, 30.0) << preset << seed << " pair " << a << b;
        }
    }
}

World coarse_world(const std::string& preset, const std::string& arrangement, const std::string& routes) {
  WorldConfig config;
  config.preset = preset;
  config.arrangement = arrangement;
  config.routes = routes;
  config.facet_factor = 4.0;
  Result<World> world = make_world(config);
  EXPECT_TRUE(world);
  return std::move(*world);
}

/// Metres of the first route near the second, either way.
double shared_metres(const World& world, std::size_t a, std::size_t b) {
  const Shared shared = shared_stretch(world.routes[a], world.routes[b]);
  return shared.along + shared.opposite;
}

class ArrangementOf : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(ArrangementOf, TwoRobotsShareEachNetworkAndNothingElse) {
  const auto& [preset, arrangement] = GetParam();
  const World world = coarse_world(preset, arrangement, "meeting");
  ASSERT_EQ(world.routes.size(), 4U);
  EXPECT_EQ(world.name, preset + "-" + arrangement);
  ASSERT_TRUE(check_mesh(world.mesh));
  expect_rays_hit_something_unless_they_leave_through_a_portal(world);
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) {
      const bool same_network = a / 2 == b / 2;
      if (same_network)
        EXPECT_GE(shared_metres(world, a, b), 30.0) << a << b;
      else
        EXPECT_EQ(shared_metres(world, a, b), 0.0) << a << b;
    }
}

INSTANTIATE_TEST_SUITE_P(All, ArrangementOf,
                         testing::Combine(testing::Values("zab", "mine", "metro", "tiles"),
                                          testing::Values("different", "mirrored", "copies", "twins")),
                         [](const auto& suite) {
                           return std::get<0>(suite.param) + "_" + std::get<1>(suite.param);
                         });

/// The second network's vertices, as they would stand where the first one is.
std::vector<Eigen::Vector3f> second_half(const World& world, const World& single) {
  const std::size_t n = single.mesh.vertices.size();
  std::vector<Eigen::Vector3f> half(world.mesh.vertices.begin() + static_cast<std::ptrdiff_t>(n),
                                    world.mesh.vertices.end());
  const auto dy = static_cast<float>(world.routes[2].waypoints[0].y() - single.routes[0].waypoints[0].y());
  for (Eigen::Vector3f& vertex : half) vertex.y() -= dy;
  return half;
}

TEST(World, TwinsAreTheSameAndCopiesDifferInTheirFurniture) {
  const World single = coarse_world("zab", "single", "meeting");
  const std::vector<Eigen::Vector3f> twin = second_half(coarse_world("zab", "twins", "meeting"), single);
  ASSERT_EQ(twin.size(), single.mesh.vertices.size());
  for (std::size_t i = 0; i < twin.size(); ++i) ASSERT_LT((twin[i] - single.mesh.vertices[i]).norm(), 1e-3F);
  const World copies = coarse_world("zab", "copies", "meeting");
  EXPECT_NE(second_half(copies, single).size(), twin.size());
  for (std::size_t i = 0; i < single.routes[0].waypoints.size(); ++i) {
    const Vector3 step = copies.routes[2].waypoints[i] - single.routes[0].waypoints[i];
    EXPECT_NEAR(step.x(), 0.0, 1e-9);
  }
}

TEST(World, AMirrorImageTurnsLeftIntoRight) {
  const World world = coarse_world("tiles", "mirrored", "meeting");
  const auto turn_of = [&](std::size_t robot) {  // Sum of the signed turns of the whole route.
    const std::vector<Vector3>& way = world.routes[robot].waypoints;
    double sum = 0.0;
    for (std::size_t i = 2; i < way.size(); ++i)
      sum += (way[i - 1] - way[i - 2]).cross(way[i] - way[i - 1]).z();
    return sum;
  };
  for (std::size_t robot = 0; robot < 2; ++robot) {
    EXPECT_NEAR(length_of(world.routes[robot]), length_of(world.routes[robot + 2]), 1e-6);
    EXPECT_NEAR(turn_of(robot), -turn_of(robot + 2), 1e-6);
  }
  const EdgeStatistics edges = edge_statistics(world.mesh);
  EXPECT_LT(edges.num_inconsistent, 40U);
}

TEST(World, RoutesApartShareNothingAcrossTheirTunnels) {
  for (const std::string& preset : layouts()) {
    const World world = coarse_world(preset, "single", "apart");
    ASSERT_EQ(world.routes.size(), 4U);
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 2; b < 4; ++b) EXPECT_EQ(shared_metres(world, a, b), 0.0) << preset << a << b;
    if (preset == "zab")
      EXPECT_EQ(shared_metres(world, 0, 1) + shared_metres(world, 2, 3), 0.0);
    else
      EXPECT_GE(std::min(shared_metres(world, 0, 1), shared_metres(world, 2, 3)), 30.0) << preset;
  }
}

TEST(World, FurnitureHasASeedOfItsOwn) {
  WorldConfig config;
  config.facet_factor = 4.0;
  config.furniture_seed = 7;
  const Result<World> other = make_world(config);
  ASSERT_TRUE(other);
  const World own = coarse_world("zab", "single", "meeting");
  EXPECT_NE(other->mesh.vertices.size(), own.mesh.vertices.size());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(other->routes[i].waypoints == own.routes[i].waypoints);
}

TEST(World, NoTwoBlocksOfATileRowAreEquallyLong) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const WorldPlan plan = plan_of("tiles", seed);
    const Polyline& row = plan.drives[0].legs[0];
    EXPECT_NEAR(std::remainder(length_of(row), 20.0), 0.0, 1e-9);
  }
  EXPECT_FALSE(plan_of("tiles", 1).drives[0].legs[2] == plan_of("tiles", 2).drives[0].legs[2] &&
               plan_of("tiles", 1).drives[0].legs[0] == plan_of("tiles", 3).drives[0].legs[0]);
}

TEST(World, SameSeedSameBytesWithAnyNumberOfThreads) {
  const int before = num_threads();
  set_num_threads(1);
  const World first = world_of("zab", 3);
  set_num_threads(2);
  const World again = world_of("zab", 3);
  set_num_threads(before);
  EXPECT_TRUE(first.mesh.vertices == again.mesh.vertices);
  EXPECT_TRUE(first.mesh.triangles == again.mesh.triangles);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(first.routes[i].waypoints == again.routes[i].waypoints);
  EXPECT_FALSE(world_of("zab", 4).mesh.vertices == first.mesh.vertices);
}

TEST(World, ZabHasAFlatFloorAndSmoothWalls) {
  const World world = world_of("zab", 1);
  for (const Route& route : world.routes)
    for (const Vector3& waypoint : route.waypoints) EXPECT_EQ(waypoint.z(), 0.0);
  std::size_t num_floor = 0;
  for (const Eigen::Vector3i& t : world.mesh.triangles) {
    const auto corner = [&](int k) { return world.mesh.vertices[static_cast<std::size_t>(t[k])]; };
    const Eigen::Vector3f normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const bool is_sliver = normal.norm() < 1e-3F;  // Its direction means nothing.
    const bool is_floor = normal.normalized().z() > 0.99F && corner(0).z() < 0.1F;  // Niches begin at 0.12 m.
    if (is_sliver || !is_floor) continue;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(corner(k).z(), 0.0F, 4e-3F);
    ++num_floor;
  }
  EXPECT_GT(num_floor, 1000U);
}

TEST(World, RefusesWhatItCannotMake) {
  WorldConfig config;
  config.preset = "subway";
  const Result<World> unknown = make_world(config);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("zab, mine, metro"), std::string::npos) << unknown.error().message;
  config = {};
  config.relief_factor = -1.0;
  EXPECT_FALSE(make_world(config));
}

TEST(World, KnobsChangeTheWorldAndKeepItDrivable) {
  for (const std::string& preset : layouts()) {
    WorldConfig config;
    config.preset = preset;
    config.facet_factor = 4.0;
    config.relief_factor = 0.0;
    config.furniture_spacing_factor = 3.0;
    config.passage_spacing_factor = 3.0;
    config.curvature_factor = 0.0;
    const Result<World> world = make_world(config);
    ASSERT_TRUE(world);
    EXPECT_TRUE(check_mesh(world->mesh));
    EXPECT_EQ(world->routes.size(), 4U);
  }
}

}  // namespace
}  // namespace adit
