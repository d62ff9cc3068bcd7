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

/// Kinds of topology.
enum class Family {
  tree,    ///< Tunnels branch and never meet again.
  loops,   ///< Some of the branches close loops.
  grid,    ///< Rooms and pillars.
  tubes,   ///< Two or three side by side with cross passages.
  levels,  ///< Two or three above one another, joined by a spiral or a hairpin.
  spiral   ///< Three or four above one another, joined by a spiral.
};
/// All families; which one a seed draws depends on their order.
inline constexpr std::array kFamilies{Family::tree,  Family::loops,  Family::grid,
                                      Family::tubes, Family::levels, Family::spiral};
/// Shape of a tunnel across: an arch on upright walls, a rectangle, or a convex polygon that is drawn.
enum class SectionKind { arch, box, irregular };
/// What walls are made of, from the smoothest to the roughest.
enum class Lining { concrete, shotcrete, rock };

/// A tunnel across its line. Lengths in metres.
struct Section {
  Profile profile;      ///< Its floor is at height 0.
  double width = 5.0;   ///< Where it is widest.
  double height = 4.5;  ///< Where it is highest.
};

/// How a tunnel comes to its shape and furniture: by draws of its own, or as one of several of a module.
enum class Copy { own, same, mirrored, changed };

/// A place where tunnels meet or one of them ends.
struct NetworkNode {
  Vector3 at = Vector3::Zero();  ///< On the floor, before the style's tilt.
  int storey = 0;                ///< Index in WorldPlan::storeys.
  bool portal = false;  ///< Of those with one tunnel: open to the outside; else the tunnel ends in rock.
};

/// A stretch of an edge's line, from point to point, and the storey in which it is built.
struct StoreyPart {
  std::size_t first = 0;  ///< Index of a point of the line,
  std::size_t last = 0;   ///< and of a later one, at which the next part begins.
  int storey = 0;         ///< Index in WorldPlan::storeys.
};

/// A tunnel from one node to another.
struct NetworkEdge {
  /// Index in Network::nodes.
  ///@{
  std::size_t from = 0;
  std::size_t to = 0;
  ///@}
  Polyline line;    ///< From node to node along the middle of the floor, before the style's tilt.
  Section section;  ///< The same from end to end.
  std::vector<StoreyPart> parts;  ///< In order, without gaps.
  Copy copy = Copy::own;          ///< `own` where `module` is 0.
  int module = 0;                 ///< Tunnels of one module have the same number; 0: none.

  /// As StoreyPart::storey; of a point that two parts share, that of the first.
  [[nodiscard]] int storey_at(std::size_t point) const;
};

/// What a world draws once and its tunnels vary.
struct NetworkStyle {
  Family family = Family::tree;             ///< Decided by the seed of the world alone, as `repeats` is.
  bool repeats = false;                     ///< Whether some tunnels are copies of one another.
  Lining lining = Lining::rock;             ///< Of all tunnels.
  SectionKind section = SectionKind::arch;  ///< Of all tunnels.
  double width = 5.0;                       ///< About which those of tunnels vary, metres.
  double height_share = 0.9;                ///< Height of a section divided by its width.
  double variation = 0.1;  ///< Largest deviation of a tunnel's width from the world's, as a share.
  double pillar = 12.0;    ///< Least rock between two tunnels that do not meet, metres.
  double bend = 0.5;       ///< Share of tunnels that bend.
  double ramp = 0.2;       ///< Share of tunnels that climb or fall.
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();  ///< Rise of all floors per metre along x and y.
  double total_length = 1000.0;                    ///< Metres of tunnel that the layout aims at.
  double furniture_spacing = 20.0;                 ///< Metres between things, before WorldConfig's factor.
};

/// Tunnels as the edges of a graph.
struct Network {
  NetworkStyle style;              ///< What all of it has in common.
  std::vector<NetworkNode> nodes;  ///< One or more edges meet in each.
  std::vector<NetworkEdge> edges;  ///< Furniture is drawn by their index.

  [[nodiscard]] std::vector<std::size_t> edges_at(std::size_t node) const;  ///< Indices of edges, ascending.
  [[nodiscard]] double total_length() const;                                ///< Of all edges, metres.
};

/// An edge as a robot follows it.
struct Step {
  std::size_t edge = 0;  ///< Index in Network::edges.
  bool forward = true;   ///< From the edge's `from` to its `to`.
};
/// The path of one robot: `begin` metres into the first step, for `length` metres.
struct NetworkPath {
  std::vector<Step> steps;  ///< Each begins at the node where the one before ends.
  double begin = 0.0;       ///< Metres, in the direction of the step.
  double length = 0.0;      ///< Metres, along the middles of the tunnels.
  double speed_mps = 1.5;   ///< As Route::speed_mps.
  double lane = 0.0;        ///< Metres to the left of the middle.
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
  double sagitta = 0.0;   ///< Metres; negative: to the right.
  int waves = 1;          ///< 1: a bow, 2: a double bend.
  double landing = 10.0;  ///< Metres at each end.
};
/// Points about 1.5 m apart in plan. The first is `from` and the last one `to`.
[[nodiscard]] Polyline shaped_line(const Vector3& from, const Vector3& to, const LineShape& shape);
/// Steepest grade of the line, rise over run.
[[nodiscard]] double steepest_grade(std::span<const Vector3> line);

/// The size is as asked for, metres; what else shapes the section is drawn.
[[nodiscard]] Section draw_section(SectionKind kind, double width, double height, Rng& rng);
/// Left and right exchanged; the profile still runs counter-clockwise.
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
/// Both along the middles of their tunnels: lanes do not count.
[[nodiscard]] Relation relation_of(const Network& network, const NetworkPath& a, const NetworkPath& b);
/// Three to six paths; fewer where the network holds no more. With routes "meeting" one pair at least shares
/// a stretch (else there is no path), with "apart" none does.
[[nodiscard]] std::vector<NetworkPath> draw_paths(const Network& network, const WorldConfig& config,
                                                  Rng& rng);
/// Where the robot drives: in its lane, around rounded corners, before the style's tilt.
[[nodiscard]] Polyline line_of(const Network& network, const NetworkPath& path);

/// A network with its paths and the plan made of it; draws again until all is sound and drivable.
struct NetworkWorld {
  Network network;                 ///< Its nodes and lines are as before the style's tilt.
  std::vector<NetworkPath> paths;  ///< Three to six, one per robot.
  WorldPlan plan;                  ///< With one route per path, in the same order.
};
/// The same configuration gives the same world. Throws ContractViolation where none of 2000 draws is sound.
[[nodiscard]] NetworkWorld draw_network_world(const WorldConfig& config);

/// How deep within free space, and how far from matter, a robot is that drives at `waypoint` (metres; of a
/// point 1.2 m above the floor). Lower bounds.
struct Clearance {
  double walls = 0.0;      ///< Negative outside of the tunnels.
  double obstacles = 0.0;  ///< Negative inside an obstacle; infinite where there is none.
};
/// Only storeys count whose floor lies within 2.5 m of the waypoint's height.
[[nodiscard]] Clearance clearance_at(const WorldPlan& plan, const Vector3& waypoint);

}  // namespace adit
