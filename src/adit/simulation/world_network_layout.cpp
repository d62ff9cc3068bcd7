// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Topologies of networks: what a world is, and trees and loops.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "adit/simulation/world_network_grow.hpp"

namespace adit {
namespace {

using layouts::chance;
using layouts::direction;
using layouts::Grower;

Lining draw_lining(Family family, Rng& rng) {
  const bool built = family == Family::tubes;  // Traffic and rail tubes are lined more often than drifts.
  const double draw = rng.uniform();
  if (draw < (built ? 0.6 : 0.15)) return Lining::concrete;
  return draw < (built ? 0.85 : 0.5) ? Lining::shotcrete : Lining::rock;
}

double draw_width(Family family, Rng& rng) {
  if (family == Family::grid) return rng.uniform(5.0, 9.0);                  // Rooms.
  if (family == Family::tubes) return rng.uniform(4.5, 9.0);                 // Rail to two-lane road.
  return chance(rng, 0.15) ? rng.uniform(6.5, 8.5) : rng.uniform(3.4, 6.2);  // Drifts for loaders, trucks.
}

/// What a world is stays the same however often its layout has to be drawn.
NetworkStyle draw_style(const WorldConfig& config, Rng& rng) {
  NetworkStyle style;
  Rng kind_rng(mix64(config.seed, 1));
  style.family = kFamilies[kind_rng.below(kFamilies.size())];
  style.repeats = chance(kind_rng, 1.0 / 3.0);
  style.lining = draw_lining(style.family, rng);
  const double kind = rng.uniform();
  const bool rough = style.lining == Lining::rock;
  style.section = kind < (rough ? 0.35 : 0.6)   ? SectionKind::arch
                  : kind < (rough ? 0.55 : 0.8) ? SectionKind::box
                                                : SectionKind::irregular;
  style.width = draw_width(style.family, rng);
  style.height_share = style.family == Family::grid ? rng.uniform(0.4, 0.85) : rng.uniform(0.72, 1.05);
  style.variation = chance(rng, 0.3) ? 0.02 : rng.uniform(0.05, 0.2);
  style.pillar = rng.uniform(9.0, 22.0);
  style.bend = rng.uniform(0.1, 0.9);
  style.ramp = rng.uniform(0.0, 0.5);
  style.total_length = rng.uniform(700.0, 1200.0);
  style.furniture_spacing = rng.uniform(10.0, 45.0);
  // Drainage asks for half a per cent or more; seams dip by some per cent.
  const double dip = style.family == Family::grid ? rng.uniform(0.0, 0.07) : rng.uniform(0.0, 0.012);
  style.tilt = dip * direction(rng.uniform(0.0, 2.0 * std::numbers::pi));
  return style;
}

/// Some of the ends open to the outside.
void open_portals(Network& network, double share, Rng& rng) {
  for (std::size_t i = 0; i < network.nodes.size(); ++i) {
    const bool opens = network.nodes[i].portal || chance(rng, share);
    network.nodes[i].portal = network.edges_at(i).size() == 1 && opens && opens_outwards(network, i);
  }
}

bool lay_tree(Network& network, Grower& grower, Rng& rng) {
  const std::size_t mouth = grower.add_node(Vector3::Zero(), 0);
  network.nodes[mouth].portal = true;
  if (!grower.try_branch(mouth, 0.0)) return false;
  const double loops = network.style.family == Family::loops ? rng.uniform(0.55, 0.85) : 0.0;
  if (!grower.grow({0, network.style.total_length, loops})) return false;
  return loops == 0.0 || network.edges.size() >= network.nodes.size();  // One loop more than a tree has.
}

bool lay(Network& network, Grower& grower, const WorldConfig& config, Rng& rng) {
  switch (network.style.family) {
    case Family::tree:
    case Family::loops:
      return lay_tree(network, grower, rng);
    case Family::grid:
      return layouts::lay_grid(network, grower, config, rng);
    case Family::tubes:
      return layouts::lay_tubes(network, grower, config, rng);
    case Family::levels:
    case Family::spiral:
      return layouts::lay_levels(network, grower, rng);
  }
  return false;
}

/// Two of a module make a repetition.
bool repeats_something(const Network& network) {
  std::map<int, int> count;
  for (const NetworkEdge& edge : network.edges)
    if (edge.module != 0 && ++count[edge.module] >= 2) return true;
  return false;
}

}  // namespace

std::optional<Network> draw_layout(const WorldConfig& config, Rng& rng) {
  constexpr double kLeast = 450.0;
  constexpr double kMost = 1350.0;
  Network network;
  network.style = draw_style(config, rng);
  if (network.style.family == Family::levels || network.style.family == Family::spiral)
    network.style.ramp = 0.0;  // Levels are level.
  Grower grower(network, config, rng);
  if (!lay(network, grower, config, rng)) return std::nullopt;
  const double share = network.style.family == Family::tubes ? rng.uniform(0.5, 1.0) : rng.uniform(0.1, 0.6);
  open_portals(network, share, rng);
  const double length = network.total_length();
  if (length < kLeast || length > kMost) return std::nullopt;
  if (network.style.repeats && !repeats_something(network)) return std::nullopt;
  return network;
}

}  // namespace adit
