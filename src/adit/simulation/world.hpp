// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Procedural tunnel networks: a mesh for ray casting and the routes of robots through it (section 2.1
/// of the paper, whose robots drive through Zentrum am Berg). The same configuration gives the same bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/result.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/route.hpp"

namespace adit {

/// World frame: metres, z up. The mesh faces the free space inside the tunnels; tunnels end in open portals.
struct World {
  std::string name;   ///< Preset and arrangement ("mine", "mine-twins"), or that of the file or its folder.
  TriangleMesh mesh;  ///< Walls, floors and all that stands there for good.
  /// Of make_world() four, with "network" three to six; those of one network start apart.
  std::vector<Route> routes;
  double tunnel_length = 0.0;  ///< Sum over the centre lines of all tunnels, metres; 0: unknown.
};

/// How hard a world is: smooth, bare walls do not fix motion along the axis, and identical places deceive
/// place recognition. Each factor scales a quantity of the preset; 1 keeps it as designed.
struct WorldConfig {
  std::string preset = "zab";
  std::uint64_t seed = 1;
  double relief_factor = 1.0;
  double furniture_spacing_factor = 1.0;
  double passage_spacing_factor = 1.0;
  double curvature_factor = 1.0;
  double facet_factor = 1.0;
  /// Which robots share tunnels. Every arrangement but "single" puts two networks side by side and lets two
  /// robots drive in each: "different", the networks of two seeds; "mirrored", a network and its mirror
  /// image; "copies", the same tunnels twice, each with furniture and rock of its own; "twins", the same
  /// twice to the last bit, which no measurement can tell apart.
  std::string arrangement = "single";
  std::string routes = "meeting";
  std::uint64_t furniture_seed = 0;
};

/// "zab": two road and two rail tubes with irregular cross passages, after Zentrum am Berg. "mine": rough
/// drifts with ramps and loops. "metro": two running tubes with identical stations and cross passages.
/// "tiles": a grid of identical tiles whose blocks are all of different length. "network": every seed has
/// another topology (a tree, loops, rooms and pillars, parallel tubes, levels joined by ramps, a spiral),
/// other sections, lining and furniture; a third of them repeat and mirror parts of themselves.
[[nodiscard]] std::vector<std::string> world_presets();

/// The keys are the names of the members; in the configuration of a run they begin with "world.".
inline Fields fields_of(WorldConfig& c) {
  return {
      {"preset", &c.preset, "", 0, 0, "kind of tunnel network", world_presets()},
      {"seed", &c.seed, "", 0, 9e15, "seed of the network; each seed gives another one of the same kind"},
      {"relief_factor", &c.relief_factor, "", 0.0, 10.0, "scales the relief of the walls"},
      {"furniture_spacing_factor", &c.furniture_spacing_factor, "", 0.3, 100.0,
       "scales the distance between niches, cabinets and parked machines"},
      {"passage_spacing_factor", &c.passage_spacing_factor, "", 0.5, 10.0,
       "scales the distance between the cross passages of zab that no route needs"},
      {"curvature_factor", &c.curvature_factor, "", 0.0, 3.0,
       "scales the curvature of the tunnels; 0: straight"},
      {"facet_factor", &c.facet_factor, "", 0.4, 4.0, "scales the longest edge of a wall's triangles"},
      {"arrangement",
       &c.arrangement,
       "",
       0,
       0,
       "one network, or two side by side with two robots in each",
       {"single", "different", "mirrored", "copies", "twins"}},
      {"routes",
       &c.routes,
       "",
       0,
       0,
       "every pair of robots shares a stretch (network: some do), or robots keep to parallel tunnels",
       {"meeting", "apart"}},
      {"furniture_seed", &c.furniture_seed, "", 0, 9e15,
       "other furniture and rock in the same tunnels; 0: those of the seed"},
  };
}

/// Fails on a field out of range (the message lists the presets when the preset is unknown), and on "network"
/// in any arrangement but "single". With "network", routes "meeting" have a pair or more that share a stretch
/// and as a rule others that share nothing; with "apart" no two share anything.
Result<World> make_world(const WorldConfig& config);

}  // namespace adit
