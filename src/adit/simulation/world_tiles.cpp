// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A grid of tunnels made of one tile, as circuits for competitions are: wall, cabinet and junction look the
/// same everywhere. Only the directions in which junctions open and the number of tiles between them
/// distinguish places, and no two blocks of a row or of a column have the same number of tiles.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "adit/simulation/world_plan.hpp"

namespace adit {
namespace {

constexpr double kTile = 20.0;  ///< Metres.
constexpr std::size_t kColumns = 5;
constexpr std::size_t kRows = 4;
constexpr double kAditLength = 2.0 * kTile;
constexpr Arch kTube{5.2, 4.6, 2.2, 16};
constexpr double kHalfWidth = 0.5 * kTube.width;

/// A junction of the grid: column and row. One beyond the border is the mouth of an adit.
using Node = std::pair<int, int>;
using Edge = std::pair<Node, Node>;

struct Grid {
  std::array<double, kColumns> x{};
  std::array<double, kRows> y{};

  [[nodiscard]] Vector3 at(const Node& node) const {
    const auto [column, row] = node;
    if (column < 0) return {x.front() - kAditLength, at({0, row}).y(), 0.0};
    if (column == kColumns) return {x.back() + kAditLength, at({0, row}).y(), 0.0};
    return {x[static_cast<std::size_t>(column)], y[static_cast<std::size_t>(row)], 0.0};
  }
};

/// Positions whose gaps are `fewest`, `fewest` + 1, ... tiles, in an order that is drawn.
template <std::size_t N>
std::array<double, N> draw_positions(int fewest, Rng& rng) {
  std::array<int, N - 1> gaps{};
  std::iota(gaps.begin(), gaps.end(), fewest);
  for (std::size_t i = gaps.size(); i > 1; --i) std::swap(gaps[i - 1], gaps[rng.below(i)]);
  std::array<double, N> positions{};
  for (std::size_t i = 1; i < N; ++i) positions[i] = positions[i - 1] + kTile * gaps[i - 1];
  return positions;
}

using Path = std::vector<Node>;  ///< From the mouth of an adit over the junctions at which the robot turns.

/// All four lead through the middle of the second row, two in each direction.
std::array<Path, 4> meeting_paths() {
  return {{{{-1, 0}, {1, 0}, {1, 1}, {3, 1}, {3, 2}, {0, 2}},
           {{5, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {4, 2}},
           {{-1, 3}, {0, 3}, {0, 2}, {1, 2}, {1, 1}, {4, 1}, {4, 3}},
           {{5, 3}, {3, 3}, {3, 1}, {0, 1}, {0, 3}}}};
}

/// Two robots in the first two rows and two in the last ones.
std::array<Path, 4> parallel_paths() {
  return {{{{-1, 0}, {1, 0}, {1, 1}, {4, 1}, {4, 0}, {0, 0}},
           {{5, 0}, {3, 0}, {3, 1}, {0, 1}, {0, 0}, {4, 0}},
           {{-1, 3}, {1, 3}, {1, 2}, {4, 2}, {4, 3}, {0, 3}},
           {{5, 3}, {3, 3}, {3, 2}, {0, 2}, {0, 3}, {4, 3}}}};
}

Edge edge_between(const Node& a, const Node& b) { return std::minmax(a, b); }

/// The edges of the grid that some path follows.
std::vector<Edge> edges_of(const std::array<Path, 4>& paths) {
  std::vector<Edge> edges;
  for (const Path& path : paths)
    for (std::size_t k = 1; k < path.size(); ++k) {
      Node at = path[k - 1];
      const Node step{(path[k].first > at.first) - (path[k].first < at.first),
                      (path[k].second > at.second) - (path[k].second < at.second)};
      while (at != path[k]) {
        const Node next{at.first + step.first, at.second + step.second};
        edges.push_back(edge_between(at, next));
        at = next;
      }
    }
  return edges;
}

std::vector<Edge> all_edges() {
  std::vector<Edge> edges;
  for (int row = 0; row < static_cast<int>(kRows); ++row)
    for (int column = 0; column < static_cast<int>(kColumns); ++column) {
      if (column + 1 < static_cast<int>(kColumns)) edges.push_back({{column, row}, {column + 1, row}});
      if (row + 1 < static_cast<int>(kRows)) edges.push_back({{column, row}, {column, row + 1}});
    }
  return edges;
}

/// A straight line in steps of about a metre: facets of that size are refined evenly, long ones into slivers.
Polyline stepped(const Vector3& from, const Vector3& to) {
  const int steps = static_cast<int>(std::ceil((to - from).norm()));
  Polyline line;
  for (int k = 0; k <= steps; ++k) line.emplace_back(from + (to - from) * (static_cast<double>(k) / steps));
  return line;
}

/// A tunnel that reaches half a width beyond both junctions, so that corners are square, with one cabinet in
/// the same place of each tile.
void add_edge(WorldPlan& plan, const Grid& grid, const Edge& edge, double cabinet_spacing) {
  const Polyline line = stepped(grid.at(edge.first), grid.at(edge.second));
  add_closed_tunnel(plan, arch_profile(kTube), extended(line, kHalfWidth));
  for (double at = 0.5 * kTile; at < length_of(line) - kHalfWidth - 1.0; at += cabinet_spacing)
    add_cabinet(plan, {point_at(line, at), 1.0, kHalfWidth});
}

/// The mouth of an adit is open; its other end lies within the junction.
void add_adit(WorldPlan& plan, const Grid& grid, const Path& path) {
  const Vector3 mouth = grid.at(path[0]);
  const Vector3 junction = grid.at({path[0].first < 0 ? 0 : static_cast<int>(kColumns) - 1, path[0].second});
  add_tunnel(plan, arch_profile(kTube), stepped(mouth, junction));
}

}  // namespace

WorldPlan plan_tiles(const WorldConfig& config) {
  Rng rng(mix64(config.seed, 1));
  WorldPlan plan = concrete_plan(config);
  Grid grid;
  grid.x = draw_positions<kColumns>(3, rng);
  grid.y = draw_positions<kRows>(2, rng);
  const std::array<Path, 4> paths = config.routes == "meeting" ? meeting_paths() : parallel_paths();
  const std::vector<Edge> driven = edges_of(paths);
  for (const Path& path : paths) add_adit(plan, grid, path);
  for (const Edge& edge : all_edges()) {
    // Junctions of three and of four paths, as they come.
    const bool stays = rng.uniform() < 0.6;
    if (stays || std::ranges::find(driven, edge) != driven.end())
      add_edge(plan, grid, edge, kTile * config.furniture_spacing_factor);
  }
  const std::array speeds{1.88, 1.84, 1.86, 1.82};
  const std::array lengths{440.0, 425.0, 430.0, 415.0};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    Drive drive{"robot_" + std::to_string(i), speeds[i], lengths[i], 5.0, 3.2, {}};
    for (std::size_t k = 1; k < paths[i].size(); ++k)
      drive.legs.push_back({grid.at(paths[i][k - 1]), grid.at(paths[i][k])});
    plan.drives.push_back(std::move(drive));
  }
  return plan;
}

}  // namespace adit
