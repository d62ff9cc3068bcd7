// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Geometry of networks: whether a tunnel fits between the others, and the shapes of lines and sections.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/simulation/world_network.hpp"

namespace adit {
namespace {

constexpr double kLineStep = 1.5;  ///< Metres between points of a line: a bend of 12 m radius keeps to 3 cm.
constexpr double kCrownPillar = 5.0;  ///< Metres of rock between a roof and the floor above it.
constexpr double kSmallestAngle = 30.0 * kDegree;
constexpr double kNarrowestBend = 9.0;  ///< Metres: loaders turn on radii of 6 to 9 m.

double plan_distance(const Vector3& a, const Vector3& b) { return (a - b).head<2>().norm(); }

/// Distances along the line to each of its points.
std::vector<double> stations(std::span<const Vector3> line) {
  std::vector<double> at{0.0};
  for (std::size_t i = 1; i < line.size(); ++i) at.push_back(at.back() + plan_distance(line[i], line[i - 1]));
  return at;
}

/// Which points of a line are compared with those of others: every second one and the last.
std::vector<std::size_t> samples_of(const Polyline& line) {
  std::vector<std::size_t> samples;
  for (std::size_t i = 0; i + 1 < line.size(); i += 2) samples.push_back(i);
  samples.push_back(line.size() - 1);
  return samples;
}

/// One edge together with the distances along it.
struct Measured {
  const NetworkEdge& edge;
  std::vector<double> at;
  std::vector<std::size_t> samples;

