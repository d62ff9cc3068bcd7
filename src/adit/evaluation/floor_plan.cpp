// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/floor_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr double kMaxCells = 4e6;
/// A cell is full of ink when this much wall stands along one edge of it.
constexpr double kFullWallHeight = 2.0;

using Triangle = std::array<Vector3, 3>;

FloorPlan empty_plan(const Eigen::AlignedBox2d& box, double cell_m) {
  ADIT_CHECK(cell_m > 0.0, "a cell has a size");
  const Eigen::Vector2d size = box.sizes();
  cell_m = std::max(cell_m, std::sqrt(size.x() * size.y() / kMaxCells));
  cell_m = std::max(cell_m, size.maxCoeff() / (0.25 * kMaxCells));
  FloorPlan plan;
  plan.cell_m = cell_m;
  plan.origin = box.min();
  plan.width = static_cast<int>(size.x() / cell_m) + 1;
  plan.height = static_cast<int>(size.y() / cell_m) + 1;
  plan.density.assign(static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.height), 0.0F);
  return plan;
}

void add_ink(FloorPlan& plan, const Eigen::Vector2d& at, double amount) {
  const Eigen::Vector2d cell = (at - plan.origin) / plan.cell_m;
  const int column = std::clamp(static_cast<int>(cell.x()), 0, plan.width - 1);
  const int row = std::clamp(static_cast<int>(cell.y()), 0, plan.height - 1);
  plan.density[static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.width) +
               static_cast<std::size_t>(column)] += static_cast<float>(amount);
}

/// Halves the triangle across its longest edge, seen from above, until it fits a cell.
void add_wall(FloorPlan& plan, const Triangle& t, double area) {
  const auto edge_length = [&](std::size_t i) { return (t[(i + 1) % 3] - t[i]).head<2>().norm(); };
  const std::array<double, 3> lengths = {edge_length(0), edge_length(1), edge_length(2)};
  const auto longest =
      static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  if (lengths[longest] <= plan.cell_m) {
    add_ink(plan, ((t[0] + t[1] + t[2]) / 3.0).head<2>(), area / (plan.cell_m * kFullWallHeight));
    return;
  }
  const Vector3& a = t[longest];
  const Vector3& b = t[(longest + 1) % 3];
  const Vector3& c = t[(longest + 2) % 3];
  const Vector3 middle = 0.5 * (a + b);
  add_wall(plan, {a, middle, c}, 0.5 * area);
  add_wall(plan, {middle, b, c}, 0.5 * area);
}

/// The 99th percentile of the cells with ink: a few crowded cells must not make all others pale.
float crowded(std::vector<float> counts) {
  std::erase(counts, 0.0F);
  const auto at =
      counts.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.99 * static_cast<double>(counts.size() - 1)));
  std::nth_element(counts.begin(), at, counts.end());
  return *at;
}

}  // namespace

FloorPlan floor_plan_of(const TriangleMesh& mesh, double cell_m) {
  const Eigen::AlignedBox3f box = bounding_box(mesh);
  if (box.isEmpty()) return {};
  FloorPlan plan =
      empty_plan({box.min().head<2>().cast<double>(), box.max().head<2>().cast<double>()}, cell_m);
  for (const Eigen::Vector3i& corners : mesh.triangles) {
    Triangle t;
    for (int i = 0; i < 3; ++i) {
      t[static_cast<std::size_t>(i)] = mesh.vertices[static_cast<std::size_t>(corners[i])].cast<double>();
    }
    const Vector3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const bool steep = std::abs(normal.z()) < std::sqrt(0.5) * normal.norm();
    if (steep) add_wall(plan, t, 0.5 * normal.norm());
  }
  for (float& ink : plan.density) ink = std::min(ink, 1.0F);
  return plan;
}

FloorPlan floor_plan_of(std::span<const Eigen::Vector3f> points, double cell_m) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& p : points) {
    if (p.allFinite()) box.extend(p.head<2>().cast<double>());
  }
  if (box.isEmpty()) return {};
  FloorPlan plan = empty_plan(box, cell_m);
  for (const Eigen::Vector3f& p : points) {
    if (p.allFinite()) add_ink(plan, p.head<2>().cast<double>(), 1.0);
  }
  const float full = std::log1p(crowded(plan.density));
  for (float& ink : plan.density) ink = std::min(1.0F, std::log1p(ink) / full);
  return plan;
}

}  // namespace adit
