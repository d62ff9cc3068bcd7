// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From a drawn network to the plan of a world: tunnels, rooms where they meet, furniture, rock and routes.
#include "adit/simulation/world_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr double kRobotHeight = 1.2;  // Metres above the floor: of the point whose clearance counts.
constexpr double kClearance = 1.0;    // Metres from there to walls and things.

enum class Thing { niche, cabinet, machine, heading, pipe };

struct Item {
  Thing thing = Thing::niche;
  double along = 0.0;  ///< Share of the tunnel's length.
  double side = 1.0;
  double reach = 8.0;  ///< Of a heading: its length; of a pipe: the share of the tunnel that it follows.
  double skew = 0.0;   ///< Of a heading: metres along the tunnel.
};

Thing draw_thing(Rng& rng) {
  const double draw = rng.uniform();
  if (draw < 0.25) return Thing::niche;
  if (draw < 0.55) return Thing::cabinet;
  if (draw < 0.70) return Thing::machine;
  return draw < 0.92 ? Thing::heading : Thing::pipe;
}

Item draw_item(double along, Rng& rng) {
  Item item;
  item.thing = draw_thing(rng);
  item.along = along;
  item.side = rng.uniform() < 0.5 ? 1.0 : -1.0;
  item.reach = item.thing == Thing::pipe ? rng.uniform(0.3, 1.0) : rng.uniform(5.0, 12.0);
  item.skew = rng.uniform(-2.5, 2.5);
  return item;
}

/// Things along a tunnel of `length` metres that keep `kMargin` metres from its ends.
std::vector<Item> draw_items(double length, double spacing, Rng& rng) {
  constexpr double kMargin = 9.0;
  constexpr double kTogether = 7.0;  // Things nearer to one another would stand in each other's walls.
  std::vector<Item> items;
  for (double at = kMargin + spacing * rng.uniform(0.0, 0.7); at < length - kMargin;
       at += std::max(kTogether, spacing * rng.uniform(0.4, 1.6)))
    items.push_back(draw_item(at / length, rng));
  return items;
}

/// Leaves one out, moves it to the other side or makes it another thing.
void change_a_detail(std::vector<Item>& items, Rng& rng) {
  if (items.empty()) return;
  const std::size_t which = rng.below(items.size());
  const double draw = rng.uniform();
  if (draw < 0.34)
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(which));
  else if (draw < 0.67)
    items[which].side = -items[which].side;
  else
    items[which] = draw_item(items[which].along, rng);
}

std::vector<Item> items_of(const Network& network, std::size_t index, const WorldConfig& config) {
  const NetworkEdge& edge = network.edges[index];
  const std::uint64_t seed = furniture_seed(config);
  const std::uint64_t own = mix64(mix64(seed, 4), index);
  Rng rng(edge.module == 0 ? own : mix64(mix64(seed, 5), static_cast<std::uint64_t>(edge.module)));
  const double spacing = network.style.furniture_spacing * config.furniture_spacing_factor;
  std::vector<Item> items = draw_items(length_of(edge.line), spacing, rng);
  if (edge.copy == Copy::mirrored)
    for (Item& item : items) item.side = -item.side;
  Rng change(own);
  if (edge.copy == Copy::changed) change_a_detail(items, change);
  return items;
}

Polyline level(Polyline line) {
  for (Vector3& p : line) p.z() = 0.0;
  return line;
}

/// Puts the tunnels of a network into storeys.
class Builder {
 public:
  Builder(const Network& network, const WorldConfig& config)
      : net_(network), config_(config), rng_(mix64(config.seed, 6)) {
    int num_storeys = 0;
    for (const NetworkEdge& edge : network.edges)
      for (const StoreyPart& part : edge.parts) num_storeys = std::max(num_storeys, part.storey + 1);
    plan_.storeys.resize(static_cast<std::size_t>(num_storeys));
    for (Storey& storey : plan_.storeys) storey.floors.set_tilt(network.style.tilt);
  }

  WorldPlan build() {
    add_rock();
    for (const NetworkEdge& edge : net_.edges) add_edge(edge);
    for (std::size_t node = 0; node < net_.nodes.size(); ++node) add_room(node);
    for (std::size_t i = 0; i < net_.edges.size(); ++i)
      for (const Item& item : items_of(net_, i, config_)) add_item(net_.edges[i], item);
    return std::move(plan_);
  }

 private:
  Storey& storey(int index) { return plan_.storeys[static_cast<std::size_t>(index)]; }

