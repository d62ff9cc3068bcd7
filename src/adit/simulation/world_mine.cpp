// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A mine: rough drifts of varying width on a bent grid of junctions, with ramps, blind headings and four
/// adits.
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "adit/simulation/world_plan.hpp"

namespace adit {
namespace {

constexpr int kColumns = 4;
constexpr int kRows = 3;
constexpr int kNumJunctions = kColumns * kRows;
constexpr double kColumnApart = 88.0;
constexpr double kRowApart = 78.0;
constexpr double kAditLength = 34.0;

/// The drift from junction to junction; adits have the numbers after the junctions.
using Network = std::array<Vector3, kNumJunctions + 4>;

int junction(int column, int row) { return row * kColumns + column; }

Network draw_network(Rng& rng) {
  Network nodes;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      nodes[static_cast<std::size_t>(junction(column, row))] = Vector3(
          kColumnApart * column + rng.uniform(-8.0, 8.0), kRowApart * row + rng.uniform(-8.0, 8.0), 0.0);
  const std::array corners{junction(0, 0), junction(kColumns - 1, 0), junction(0, kRows - 1),
                           junction(kColumns - 1, kRows - 1)};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double west_or_east = i % 2 == 0 ? -1.0 : 1.0;
    nodes[kNumJunctions + i] = nodes[static_cast<std::size_t>(corners[i])] +
                               Vector3(west_or_east * kAditLength, rng.uniform(-6.0, 6.0), 0.0);
  }
  return nodes;
}

/// A winding line between two nodes that leaves both straight; the same line whichever end comes first.
Polyline drift_line(const Network& nodes, int from, int to, const WorldConfig& config) {
  if (from > to) return reversed_line(drift_line(nodes, to, from, config));
  const int drift = 100 * from + to;
  Rng rng(mix64(config.seed, static_cast<std::uint64_t>(drift)));
  const Vector3& begin = nodes[static_cast<std::size_t>(from)];
  const Vector3 path = nodes[static_cast<std::size_t>(to)] - begin;
  const double amplitude = config.curvature_factor * 0.05 * path.norm() * rng.uniform(-1.0, 1.0);
  const double waves = rng.uniform() < 0.5 ? 1.0 : 2.0;
  const Vector3 aside = Vector3::UnitZ().cross(path).normalized();
  const int steps = static_cast<int>(std::ceil(path.norm() / 2.0));
  Polyline line;
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    const double envelope = std::sin(std::numbers::pi * t);
    line.emplace_back(begin + t * path +
                      amplitude * envelope * std::sin(waves * std::numbers::pi * t) * aside);
  }
  return line;
}

std::vector<std::pair<int, int>> drifts() {
  std::vector<std::pair<int, int>> pairs;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      if (column + 1 < kColumns) pairs.emplace_back(junction(column, row), junction(column + 1, row));
      if (row + 1 < kRows) pairs.emplace_back(junction(column, row), junction(column, row + 1));
    }
  return pairs;
}

void add_drifts(WorldPlan& plan, const Network& nodes, const WorldConfig& config, Rng& rng) {
  const std::array adits{junction(0, 0), junction(kColumns - 1, 0), junction(0, kRows - 1),
                         junction(kColumns - 1, kRows - 1)};
  for (int i = 0; i < 4; ++i)
    add_tunnel(plan, arch_profile({5.2, 4.4, 2.0, 12}),
               drift_line(nodes, kNumJunctions + i, adits[static_cast<std::size_t>(i)], config));
  for (const auto& [from, to] : drifts()) {
    const double width = rng.uniform(4.6, 5.6);
    add_tunnel(plan, arch_profile({width, width * rng.uniform(0.75, 0.95), 1.8, 12}),
               drift_line(nodes, from, to, config));
  }
}

/// Rooms of different size where drifts meet.
void add_junctions(WorldPlan& plan, const Network& nodes, Rng& rng) {
  for (std::size_t i = 0; i < kNumJunctions; ++i) {
    const double angle = rng.uniform(0.0, std::numbers::pi);
    const double reach = rng.uniform(3.2, 5.0);
    const Vector3 along(reach * std::cos(angle), reach * std::sin(angle), 0.0);
    plan.spaces.push_back(
        box_between(nodes[i] - along, nodes[i] + along,
                    arch_profile({rng.uniform(7.0, 10.0), rng.uniform(4.8, 5.8), 2.2, 12})));
  }
}

