// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "adit/core/angles.hpp"
#include "adit/core/parallel.hpp"
#include "adit/simulation/trajectory.hpp"

namespace adit {
namespace {

constexpr std::uint64_t kNumSeeds = 50;

WorldConfig config_of(std::uint64_t seed, double facet_factor = 1.0) {
  WorldConfig config;
  config.preset = "network";
  config.seed = seed;
  config.facet_factor = facet_factor;
  return config;
}

/// Drawn once for all tests: the plans, without their meshes.
const std::vector<NetworkWorld>& networks() {
  static const std::vector<NetworkWorld> all = [] {
    std::vector<NetworkWorld> drawn(kNumSeeds);
    parallel_for_each(drawn.size(), [&](std::size_t i) { drawn[i] = draw_network_world(config_of(i + 1)); });
    return drawn;
  }();
  return all;
}

std::size_t junctions_of(const Network& network) {
  std::size_t count = 0;
  for (std::size_t node = 0; node < network.nodes.size(); ++node)
    if (network.edges_at(node).size() >= 3) ++count;
  return count;
}

TEST(Network, EverySeedIsDrivableAndOfTheStatedSize) {
  for (const NetworkWorld& world : networks()) {
    const double length = world.plan.tunnel_length;
    EXPECT_GT(length, 450.0);
    EXPECT_LT(length, 1600.0);
    ASSERT_GE(world.paths.size(), 3U);
    ASSERT_LE(world.paths.size(), 6U);
    ASSERT_EQ(world.plan.routes.size(), world.paths.size());
    std::vector<Vector3> starts;
    for (const Route& route : world.plan.routes) {
      EXPECT_GE(length_of(route), 140.0) << route.name;
      EXPECT_LE(length_of(route), 360.0) << route.name;
      const Vector3& start = route.waypoints.front();
      for (const Vector3& other : starts) EXPECT_GT((start - other).norm(), 5.0);
      starts.push_back(start);
      for (std::size_t i = 0; i < route.waypoints.size(); ++i) {
        const Clearance clearance = clearance_at(world.plan, route.waypoints[i]);
        ASSERT_GE(clearance.walls, 1.0) << route.name << " at " << route.waypoints[i].transpose();
        ASSERT_GE(clearance.obstacles, 1.0) << route.name << " at " << route.waypoints[i].transpose();
        if (i == 0) continue;
        ASSERT_NEAR((route.waypoints[i] - route.waypoints[i - 1]).norm(), 1.0, 0.2);
      }
    }
  }
}

TEST(Network, RobotsStartWhereATunnelEnds) {
  for (const NetworkWorld& world : networks())
    for (std::size_t i = 0; i < world.paths.size(); ++i) {
      const Step& first = world.paths[i].steps.front();
      const NetworkEdge& edge = world.network.edges[first.edge];
      const std::size_t node = first.forward ? edge.from : edge.to;
      EXPECT_EQ(world.network.edges_at(node).size(), 1U);
      EXPECT_LT((world.network.nodes[node].at - world.plan.routes[i].waypoints[0]).head<2>().norm(), 6.0);
    }
}

TEST(Network, RampsJunctionsAndSectionsStayWithinMinePractice) {
  for (const NetworkWorld& world : networks()) {
    const Network& network = world.network;
    for (const NetworkEdge& edge : network.edges) {
      EXPECT_LT(steepest_grade(edge.line) + network.style.tilt.norm(), 0.15 + 5e-3);
      EXPECT_GE(edge.section.width, 3.0);
      EXPECT_LE(edge.section.width, 10.0);
      EXPECT_GE(edge.section.height, 2.5);
      EXPECT_LE(edge.section.height, 8.0);
    }
    for (std::size_t node = 0; node < network.nodes.size(); ++node) {
      const std::vector<std::size_t> edges = network.edges_at(node);
      for (const std::size_t a : edges)
        for (const std::size_t b : edges) {
          if (a == b) continue;
          EXPECT_LE(direction_at(network.edges[a], node).dot(direction_at(network.edges[b], node)),
                    std::cos(30.0 * kDegree) + 1e-9);
        }
    }
  }
}

/// Rock between all stretches of two routes as driven, by brute force over their waypoints.
double rock_between_routes(const NetworkWorld& world, std::size_t a, std::size_t b) {
  double widest = 0.0;
  double tallest = 0.0;
  for (const NetworkEdge& edge : world.network.edges) {
    widest = std::max(widest, edge.section.width);
    tallest = std::max(tallest, edge.section.height);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3& p : world.plan.routes[a].waypoints)
    for (const Vector3& q : world.plan.routes[b].waypoints) {
      const double aside = std::max(0.0, (p - q).head<2>().norm() - widest);
      const double above = std::max(0.0, std::abs(p.z() - q.z()) - tallest);
      least = std::min(least, std::hypot(aside, above));
    }
  return least;
}

/// Metres of the first route within 3 m of the second.
double metres_near(const Route& first, const Route& second) {
  double metres = 0.0;
  for (std::size_t i = 1; i < first.waypoints.size(); ++i) {
    const bool near = std::ranges::any_of(
        second.waypoints, [&](const Vector3& q) { return (q - first.waypoints[i]).norm() < 3.0; });
    if (near) metres += (first.waypoints[i] - first.waypoints[i - 1]).norm();
  }
  return metres;
}

TEST(Network, PairsShareAStretchOrStayApart) {
  std::vector<double> shares;
  std::size_t apart = 0;
  for (const NetworkWorld& world : networks())
    for (std::size_t a = 0; a < world.paths.size(); ++a)
      for (std::size_t b = a + 1; b < world.paths.size(); ++b) {
        const Relation relation = relation_of(world.network, world.paths[a], world.paths[b]);
        const Route& first = world.plan.routes[a];
        const Route& second = world.plan.routes[b];
        if (relation.shared == 0.0) {
          ++apart;
          EXPECT_GE(relation.apart, 10.0);
          // Lanes, corners and relief move routes by a few metres at most.
          EXPECT_GT(rock_between_routes(world, a, b), 4.0) << first.name << " " << second.name;
          EXPECT_EQ(metres_near(first, second), 0.0);
          continue;
        }
        EXPECT_GE(relation.shared, 20.0);
        EXPECT_NEAR(metres_near(first, second), relation.shared, 25.0);
        shares.push_back(relation.shared / std::min(world.paths[a].length, world.paths[b].length));
      }
  std::ranges::sort(shares);
  EXPECT_GT(apart, 40U);
  ASSERT_GT(shares.size(), 80U);
  EXPECT_LT(shares[shares.size() / 10], 0.25) << "some pairs share little";
  EXPECT_GT(shares[shares.size() * 9 / 10], 0.6) << "some pairs share most of their routes";
}

TEST(Network, EverySeedIsAnotherMine) {
  std::map<Family, int> families;
  std::set<std::size_t> junctions;
  std::set<std::size_t> robots;
  std::set<int> lengths;
  std::map<Lining, int> linings;
  std::map<SectionKind, int> sections;
  int repeating = 0;
  int with_ramps = 0;
  for (const NetworkWorld& world : networks()) {
    const NetworkStyle& style = world.network.style;
    ++families[style.family];
    ++linings[style.lining];
    ++sections[style.section];
    junctions.insert(junctions_of(world.network));
    robots.insert(world.paths.size());
    lengths.insert(static_cast<int>(std::lround(world.plan.tunnel_length)));
    repeating += style.repeats ? 1 : 0;
    with_ramps +=
        std::ranges::any_of(world.network.edges,
                            [](const NetworkEdge& edge) { return steepest_grade(edge.line) > 0.03; })
            ? 1
            : 0;
  }
  EXPECT_EQ(families.size(), kFamilies.size());
  for (const auto& [family, count] : families) EXPECT_GE(count, 3);
  EXPECT_EQ(linings.size(), 3U);
  EXPECT_EQ(sections.size(), 3U);
  EXPECT_GE(junctions.size(), 8U);
  EXPECT_EQ(robots.size(), 4U);
  EXPECT_GE(lengths.size(), 45U);
  EXPECT_GE(repeating, 10);
  EXPECT_LE(repeating, 25);
  EXPECT_GE(with_ramps, 15);
}

/// Plan of a tunnel's line as seen from its beginning, x ahead.
std::vector<Eigen::Vector2d> own_frame(const NetworkEdge& edge) {
  const Eigen::Vector2d x = (edge.line.back() - edge.line.front()).head<2>().normalized();
  std::vector<Eigen::Vector2d> points;
  for (const Vector3& p : edge.line) {
    const Eigen::Vector2d d = (p - edge.line.front()).head<2>();
    points.emplace_back(d.dot(x), x.x() * d.y() - x.y() * d.x());
  }
  return points;
}

TEST(Network, RepeatedModulesHaveOneShapeOrItsMirrorImage) {
  std::size_t compared = 0;
  for (const NetworkWorld& world : networks()) {
    const Network& network = world.network;
    std::map<int, std::vector<const NetworkEdge*>> modules;
    for (const NetworkEdge& edge : network.edges)
      if (edge.module != 0) modules[edge.module].push_back(&edge);
    EXPECT_EQ(network.style.repeats, !modules.empty());
    if (network.style.family == Family::tubes) continue;  // Their bays follow the tubes' curves.
    for (const auto& [module, edges] : modules)
      for (std::size_t i = 1; i < edges.size(); ++i) {
        const std::vector<Eigen::Vector2d> first = own_frame(*edges[0]);
        const std::vector<Eigen::Vector2d> other = own_frame(*edges[i]);
        ASSERT_EQ(first.size(), other.size());
        double same = 0.0;
        double mirrored = 0.0;
        for (std::size_t k = 0; k < first.size(); ++k) {
          same = std::max(same, (first[k] - other[k]).norm());
          mirrored = std::max(mirrored, (first[k] - Eigen::Vector2d(other[k].x(), -other[k].y())).norm());
        }
        EXPECT_LT(std::min(same, mirrored), 1e-6);
        ++compared;
      }
  }
  EXPECT_GT(compared, 50U);
}

TEST(Network, FurnitureHasASeedOfItsOwnAndRoutesDoNotDependOnIt) {
  WorldConfig config = config_of(6);
  const NetworkWorld own = draw_network_world(config);
  config.furniture_seed = 99;
  const NetworkWorld other = draw_network_world(config);
  EXPECT_EQ(own.network.edges.size(), other.network.edges.size());
  EXPECT_NE(own.plan.relief.seed, other.plan.relief.seed);
  ASSERT_EQ(own.plan.routes.size(), other.plan.routes.size());
  for (std::size_t i = 0; i < own.plan.routes.size(); ++i)
    for (std::size_t k = 0; k < own.plan.routes[i].waypoints.size(); ++k)
      EXPECT_LT((own.plan.routes[i].waypoints[k] - other.plan.routes[i].waypoints[k]).head<2>().norm(), 1e-9);
}

TEST(Network, RoutesApartShareNothing) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    WorldConfig config = config_of(seed);
    config.routes = "apart";
    const NetworkWorld world = draw_network_world(config);
    ASSERT_GE(world.paths.size(), 3U);
    for (std::size_t a = 0; a < world.paths.size(); ++a)
      for (std::size_t b = a + 1; b < world.paths.size(); ++b) {
        const Relation relation = relation_of(world.network, world.paths[a], world.paths[b]);
        EXPECT_EQ(relation.shared, 0.0);
        EXPECT_GE(relation.apart, 10.0);
      }
  }
}