  explicit Measured(const NetworkEdge& e) : edge(e), at(stations(e.line)), samples(samples_of(e.line)) {}
  /// Along the edge to one of its nodes.
  [[nodiscard]] double distance_to(std::size_t node, std::size_t point) const {
    double distance = std::numeric_limits<double>::infinity();
    if (edge.from == node) distance = at[point];
    if (edge.to == node) distance = std::min(distance, at.back() - at[point]);
    return distance;
  }
};

/// Tunnels of two storeys may cross in plan.
bool passes_over(const NetworkEdge& a, std::size_t i, const NetworkEdge& b, std::size_t j) {
  return a.storey_at(i) != b.storey_at(j) && rock_between(a, i, b, j) >= kCrownPillar;
}

/// Whether enough rock is between two tunnels; those that meet in a node need none near it.
bool keep_clear(const Measured& a, const Measured& b, double pillar) {
  const double clear = 0.5 * (a.edge.section.width + b.edge.section.width) + pillar;
  for (const std::size_t i : a.samples)
    for (const std::size_t j : b.samples) {
      const double distance = plan_distance(a.edge.line[i], b.edge.line[j]);
      if (distance >= clear || passes_over(a.edge, i, b.edge, j)) continue;
      double needed = clear;
      for (const std::size_t node : {a.edge.from, a.edge.to})
        if (node == b.edge.from || node == b.edge.to)
          // Straight tunnels 30 degrees apart are at least half as far from each other as from the node.
          needed = std::min(needed, 0.45 * std::min(a.distance_to(node, i), b.distance_to(node, j)));
      if (distance < needed) return false;
    }
  return true;
}

bool keeps_clear_of_itself(const Measured& a, double pillar) {
  const double clear = a.edge.section.width + pillar;
  for (const std::size_t i : a.samples)
    for (const std::size_t j : a.samples) {
      if (a.at[j] - a.at[i] < 2.0 * clear || passes_over(a.edge, i, a.edge, j)) continue;
      if (plan_distance(a.edge.line[i], a.edge.line[j]) < clear) return false;
    }
  return true;
}

/// Whether all bends are wide enough for the section and for vehicles.
bool bends_gently(const NetworkEdge& edge) {
  const double narrowest = std::max(kNarrowestBend, 0.5 * edge.section.width + 4.0);
  for (std::size_t i = 2; i < edge.line.size(); ++i) {
    const Eigen::Vector2d before = (edge.line[i - 1] - edge.line[i - 2]).head<2>();
    const Eigen::Vector2d after = (edge.line[i] - edge.line[i - 1]).head<2>();
    const double turn = std::acos(std::clamp(before.normalized().dot(after.normalized()), -1.0, 1.0));
    if (turn * narrowest > 0.5 * (before.norm() + after.norm())) return false;
  }
  return true;
}

bool leaves_at_an_angle(const Network& network, const NetworkEdge& edge, std::size_t node) {
  const Eigen::Vector2d direction = direction_at(edge, node);
  return std::ranges::none_of(network.edges_at(node), [&](std::size_t other) {
    return direction.dot(direction_at(network.edges[other], node)) > std::cos(kSmallestAngle);
  });
}

/// Corners of the convex hull, counter-clockwise (Andrew 1979).
Profile hull(Profile points) {
  std::ranges::sort(
      points, [](const auto& a, const auto& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  };
  Profile corners;
  for (int half = 0; half < 2; ++half) {
    const std::size_t begin = corners.size();
    for (const Eigen::Vector2d& p : points) {
      while (corners.size() >= begin + 2 && turn(corners[corners.size() - 2], corners.back(), p) <= 0.0)
        corners.pop_back();
      corners.push_back(p);
    }
    corners.pop_back();
    std::ranges::reverse(points);
  }
  return corners;
}

Profile irregular_profile(double width, double height, Rng& rng) {
  Profile points;
  for (const double side : {-0.5, 0.5}) {
    points.emplace_back(side * width * rng.uniform(0.84, 1.0), 0.0);
    const double low = rng.uniform(0.2, 0.5);
    points.emplace_back(side * width, height * low);
    const double shoulder = rng.uniform(0.66, 0.86);
    points.emplace_back(side * width * rng.uniform(0.65, 0.95), height * shoulder);
    const double roof = rng.uniform(0.9, 1.0);
    points.emplace_back(side * width * rng.uniform(0.2, 0.6), height * roof);
  }
  const double top = rng.uniform(-0.2, 0.2);
  points.emplace_back(width * top, height);
  return hull(points);
}

}  // namespace

int NetworkEdge::storey_at(std::size_t point) const {
  for (const StoreyPart& part : parts)
    if (point <= part.last) return part.storey;
  return parts.back().storey;
}

std::vector<std::size_t> Network::edges_at(std::size_t node) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (edges[i].from == node || edges[i].to == node) found.push_back(i);
  return found;
}

double Network::total_length() const {
  double sum = 0.0;
  for (const NetworkEdge& edge : edges) sum += length_of(edge.line);
  return sum;
}

Eigen::Vector2d direction_at(const NetworkEdge& edge, std::size_t node) {
  const Polyline& line = edge.line;
  const Vector3 step = node == edge.from ? line[1] - line[0] : line[line.size() - 2] - line.back();
  return step.head<2>().normalized();
}

double rock_between(const NetworkEdge& a, std::size_t i, const NetworkEdge& b, std::size_t j) {
  const double aside = plan_distance(a.line[i], b.line[j]) - 0.5 * (a.section.width + b.section.width);
  const bool a_is_lower = a.line[i].z() < b.line[j].z();
  const double above =
      std::abs(a.line[i].z() - b.line[j].z()) - (a_is_lower ? a.section.height : b.section.height);
  return std::hypot(std::max(aside, 0.0), std::max(above, 0.0));
}

bool fits(const Network& network, const NetworkEdge& edge) {
  const double pillar = network.style.pillar;
  if (!bends_gently(edge)) return false;
  if (!leaves_at_an_angle(network, edge, edge.from) || !leaves_at_an_angle(network, edge, edge.to))
    return false;
  const Measured measured(edge);
  return keeps_clear_of_itself(measured, pillar) &&
         std::ranges::all_of(network.edges, [&](const NetworkEdge& other) {
           return keep_clear(measured, Measured(other), pillar);
         });
}

bool opens_outwards(const Network& network, std::size_t node) {
  constexpr double kFar = 120.0;
  constexpr double kRoom = 6.0;
  const std::size_t own = network.edges_at(node).front();
  const Vector3& mouth = network.nodes[node].at;
  const Eigen::Vector2d out = -direction_at(network.edges[own], node);
  for (const auto& edge : network.edges)
    for (const Vector3& p : edge.line) {
      const Eigen::Vector2d off = (p - mouth).head<2>();
      const double ahead = off.dot(out);
      const double aside = std::abs(out.x() * off.y() - out.y() * off.x());
      const double half = 0.5 * edge.section.width;
      // What widens by 45 degrees: rays that leave more sideways meet the last metres of the tunnel.
      if (ahead > 1.0 && ahead < kFar && aside < ahead + half + kRoom) return false;
    }
  return true;
}

double ramp_rise(double share) {
  constexpr double kCurve = 0.15;  // Of the length, at each end, in which the grade builds up.
  const double u = std::clamp(share, 0.0, 1.0);
  const double steepest = 1.0 / (1.0 - kCurve);
  if (u < kCurve) return 0.5 * steepest * u * u / kCurve;
  if (u > 1.0 - kCurve) return 1.0 - 0.5 * steepest * (1.0 - u) * (1.0 - u) / kCurve;
  return steepest * (u - 0.5 * kCurve);
}

Polyline shaped_line(const Vector3& from, const Vector3& to, const LineShape& shape) {
  const Vector3 path = to - from;
  const Vector3 level(path.x(), path.y(), 0.0);
  const Vector3 left = Vector3::UnitZ().cross(level).normalized();
  const int steps = std::max(2, static_cast<int>(std::ceil(level.norm() / kLineStep)));
  Polyline line;
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    const double bow = std::sin(std::numbers::pi * t);
    const double aside = shape.waves == 1 ? bow * bow : bow * std::sin(2.0 * std::numbers::pi * t);
    line.emplace_back(from + t * level + shape.sagitta * aside * left);
  }
  const std::vector<double> at = stations(line);
  const double run = at.back() - 2.0 * shape.landing;
  for (std::size_t i = 0; i < line.size() && path.z() != 0.0; ++i)
    line[i].z() = from.z() + path.z() * ramp_rise((at[i] - shape.landing) / std::max(run, 1.0));
  line.back() = to;
  return line;
}

