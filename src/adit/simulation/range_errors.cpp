// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/range_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"
#include "adit/core/simd.hpp"
#include "adit/simulation/surface_signal.hpp"

namespace adit {
namespace {

constexpr float kDustReach = 5.0F;                ///< Metres: beyond, dust returns too little.
constexpr double kWalkStatedAt = 80.0 * kDegree;  ///< Incidence, of LidarErrorConfig::incidence_walk.

// For 0 <= x <= 1, to 1e-6 (Abramowitz and Stegun, 4.4.46). The C library's is not vectorized.
float arc_cosine(float x) {
  constexpr std::array<float, 8> kCoefficients = {1.5707963050F,  -0.2145988016F, 0.0889789874F,
                                                  -0.0501743046F, 0.0308918810F,  -0.0170881256F,
                                                  0.0066700901F,  -0.0012624911F};
  float sum = kCoefficients[7];
  for (std::size_t k = 7; k-- > 0;) sum = sum * x + kCoefficients[k];
  return std::sqrt(1.0F - x) * sum;
}

}  // namespace

RayDraws::RayDraws(std::uint64_t column_seed, std::size_t first_beam, std::size_t num) {
  std::array<std::int32_t, RayBlock::kCapacity> sums;
  std::array<std::int32_t, RayBlock::kCapacity> draws;
  std::array<std::int32_t, RayBlock::kCapacity> more_draws;
  for (std::size_t i = 0; i < num; ++i) {
    const std::uint64_t ray_seed = mix64(column_seed ^ (first_beam + i));
    const std::uint64_t bits = mix64(ray_seed);
    const std::uint64_t pairs = (bits & 0xffff0000ffffU) + ((bits >> 16U) & 0xffff0000ffffU);
    sums[i] = static_cast<std::int32_t>((pairs >> 32U) + (pairs & 0xffffffffU));
    const std::uint64_t others = mix64(~ray_seed);
    draws[i] = static_cast<std::int32_t>(others >> 40U);
    more_draws[i] = static_cast<std::int32_t>(others & 0x7fffffffU);
  }
  constexpr double kMean = 2.0 * 0xffff;
  for (std::size_t i = 0; i < num; ++i) {
    noise[i] = static_cast<float>((sums[i] - kMean) * (std::numbers::sqrt3 / 0x10000));
    dropout[i] = static_cast<float>(draws[i]) * 0x1p-24F;
    falseness[i] = static_cast<float>(more_draws[i] & 0xfffff) * 0x1p-20F;
    share[i] = static_cast<float>(more_draws[i] >> 20) * 0x1p-11F;
  }
}

ReturnModel::ReturnModel(const LidarConfig& c, const LidarUnit& unit, double dust)
    : range_min(static_cast<float>(c.range_min)),
      range_max(static_cast<float>(c.range_max)),
      noise_near(static_cast<float>(c.noise_near)),
      noise_slope(static_cast<float>((c.noise_far - c.noise_near) / (c.range_max - c.range_min))),
      cos_dropout_start(static_cast<float>(std::cos(c.dropout_start_deg * kDegree))),
      dropout_start(static_cast<float>(c.dropout_start_deg * kDegree)),
      dropout_width(static_cast<float>(c.dropout_end_deg * kDegree) - dropout_start),
      walk(static_cast<float>(unit.incidence_walk / std::pow(1.0 - std::cos(kWalkStatedAt), 2))),
      intensity_walk(static_cast<float>(unit.intensity_walk)),
      response(static_cast<float>(unit.response)),
      fall_off(static_cast<float>(unit.fall_off)),
      false_returns(static_cast<float>(unit.false_returns)),
      false_or_dust(static_cast<float>(unit.false_returns + dust)) {}

ADIT_WIDE_VECTORS void add_noise_by_range(const ReturnModel& returns, const RayBlock& rays,
                                          RayBlock::Numbers& sigmas) {
  for (std::size_t i = 0; i < rays.size; ++i)
    sigmas[i] = returns.noise_near + returns.noise_slope * (rays.distances[i] - returns.range_min);
}

ADIT_WIDE_VECTORS void add_noise_by_signal(const ReturnModel& returns, const RayBlock::Numbers& signals,
                                           std::size_t num, RangeErrors& errors) {
  constexpr float kMost = 1.5F;  // of the noise of a return that is just seen
  const float grows = returns.noise_slope * (returns.range_max - returns.range_min);
  for (std::size_t i = 0; i < num; ++i) {
    errors.sigmas[i] = returns.noise_near + grows * std::min(kMost, 1.0F / std::sqrt(signals[i]));
    errors.biases[i] += returns.intensity_walk * share_of_walk(signals[i]);
  }
}

// Beyond the end of the drop-out, all of 0 to 1 is below the share that is lost.
ADIT_WIDE_VECTORS void report_ranges(const ReturnModel& returns, const RayDraws& chance, const RayBlock& rays,
                                     const RangeErrors& errors, RayBlock::Numbers& ranges) {
  const auto& distances = rays.distances;
  const float range_min = returns.range_min;
  const float range_max = returns.range_max;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float cosine = std::min(rays.cosines[i], 1.0F);
    const float off_normal = 1.0F - cosine;
    const float true_return = distances[i] + errors.sigmas[i] * chance.noise[i] +
                              (errors.biases[i] + returns.walk * off_normal * off_normal);
    const float in_dust = range_min + kDustReach * chance.share[i] * chance.share[i];
    const bool is_false = chance.falseness[i] < returns.false_returns;
    const bool is_dust = !is_false & (chance.falseness[i] < returns.false_or_dust);
    const float not_false = is_dust ? std::min(in_dust, true_return) : true_return;
    const float range = is_false ? chance.share[i] * true_return : not_false;
    const float share_lost = (arc_cosine(cosine) - returns.dropout_start) / returns.dropout_width;
    const bool lost = (cosine < returns.cos_dropout_start) & (chance.dropout[i] < share_lost);
    const bool kept = !lost & (distances[i] < RayHit::kMiss) & (range >= range_min) & (range <= range_max);
    ranges[i] = kept ? range : RayHit::kMiss;
  }
}

ADIT_WIDE_VECTORS void add_intensities(const ReturnModel& returns, const RayBlock& rays,
                                       const RayBlock::Numbers& signals, float reach, const RayDraws& chance,
                                       RayBlock::Numbers& intensities) {
  constexpr float kSpread = 0.1F;       // of readings, evenly
  constexpr float kBrightest = 255.0F;  // that is reported
  constexpr float kPercent = 100.0F * kNominalReflectivity;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float share = rays.distances[i] / reach;
    const float reading = kPercent * signals[i] * share * share;
    intensities[i] = std::min(kBrightest, reading * (1.0F + kSpread * (chance.share[i] - 0.5F)));
  }
  if (returns.response == 1.0F && returns.fall_off == 0.0F) return;
  constexpr float kAsStated = 10.0F;  // metres at which an intensity is what it would be without fall-off
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float raw = std::pow(intensities[i], returns.response) *
                      std::pow(rays.distances[i] / kAsStated, returns.fall_off);
    intensities[i] = std::clamp(std::round(raw), 1.0F, kBrightest);
  }
}

}  // namespace adit
