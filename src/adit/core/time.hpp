// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace adit {

/// Between two stamps.
using Duration = std::chrono::nanoseconds;

/// A sensor's own clock, integer nanoseconds since its epoch. Never a double: 1.6e9 s keeps only 0.2 us in
/// one.
struct Stamp {
  std::int64_t ns = 0;  ///< Nanoseconds.

  /// In the order of time.
  auto operator<=>(const Stamp&) const = default;
  /// So much later.
  Stamp operator+(Duration d) const { return {ns + d.count()}; }
  /// So much earlier.
  Stamp operator-(Duration d) const { return {ns - d.count()}; }
  /// Since `other`; negative where it is later.
  Duration operator-(Stamp other) const { return Duration(ns - other.ns); }

  /// Seconds, for printing and for differences near zero only.
  [[nodiscard]] double seconds() const { return static_cast<double>(ns) * 1e-9; }
};

/// The duration in seconds.
[[nodiscard]] inline double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }
/// Of so many seconds, to the nearest nanosecond.
[[nodiscard]] inline Duration from_seconds(double s) { return Duration(std::llround(s * 1e9)); }

}  // namespace adit
