// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/floor_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace adit {
namespace {

constexpr double kSteepestFloor = 0.5;  ///< Least share of a triangle's normal that points up or down.
constexpr double kSameSurface = 0.03;   ///< Metres between surfaces that are taken for one.
constexpr double kSeam = 1e-3;  ///< Metres by which triangles are widened: cracks between them are floor.

struct PlanTriangle {
  std::array<Vector3, 3> corners;
  Vector3 normal;  // not of unit length
};

/// Height of the triangle's plane at (x, y), or NaN where that is outside of the triangle.
double height_at(const PlanTriangle& t, double x, double y) {
  const double sign = t.normal.z() > 0.0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3& a = t.corners[i];
    const Vector3 along = t.corners[(i + 1) % 3] - a;
    const double inside = sign * (along.x() * (y - a.y()) - along.y() * (x - a.x()));
    if (inside < -kSeam * std::hypot(along.x(), along.y())) return std::nan("");
  }
  const Vector3& a = t.corners[0];
  return a.z() - (t.normal.x() * (x - a.x()) + t.normal.y() * (y - a.y())) / t.normal.z();
}

void add_samples(const PlanTriangle& t, double cell, std::vector<FloorSample>& samples) {
  Eigen::AlignedBox3d box;
  for (const Vector3& corner : t.corners) box.extend(corner);
  const auto first = [&](double low) { return static_cast<int>(std::ceil((low - kSeam) / cell - 0.5)); };
  const auto last = [&](double high) { return static_cast<int>(std::floor((high + kSeam) / cell - 0.5)); };
  for (int x = first(box.min().x()); x <= last(box.max().x()); ++x) {
    for (int y = first(box.min().y()); y <= last(box.max().y()); ++y) {
      const double z = height_at(t, (x + 0.5) * cell, (y + 0.5) * cell);
      if (!std::isnan(z)) samples.push_back({{x, y}, z});
    }
  }
}

/// Of samples of one column that are one surface the highest.
void merge_doubles(std::vector<FloorSample>& samples) {
  std::size_t kept = 0;
  for (const FloorSample& sample : samples) {
    FloorSample* below = kept > 0 ? &samples[kept - 1] : nullptr;
    if (below != nullptr && below->column == sample.column && sample.z - below->z < kSameSurface) {
      *below = sample;
    } else {
      samples[kept++] = sample;
    }
  }
  samples.resize(kept);
}

}  // namespace

FloorColumn column_of(const Vector3& p, double cell) {
  return {static_cast<int>(std::floor(p.x() / cell)), static_cast<int>(std::floor(p.y() / cell))};
}

std::vector<FloorSample> floor_samples(const TriangleMesh& mesh, double cell) {
  std::vector<FloorSample> samples;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    PlanTriangle triangle;
    for (int i = 0; i < 3; ++i)
      triangle.corners[static_cast<std::size_t>(i)] =
          mesh.vertices[static_cast<std::size_t>(t[i])].cast<double>();
    const auto& [a, b, c] = triangle.corners;
    triangle.normal = (b - a).cross(c - a);
    if (std::abs(triangle.normal.z()) > kSteepestFloor * triangle.normal.norm())
      add_samples(triangle, cell, samples);
  }
  std::ranges::sort(samples, [](const FloorSample& a, const FloorSample& b) {
    return std::tuple(a.column, a.z) < std::tuple(b.column, b.z);
  });
  merge_doubles(samples);
  return samples;
}

}  // namespace adit