/// Headings that were given up, off the drifts' sides.
void add_headings(WorldPlan& plan, const Network& nodes, const WorldConfig& config, Rng& rng) {
  for (const auto& [from, to] : drifts()) {
    const Polyline line = drift_line(nodes, from, to, config);
    const double spacing = 55.0 * config.furniture_spacing_factor;
    for (double at = rng.uniform(0.3, 1.3) * spacing; at < length_of(line) - 15.0;
         at += spacing * rng.uniform(0.7, 1.5)) {
      if (at < 15.0) continue;
      const WallSite site{point_at(line, at), rng.uniform() < 0.5 ? 1.0 : -1.0, 2.5};
      const double skew = rng.uniform(-3.0, 3.0);
      add_closed_tunnel(plan, arch_profile({rng.uniform(3.2, 4.4), 3.4, 1.6, 10}),
                        {site.at(0.0), site.at(rng.uniform(6.0, 13.0), skew)});
    }
  }
}

/// A robot's path through the nodes and how far along it the robot drives.
struct Path {
  std::vector<int> nodes;
  double length;
};

/// Paths around the middle of the mine; every pair of robots shares a stretch.
std::array<Path, 4> meeting_paths() {
  const auto a = [](int column) { return junction(column, 0); };
  const auto b = [](int column) { return junction(column, 1); };
  const auto c = [](int column) { return junction(column, 2); };
  return {{
      {{kNumJunctions + 0, a(0), a(1), b(1), b(2), c(2), c(3), b(3)}, 438.0},
      {{kNumJunctions + 1, a(3), b(3), b(2), b(1), a(1), a(2), a(3)}, 402.0},
      {{kNumJunctions + 2, c(0), c(1), b(1), b(2), a(2), a(3), b(3)}, 427.0},
      {{kNumJunctions + 3, c(3), b(3), b(2), b(1), b(0), a(0), a(1)}, 415.0},
  }};
}

/// Two robots pass one another in the first row of drifts, two in the last, and no robot leaves its row.
std::array<Path, 4> parallel_paths() {
  const auto a = [](int column) { return junction(column, 0); };
  const auto c = [](int column) { return junction(column, kRows - 1); };
  constexpr double kLength = 260.0;
  return {{
      {{kNumJunctions + 0, a(0), a(1), a(2), a(3)}, kLength},
      {{kNumJunctions + 1, a(3), a(2), a(1), a(0)}, kLength},
      {{kNumJunctions + 2, c(0), c(1), c(2), c(3)}, kLength},
      {{kNumJunctions + 3, c(3), c(2), c(1), c(0)}, kLength},
  }};
}

std::vector<Drive> draw_drives(const Network& nodes, const WorldConfig& config) {
  const std::array<Path, 4> paths = config.routes == "meeting" ? meeting_paths() : parallel_paths();
  const std::array speeds{1.87, 1.83, 1.85, 1.81};
  std::vector<Drive> all;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::vector<int>& path = paths[i].nodes;
    Drive drive{"robot_" + std::to_string(i), speeds[i], paths[i].length, 5.0, 5.0, {}};
    for (std::size_t k = 1; k < path.size(); ++k)
      drive.legs.push_back(drift_line(nodes, path[k - 1], path[k], config));
    all.push_back(std::move(drive));
  }
  return all;
}

}  // namespace

WorldPlan plan_mine(const WorldConfig& config) {
  Rng rng(mix64(config.seed, 1));
  WorldPlan plan;
  // Blasted rock: the width wanders over tens of metres, edges of boulders stand out by decimetres.
  plan.relief = {
      mix64(furniture_seed(config), 2), {{18.0, 0.35}, {3.2, 0.22}, {1.1, 0.06}}, 0.12, 5.0, 420.0};
  for (ReliefOctave& octave : plan.relief.octaves) octave.amplitude *= config.relief_factor;
  plan.max_edge = 0.6 * config.facet_factor;
  plan.flat_floor = false;
  const Network nodes = draw_network(rng);
  add_drifts(plan, nodes, config, rng);
  add_junctions(plan, nodes, rng);
  Rng furniture = furniture_rng(config, rng);
  add_headings(plan, nodes, config, furniture);
  plan.drives = draw_drives(nodes, config);
  return plan;
}

}  // namespace adit
