// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/beam.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr std::size_t kSubRays = 6;  ///< Of a footprint, around its middle.
constexpr float kHalfRoot3 = std::numbers::sqrt3_v<float> / 2.0F;
constexpr std::array<std::array<float, 2>, kSubRays> kRing{{{1.0F, 0.0F},
                                                            {0.5F, kHalfRoot3},
                                                            {-0.5F, kHalfRoot3},
                                                            {-1.0F, 0.0F},
                                                            {-0.5F, -kHalfRoot3},
                                                            {0.5F, -kHalfRoot3}}};
constexpr float kRingRadius = 0.7F;  ///< Of the beam's radius.
constexpr float kStep = 0.1F;  ///< Metres by which three neighbours are off a line where there is an edge.
constexpr float kGrazing = 0.34202F;  ///< Cosine of 70 degrees.
constexpr float kLeastCosine = 0.05F;

// Off the middle between two neighbours, or some of the three met nothing.
bool is_edge(float one, float middle, float other) {
  if (std::min({one, middle, other}) == RayHit::kMiss) return false;
  return !(std::abs((one - middle) - (middle - other)) <= kStep);  // NaN where two of them met nothing
}

bool needs_footprint(const RayBlock& rays, const Neighbours& columns, std::size_t i) {
  const float range = rays.distances[i];
  if (range < RayHit::kMiss && rays.cosines[i] < kGrazing) return true;
  const float above = rays.distances[i > 0 ? i - 1 : i];
  const float below = rays.distances[i + 1 < rays.size ? i + 1 : i];
  const float before = columns.before != nullptr ? (*columns.before)[i] : range;
  const float after = columns.after != nullptr ? (*columns.after)[i] : range;
  return is_edge(above, range, below) || is_edge(before, range, after);
}

Eigen::Vector3f at(const RayBlock::Vectors& vectors, std::size_t i) {
  return {vectors.x[i], vectors.y[i], vectors.z[i]};
}

void set(RayBlock::Vectors& vectors, std::size_t i, const Eigen::Vector3f& v) {
  vectors.x[i] = v.x();
  vectors.y[i] = v.y();
  vectors.z[i] = v.z();
}

void add_ring(const RayBlock& rays, std::size_t i, float radius, RayBlock& ring) {
  const Eigen::Vector3f direction = at(rays.directions, i);
  const Eigen::Vector3f side = direction.unitOrthogonal();
  const Eigen::Vector3f up = direction.cross(side);
  for (const auto& [to_side, to_up] : kRing) {
    const Eigen::Vector3f around = to_side * side + to_up * up;
    set(ring.origins, ring.size, at(rays.origins, i));
    set(ring.directions, ring.size, (direction + radius * around).normalized());
    ++ring.size;
  }
}

struct Part {
  float distance;
  float cosine;
};

/// The strongest return of a footprint: of its parts, those of one surface, or less than a pulse apart, of
/// which most comes back. `share` in [0, 1) draws where between the nearest and the farthest of them it lies.
/// `radius`: of the footprint, in radians.
Part strongest(std::array<Part, kSubRays + 1> parts, float pulse, float radius, float share) {
  std::ranges::sort(parts, {}, &Part::distance);
  const auto cosine_of = [](const Part& part) { return std::max(part.cosine, kLeastCosine); };
  // One surface is as long in a footprint as its slope says.
  const auto are_one = [&](const Part& one, const Part& next) {
    const float cosine = cosine_of(one);
    const float slope = std::sqrt(std::max(1.0F - cosine * cosine, 0.0F)) / cosine;
    return next.distance - one.distance < std::max(pulse, radius * one.distance * slope);
  };
  Part best{RayHit::kMiss, 0.0F};
  float most = 0.0F;
  for (std::size_t first = 0; first < parts.size() && parts[first].distance < RayHit::kMiss;) {
    std::size_t end = first + 1;
    while (end < parts.size() && are_one(parts[end - 1], parts[end])) ++end;
    float energy = 0.0F;
    float distance = 0.0F;
    float cosine = 0.0F;
    for (std::size_t k = first; k < end; ++k) {
      const float back = cosine_of(parts[k]) / (parts[k].distance * parts[k].distance);
      energy += back;
      distance += back * parts[k].distance;
      cosine += back * parts[k].cosine;
    }
    if (energy > most) {
      most = energy;
      const float nearest = parts[first].distance;
      const float farthest = parts[end - 1].distance;
      const float drawn = distance / energy + (share - 0.5F) * (farthest - nearest);
      best = {std::clamp(drawn, nearest, farthest), cosine / energy};
    }
    first = end;
  }
  return best;
}

}  // namespace

bool cast_rays(const Raycaster& world, const std::optional<Raycaster>& movers, float range_max,
               RayBlock& rays) {
  world.cast(rays, range_max);
  if (!movers) return false;
  bool meets_movers = false;
  RayBlock nearer = rays;
  movers->cast(nearer, range_max);
  for (std::size_t i = 0; i < rays.size; ++i) {
    const bool hits = nearer.distances[i] < rays.distances[i];
    meets_movers = meets_movers || hits;
    rays.distances[i] = hits ? nearer.distances[i] : rays.distances[i];
    rays.cosines[i] = hits ? nearer.cosines[i] : rays.cosines[i];
  }
  return meets_movers;
}

void widen_rays(const Raycaster& world, const std::optional<Raycaster>& movers, const Beam& beam,
                const Neighbours& columns, float range_max, std::uint64_t seed, RayBlock& rays) {
  constexpr std::size_t kAtOnce = RayBlock::kCapacity / kSubRays;
  if (beam.divergence <= 0.0) return;
  const float radius = kRingRadius * static_cast<float>(beam.divergence / 2.0);
  std::array<std::size_t, RayBlock::kCapacity> wide;
  std::size_t num_wide = 0;
  for (std::size_t i = 0; i < rays.size; ++i)
    if (needs_footprint(rays, columns, i)) wide[num_wide++] = i;
  for (std::size_t from = 0; from < num_wide; from += kAtOnce) {
    const std::size_t to = std::min(num_wide, from + kAtOnce);
    RayBlock ring;
    for (std::size_t k = from; k < to; ++k) add_ring(rays, wide[k], radius, ring);
    cast_rays(world, movers, range_max, ring);
    for (std::size_t k = from; k < to; ++k) {
      const std::size_t i = wide[k];
      std::array<Part, kSubRays + 1> parts;
      for (std::size_t s = 0; s < kSubRays; ++s) {
        const std::size_t of_ring = (k - from) * kSubRays + s;
        parts[s] = {ring.distances[of_ring], ring.cosines[of_ring]};
      }
      parts[kSubRays] = {rays.distances[i], rays.cosines[i]};
      const auto share = static_cast<float>(mix64(seed, i) >> 40U) * 0x1p-24F;
      const Part met = strongest(parts, static_cast<float>(beam.pulse_m), radius, share);
      rays.distances[i] = met.distance;
      rays.cosines[i] = met.cosine;
    }
  }
}

}  // namespace adit
