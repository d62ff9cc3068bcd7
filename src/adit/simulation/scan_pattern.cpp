// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scan_pattern.hpp"

#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"

namespace adit {
namespace {

// Turns since the epoch, without the whole ones: seconds since 1970 leave too few digits for thousands of
// turns per minute, so whole minutes, in which the number of turns is whole too for a whole rate, go first.
double phase(double turns_per_minute, Stamp stamp) {
  constexpr std::int64_t kMinute = 60'000'000'000;
  const std::int64_t minutes = stamp.ns / kMinute;
  const double whole = std::fmod(turns_per_minute, 1.0) * static_cast<double>(minutes);
  const double turns = whole + turns_per_minute * static_cast<double>(stamp.ns % kMinute) / kMinute;
  return 2.0 * std::numbers::pi * (turns - std::floor(turns));
}

Vector3 rosette(const LidarConfig& config, Stamp stamp) {
  const double bend = 0.5 * config.elevation_max_deg * kDegree;
  const double first = phase(config.first_rpm, stamp);
  const double second = phase(config.second_rpm, stamp);
  const double left = bend * (std::cos(first) + std::cos(second));
  const double up = bend * (std::sin(first) + std::sin(second));
  const double off = std::hypot(left, up);
  const double share = off > 0.0 ? std::sin(off) / off : 1.0;
  return {std::cos(off), share * left, share * up};
}

Vector3 wave(const LidarConfig& config, Stamp stamp) {
  const double azimuth = std::numbers::pi - phase(config.first_rpm, stamp);
  const double swing = 0.5 - 0.5 * std::cos(phase(config.second_rpm, stamp));
  const double elevation =
      (config.elevation_min_deg + swing * (config.elevation_max_deg - config.elevation_min_deg)) * kDegree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

}  // namespace

Vector3 pattern_direction(const LidarConfig& config, Stamp stamp) {
  ADIT_CHECK(config.pattern != LidarPattern::spinning, "a spinning LiDAR looks by column and beam");
  return config.pattern == LidarPattern::rosette ? rosette(config, stamp) : wave(config, stamp);
}

}  // namespace adit
