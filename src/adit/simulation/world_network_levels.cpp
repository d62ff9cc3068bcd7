// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Levels above one another, joined by a spiral or a hairpin.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "adit/simulation/world_network_grow.hpp"

namespace adit::layouts {
namespace {

/// A ramp's line in plan from (0, 0): a full round of a spiral with two straight sides that returns there
/// heading along y, or a hairpin that leaves along -x and comes back 2 `radius` metres aside.
struct RampPlan {
  bool spiral = true;
  double radius = 18.0;
  double straight = 10.0;
  double side = 1.0;  ///< +1: turns left.
  [[nodiscard]] double length() const {
    return (spiral ? 2.0 : 1.0) * (std::numbers::pi * radius) + 2.0 * straight;
  }
};

Polyline ramp_line(const RampPlan& ramp, double rise, double landing) {
  struct Stretch {
    double length;
    double turn;
  };
  const double arc = std::numbers::pi * ramp.radius;
  const double turn = ramp.side / ramp.radius;
  const std::vector<Stretch> stretches =
      ramp.spiral ? std::vector<Stretch>{{0.5 * ramp.straight, 0.0},
                                         {arc, turn},
                                         {ramp.straight, 0.0},
                                         {arc, turn},
                                         {0.5 * ramp.straight, 0.0}}
                  : std::vector<Stretch>{{ramp.straight, 0.0}, {arc, turn}, {ramp.straight, 0.0}};
  Polyline fine{Vector3::Zero()};
  double heading = ramp.spiral ? 0.5 * ramp.side * std::numbers::pi : std::numbers::pi;
  for (const Stretch& stretch : stretches) {
    const int steps = std::max(1, static_cast<int>(std::ceil(stretch.length / 1.5)));
    const double step = stretch.length / steps;
    for (int k = 0; k < steps; ++k) {
      const double half = 0.5 * stretch.turn * step;
      // The chord of a piece of arc.
      const double chord = half == 0.0 ? step : step * std::sin(half) / half;
      heading += half;
      fine.push_back(ahead(fine.back(), heading, chord));
      heading += half;
    }
  }
  const double length = length_of(fine);
  Polyline line = stretch_of(fine, 0.0, length);
  const auto last = static_cast<double>(line.size() - 1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double at = length * static_cast<double>(i) / last;
    line[i].z() = rise * ramp_rise((at - landing) / (length - 2.0 * landing));
  }
  return line;
}

/// What is above one another in plan is built in storeys of its own.
std::vector<StoreyPart> ramp_parts(std::size_t points, int lower, int between) {
  const std::size_t last = points - 1;
  const std::size_t a = 2 * last / 5;
  const std::size_t b = 3 * last / 5;
  return {{0, a, lower}, {a, b, between}, {b, last, lower + 1}};
}

/// Gives a level to the node `access` by copying that of the node `pattern`, each node and edge moved.
bool copy_level(Network& network, Grower& grower, std::size_t pattern, std::size_t access, double mirror,
                Rng& rng) {
  const int from_storey = network.nodes[pattern].storey;
  const int storey = network.nodes[access].storey;
  const auto moved = [&](const Vector3& p) -> Vector3 {
    const Vector3 d = p - network.nodes[pattern].at;
    return network.nodes[access].at + Vector3(d.x(), mirror * d.y(), d.z());
  };
  std::map<std::size_t, std::size_t> twin{{pattern, access}};
  const std::size_t num_edges = network.edges.size();
  for (std::size_t i = 0; i < num_edges; ++i) {
    if (network.edges[i].parts.size() != 1 || network.edges[i].parts[0].storey != from_storey) continue;
    NetworkEdge edge = network.edges[i];
    for (const std::size_t node : {edge.from, edge.to})
      if (!twin.contains(node)) {
        const std::size_t added = grower.add_node(moved(network.nodes[node].at), storey);
        twin[node] = added;
      }
    edge.from = twin[edge.from];
    edge.to = twin[edge.to];
    for (Vector3& p : edge.line) p = moved(p);
    edge.parts.clear();
    edge.module = network.edges[i].module = 100 + static_cast<int>(i);
    if (network.edges[i].copy == Copy::own) network.edges[i].copy = Copy::same;
    edge.copy = mirror < 0.0 ? Copy::mirrored : chance(rng, 0.25) ? Copy::changed : Copy::same;
    if (mirror < 0.0) edge.section = mirrored(edge.section);
    if (!grower.try_edge(std::move(edge), storey)) return false;
  }
  return true;
}

}  // namespace

bool lay_levels(Network& network, Grower& grower, Rng& rng) {
  const bool spiral = network.style.family == Family::spiral || chance(rng, 0.4);
  const int num_levels = network.style.family == Family::spiral ? static_cast<int>(3 + rng.below(2))
                         : spiral                               ? static_cast<int>(2 + rng.below(2))
                                                                : 2;
  const Section section = grower.draw_section();
  const double landing = landing_of(section.width);
  const double grade = rng.uniform(kFlattest, kSteepest);
  const double tallest = network.style.width * (1.0 + network.style.variation) * 1.1;
  const double least = std::clamp(tallest, 3.0, 8.0) + kCrownPillar;
  RampPlan ramp{spiral, rng.uniform(15.0, 24.0), rng.uniform(4.0, 30.0), sign_of(rng)};
  const double needed = least / (grade * kCurveShare) + 2.0 * landing;
  ramp.straight += std::max(0.0, 0.5 * (needed - ramp.length()));
  const double rise = grade * kCurveShare * (ramp.length() - 2.0 * landing);
  const Polyline line = ramp_line(ramp, rise, landing);

  std::vector<std::size_t> access{grower.add_node(Vector3::Zero(), 0)};
  for (int k = 0; k + 1 < num_levels; ++k) {
    const Vector3 at = network.nodes[access.back()].at;
    access.push_back(grower.add_node(at + line.back(), k + 1));
    network.nodes.back().at.z() = at.z() + rise;
    NetworkEdge edge{access[access.size() - 2],
                     access.back(),
                     line,
                     section,
                     ramp_parts(line.size(), k, num_levels + k),
                     Copy::own,
                     0};
    for (Vector3& p : edge.line) p += at;
    if (!grower.try_edge(std::move(edge), k)) return false;
  }
  const double left = network.style.total_length + 150.0 - network.total_length();
  const double per_level = std::clamp(left / num_levels, 110.0, 320.0);
  for (std::size_t k = 0; k < access.size(); ++k) {
    if (k > 0 && network.style.repeats) {
      const double mirror = chance(rng, 0.3) ? -1.0 : 1.0;
      if (!copy_level(network, grower, access[0], access[k], mirror, rng)) return false;
      continue;
    }
    if (!grower.try_branch(access[k], rng.uniform(-0.3, 0.3), 8.0)) return false;
    const double loops = chance(rng, 0.5) ? rng.uniform(0.2, 0.6) : 0.0;
    const int storey = static_cast<int>(k);
    if (!grower.grow({storey, per_level, loops, 8.0})) return false;
  }
  return true;
}

}  // namespace adit::layouts
