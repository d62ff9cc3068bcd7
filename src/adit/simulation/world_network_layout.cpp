// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Topologies of networks. Priors are those of mines and tunnels as they are built; where each comes from:
/// docs/decisions/0037-network-worlds.md.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/simulation/world_network.hpp"

namespace adit {
namespace {

constexpr double kSteepest = 0.14;    // 1:7, the steepest that haulage ramps are usually driven at.
constexpr double kFlattest = 0.10;    // 1:10, the flattest usual ramp between levels.
constexpr double kCurveShare = 0.85;  // Mean grade of a ramp's slope divided by its steepest (ramp_rise).
constexpr double kCrownPillar = 6.5;  // Metres of rock between a level's roof and the floor above.

bool chance(Rng& rng, double share) { return rng.uniform() < share; }
double sign_of(Rng& rng) { return chance(rng, 0.5) ? 1.0 : -1.0; }
double landing_of(double width) { return 6.0 + 1.5 * width; }

Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }
Vector3 ahead(const Vector3& from, double heading, double distance) {
  const Eigen::Vector2d d = distance * direction(heading);
  return from + Vector3(d.x(), d.y(), 0.0);
}

// ---------------------------------------------------------------------------------------------- style

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

// -------------------------------------------------------------------------------------------- growing

/// A tunnel that is placed several times.
struct Module {
  double length = 50.0;
  LineShape shape;
  Section section;
};

class Grower {
 public:
  Grower(Network& network, const WorldConfig& config, Rng& rng)
      : net_(network), curvature_(config.curvature_factor), rng_(rng) {
    if (style().repeats) {
      module_.length = rng.uniform(32.0, 80.0);
      module_.shape = draw_shape(module_.length);
      module_.section = draw_section();
    }
  }

  std::size_t add_node(const Vector3& at, int storey) {
    net_.nodes.push_back({at, storey, false});
    return net_.nodes.size() - 1;
  }

  Section draw_section(double share = 1.0) {
    const double width =
        std::clamp(share * style().width * (1.0 + style().variation * rng_.uniform(-1.0, 1.0)), 3.2, 10.0);
    const double height = std::clamp(width * style().height_share * rng_.uniform(0.95, 1.05), 2.8, 8.0);
    return adit::draw_section(style().section, width, height, rng_);
  }

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

