// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_relief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kFloorInfluence =
    1.2;  ///< Metres above the floor at which the floor's flatness has faded out.

/// Three independent numbers in [-1, 1] for a node of the lattice.
Vector3 node_value(std::uint64_t seed, const Eigen::Vector3i& node) {
  std::uint64_t hash = seed;
  for (int k = 0; k < 3; ++k)
    hash = mix64(hash, static_cast<std::uint64_t>(static_cast<std::int64_t>(node[k])));
  Vector3 value;
  for (int k = 0; k < 3; ++k) {
    hash = mix64(hash);
    value[k] = static_cast<double>(hash >> 11U) * 0x1.0p-52 - 1.0;
  }
  return value;
}

/// Lattice values blended with a quintic, so that the first two derivatives are continuous.
Vector3 smooth_noise(std::uint64_t seed, const Vector3& p) {
  const Vector3 base = p.array().floor();
  const Eigen::Array3d f = (p - base).array();
  const Eigen::Array3d w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  Vector3 sum = Vector3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    double weight = 1.0;
    for (int k = 0; k < 3; ++k) weight *= step[k] == 1 ? w[k] : 1.0 - w[k];
    sum += weight * node_value(seed, base.cast<int>() + step);
  }
  return sum;
}

/// `above_floor` is the height of p above the smooth floor.
Vector3 rock(const Relief& relief, const Vector3& p, double above_floor) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < relief.octaves.size(); ++i)
    if (relief.octaves[i].amplitude > 0.0)
      // A lattice has about two nodes per wave.
      sum += relief.octaves[i].amplitude *
             smooth_noise(mix64(relief.seed, i), p * (2.0 / relief.octaves[i].wavelength));
  const double fade = std::clamp(above_floor / kFloorInfluence, 0.0, 1.0);
  sum.z() *= relief.floor_share + (1.0 - relief.floor_share) * fade * fade * (3.0 - 2.0 * fade);
  return sum;
}

double ramp(const Relief& relief, const Vector3& p) {
  if (relief.ramp_amplitude == 0.0) return 0.0;
  const double k = 2.0 * std::numbers::pi / relief.ramp_wavelength;
  const double phase = static_cast<double>(mix64(relief.seed) % 1000) * 2e-3 * std::numbers::pi;
  return relief.ramp_amplitude * 0.5 *
         (std::sin(k * (0.9 * p.x() + 0.4 * p.y()) + phase) +
          std::sin(k * (0.9 * p.y() - 0.5 * p.x()) - phase));
}

}  // namespace

Vector3 displaced(const Relief& relief, const Vector3& p) {
  return p + rock(relief, p, p.z()) + Vector3(0.0, 0.0, ramp(relief, p));
}

Vector3 displaced(const Relief& relief, const Vector3& p, double lift) {
  const Vector3 lifted = p + Vector3(0.0, 0.0, lift);
  return lifted + rock(relief, lifted, p.z()) + Vector3(0.0, 0.0, ramp(relief, p));
}

Vector3 on_floor(const Relief& relief, const Vector3& p) {
  const Vector3 foot(p.x(), p.y(), 0.0);
  return {p.x(), p.y(), displaced(relief, foot).z()};
}

Vector3 on_floor(const Relief& relief, const Vector3& p, double lift) {
  const Vector3 foot(p.x(), p.y(), 0.0);
  return {p.x(), p.y(), displaced(relief, foot, lift).z()};
}

}  // namespace adit
