// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a LiDAR makes of true ranges: noise, bias, drop-out, false returns and intensities, a block of rays
/// at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "adit/simulation/lidar_model.hpp"

namespace adit {

/// The draws of a block of rays. They depend on the seed of the column and the number of the beam alone.
struct RayDraws {
  /// Near normal with mean 0 and standard deviation 1: the sum of four 16-bit uniform numbers (Irwin and
  /// Hall). No logarithm, so every machine draws the same; and bounded by 3.5, as no sensor errs by metres.
  RayBlock::Numbers noise;
  RayBlock::Numbers dropout;    ///< Uniform in [0, 1), as those below.
  RayBlock::Numbers falseness;  ///< Below the share of false returns the range is false.
  RayBlock::Numbers share;      ///< Of the range, where it is false.

  /// Of `num` beams from `first_beam` on.
  RayDraws(std::uint64_t column_seed, std::size_t first_beam, std::size_t num);
};

/// How true ranges are reported, and which are lost.
struct ReturnModel {
  float range_min;          ///< Metres; nearer returns are dropped.
  float range_max;          ///< Metres; farther ones, too.
  float noise_near;         ///< Standard deviation at range_min, metres.
  float noise_slope;        ///< By which it grows per metre.
  float cos_dropout_start;  ///< Cosine of the incidence from which returns get lost.
  float dropout_start;      ///< The same angle, radians.
  float dropout_width;      ///< Radians to where all are lost.
  float walk;               ///< Metres per squared (1 - cosine of the incidence).
  float intensity_walk;     ///< Metres, of the weakest return.
  float response;           ///< Power to which intensities are reported,
  float fall_off;           ///< and of the range with which they change.
  float false_returns;      ///< Share of rays that report too short a range.
  float false_or_dust;      ///< Share of these and of rays that end in dust.

  /// `dust`: share of rays that end in it.
  ReturnModel(const LidarConfig& config, const LidarUnit& unit, double dust);
};

/// Of each ray of a block, metres.
struct RangeErrors {
  RayBlock::Numbers sigmas;  ///< Standard deviations.
  RayBlock::Numbers biases;  ///< Added to ranges.
};

/// Standard deviations that grow with the range.
void add_noise_by_range(const ReturnModel& returns, const RayBlock& rays, RayBlock::Numbers& sigmas);
/// As photons are counted: with the root of their number, from the nominal surface the same as by range. Adds
/// the walk of ranges with the intensity.
void add_noise_by_signal(const ReturnModel& returns, const RayBlock::Numbers& signals, std::size_t num,
                         RangeErrors& errors);
/// The ranges that are reported, or RayHit::kMiss.
void report_ranges(const ReturnModel& returns, const RayDraws& chance, const RayBlock& rays,
                   const RangeErrors& errors, RayBlock::Numbers& ranges);
/// Reflectivity times the cosine of the incidence, in percent, as far as the signal tells, up to 255; where
/// the unit reports it in another way, as a whole number from 1 on. `reach`: LidarConfig::reach.
void add_intensities(const ReturnModel& returns, const RayBlock& rays, const RayBlock::Numbers& signals,
                     float reach, const RayDraws& chance, RayBlock::Numbers& intensities);

}  // namespace adit
