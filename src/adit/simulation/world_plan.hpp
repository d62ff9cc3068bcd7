// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The plan that a preset makes, before anything is meshed. Internal to the world.
#pragma once

#include <vector>

#include "adit/core/rng.hpp"
#include "adit/simulation/world.hpp"
#include "adit/simulation/world_drive.hpp"
#include "adit/simulation/world_floors.hpp"
#include "adit/simulation/world_relief.hpp"
#include "adit/simulation/world_solids.hpp"

namespace adit {

/// Tunnels of which no two cross in plan. They are built level, at z = 0, and then sheared upwards to where
/// their floors lie: walls stay upright and every facet of the level tunnels stays exact. Storeys meet in the
/// open ends of tunnels that are swept as parts of one line (`sweep_part`) and have the same floors there.
struct Storey {
  std::vector<Solid> spaces;     ///< As those of the plan.
  std::vector<Solid> obstacles;  ///< As those of the plan.
  Floors floors;                 ///< How high its floors lie above z = 0.
};

/// What make_world() makes a mesh and routes of.
struct WorldPlan {
  std::vector<Solid>
      spaces;  ///< Tunnels before what opens into them, so that floors keep the tunnel's facets.
  std::vector<Solid> obstacles;  ///< Matter, faces looking outwards.
  Relief relief;                 ///< Displaces the level spaces and all storeys.
  double max_edge = 1.0;         ///< Longest edge of a triangle, metres.
  bool flat_floor = true;        ///< As Surfacing::flat_floor.
  std::vector<Drive> drives;     ///< Along level lines; their routes follow the floor with its relief.
  std::vector<Route> routes;     ///< Routes that are planned already; they follow those of `drives`.
  std::vector<Storey> storeys;   ///< Beside the level spaces above.
  double tunnel_length = 0.0;    ///< Sum over the centre lines, metres.
};

/// The plan of the preset, see world_presets(). Each number of `config` lies within its range; preset and
/// arrangement are not looked at.
///@{
[[nodiscard]] WorldPlan plan_zab(const WorldConfig& config);
[[nodiscard]] WorldPlan plan_mine(const WorldConfig& config);
[[nodiscard]] WorldPlan plan_metro(const WorldConfig& config);
[[nodiscard]] WorldPlan plan_tiles(const WorldConfig& config);
[[nodiscard]] WorldPlan plan_network(const WorldConfig& config);
///@}

/// An empty plan with concrete walls: facets of a metre, uneven by millimetres.
[[nodiscard]] WorldPlan concrete_plan(const WorldConfig& config);
/// The seed of furniture and rock, which can differ in otherwise identical tunnels.
[[nodiscard]] std::uint64_t furniture_seed(const WorldConfig& config);
/// The generator of the furniture: continues `after_tunnels`, or starts anew where the furniture has its own
/// seed.
[[nodiscard]] Rng furniture_rng(const WorldConfig& config, const Rng& after_tunnels);

/// Adds a tunnel along `line` (world frame, metres), open at both ends, and its length.
void add_tunnel(WorldPlan& plan, const Profile& profile, const Polyline& line);
/// The same with walls at both ends; where an end lies inside another tunnel there is no wall.
void add_closed_tunnel(WorldPlan& plan, const Profile& profile, const Polyline& line);

/// A place beside a tunnel: `distance` along its line, on its left (+1) or right (-1).
struct WallSite {
  LinePoint foot;           ///< On the line.
  double side = 1.0;        ///< +1: left, -1: right.
  double half_width = 5.0;  ///< Of the tunnel, metres.

  /// Unit direction to the left of the line, on whichever side the site is.
  [[nodiscard]] Vector3 left() const { return Vector3::UnitZ().cross(foot.direction); }
  /// The point `lateral` metres from the line towards the site's side and `along` metres further on.
  [[nodiscard]] Vector3 at(double lateral, double along = 0.0) const {
    return foot.position + left() * (side * lateral) + foot.direction * along;
  }
};
/// Free space in the wall: 1.8 m wide, 0.9 m deep, from 0.12 to 2.1 m above the floor.
[[nodiscard]] Solid niche(const WallSite& site);
/// Matter at the wall: 1.1 m along it, 1.9 m high, it stands out by 0.45 m.
[[nodiscard]] Solid cabinet(const WallSite& site);
/// A wheel loader parked along the tunnel, its middle `lateral` metres from the line.
[[nodiscard]] std::vector<Solid> machine(const WallSite& site, double lateral);
/// Adds a niche to the level spaces of the plan, the others to its obstacles.
///@{
void add_niche(WorldPlan& plan, const WallSite& site);
void add_cabinet(WorldPlan& plan, const WallSite& site);
void add_machine(WorldPlan& plan, const WallSite& site, double lateral);
///@}

}  // namespace adit
