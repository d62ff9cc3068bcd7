// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the families of networks are laid out with. Priors are those of mines and tunnels as they are built;
/// where each comes from: docs/decisions/0037-network-worlds.md. Internal to the world.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/simulation/world_network.hpp"

namespace adit::layouts {

inline constexpr double kSteepest = 0.14;  ///< 1:7, the steepest that haulage ramps are usually driven at.
inline constexpr double kFlattest = 0.10;  ///< 1:10, the flattest usual ramp between levels.
inline constexpr double kCurveShare =
    0.85;  ///< Mean grade of a ramp's slope divided by its steepest (ramp_rise).
inline constexpr double kCrownPillar = 6.5;  ///< Metres of rock between a level's roof and the floor above.

/// True with the probability `share`; draws one number.
inline bool chance(Rng& rng, double share) { return rng.uniform() < share; }
/// 1 or -1, as often; draws one number.
inline double sign_of(Rng& rng) { return chance(rng, 0.5) ? 1.0 : -1.0; }
/// Metres that a tunnel of that width (metres) stays level at each end.
inline double landing_of(double width) { return 6.0 + 1.5 * width; }

/// Unit vector in plan. `heading`: radians from x towards y.
inline Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }
/// The point `distance` metres from `from`, at the same height. `heading` as above.
inline Vector3 ahead(const Vector3& from, double heading, double distance) {
  const Eigen::Vector2d d = distance * direction(heading);
  return from + Vector3(d.x(), d.y(), 0.0);
}

/// Evenly spaced points from `begin` to `end` along a line.
inline Polyline stretch_of(const Polyline& line, double begin, double end) {
  const int steps = std::max(2, static_cast<int>(std::ceil((end - begin) / 1.5)));
  Polyline part;
  for (int k = 0; k <= steps; ++k) part.push_back(point_at(line, begin + (end - begin) * k / steps).position);
  return part;
}

/// A tunnel that is placed several times.
struct Module {
  double length = 50.0;  ///< From end to end in plan, metres.
  LineShape shape;       ///< But for its landing, which follows from the width.
  Section section;       ///< That of mirrored copies is its mirror image.
};

/// Adds nodes and edges to a network; draws a module first where the style repeats.
class Grower {
 public:
  /// `network`, whose style is drawn already, and `rng` outlive it.
  Grower(Network& network, const WorldConfig& config, Rng& rng)
      : net_(network), curvature_(config.curvature_factor), rng_(rng) {
    if (style().repeats) {
      module_.length = rng.uniform(32.0, 80.0);
      module_.shape = draw_shape(module_.length);
      module_.section = draw_section();
    }
  }

  /// `at` on the floor, metres. Returns the index of the node.
  std::size_t add_node(const Vector3& at, int storey) {
    net_.nodes.push_back({at, storey, false});
    return net_.nodes.size() - 1;
  }

  /// About `share` times the style's width, which varies as the style says: 3.2 to 10 m wide, 2.8 to 8 m
  /// high.
  Section draw_section(double share = 1.0) {
    const double width =
        std::clamp(share * style().width * (1.0 + style().variation * rng_.uniform(-1.0, 1.0)), 3.2, 10.0);
    const double height = std::clamp(width * style().height_share * rng_.uniform(0.95, 1.05), 2.8, 8.0);
    return adit::draw_section(style().section, width, height, rng_);
  }

  /// A shape for a tunnel of `length` metres in plan, its landing apart.
  LineShape draw_shape(double length) {
    LineShape shape;
    const bool bends = chance(rng_, style().bend);
    shape.waves = chance(rng_, 0.65) ? 1 : 2;
    // The bow's tightest radius is length^2 / (2 pi^2 sagitta).
    const double most = length * length / (2.0 * std::numbers::pi * std::numbers::pi * 14.0);
    const double sagitta = rng_.uniform(-1.0, 1.0) * std::min(most, 0.2 * length);
    shape.sagitta = bends ? curvature_ * sagitta : 0.0;
    return shape;
  }

  /// Adds the edge if it fits. Its ends are nodes already.
  bool try_edge(NetworkEdge edge, int storey) {
    if (edge.parts.empty()) edge.parts = {{0, edge.line.size() - 1, storey}};
    if (!fits(net_, edge)) return false;
    net_.edges.push_back(std::move(edge));
    return true;
  }

