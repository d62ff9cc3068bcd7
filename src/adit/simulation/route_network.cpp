// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/route_network.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <utility>

namespace adit {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kComfort = 1.0;      ///< Metres beyond what the robot needs, at which walls no longer count.
constexpr double kNarrowCosts = 3.0;  ///< Times its length a way without any of that costs in addition.
constexpr double kStraightOn =
    -0.5;  ///< Cosine between two ways of a place that one can drive through: 120 degrees.

using Reached = std::pair<double, std::uint32_t>;  // cost or distance, cell or place
using Frontier = std::priority_queue<Reached, std::vector<Reached>, std::greater<>>;

double comfort_of(const FloorCell& cell, const RouteConfig& config) {
  return std::clamp((cell.margin - config.half_width_m()) / kComfort, 0.0, 1.0);
}

double step_length(const DrivableFloor& floor, std::uint32_t a, std::uint32_t b) {
  return (floor.cells[b].position - floor.cells[a].position).norm();
}

double step_cost(const DrivableFloor& floor, std::uint32_t a, std::uint32_t b, const RouteConfig& config) {
  const double comfort = 0.5 * (comfort_of(floor.cells[a], config) + comfort_of(floor.cells[b], config));
  return step_length(floor, a, b) * (1.0 + kNarrowCosts * (1.0 - comfort));
}

/// Marks what is nearer than `spacing` to a place, along the floor.
void mark_around(const DrivableFloor& floor, std::uint32_t place, double spacing,
                 std::vector<double>& distance) {
  Frontier frontier;
  distance[place] = 0.0;
  frontier.emplace(0.0, place);
  while (!frontier.empty()) {
    const auto [d, cell] = frontier.top();
    frontier.pop();
    if (d > distance[cell]) continue;
    for (const std::uint32_t next : floor.cells[cell].links) {
      if (next == FloorCell::kNone) continue;
      const double there = d + step_length(floor, cell, next);
      if (there >= spacing || there >= distance[next]) continue;
      distance[next] = there;
      frontier.emplace(there, next);
    }
  }
}

/// Cells no nearer than `spacing` to one another that leave no gap, those with the most room first.
std::vector<std::uint32_t> place_cells(const DrivableFloor& floor, const RouteConfig& config,
                                       double spacing) {
  std::vector<std::uint32_t> order(floor.cells.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::greater<>(), [&](std::uint32_t cell) {
    return std::min(floor.cells[cell].margin, config.half_width_m() + kComfort);
  });
  std::vector<double> distance(floor.cells.size(), kUnreached);
  std::vector<std::uint32_t> places;
  for (const std::uint32_t cell : order) {
    if (distance[cell] != kUnreached) continue;
    places.push_back(cell);
    mark_around(floor, cell, spacing, distance);
  }
  std::ranges::sort(places);
  return places;
}

/// For each cell the place that is reached from it at the least cost, and the next cell on the way there.
struct Basins {
  std::vector<double> cost;
  std::vector<std::uint32_t> place;
  std::vector<std::uint32_t> towards;
};

Basins basins_of(const DrivableFloor& floor, const std::vector<std::uint32_t>& places,
                 const RouteConfig& config) {
  const std::size_t n = floor.cells.size();
  Basins basins{std::vector<double>(n, kUnreached), std::vector<std::uint32_t>(n),
                std::vector<std::uint32_t>(n)};
  Frontier frontier;
  for (std::uint32_t p = 0; p < places.size(); ++p) {
    basins.cost[places[p]] = 0.0;
    basins.place[places[p]] = p;
    basins.towards[places[p]] = places[p];
    frontier.emplace(0.0, places[p]);
  }
  while (!frontier.empty()) {
    const auto [cost, cell] = frontier.top();
    frontier.pop();
    if (cost > basins.cost[cell]) continue;
    for (const std::uint32_t next : floor.cells[cell].links) {
      if (next == FloorCell::kNone) continue;
      const double there = cost + step_cost(floor, cell, next, config);
      if (there >= basins.cost[next]) continue;
      basins.cost[next] = there;
      basins.place[next] = basins.place[cell];
      basins.towards[next] = cell;
      frontier.emplace(there, next);
    }
  }
  return basins;
}

/// Where two basins meet at the least cost: a step from cell to cell.
struct Pass {
  double cost = kUnreached;
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

std::map<std::pair<std::uint32_t, std::uint32_t>, Pass> passes_of(const DrivableFloor& floor,
                                                                  const Basins& basins,
                                                                  const RouteConfig& config) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Pass> passes;
  for (std::uint32_t cell = 0; cell < floor.cells.size(); ++cell) {
    for (const std::uint32_t next : floor.cells[cell].links) {
      if (next == FloorCell::kNone || basins.place[cell] >= basins.place[next]) continue;
      const double cost = basins.cost[cell] + step_cost(floor, cell, next, config) + basins.cost[next];
      Pass& pass = passes[{basins.place[cell], basins.place[next]}];
      if (cost < pass.cost) pass = {cost, cell, next};
    }
  }
  return passes;
}

std::vector<std::uint32_t> way_to_place(const Basins& basins, std::uint32_t cell) {
  std::vector<std::uint32_t> way{cell};
  while (basins.towards[way.back()] != way.back()) way.push_back(basins.towards[way.back()]);
  return way;
}

RouteEdge edge_of(const DrivableFloor& floor, const Basins& basins, const Pass& pass, std::uint32_t to) {
  RouteEdge edge;
  edge.to = to;
  edge.cells = way_to_place(basins, pass.from);
  std::ranges::reverse(edge.cells);
  const std::vector<std::uint32_t> rest = way_to_place(basins, pass.to);
  edge.cells.insert(edge.cells.end(), rest.begin(), rest.end());
  for (std::size_t i = 1; i < edge.cells.size(); ++i)
    edge.length_m += step_length(floor, edge.cells[i - 1], edge.cells[i]);
  return edge;
}

}  // namespace

