// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Tunnel networks whose topology is drawn: the graph behind the preset "network". World frame, metres.
/// What is drawn from where: docs/decisions/0037-network-worlds.md. Internal to the world.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/simulation/world_plan.hpp"

namespace adit {

enum class Family { tree, loops, grid, tubes, levels, spiral };
inline constexpr std::array kFamilies{Family::tree,  Family::loops,  Family::grid,
                                      Family::tubes, Family::levels, Family::spiral};
enum class SectionKind { arch, box, irregular };
enum class Lining { concrete, shotcrete, rock };

struct Section {
  Profile profile;
  double width = 5.0;
  double height = 4.5;
};

/// How a tunnel comes to its shape and furniture: by draws of its own, or as one of several of a module.
enum class Copy { own, same, mirrored, changed };

struct NetworkNode {
  Vector3 at = Vector3::Zero();  ///< On the floor, before the style's tilt.
  int storey = 0;
  bool portal = false;  ///< Of those with one tunnel: open to the outside; else the tunnel ends in rock.
};

/// A stretch of an edge's line, from point to point, and the storey in which it is built.
struct StoreyPart {
  std::size_t first = 0;
  std::size_t last = 0;
  int storey = 0;
};

struct NetworkEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Polyline line;  ///< From node to node along the middle of the floor, before the style's tilt.
  Section section;
  std::vector<StoreyPart> parts;  ///< In order, without gaps.
  Copy copy = Copy::own;
  int module = 0;  ///< Tunnels of one module have the same number; 0: none.

  [[nodiscard]] int storey_at(std::size_t point) const;
};

/// What a world draws once and its tunnels vary.
struct NetworkStyle {
  Family family = Family::tree;
  bool repeats = false;
  Lining lining = Lining::rock;
  SectionKind section = SectionKind::arch;
  double width = 5.0;
  double height_share = 0.9;  ///< Height of a section divided by its width.
  double variation = 0.1;     ///< Largest deviation of a tunnel's width from the world's, as a share.
  double pillar = 12.0;       ///< Least rock between two tunnels that do not meet, metres.
  double bend = 0.5;          ///< Share of tunnels that bend.
  double ramp = 0.2;          ///< Share of tunnels that climb or fall.
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();  ///< Rise of all floors per metre along x and y.
  double total_length = 1000.0;
  double furniture_spacing = 20.0;
};

struct Network {
  NetworkStyle style;
  std::vector<NetworkNode> nodes;
  std::vector<NetworkEdge> edges;

  [[nodiscard]] std::vector<std::size_t> edges_at(std::size_t node) const;
  [[nodiscard]] double total_length() const;
};

/// An edge as a robot follows it.
struct Step {
  std::size_t edge = 0;
  bool forward = true;
};
/// The path of one robot: `begin` metres into the first step, for `length` metres.
struct NetworkPath {
  std::vector<Step> steps;
  double begin = 0.0;
  double length = 0.0;
  double speed_mps = 1.5;
  double lane = 0.0;  ///< Metres to the left of the middle.
};

// Geometry of the graph.

/// Unit direction in plan in which an edge leaves one of its nodes.
[[nodiscard]] Eigen::Vector2d direction_at(const NetworkEdge& edge, std::size_t node);
/// Metres of rock between two tunnels as seen at a point of each one's line.
[[nodiscard]] double rock_between(const NetworkEdge& a, std::size_t i, const NetworkEdge& b, std::size_t j);
/// Whether `edge` keeps clear of all edges: rock of the style's pillar between those that do not meet, 30
/// degrees or more between those that do, and no bend too narrow for its section.
[[nodiscard]] bool fits(const Network& network, const NetworkEdge& edge);
/// Whether rays that leave the network at this node, which has one edge, meet none of its tunnels.
[[nodiscard]] bool opens_outwards(const Network& network, std::size_t node);
/// Share of the height difference that a ramp has overcome at a share of its length; level at both ends.
[[nodiscard]] double ramp_rise(double share);
/// A line from `from` to `to`, in plan with a bow (`waves` 1) or a double bend (2) of `sagitta` metres to the
/// left that leaves both ends straight, and level for `landing` metres there.
struct LineShape {
  double sagitta = 0.0;
  int waves = 1;
  double landing = 10.0;
};
[[nodiscard]] Polyline shaped_line(const Vector3& from, const Vector3& to, const LineShape& shape);
/// Steepest grade of the line, rise over run.
[[nodiscard]] double steepest_grade(std::span<const Vector3> line);

[[nodiscard]] Section draw_section(SectionKind kind, double width, double height, Rng& rng);
[[nodiscard]] Section mirrored(Section section);
/// Metres from the line to the wall `above` metres over the floor, on the left (side +1) or right (-1).
[[nodiscard]] double half_width(const Section& section, double above, double side);

/// The topology; none where the draw leads to no sound network. Uses no furniture.
[[nodiscard]] std::optional<Network> draw_layout(const WorldConfig& config, Rng& rng);

/// What two paths have in common.
struct Relation {
  double shared = 0.0;  ///< Metres of tunnel that both drive along.
  double apart = 0.0;   ///< Least rock between the tunnels that they drive along; 0 where these meet.
};
[[nodiscard]] Relation relation_of(const Network& network, const NetworkPath& a, const NetworkPath& b);
/// Three to six paths; fewer where the network holds no more. With routes "meeting" one pair at least shares
/// a stretch (else there is no path), with "apart" none does.
[[nodiscard]] std::vector<NetworkPath> draw_paths(const Network& network, const WorldConfig& config,
                                                  Rng& rng);
[[nodiscard]] Polyline line_of(const Network& network, const NetworkPath& path);

/// A network with its paths and the plan made of it; draws again until all is sound and drivable.
struct NetworkWorld {
  Network network;
  std::vector<NetworkPath> paths;
  WorldPlan plan;
};
[[nodiscard]] NetworkWorld draw_network_world(const WorldConfig& config);

/// How deep within free space, and how far from matter, a robot is that drives at `waypoint` (metres; of a
/// point 1.2 m above the floor). Lower bounds.
struct Clearance {
  double walls = 0.0;
  double obstacles = 0.0;
};
[[nodiscard]] Clearance clearance_at(const WorldPlan& plan, const Vector3& waypoint);

}  // namespace adit
