// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/triangle_distance.hpp"

#include <algorithm>

namespace adit {
namespace {

double squared_distance_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double squared_length = along.squaredNorm();
  const double share = squared_length > 0.0 ? std::clamp((p - a).dot(along) / squared_length, 0.0, 1.0) : 0.0;
  return (a + share * along - p).squaredNorm();
}

}  // namespace

double squared_distance_to_triangle(const Vector3& p, const std::array<Vector3, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vector3 normal = (b - a).cross(c - a);
  const auto is_inside_of = [&](const Vector3& from, const Vector3& to) {
    return normal.cross(to - from).dot(p - from) >= 0.0;
  };
  const double squared_normal = normal.squaredNorm();
  if (squared_normal > 0.0 && is_inside_of(a, b) && is_inside_of(b, c) && is_inside_of(c, a)) {
    const double height = normal.dot(p - a);
    return height * height / squared_normal;
  }
  return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c),
                   squared_distance_to_segment(p, c, a)});
}

}  // namespace adit