TEST(Network, RefusesArrangements) {
  for (const char* arrangement : {"different", "mirrored", "copies", "twins"}) {
    WorldConfig config = config_of(1);
    config.arrangement = arrangement;
    const Result<World> world = make_world(config);
    ASSERT_FALSE(world);
    EXPECT_NE(world.error().message.find("use arrangement single"), std::string::npos);
  }
}

/// Whether a ray passes through the mouth of a portal, with half a metre around it for its relief.
bool leaves_by_a_portal(const NetworkWorld& world, const Vector3& origin, const Vector3& direction) {
  const Network& network = world.network;
  for (std::size_t node = 0; node < network.nodes.size(); ++node) {
    if (!network.nodes[node].portal) continue;
    const NetworkEdge& edge = network.edges[network.edges_at(node).front()];
    const Eigen::Vector2d in = direction_at(edge, node);
    const Vector3 mouth = network.nodes[node].at;
    const double along = direction.head<2>().dot(in);
    const double distance = (mouth - origin).head<2>().dot(in) / along;
    if (!(distance > 0.0)) continue;
    const Vector3 p = origin + distance * direction;
    const double floor = mouth.z() + network.style.tilt.dot(mouth.head<2>());
    const double aside = std::abs(in.x() * (p - mouth).y() - in.y() * (p - mouth).x());
    if (aside < 0.5 * edge.section.width + 0.5 && p.z() > floor - 0.5 &&
        p.z() < floor + edge.section.height + 0.5)
      return true;
  }
  return false;
}

