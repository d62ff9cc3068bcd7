// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Rooms and pillars: a lattice of rooms with headings and adits at its border.
#include <algorithm>
#include <cmath>

#include "adit/simulation/world_network_grow.hpp"

namespace adit::layouts {
namespace {

struct Lattice {
  int columns;
  int rows;
  Eigen::Vector2d along;
  Eigen::Vector2d across;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

Lattice draw_lattice(const NetworkStyle& style, Rng& rng) {
  const double skew = rng.uniform(60.0, 120.0) * kDegree;
  const double pitch_along = style.width + rng.uniform(10.0, 30.0);
  const double pitch_across = (style.width + rng.uniform(10.0, 30.0)) / std::sin(skew);
  Lattice lattice{static_cast<int>(3 + rng.below(5)), static_cast<int>(3 + rng.below(4)),
                  pitch_along * direction(0.0), pitch_across * direction(skew)};
  const auto length = [&] {
    return lattice.rows * (lattice.columns - 1) * pitch_along +
           lattice.columns * (lattice.rows - 1) * pitch_across;
  };
  while (length() > style.total_length + 150.0 && lattice.columns > 2)
    lattice.columns > lattice.rows || lattice.rows == 2 ? --lattice.columns : --lattice.rows;
  return lattice;
}

bool is_connected_without(const Network& network, std::size_t left_out) {
  std::vector<bool> reached(network.nodes.size(), false);
  reached[0] = true;
  for (bool grows = true; grows;) {
    grows = false;
    for (std::size_t i = 0; i < network.edges.size(); ++i) {
      const NetworkEdge& edge = network.edges[i];
      if (i == left_out || reached[edge.from] == reached[edge.to]) continue;
      reached[edge.from] = reached[edge.to] = true;
      grows = true;
    }
  }
  return std::ranges::all_of(reached, [](bool r) { return r; });
}

/// Pillars that were never cut through.
void leave_out_some(Network& network, double share, Rng& rng) {
  const auto num = static_cast<int>(share * static_cast<double>(network.edges.size()));
  for (int k = 0; k < num; ++k) {
    const std::size_t i = rng.below(network.edges.size());
    if (is_connected_without(network, i))
      network.edges.erase(network.edges.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// Headings and adits from the border outwards.
void add_headings(Network& network, const Lattice& lattice, Grower& grower, Rng& rng) {
  const std::uint64_t wanted = 5 + rng.below(5);
  for (std::uint64_t k = 0; k < wanted; ++k) {
    const bool on_row = chance(rng, 0.5);
    const bool far = chance(rng, 0.5);
    const int column = on_row ? (far ? lattice.columns - 1 : 0)
                              : static_cast<int>(rng.below(static_cast<std::uint64_t>(lattice.columns)));
    const int row = on_row ? static_cast<int>(rng.below(static_cast<std::uint64_t>(lattice.rows)))
                           : (far ? lattice.rows - 1 : 0);
    const Eigen::Vector2d out = (far ? 1.0 : -1.0) * (on_row ? lattice.along : lattice.across);
    const std::size_t from = lattice.index(column, row);
    const Vector3 to = ahead(network.nodes[from].at, std::atan2(out.y(), out.x()), rng.uniform(18.0, 55.0));
    NetworkEdge edge{from,
                     grower.add_node(to, 0),
                     shaped_line(network.nodes[from].at, to, {}),
                     grower.draw_section(),
                     {},
                     Copy::own,
                     0};
    if (!grower.try_edge(std::move(edge), 0)) network.nodes.pop_back();
  }
}

}  // namespace

bool lay_grid(Network& network, Grower& grower, const WorldConfig& config, Rng& rng) {
  network.style.pillar = 6.0;  // The lattice has its own; this keeps headings clear.
  const NetworkStyle& style = network.style;
  const Lattice lattice = draw_lattice(style, rng);
  const double jitter = style.repeats ? 0.0 : config.curvature_factor * rng.uniform(0.0, 2.0);
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      const Eigen::Vector2d at = column * lattice.along + row * lattice.across;
      const double dx = jitter * rng.uniform(-1.0, 1.0);
      const double dy = jitter * rng.uniform(-1.0, 1.0);
      grower.add_node({at.x() + dx, at.y() + dy, 0.0}, 0);
    }
  const std::array modules{grower.draw_section(), grower.draw_section()};
  const auto connect = [&](std::size_t a, std::size_t b, int module) {
    NetworkEdge edge{
        a,         b, shaped_line(network.nodes[a].at, network.nodes[b].at, {}), grower.draw_section(), {},
        Copy::own, 0};
    if (style.repeats && chance(rng, 0.75)) {
      edge.section = modules[static_cast<std::size_t>(module - 1)];
      edge.module = module;
      edge.copy = chance(rng, 0.5) ? Copy::same : Copy::changed;
    }
    grower.try_edge(std::move(edge), 0);
  };
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      if (column + 1 < lattice.columns)
        connect(lattice.index(column, row), lattice.index(column + 1, row), 1);
      if (row + 1 < lattice.rows) connect(lattice.index(column, row), lattice.index(column, row + 1), 2);
    }
  if (!is_connected_without(network, network.edges.size())) return false;
  leave_out_some(network, rng.uniform(0.0, 0.3), rng);
  add_headings(network, lattice, grower, rng);
  return true;
}

}  // namespace adit::layouts