  /// A new tunnel from `from` to a node of its own.
  bool try_branch(std::size_t from, double heading, double min_x = -1e9) {
    const bool of_module = style().repeats && chance(rng_, 0.55);
    const double length = of_module ? module_.length : rng_.uniform(26.0, 110.0);
    NetworkEdge edge{from, 0, {}, of_module ? module_.section : draw_section(), {}, Copy::own, 0};
    LineShape shape = of_module ? module_.shape : draw_shape(length);
    shape.landing = landing_of(edge.section.width);
    if (of_module) make_copy(edge, shape);
    Vector3 to = ahead(net_.nodes[from].at, heading, length);
    if (to.x() < min_x) return false;
    to.z() += of_module ? 0.0 : draw_rise(length - 2.0 * shape.landing);
    edge.line = shaped_line(net_.nodes[from].at, to, shape);
    edge.to = add_node(to, net_.nodes[from].storey);
    if (try_edge(std::move(edge), net_.nodes[from].storey)) return true;
    net_.nodes.pop_back();
    return false;
  }

  /// A tunnel between two nodes that are there.
  bool try_connection(std::size_t a, std::size_t b) {
    const Vector3& from = net_.nodes[a].at;
    const Vector3& to = net_.nodes[b].at;
    const double length = (to - from).head<2>().norm();
    if (a == b || length < 20.0 || length > 130.0) return false;
    NetworkEdge edge{a, b, {}, draw_section(), {}, Copy::own, 0};
    LineShape shape = draw_shape(length);
    shape.landing = landing_of(edge.section.width);
    edge.line = shaped_line(from, to, shape);
    return steepest_grade(edge.line) <= kSteepest && try_edge(std::move(edge), net_.nodes[a].storey);
  }

  /// What grow() is to add, and where.
  struct Growth {
    int storey = 0;         ///< Of the nodes from which it branches off.
    double length = 500.0;  ///< Metres to add.
    double loops = 0.0;     ///< Share of tunnels that close a loop.
    double min_x = -1e9;    ///< No node lies further to the west.
  };
  /// Branches off at random until the length is reached. Whether most of it was.
  bool grow(const Growth& growth) {
    constexpr int kFailures = 160;
    const double begin = net_.total_length();
    int failures = 0;
    while (net_.total_length() - begin < growth.length && failures < kFailures)
      if (!grow_once(growth)) ++failures;
    return net_.total_length() - begin > 0.6 * growth.length;
  }

  /// That of the network.
  [[nodiscard]] const NetworkStyle& style() const { return net_.style; }

 private:
  void make_copy(NetworkEdge& edge, LineShape& shape) {
    const double draw = rng_.uniform();
    edge.copy = draw < 0.4 ? Copy::same : draw < 0.7 ? Copy::mirrored : Copy::changed;
    edge.module = 1;
    if (edge.copy != Copy::mirrored) return;
    shape.sagitta = -shape.sagitta;
    edge.section = mirrored(edge.section);
  }

  double draw_rise(double run) {
    const double grade = rng_.uniform(0.02, kSteepest);
    const bool climbs = chance(rng_, style().ramp);
    const double sign = sign_of(rng_);
    return climbs && run > 12.0 ? sign * grade * kCurveShare * run : 0.0;
  }

  bool grow_once(const Growth& growth) {
    std::vector<std::size_t> tips;
    std::vector<std::size_t> inner;
    for (std::size_t i = 0; i < net_.nodes.size(); ++i) {
      if (net_.nodes[i].storey != growth.storey || net_.nodes[i].portal) continue;
      const std::size_t degree = net_.edges_at(i).size();
      if (degree == 1) tips.push_back(i);
      if (degree == 2 || degree == 3) inner.push_back(i);
    }
    const bool closes = chance(rng_, growth.loops);
    const std::vector<std::size_t>& from = inner.empty() || chance(rng_, 0.4) ? tips : inner;
    if (from.empty()) return false;
    const std::size_t node = from[rng_.below(from.size())];
    if (closes) {
      const std::size_t other = rng_.below(net_.nodes.size());
      const NetworkNode& end = net_.nodes[other];
      return end.storey == growth.storey && !end.portal && try_connection(node, other);
    }
    const std::vector<std::size_t> edges = net_.edges_at(node);
    const Eigen::Vector2d back = direction_at(net_.edges[edges[rng_.below(edges.size())]], node);
    const double angle = edges.size() == 1 ? rng_.uniform(80.0, 180.0) : rng_.uniform(30.0, 150.0);
    const double heading = std::atan2(back.y(), back.x()) + sign_of(rng_) * angle * kDegree;
    return try_branch(node, heading, growth.min_x);
  }

  Network& net_;
  double curvature_;
  Rng& rng_;
  Module module_;
};

/// Lays tunnels of the network's style into it. False where the draw does not come out: then the network is
/// of no use.
///@{
bool lay_grid(Network& network, Grower& grower, const WorldConfig& config, Rng& rng);
bool lay_tubes(Network& network, Grower& grower, const WorldConfig& config, Rng& rng);
bool lay_levels(Network& network, Grower& grower, Rng& rng);
///@}

}  // namespace adit::layouts