/// Rays from the routes meet a surface that faces them, or leave by a portal: there is no other hole. Slivers
/// of millimetres that relief turned over show their back to one ray in some 1e4, in the other presets too.
void expect_no_holes(const NetworkWorld& drawn, const World& world, const Raycaster& raycaster) {
  constexpr int kRays = 3000;
  Rng rng(7);
  int turned_over = 0;
  for (const Route& route : world.routes)
    for (int i = 0; i < kRays; ++i) {
      const Vector3 origin = route.waypoints[rng.below(route.waypoints.size())] + Vector3(0.0, 0.0, 1.0);
      const double x = rng.normal();
      const double y = rng.normal();
      const Vector3 direction = Vector3(x, y, rng.normal()).normalized();
      const RayHit hit = raycaster.cast({origin.cast<float>(), direction.cast<float>()}, 2000.0F);
      if (leaves_by_a_portal(drawn, origin, direction)) continue;
      ASSERT_TRUE(hit.hit()) << route.name << " from " << origin.transpose() << " to "
                             << direction.transpose();
      if (hit.normal.cast<double>().dot(direction) > 1e-3) ++turned_over;
    }
  EXPECT_LE(turned_over, 2);
}

class NetworkOf : public testing::TestWithParam<std::uint64_t> {};

// One test for all properties: making the world is what costs. Coarser walls, to be quick.
TEST_P(NetworkOf, IsSoundAndDrivable) {
  const WorldConfig config = config_of(GetParam(), 2.0);
  const Result<World> world = make_world(config);
  ASSERT_TRUE(world);
  EXPECT_EQ(world->name, "network");
  ASSERT_TRUE(check_mesh(world->mesh));
  EXPECT_LT(world->mesh.triangles.size(), 1'000'000U);
  // Rims of portals and of things that stand in the floor; slivers where faces are cut.
  const EdgeStatistics edges = edge_statistics(world->mesh);
  EXPECT_LT(static_cast<double>(edges.num_boundary), 4e-3 * static_cast<double>(edges.num_edges));
  EXPECT_LT(static_cast<double>(edges.num_over_shared), 2e-3 * static_cast<double>(edges.num_edges));
  EXPECT_LT(edges.num_inconsistent, 40U);
  const Result<Raycaster> raycaster = Raycaster::build(world->mesh, EdgeRule::watertight);
  ASSERT_TRUE(raycaster);
  expect_no_holes(draw_network_world(config), *world, *raycaster);
  for (const Route& route : world->routes) {
    const Result<Trajectory> truth = drive(*raycaster, route, DriveConfig(), Stamp{});
    ASSERT_TRUE(truth) << truth.error().message;
    for (std::size_t i = 1; i < truth->size(); ++i) {
      const Vector3 up = (*truth)[i].T_world_body.rotation() * Vector3::UnitZ();
      ASSERT_GT(up.z(), std::cos(20.0 * kDegree)) << route.name << " tips over at " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, NetworkOf, testing::Range<std::uint64_t>(1, 13));

TEST(Network, SameSeedSameBytesWithAnyNumberOfThreads) {
  const int before = num_threads();
  const WorldConfig config = config_of(16, 3.0);
  set_num_threads(1);
  const Result<World> first = make_world(config);
  set_num_threads(2);
  const Result<World> again = make_world(config);
  set_num_threads(before);
  ASSERT_TRUE(first && again);
  EXPECT_TRUE(first->mesh.vertices == again->mesh.vertices);
  EXPECT_TRUE(first->mesh.triangles == again->mesh.triangles);
  ASSERT_EQ(first->routes.size(), again->routes.size());
  for (std::size_t i = 0; i < first->routes.size(); ++i)
    EXPECT_TRUE(first->routes[i].waypoints == again->routes[i].waypoints);
}

}  // namespace
}  // namespace adit
