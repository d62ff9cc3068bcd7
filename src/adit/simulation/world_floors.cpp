// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_floors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double kCell = 4.0;    ///< Metres.
constexpr double kReach = 16.0;  ///< Metres: beyond the walls of any tunnel, niche or room from its line.

}  // namespace

Floors::Cell Floors::cell_of(double x, double y) {
  return {static_cast<std::int64_t>(std::floor(x / kCell)), static_cast<std::int64_t>(std::floor(y / kCell))};
}

void Floors::add(std::span<const Vector3> line) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector3 low = line[i - 1].cwiseMin(line[i]);
    const Vector3 high = line[i - 1].cwiseMax(line[i]);
    const Cell first = cell_of(low.x() - kReach, low.y() - kReach);
    const Cell last = cell_of(high.x() + kReach, high.y() + kReach);
    for (std::int64_t x = first.first; x <= last.first; ++x)
      for (std::int64_t y = first.second; y <= last.second; ++y) near_[{x, y}].push_back(segments_.size());
    segments_.push_back({line[i - 1], line[i]});
  }
}

double Floors::height(const Vector3& p) const {
  double nearest = std::numeric_limits<double>::infinity();
  double height = 0.0;
  const auto visit = [&](const Segment& segment) {
    const Eigen::Vector2d along = (segment.to - segment.from).head<2>();
    const Eigen::Vector2d off = (p - segment.from).head<2>();
    const double share = std::clamp(off.dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (off - share * along).squaredNorm();
    if (distance >= nearest) return;
    nearest = distance;
    height = segment.from.z() + share * (segment.to.z() - segment.from.z());
  };
  const auto found = near_.find(cell_of(p.x(), p.y()));
  if (found != near_.end())
    for (const std::size_t i : found->second) visit(segments_[i]);
  if (nearest > kReach * kReach)  // Then the nearest one may be listed in another cell only.
    for (const Segment& segment : segments_) visit(segment);
  return height + tilt_.dot(p.head<2>());
}

}  // namespace adit
