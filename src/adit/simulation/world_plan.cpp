// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_plan.hpp"

#include <utility>

namespace adit {
namespace {

constexpr double kSunk =
    -0.05;  ///< Metres: obstacles stand in the floor, so that no facet lies in its plane.

Solid block(const Vector3& from, const Vector3& to, const Profile& profile) {
  return turned_out(box_between(from, to, profile));
}

}  // namespace

WorldPlan concrete_plan(const WorldConfig& config) {
  WorldPlan plan;
  plan.relief = {mix64(furniture_seed(config), 2), {{5.0, 0.006 * config.relief_factor}}, 0.0, 0.0, 1.0};
  plan.max_edge = 1.0 * config.facet_factor;
  return plan;
}

std::uint64_t furniture_seed(const WorldConfig& config) {
  return config.furniture_seed == 0 ? config.seed : config.furniture_seed;
}

Rng furniture_rng(const WorldConfig& config, const Rng& after_tunnels) {
  return config.furniture_seed == 0 ? after_tunnels : Rng(mix64(config.furniture_seed, 3));
}

void add_tunnel(WorldPlan& plan, const Profile& profile, const Polyline& line) {
  plan.spaces.push_back(sweep(profile, line, Ends::open));
  plan.tunnel_length += length_of(line);
}

void add_closed_tunnel(WorldPlan& plan, const Profile& profile, const Polyline& line) {
  plan.spaces.push_back(sweep(profile, line, Ends::closed));
  plan.tunnel_length += length_of(line);
}

Solid niche(const WallSite& site) {
  constexpr double kDepth = 0.9;
  return box_between(site.at(site.half_width - 1.0), site.at(site.half_width + kDepth),
                     box_profile(1.8, 0.12, 2.1));
}

Solid cabinet(const WallSite& site) {
  return block(site.at(site.half_width - 0.45), site.at(site.half_width + 0.2), box_profile(1.1, kSunk, 1.9));
}

std::vector<Solid> machine(const WallSite& site, double lateral) {
  return {block(site.at(lateral, -2.8), site.at(lateral, 2.0), box_profile(2.0, kSunk, 1.5)),
          block(site.at(lateral, -1.0), site.at(lateral, 0.7), box_profile(1.7, 1.4, 3.0)),
          block(site.at(lateral, 1.9), site.at(lateral, 3.0), box_profile(2.3, kSunk, 0.9))};
}

void add_niche(WorldPlan& plan, const WallSite& site) { plan.spaces.push_back(niche(site)); }

void add_cabinet(WorldPlan& plan, const WallSite& site) { plan.obstacles.push_back(cabinet(site)); }

void add_machine(WorldPlan& plan, const WallSite& site, double lateral) {
  for (Solid& part : machine(site, lateral)) plan.obstacles.push_back(std::move(part));
}

}  // namespace adit