  /// Formwork leaves waves of a centimetre, sprayed concrete some centimetres, blasting decimetres.
  void add_rock() {
    Rng rng(mix64(config_.seed, 7));
    const Lining lining = net_.style.lining;
    const double strength = rng.uniform(0.6, 1.4) * std::clamp(net_.style.width / 5.0, 0.6, 1.2);
    const double stretch = rng.uniform(0.75, 1.4);
    plan_.relief = {mix64(furniture_seed(config_), 2), {{7.0, 0.010}, {1.7, 0.004}}, 0.0, 0.0, 1.0};
    if (lining == Lining::shotcrete) {
      plan_.relief.octaves = {{11.0, 0.09}, {2.6, 0.05}, {0.9, 0.015}};
      plan_.relief.floor_share = rng.uniform(0.0, 0.15);
    }
    if (lining == Lining::rock) {
      plan_.relief.octaves = {{17.0, 0.28}, {3.4, 0.18}, {1.2, 0.05}};
      plan_.relief.floor_share = rng.uniform(0.05, 0.2);
    }
    for (ReliefOctave& octave : plan_.relief.octaves) {
      octave.amplitude *= strength * config_.relief_factor;
      octave.wavelength *= stretch;
    }
    plan_.max_edge = (lining == Lining::concrete    ? 1.0
                      : lining == Lining::shotcrete ? 0.75
                                                    : 0.65) *
                     config_.facet_factor;
    plan_.flat_floor = lining == Lining::concrete;
  }

  void add_edge(const NetworkEdge& edge) {
    const Polyline flat = level(edge.line);
    for (const StoreyPart& part : edge.parts) {
      storey(part.storey).spaces.push_back(tunnel_part(edge, flat, part));
      // A few points more than are built: where two storeys meet, both see the same floor.
      constexpr std::size_t kBeyond = 5;
      const auto begin = static_cast<std::ptrdiff_t>(part.first > kBeyond ? part.first - kBeyond : 0);
      const auto end = static_cast<std::ptrdiff_t>(std::min(part.last + kBeyond + 1, edge.line.size()));
      storey(part.storey).floors.add(std::span(edge.line.begin() + begin, edge.line.begin() + end));
    }
    plan_.tunnel_length += length_of(edge.line);
  }

  /// Only dead ends have a wall: elsewhere the tunnel goes on in another storey, a room or the open.
  Solid tunnel_part(const NetworkEdge& edge, const Polyline& flat, const StoreyPart& part) const {
    const auto ends = [&](std::size_t node) {
      const bool dead = net_.edges_at(node).size() == 1 && !net_.nodes[node].portal;
      return dead ? Ends::closed : Ends::open;
    };
    return sweep_part(edge.section.profile, flat,
                      {part.first, part.last, part.first == 0 ? ends(edge.from) : Ends::open,
                       part.last + 1 == flat.size() ? ends(edge.to) : Ends::open});
  }

