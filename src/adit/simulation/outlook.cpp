// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/outlook.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr int kSphereRays = 64;
constexpr std::size_t kLookOuts = 256;
constexpr double kOpening = 0.1;
constexpr float kOutOfSight = 1e6F;  ///< Metres: no mesh is as large.

/// Of a Fibonacci lattice.
Vector3 sphere_direction(int k) {
  const double z = 1.0 - (2.0 * k + 1.0) / kSphereRays;
  const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

struct RayCount {
  int escaped = 0;
  int front = 0;
};

RayCount count_rays(const Vector3& eye, const Raycaster& raycaster) {
  RayCount count;
  for (int ray = 0; ray < kSphereRays; ++ray) {
    const Eigen::Vector3f direction = sphere_direction(ray).cast<float>();
    const RayHit hit = raycaster.cast({eye.cast<float>(), direction}, kOutOfSight);
    count.escaped += hit.hit() ? 0 : 1;
    count.front += hit.hit() && hit.normal.dot(direction) < 0.0F ? 1 : 0;
  }
  return count;
}

}  // namespace

Outlook look_around(std::span<const Vector3> positions, double height, const Raycaster& raycaster) {
  const std::size_t num_places = std::min(positions.size(), kLookOuts);
  const auto place = [&](std::size_t k) -> const Vector3& {
    return positions[k * positions.size() / num_places];
  };
  std::vector<RayCount> counts(num_places);
  parallel_for_each(num_places, [&](std::size_t k) {
    counts[k] = count_rays(place(k) + height * Vector3::UnitZ(), raycaster);
  });
  Outlook outlook;
  RayCount total;
  int most = -1;
  for (std::size_t k = 0; k < num_places; ++k) {
    total.escaped += counts[k].escaped;
    total.front += counts[k].front;
    if (counts[k].escaped > most) {
      most = counts[k].escaped;
      outlook.widest_open = place(k);
    }
    if (counts[k].escaped > kOpening * kSphereRays) outlook.openings.push_back(place(k));
  }
  const int all = static_cast<int>(num_places) * kSphereRays;
  outlook.escaping = static_cast<double>(total.escaped) / all;
  outlook.facing = all > total.escaped ? static_cast<double>(total.front) / (all - total.escaped) : 0.0;
  return outlook;
}

}  // namespace adit
