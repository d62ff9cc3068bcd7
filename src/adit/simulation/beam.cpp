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
constexpr float kRingRadius = 0.7F;   ///< Of the beam's radius.
constexpr float kEdge = 0.03F;        ///< Neighbours whose ranges differ by more than this share.
constexpr float kGrazing = 0.34202F;  ///< Cosine of 70 degrees.
constexpr float kLeastCosine = 0.05F;

// Returns whether a mover is nearer than the world anywhere.
bool cast_at_all(const Raycaster& world, const std::optional<Raycaster>& movers, float range_max,
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

bool is_edge(float one, float other) {
  return std::abs(one - other) > kEdge * std::min(one, other);  // also where one of them met nothing
}

bool needs_footprint(const RayBlock& rays, std::size_t i) {
  if (rays.distances[i] < RayHit::kMiss && rays.cosines[i] < kGrazing) return true;
  return (i > 0 && is_edge(rays.distances[i], rays.distances[i - 1])) ||
         (i + 1 < rays.size && is_edge(rays.distances[i], rays.distances[i + 1]));
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

/// The strongest return of a footprint: of its parts, those less than a pulse apart whose cosines add up to
/// most. `share` in [0, 1) draws where it lies between the nearest and the farthest of them.
Part strongest(std::array<Part, kSubRays + 1> parts, float pulse, float share) {
  std::ranges::sort(parts, {}, &Part::distance);
  Part best{RayHit::kMiss, 0.0F};
  float most = 0.0F;
  for (std::size_t first = 0; first < parts.size() && parts[first].distance < RayHit::kMiss; ++first) {
    float energy = 0.0F;
    float distance = 0.0F;
    std::size_t last = first;
    for (std::size_t k = first; k < parts.size() && parts[k].distance - parts[first].distance < pulse; ++k) {
      const float cosine = std::max(parts[k].cosine, kLeastCosine);
      energy += cosine;
      distance += cosine * parts[k].distance;
      last = k;
    }
    if (energy <= most) continue;
    most = energy;
    const float spread = parts[last].distance - parts[first].distance;
    best = {distance / energy + (share - 0.5F) * 0.5F * spread, parts[first].cosine};
  }
  return best;
}

}  // namespace

void cast_beams(const Raycaster& world, const std::optional<Raycaster>& movers, const Beam& beam,
                float range_max, std::uint64_t seed, RayBlock& rays) {
  constexpr std::size_t kAtOnce = RayBlock::kCapacity / kSubRays;
  const bool meets_movers = cast_at_all(world, movers, range_max, rays);
  if (beam.divergence <= 0.0) return;
  // Without a mover in the block, none is looked for in footprints: most columns see none.
  const std::optional<Raycaster> near_movers = meets_movers ? movers : std::nullopt;
  const float radius = kRingRadius * static_cast<float>(beam.divergence / 2.0);
  std::array<std::size_t, RayBlock::kCapacity> wide;
  std::size_t num_wide = 0;
  for (std::size_t i = 0; i < rays.size; ++i)
    if (needs_footprint(rays, i)) wide[num_wide++] = i;
  for (std::size_t from = 0; from < num_wide; from += kAtOnce) {
    const std::size_t to = std::min(num_wide, from + kAtOnce);
    RayBlock ring;
    for (std::size_t k = from; k < to; ++k) add_ring(rays, wide[k], radius, ring);
    cast_at_all(world, near_movers, range_max, ring);
    for (std::size_t k = from; k < to; ++k) {
      const std::size_t i = wide[k];
      std::array<Part, kSubRays + 1> parts;
      for (std::size_t s = 0; s < kSubRays; ++s) {
        const std::size_t of_ring = (k - from) * kSubRays + s;
        parts[s] = {ring.distances[of_ring], ring.cosines[of_ring]};
      }
      parts[kSubRays] = {rays.distances[i], rays.cosines[i]};
      const auto share = static_cast<float>(mix64(seed, i) >> 40U) * 0x1p-24F;
      const Part met = strongest(parts, static_cast<float>(beam.pulse_m), share);
      rays.distances[i] = met.distance;
      rays.cosines[i] = met.cosine;
    }
  }
}

}  // namespace adit
