// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_drive.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "adit/core/check.hpp"

namespace adit {
namespace {

/// Distances along two lines at which they cross in plan.
struct Crossing {
  double on_first = 0.0;
  double on_second = 0.0;
};

double cross(const Vector3& a, const Vector3& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Touching ends count: legs may end on one another with the error of rounding.
constexpr double kTouch = 1e-6;

std::optional<Crossing> crossing_of(std::span<const Vector3> first, std::span<const Vector3> second) {
  double at_first = 0.0;
  for (std::size_t i = 1; i < first.size(); ++i) {
    const Vector3 d = first[i] - first[i - 1];
    double at_second = 0.0;
    for (std::size_t j = 1; j < second.size(); ++j) {
      const Vector3 e = second[j] - second[j - 1];
      const Vector3 gap = second[j - 1] - first[i - 1];
      const double determinant = cross(d, e);
      const double s = cross(gap, e) / determinant;
      const double t = cross(gap, d) / determinant;
      const auto within = [](double x) { return x >= -kTouch && x <= 1.0 + kTouch; };
      if (determinant != 0.0 && within(s) && within(t))
        return Crossing{at_first + s * d.norm(), at_second + t * e.norm()};
      at_second += e.norm();
    }
    at_first += d.norm();
  }
  return std::nullopt;
}

/// The part of each leg that is driven, in driving direction.
std::vector<Polyline> driven_parts(const Drive& drive) {
  std::vector<Polyline> parts;
  double begin = drive.start;
  for (std::size_t i = 0; i < drive.legs.size(); ++i) {
    if (i + 1 == drive.legs.size()) {
      parts.push_back(part_of(drive.legs[i], begin, length_of(drive.legs[i])));
      break;
    }
    const std::optional<Crossing> crossing = crossing_of(drive.legs[i], drive.legs[i + 1]);
    ADIT_CHECK(crossing.has_value(), "consecutive legs of a drive must meet");
    const bool forward = crossing->on_first > begin;
    parts.push_back(forward ? part_of(drive.legs[i], begin, crossing->on_first)
                            : reversed_line(part_of(drive.legs[i], crossing->on_first, begin)));
    begin = crossing->on_second;
  }
  return parts;
}

/// A quadratic Bezier curve from `from` to `to` that leaves and arrives in the direction of `corner`: its
/// curvature has no jump in the middle, and its smallest radius at a right angle is 0.7 times the leg.
void append_turn(Polyline& line, const Vector3& from, const Vector3& corner, const Vector3& to) {
  constexpr int kSteps = 16;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = static_cast<double>(k) / kSteps;
    line.emplace_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to);
  }
}

}  // namespace

double length_of(std::span<const Vector3> line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

Polyline offset_line(std::span<const Vector3> line, double left) {
  Polyline out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vector3 along = line[std::min(i + 1, line.size() - 1)] - line[i > 0 ? i - 1 : 0];
    out.emplace_back(line[i] + left * Vector3::UnitZ().cross(along).normalized());
  }
  return out;
}

Polyline reversed_line(Polyline line) {
  std::ranges::reverse(line);
  return line;
}

Polyline extended(Polyline line, double by) {
  const Vector3 first = (line[0] - line[1]).normalized();
  const Vector3 last = (line.back() - line[line.size() - 2]).normalized();
  line.front() += by * first;
  line.back() += by * last;
  return line;
}

LinePoint point_at(std::span<const Vector3> line, double distance) {
  double rest = std::max(distance, 0.0);
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector3 step = line[i] - line[i - 1];
    const double length = step.norm();
    if (length == 0.0) continue;
    if (rest <= length) return {line[i - 1] + step * (rest / length), step / length};
    rest -= length;
  }
  return {line.back(), (line.back() - line[line.size() - 2]).normalized()};
}

Polyline part_of(std::span<const Vector3> line, double begin, double end) {
  Polyline part{point_at(line, begin).position};
  double at = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    at += (line[i] - line[i - 1]).norm();
    if (at > begin + kTouch && at < end - kTouch) part.push_back(line[i]);
  }
  part.push_back(point_at(line, end).position);
  return part;
}

Polyline rounded(const std::vector<Polyline>& parts, double corner) {
  Polyline line;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double length = length_of(parts[i]);
    const double reach = std::min(corner, 0.49 * length);
    const double begin = i == 0 ? 0.0 : reach;
    const double end = i + 1 == parts.size() ? length : length - reach;
    const Polyline straight = part_of(parts[i], begin, end);
    if (i > 0) {
      const Vector3 from = line.back();
      append_turn(line, from, parts[i].front(), straight.front());
    }
    line.insert(line.end(), straight.begin(), straight.end());
  }
  return line;
}

Route route_of(const Drive& drive) {
  const Polyline line = rounded(driven_parts(drive), drive.corner);
  // Crossings are drawn, and with some seeds they cut the path short by a few metres. Such a robot stops
  // before it leaves through a portal, where the floor ends.
  constexpr double kShortest = 0.9;
  constexpr double kBeforePortal = 2.0;
  const double path = length_of(line);
  const double length = path >= drive.length ? drive.length : path - kBeforePortal;
  ADIT_CHECK(length >= kShortest * drive.length, "the legs of a drive must be about as long as the drive");
  Route route{drive.name, drive.speed_mps, {}};
  const int num_steps = static_cast<int>(std::lround(length));
  for (int i = 0; i <= num_steps; ++i)
    route.waypoints.push_back(point_at(line, length * i / num_steps).position);
  return route;
}

}  // namespace adit
