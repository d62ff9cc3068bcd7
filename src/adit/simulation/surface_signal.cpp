// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/surface_signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/pose.hpp"
#include "adit/core/rng.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

constexpr float kWellBelowMiss = 1e4F;  ///< Metres: cells of rays without a hit are not used.
constexpr std::uint64_t kEvennessStream = 0x6576656e;
constexpr float kSignsPerMetre = 2.0F;
constexpr float kSignReflectivity = 0.9F;
constexpr float kBrightest = 0.9F;
constexpr float kPuddlesPerMetre = 0.4F;
constexpr float kMirrorCosine = 0.34202F;  ///< Of 70 degrees: more head-on, water returns next to nothing.
constexpr float kLevel = 0.95F;            ///< Upward part of a floor's normal.
constexpr float kNearestSurface = 0.05F;

// Off the origin, so that walls at round coordinates lie within cells.
constexpr float kCellOffset = 0.3711F;

std::uint64_t cell_of(float position, float per_metre) {
  return static_cast<std::uint64_t>(
      static_cast<std::int64_t>(std::floor(position * per_metre + kCellOffset)));
}

std::uint64_t hash_of_cell(std::uint64_t seed, std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return mix64(seed ^ (x * 0x9e3779b97f4a7c15U + y * 0xc2b2ae3d27d4eb4fU + z * 0x165667b19e3779f9U));
}

// Half rock and coal, half shotcrete and concrete, by the rank of a patch in [0, 1).
double reflectivity_at(double rank) {
  return rank < 0.5 ? 0.05 * std::pow(4.0, 2.0 * rank) : 0.2 * std::pow(3.0, 2.0 * rank - 1.0);
}

float uniform_draw(std::uint64_t seed, std::size_t i) {
  return static_cast<float>(mix64(seed, i) >> 40U) * 0x1p-24F;
}

Eigen::Vector3f entry(const RayBlock::Vectors& vectors, std::size_t i) {
  return {vectors.x[i], vectors.y[i], vectors.z[i]};
}

float fresnel(float cosine) {
  constexpr float kHeadOn = 0.02F;  // of water
  const float off = 1.0F - cosine;
  return kHeadOn + (1.0F - kHeadOn) * (off * off) * (off * off) * off;
}

}  // namespace

Fields fields_of(SurfaceConfig& c) {
  return {{"contrast", &c.contrast, "", 0, 2,
           "spread of reflectivities, 1: 5 to 60 %; noise, drop-out and intensity follow; 0: none of this"},
          {"evenness", &c.evenness, "", 0, 1,
           "each world draws its contrast evenly, from this share less than what is stated to all of it"},
          {"visit_change", &c.visit_change, "", 0, 2,
           "sigma of the decimal logarithm by which dust and damp change a patch between two visits"},
          {"patch", &c.patch, "m", 0.1, 100, "size of patches of one reflectivity"},
          {"signs", &c.signs, "", 0, 1,
           "share of squares of half a metre that reflect 90 %; none where contrast is 0"},
          {"wet", &c.wet, "", 0, 1, "share of the floor under water, which mirrors grazing rays"}};
}

SurfaceConfig field_surfaces() {
  return {.contrast = 1.0, .evenness = 0.75, .visit_change = 0.23, .patch = 3.0, .signs = 0.002, .wet = 0.03};
}

Surfaces::Surfaces(const SurfaceConfig& config, std::uint64_t seed)
    : are_alike_(config.contrast == 0.0),
      per_metre_(static_cast<float>(1.0 / config.patch)),
      num_signs_(static_cast<std::uint64_t>(config.signs * 0x1p32)),
      num_wet_(static_cast<std::uint64_t>(config.wet * 0x1p32)),
      seed_(seed) {
  constexpr auto kNominal = static_cast<double>(kNominalReflectivity);
  constexpr double kLogisticSigma = std::numbers::pi / std::numbers::sqrt3;
  const double contrast =
      config.contrast * (1.0 - config.evenness * Rng(mix64(seed, kEvennessStream)).uniform());
  for (std::size_t i = 0; i < palette_.size(); ++i) {
    const double rank = (static_cast<double>(i) + 0.5) / static_cast<double>(palette_.size());
    const double scaled = kNominal * std::pow(reflectivity_at(rank) / kNominal, contrast);
    palette_[i] = static_cast<float>(std::min(scaled, 1.0));
    const double logistic = std::log(rank / (1.0 - rank)) / kLogisticSigma;  // as good as normal here
    changes_[i] = static_cast<float>(std::pow(10.0, config.visit_change * logistic));
  }
}