double steepest_grade(std::span<const Vector3> line) {
  double steepest = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i)
    steepest =
        std::max(steepest, std::abs(line[i].z() - line[i - 1].z()) / plan_distance(line[i], line[i - 1]));
  return steepest;
}

Section draw_section(SectionKind kind, double width, double height, Rng& rng) {
  Section section{{}, width, height};
  const double spring = rng.uniform(0.35, 0.6);
  if (kind == SectionKind::arch) section.profile = arch_profile({width, height, spring * height, 14});
  if (kind == SectionKind::box) section.profile = box_profile(width, 0.0, height);
  if (kind == SectionKind::irregular) section.profile = irregular_profile(width, height, rng);
  return section;
}

Section mirrored(Section section) {
  for (Eigen::Vector2d& p : section.profile) p.x() = -p.x();
  std::ranges::reverse(section.profile);
  return section;
}

double half_width(const Section& section, double above, double side) {
  double reach = 0.0;
  const Profile& p = section.profile;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d& a = p[i];
    const Eigen::Vector2d& b = p[(i + 1) % p.size()];
    if (a.y() == b.y() || (above - a.y()) * (above - b.y()) > 0.0) continue;
    const double share = (above - a.y()) / (b.y() - a.y());
    reach = std::max(reach, side * (a.x() + share * (b.x() - a.x())));
  }
  return reach;
}

}  // namespace adit