bool RouteNetwork::is_end(std::uint32_t place) const {
  const auto direction = [&](const RouteEdge& way) -> Vector3 {
    return (places[way.to].position - places[place].position).normalized();
  };
  const std::vector<RouteEdge>& ways = places[place].ways;
  for (std::size_t a = 0; a < ways.size(); ++a)
    for (std::size_t b = a + 1; b < ways.size(); ++b)
      if (direction(ways[a]).dot(direction(ways[b])) < kStraightOn) return false;
  return true;
}

RouteNetwork route_network(const DrivableFloor& floor, const RouteConfig& config, double spacing) {
  const std::vector<std::uint32_t> cells = place_cells(floor, config, spacing);
  const Basins basins = basins_of(floor, cells, config);
  RouteNetwork network;
  for (const std::uint32_t cell : cells) network.places.push_back({cell, floor.cells[cell].position, {}});
  for (const auto& [ends, pass] : passes_of(floor, basins, config)) {
    RouteEdge edge = edge_of(floor, basins, pass, ends.second);
    RouteEdge reverse = edge;
    reverse.to = ends.first;
    std::ranges::reverse(reverse.cells);
    network.places[ends.first].ways.push_back(std::move(edge));
    network.places[ends.second].ways.push_back(std::move(reverse));
  }
  for (RouteNetwork::Place& place : network.places) std::ranges::sort(place.ways, {}, &RouteEdge::to);
  return network;
}

std::vector<double> distances_from(const RouteNetwork& network, std::uint32_t from,
                                   std::vector<std::uint32_t>* before) {
  std::vector<double> distance(network.places.size(), kUnreached);
  if (before != nullptr) before->assign(network.places.size(), from);
  Frontier frontier;
  distance[from] = 0.0;
  frontier.emplace(0.0, from);
  while (!frontier.empty()) {
    const auto [d, place] = frontier.top();
    frontier.pop();
    if (d > distance[place]) continue;
    for (const RouteEdge& way : network.places[place].ways) {
      if (d + way.length_m >= distance[way.to]) continue;
      distance[way.to] = d + way.length_m;
      if (before != nullptr) (*before)[way.to] = place;
      frontier.emplace(distance[way.to], way.to);
    }
  }
  return distance;
}

}  // namespace adit