Surfaces Surfaces::on_visit(std::uint64_t seed) const {
  Surfaces out = *this;
  out.visit_ = seed;
  return out;
}

void Surfaces::reflectivities(const RayBlock& rays, RayBlock::Numbers& out) const {
  if (are_alike_) {
    out.fill(kNominalReflectivity);
    return;
  }
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float distance = std::min(rays.distances[i], kWellBelowMiss);
    const Eigen::Vector3f p = entry(rays.origins, i) + distance * entry(rays.directions, i);
    const std::uint64_t bits = hash_of_cell(seed_, cell_of(p.x(), per_metre_), cell_of(p.y(), per_metre_),
                                            cell_of(p.z(), per_metre_));
    out[i] = palette_[bits >> 56U];
    if (visit_ != 0 && changes_.front() != 1.0F)  // else nothing changes between visits
      out[i] = std::min(out[i] * changes_[mix64(bits, visit_) >> 56U], kBrightest);
    if (num_signs_ == 0) continue;
    const std::uint64_t sign = hash_of_cell(~seed_, cell_of(p.x(), kSignsPerMetre),
                                            cell_of(p.y(), kSignsPerMetre), cell_of(p.z(), kSignsPerMetre));
    if ((sign >> 32U) < num_signs_) out[i] = kSignReflectivity;
  }
}

void Surfaces::mirror(const Raycaster& world, float range_max, std::uint64_t seed, RayBlock& rays) const {
  constexpr float kOffSurface = 1e-3F;
  constexpr std::uint64_t kFlat = 0;
  if (num_wet_ == 0) return;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float distance = rays.distances[i];
    if (!(rays.directions.z[i] < 0.0F && distance < RayHit::kMiss && rays.cosines[i] < kMirrorCosine))
      continue;
    const Ray ray{entry(rays.origins, i), entry(rays.directions, i)};
    const Eigen::Vector3f p = ray.origin + distance * ray.direction;
    const std::uint64_t bits =
        hash_of_cell(seed_ + 1, cell_of(p.x(), kPuddlesPerMetre), cell_of(p.y(), kPuddlesPerMetre), kFlat);
    if ((bits >> 32U) >= num_wet_ || uniform_draw(seed, i) >= fresnel(rays.cosines[i])) continue;
    const RayHit floor = world.cast(ray, range_max);
    if (!floor.hit() || std::abs(floor.normal.z()) < kLevel) continue;
    if (floor.distance > distance + 1.0F) continue;  // what the ray met stands in front of the world
    const Eigen::Vector3f up = floor.normal.z() > 0.0F ? floor.normal : Eigen::Vector3f(-floor.normal);
    const Eigen::Vector3f away = ray.direction - 2.0F * up.dot(ray.direction) * up;
    const Eigen::Vector3f from = ray.origin + floor.distance * ray.direction + kOffSurface * up;
    const RayHit seen = world.cast({from, away}, std::max(0.0F, range_max - floor.distance));
    rays.distances[i] = seen.hit() ? floor.distance + seen.distance : RayHit::kMiss;
    rays.cosines[i] = seen.hit() ? std::abs(seen.normal.dot(away)) : 0.0F;
  }
}

ADIT_WIDE_VECTORS void add_signals(const RayBlock& rays, const RayBlock::Numbers& reflectivities, float reach,
                                   RayBlock::Numbers& signals) {
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float share = reach / std::max(rays.distances[i], kNearestSurface);
    signals[i] = reflectivities[i] / kNominalReflectivity * std::min(rays.cosines[i], 1.0F) * (share * share);
  }
}

void drop_weak(const RayBlock::Numbers& signals, std::uint64_t seed, RayBlock& rays) {
  for (std::size_t i = 0; i < rays.size; ++i)
    if (signals[i] < 1.5F && signals[i] < 0.5F + uniform_draw(seed, i)) rays.distances[i] = RayHit::kMiss;
}

float share_of_walk(float signal) {
  constexpr float kRootOfHalf = 10.0F;
  return 1.0F / (1.0F + std::sqrt(std::max(signal, 0.0F)) / kRootOfHalf);
}

}  // namespace adit