  /// A room with many sides that holds the ends of all tunnels that meet in a node.
  void add_room(std::size_t node) {
    const std::vector<std::size_t> edges = net_.edges_at(node);
    const double share = rng_.uniform(1.04, 1.4);
    const double higher = rng_.uniform(0.1, 0.7);
    const double turn = rng_.uniform(0.0, 2.0 * std::numbers::pi);
    const auto sides = static_cast<int>(6 + rng_.below(6));
    if (edges.size() < 2) return;
    double half = 0.0;
    double height = 0.0;
    for (const std::size_t i : edges) {
      for (const Eigen::Vector2d& p : net_.edges[i].section.profile) half = std::max(half, std::abs(p.x()));
      height = std::max(height, net_.edges[i].section.height);
    }
    const double radius = share * half / std::cos(std::numbers::pi / sides);
    std::vector<Eigen::Vector2d> corners;
    for (int k = 0; k < sides; ++k) {
      const double angle = turn + 2.0 * std::numbers::pi * k / sides;
      corners.emplace_back(net_.nodes[node].at.head<2>() +
                           radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    storey(net_.nodes[node].storey).spaces.push_back(upright_prism(corners, height + higher));
  }

  void add_item(const NetworkEdge& edge, const Item& item) {
    const double length = length_of(edge.line);
    const double at = item.along * length;
    const Polyline flat = level(edge.line);
    const LinePoint foot = point_at(flat, at * length_of(flat) / length);
    const auto point = static_cast<std::size_t>(item.along * static_cast<double>(flat.size() - 1));
    const WallSite site{foot, item.side, half_width(edge.section, 1.0, item.side)};
    Storey& here = storey(edge.storey_at(point));
    const double width = edge.section.width;
    // Where two storeys meet, nothing may stand in the way of the seam.
    const bool near_seam = std::ranges::any_of(edge.parts, [&](const StoreyPart& part) {
      return part.last + 1 < flat.size() && (flat[part.last] - foot.position).norm() < 6.0;
    });
    if (near_seam) return;
    if (item.thing == Thing::niche) here.spaces.push_back(niche(site));
    if (item.thing == Thing::cabinet && width >= 4.2) here.obstacles.push_back(cabinet(site));
    if (item.thing == Thing::machine && width >= 7.2)
      std::ranges::move(machine(site, site.half_width - 1.4), std::back_inserter(here.obstacles));
    if (item.thing == Thing::heading) add_heading(edge, item, site, here);
    if (item.thing == Thing::pipe && width >= 4.2 && edge.parts.size() == 1) add_pipe(edge, item, here);
  }

  /// A heading that was given up, where no other tunnel is near.
  void add_heading(const NetworkEdge& edge, const Item& item, const WallSite& site, Storey& here) {
    const double end = site.half_width + item.reach;
    const double width = 0.75 * edge.section.width;
    const double height = std::max(2.4, 0.8 * edge.section.height);
    NetworkEdge heading;
    heading.line = {site.at(0.0), site.at(end, item.skew)};
    heading.section = {arch_profile({width, height, 0.5 * height, 10}), width, height};
    heading.parts = edge.parts;
    for (Vector3& p : heading.line)
      p.z() = here.floors.height(site.foot.position) - net_.style.tilt.dot(site.foot.position.head<2>());
    constexpr double kRock = 5.0;
    for (const NetworkEdge& other : net_.edges)
      for (std::size_t i = 0; i < other.line.size() && &other != &edge; ++i)
        if (rock_between(heading, 1, other, i) < kRock) return;
    here.spaces.push_back(
        sweep(heading.section.profile, level({site.at(0.0), site.at(end, item.skew)}), Ends::closed));
    here.floors.add(heading.line);
    plan_.tunnel_length += item.reach;
  }

  /// A pipe or duct on brackets at a wall.
  static void add_pipe(const NetworkEdge& edge, const Item& item, Storey& here) {
    constexpr double kSize = 0.25;
    constexpr double kFromEnd = 9.0;
    const Polyline flat = level(edge.line);
    const double length = length_of(flat);
    const double begin = std::max(kFromEnd, item.along * length);
    const double end = std::min(length - kFromEnd, begin + item.reach * length);
    if (end - begin < 6.0) return;
    const double lateral = half_width(edge.section, 2.0, item.side) - 0.4;
    Polyline line;
    const int steps = static_cast<int>(std::ceil((end - begin) / 2.0));
    for (int k = 0; k <= steps; ++k)
      line.push_back(point_at(flat, begin + (end - begin) * k / steps).position);
    here.obstacles.push_back(turned_out(
        sweep(shifted(box_profile(kSize, 1.85, 1.85 + kSize), item.side * lateral), line, Ends::closed)));
  }

  const Network& net_;
  const WorldConfig& config_;
  Rng rng_;
  WorldPlan plan_;
};

Route route_of(const Network& network, const NetworkPath& path, const Relief& relief, std::size_t number) {
  const Polyline line = line_of(network, path);
  const double length = length_of(line);
  const int num_steps = static_cast<int>(std::lround(length));
  Route route{"robot_" + std::to_string(number), path.speed_mps, {}};
  for (int i = 0; i <= num_steps; ++i) {
    const Vector3 p = point_at(line, length * i / num_steps).position;
    route.waypoints.push_back(on_floor(relief, p, p.z() + network.style.tilt.dot(p.head<2>())));
  }
  return route;
}

bool is_drivable(const WorldPlan& plan) {
  constexpr double kSharpest = 0.6;  // Radians between two metres of a route.
  for (const Route& route : plan.routes)
    for (std::size_t i = 0; i < route.waypoints.size(); ++i) {
      const Clearance clearance = clearance_at(plan, route.waypoints[i]);
      if (clearance.walls < kClearance || clearance.obstacles < kClearance) return false;
      if (i < 2) continue;
      const Vector3 before = (route.waypoints[i - 1] - route.waypoints[i - 2]).normalized();
      const Vector3 after = (route.waypoints[i] - route.waypoints[i - 1]).normalized();
      if (before.dot(after) < std::cos(kSharpest)) return false;
    }
  return true;
}

}  // namespace

Clearance clearance_at(const WorldPlan& plan, const Vector3& waypoint) {
  // The storey whose floor is nearest to the waypoint among those that have room above it.
  constexpr double kSameFloor = 2.5;  // Relief moves floors by decimetres, storeys are metres apart.
  Clearance best{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const Vector3 body(waypoint.x(), waypoint.y(), kRobotHeight);
  for (const Storey& storey : plan.storeys) {
    if (std::abs(storey.floors.height(waypoint) - waypoint.z()) > kSameFloor) continue;
    best.walls = std::max(best.walls, depth_inside(storey.spaces, body));
    best.obstacles = std::min(best.obstacles, distance_to(storey.obstacles, body));
  }
  return best;
}

NetworkWorld draw_network_world(const WorldConfig& config) {
  constexpr std::uint64_t kAttempts = 2000;
  constexpr std::size_t kFewestRobots = 3;
  for (std::uint64_t attempt = 0; attempt < kAttempts; ++attempt) {
    Rng rng(mix64(mix64(config.seed, 8), attempt));
    std::optional<Network> network = draw_layout(config, rng);
    if (!network) continue;
    std::vector<NetworkPath> paths = draw_paths(*network, config, rng);
    if (paths.size() < kFewestRobots) continue;
    WorldPlan plan = Builder(*network, config).build();
    for (std::size_t i = 0; i < paths.size(); ++i)
      plan.routes.push_back(route_of(*network, paths[i], plan.relief, i));
    if (is_drivable(plan)) return {*std::move(network), std::move(paths), std::move(plan)};
  }
  ADIT_CHECK(false, "one of many draws of a network must be sound");
  return {};
}

WorldPlan plan_network(const WorldConfig& config) { return draw_network_world(config).plan; }

}  // namespace adit