  struct Growth {
    int storey = 0;
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

// ----------------------------------------------------------------------------------- room and pillar

struct Lattice {
  int columns;
  int rows;
  Eigen::Vector2d along;
  Eigen::Vector2d across;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row * columns + column);
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

// ------------------------------------------------------------------------------------- parallel tubes

/// Evenly spaced points from `begin` to `end` along a line.
Polyline stretch_of(const Polyline& line, double begin, double end) {
  const int steps = std::max(2, static_cast<int>(std::ceil((end - begin) / 1.5)));
  Polyline part;
  for (int k = 0; k <= steps; ++k) part.push_back(point_at(line, begin + (end - begin) * k / steps).position);
  return part;
}

struct Tubes {
  std::vector<Polyline> lines;
  /// Of each tube: the nodes along it by distance from its beginning.
  std::vector<std::map<double, std::size_t>> nodes;
};

Tubes draw_tubes(const NetworkStyle& style, const WorldConfig& config, Rng& rng) {
  const std::size_t num = chance(rng, 0.65) ? 2 : 3;
  const double length = std::clamp(style.total_length / static_cast<double>(num) * 0.85, 210.0, 420.0);
  const double amplitude = config.curvature_factor * rng.uniform(0.0, 14.0);
  const double wavelength = rng.uniform(220.0, 500.0);
  const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  Polyline middle;
  for (double x = 0.0; x <= length; x += 1.5)
    middle.emplace_back(x, amplitude * std::sin(2.0 * std::numbers::pi * x / wavelength + phase), 0.0);
  Tubes tubes;
  double left = 0.0;
  for (std::size_t i = 0; i < num; ++i) {
    tubes.lines.push_back(offset_line(middle, left));
    tubes.nodes.emplace_back();
    left += style.width * (1.0 + style.variation) + rng.uniform(11.0, 32.0);
  }
  return tubes;
}

bool is_free(const std::map<double, std::size_t>& nodes, double at, double gap) {
  return std::ranges::none_of(nodes, [&](const auto& node) { return std::abs(node.first - at) < gap; });
}

struct Passage {
  std::size_t from;
  std::size_t to;
};

std::vector<Passage> draw_passages(Tubes& tubes, const NetworkStyle& style, Grower& grower, Rng& rng) {
  const double gap = 2.0 * style.width + 8.0;
  const double mean = rng.uniform(gap + 6.0, 80.0);  // Metro and service passages; road tunnels have fewer.
  std::vector<Passage> passages;
  for (std::size_t i = 0; i + 1 < tubes.lines.size(); ++i) {
    const double skew = rng.uniform(-0.5, 0.5) * (tubes.lines[i + 1][0] - tubes.lines[i][0]).norm();
    double at = 24.0 + mean * rng.uniform(0.0, 0.5);
    while (true) {
      const double turn = style.repeats ? skew : skew * rng.uniform(-1.0, 1.0);
      const double to = at + turn;
      if (std::max(at, to) > std::min(length_of(tubes.lines[i]), length_of(tubes.lines[i + 1])) - 20.0) break;
      if (to > 20.0 && is_free(tubes.nodes[i], at, gap) && is_free(tubes.nodes[i + 1], to, gap)) {
        const std::size_t a = grower.add_node(point_at(tubes.lines[i], at).position, 0);
        const std::size_t b = grower.add_node(point_at(tubes.lines[i + 1], to).position, 0);
        tubes.nodes[i][at] = a;
        tubes.nodes[i + 1][to] = b;
        passages.push_back({a, b});
      }
      at += style.repeats ? mean : mean * rng.uniform(0.5, 1.5);
    }
  }
  return passages;
}

bool lay_tubes(Network& network, Grower& grower, const WorldConfig& config, Rng& rng) {
  network.style.pillar = 8.0;
  const NetworkStyle& style = network.style;
  Tubes tubes = draw_tubes(style, config, rng);
  const std::vector<Passage> passages = draw_passages(tubes, style, grower, rng);
  if (passages.size() < tubes.lines.size()) return false;
  for (std::size_t i = 0; i < tubes.lines.size(); ++i) {
    const Polyline& line = tubes.lines[i];
    tubes.nodes[i][0.0] = grower.add_node(line.front(), 0);
    tubes.nodes[i][length_of(line)] = grower.add_node(line.back(), 0);
    const Section section = grower.draw_section();
    auto before = tubes.nodes[i].begin();
    for (auto after = std::next(before); after != tubes.nodes[i].end(); before = after++) {
      Polyline part = stretch_of(line, before->first, after->first);
      const Copy copy = !style.repeats ? Copy::own : chance(rng, 0.6) ? Copy::same : Copy::changed;
      if (!grower.try_edge(
              {before->second, after->second, std::move(part), section, {}, copy, style.repeats ? 1 : 0}, 0))
        return false;
    }
  }
  const Section module = grower.draw_section(0.7);
  for (const auto& [a, b] : passages) {
    Polyline line = shaped_line(network.nodes[a].at, network.nodes[b].at, {});
    NetworkEdge edge{a,
                     b,
                     std::move(line),
                     style.repeats ? module : grower.draw_section(0.7),
                     {},
                     style.repeats ? Copy::same : Copy::own,
                     style.repeats ? 2 : 0};
    if (!grower.try_edge(std::move(edge), 0)) return false;
  }
  return true;
}

// --------------------------------------------------------------------------- levels joined by ramps

/// A ramp's line in plan from (0, 0): a full round of a spiral with two straight sides that returns there
/// heading along y, or a hairpin that leaves along -x and comes back 2 `radius` metres aside.
struct RampPlan {
  bool spiral = true;
  double radius = 18.0;
  double straight = 10.0;
  double side = 1.0;  ///< +1: turns left.
  [[nodiscard]] double length() const {
    return (spiral ? 2.0 : 1.0) * (std::numbers::pi * radius) + 2.0 * straight;
  }
};

Polyline ramp_line(const RampPlan& ramp, double rise, double landing) {
  struct Stretch {
    double length;
    double turn;
  };
  const double arc = std::numbers::pi * ramp.radius;
  const double turn = ramp.side / ramp.radius;
  const std::vector<Stretch> stretches =
      ramp.spiral ? std::vector<Stretch>{{0.5 * ramp.straight, 0.0},
                                         {arc, turn},
                                         {ramp.straight, 0.0},
                                         {arc, turn},
                                         {0.5 * ramp.straight, 0.0}}
                  : std::vector<Stretch>{{ramp.straight, 0.0}, {arc, turn}, {ramp.straight, 0.0}};
  Polyline fine{Vector3::Zero()};
  double heading = ramp.spiral ? 0.5 * ramp.side * std::numbers::pi : std::numbers::pi;
  for (const Stretch& stretch : stretches) {
    const int steps = std::max(1, static_cast<int>(std::ceil(stretch.length / 1.5)));
    const double step = stretch.length / steps;
    for (int k = 0; k < steps; ++k) {
      const double half = 0.5 * stretch.turn * step;
      // The chord of a piece of arc.
      const double chord = half == 0.0 ? step : step * std::sin(half) / half;
      heading += half;
      fine.push_back(ahead(fine.back(), heading, chord));
      heading += half;
    }
  }
  const double length = length_of(fine);
  Polyline line = stretch_of(fine, 0.0, length);
  const auto last = static_cast<double>(line.size() - 1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double at = length * static_cast<double>(i) / last;
    line[i].z() = rise * ramp_rise((at - landing) / (length - 2.0 * landing));
  }
  return line;
}

/// What is above one another in plan is built in storeys of its own.
std::vector<StoreyPart> ramp_parts(std::size_t points, int lower, int between) {
  const std::size_t last = points - 1;
  const std::size_t a = 2 * last / 5;
  const std::size_t b = 3 * last / 5;
  return {{0, a, lower}, {a, b, between}, {b, last, lower + 1}};
}

/// Gives a level to the node `access` by copying that of the node `pattern`, each node and edge moved.
bool copy_level(Network& network, Grower& grower, std::size_t pattern, std::size_t access, double mirror,
                Rng& rng) {
  const int from_storey = network.nodes[pattern].storey;
  const int storey = network.nodes[access].storey;
  const auto moved = [&](const Vector3& p) -> Vector3 {
    const Vector3 d = p - network.nodes[pattern].at;
    return network.nodes[access].at + Vector3(d.x(), mirror * d.y(), d.z());
  };
  std::map<std::size_t, std::size_t> twin{{pattern, access}};
  const std::size_t num_edges = network.edges.size();
  for (std::size_t i = 0; i < num_edges; ++i) {
    if (network.edges[i].parts.size() != 1 || network.edges[i].parts[0].storey != from_storey) continue;
    NetworkEdge edge = network.edges[i];
    for (const std::size_t node : {edge.from, edge.to})
      if (!twin.contains(node)) {
        const std::size_t added = grower.add_node(moved(network.nodes[node].at), storey);
        twin[node] = added;
      }
    edge.from = twin[edge.from];
    edge.to = twin[edge.to];
    for (Vector3& p : edge.line) p = moved(p);
    edge.parts.clear();
    edge.module = network.edges[i].module = 100 + static_cast<int>(i);
    if (network.edges[i].copy == Copy::own) network.edges[i].copy = Copy::same;
    edge.copy = mirror < 0.0 ? Copy::mirrored : chance(rng, 0.25) ? Copy::changed : Copy::same;
    if (mirror < 0.0) edge.section = mirrored(edge.section);
    if (!grower.try_edge(std::move(edge), storey)) return false;
  }
  return true;
}

bool lay_levels(Network& network, Grower& grower, Rng& rng) {
  const bool spiral = network.style.family == Family::spiral || chance(rng, 0.4);
  const int num_levels = network.style.family == Family::spiral ? static_cast<int>(3 + rng.below(2))
                         : spiral                               ? static_cast<int>(2 + rng.below(2))
                                                                : 2;
  const Section section = grower.draw_section();
  const double landing = landing_of(section.width);
  const double grade = rng.uniform(kFlattest, kSteepest);
  const double tallest = network.style.width * (1.0 + network.style.variation) * 1.1;
  const double least = std::clamp(tallest, 3.0, 8.0) + kCrownPillar;
  RampPlan ramp{spiral, rng.uniform(15.0, 24.0), rng.uniform(4.0, 30.0), sign_of(rng)};
  const double needed = least / (grade * kCurveShare) + 2.0 * landing;
  ramp.straight += std::max(0.0, 0.5 * (needed - ramp.length()));
  const double rise = grade * kCurveShare * (ramp.length() - 2.0 * landing);
  const Polyline line = ramp_line(ramp, rise, landing);

  std::vector<std::size_t> access{grower.add_node(Vector3::Zero(), 0)};
  for (int k = 0; k + 1 < num_levels; ++k) {
    const Vector3 at = network.nodes[access.back()].at;
    access.push_back(grower.add_node(at + line.back(), k + 1));
    network.nodes.back().at.z() = at.z() + rise;
    NetworkEdge edge{access[access.size() - 2],
                     access.back(),
                     line,
                     section,
                     ramp_parts(line.size(), k, num_levels + k),
                     Copy::own,
                     0};
    for (Vector3& p : edge.line) p += at;
    if (!grower.try_edge(std::move(edge), k)) return false;
  }
  const double left = network.style.total_length + 150.0 - network.total_length();
  const double per_level = std::clamp(left / num_levels, 110.0, 320.0);
  for (std::size_t k = 0; k < access.size(); ++k) {
    if (k > 0 && network.style.repeats) {
      const double mirror = chance(rng, 0.3) ? -1.0 : 1.0;
      if (!copy_level(network, grower, access[0], access[k], mirror, rng)) return false;
      continue;
    }
    if (!grower.try_branch(access[k], rng.uniform(-0.3, 0.3), 8.0)) return false;
    const double loops = chance(rng, 0.5) ? rng.uniform(0.2, 0.6) : 0.0;
    const int storey = static_cast<int>(k);
    if (!grower.grow({storey, per_level, loops, 8.0})) return false;
  }
  return true;
}

bool lay(Network& network, Grower& grower, const WorldConfig& config, Rng& rng) {
  switch (network.style.family) {
    case Family::tree:
    case Family::loops:
      return lay_tree(network, grower, rng);
    case Family::grid:
      return lay_grid(network, grower, config, rng);
    case Family::tubes:
      return lay_tubes(network, grower, config, rng);
    case Family::levels:
    case Family::spiral:
      return lay_levels(network, grower, rng);
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
