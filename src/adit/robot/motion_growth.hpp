// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How far a robot turned and drove since some begin, by one of its sensors, and comparisons of two sensors.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// A quantity that grows with time, such as an angle turned; linear between the samples.
class Growth {
 public:
  /// Not a number: nothing is known.
  static constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

  /// Nothing is known between samples that are further apart than `longest_gap`.
  explicit Growth(Duration longest_gap = std::chrono::milliseconds(200)) : longest_gap_(longest_gap) {}

  /// Stamps ascend. A value of `kNothing` begins another piece, which has nothing to do with the one before.
  void add(Stamp stamp, double value);
  /// Whether nothing was added yet.
  [[nodiscard]] bool empty() const { return stamps_.empty(); }
  /// The value that was added last; 0 before the first.
  [[nodiscard]] double last() const { return values_.empty() ? 0.0 : values_.back(); }
  /// The first stamp and the last one; not to be asked for while it is empty.
  ///@{
  [[nodiscard]] Stamp begin() const { return stamps_.front(); }
  [[nodiscard]] Stamp end() const { return stamps_.back(); }
  ///@}

  /// `kNothing` outside and in gaps.
  [[nodiscard]] double at(Stamp stamp) const { return find(stamp).value; }
  /// Where `stamp` lies in a gap, the end of it; else `stamp`.
  [[nodiscard]] Stamp resumes(Stamp stamp) const;
  /// The mean rate within `half` of `stamp`, per second; of one piece alone.
  [[nodiscard]] double rate(Stamp stamp, Duration half) const;

 private:
  struct Value {
    double value = kNothing;
    std::size_t piece = 0;
  };
  [[nodiscard]] Value find(Stamp stamp) const;

  Duration longest_gap_;
  std::vector<std::size_t> pieces_;  ///< Of each sample, counted.
  std::vector<Stamp> stamps_;
  std::vector<double> values_;
};

/// Radians about the upward axis, and what of the motion ahead the sensor measures.
struct Growths {
  Growth turn;     ///< Anticlockwise is positive.
  Growth forward;  ///< Metres by the wheels; m/s by an IMU, which feels only changes of speed.
};
/// `forward` in metres. `wheel` is not empty.
[[nodiscard]] Growths growths_of(const Trajectory& wheel);

/// The line through pairs of numbers; all zero where these are fewer than two or do not vary.
struct Regression {
  std::size_t num = 0;       ///< Pairs that count.
  double correlation = 0.0;  ///< -1 to 1.
  double slope = 0.0;        ///< Of y on x.
  double sigma = 0.0;        ///< Standard deviation of x.
};
/// Of y[i + shift] on x[i]. Pairs in which a number is missing do not count.
[[nodiscard]] Regression regress(const std::vector<double>& x, const std::vector<double>& y,
                                 std::ptrdiff_t shift);

/// Comparisons look at rates at every so many seconds.
inline constexpr Duration kRateGrid = std::chrono::milliseconds(20);
/// Where to go on from `stamp`: at the end of a gap of more than a second in one of both, as a clock that
/// jumps leaves one, else at `stamp`.
[[nodiscard]] Stamp beyond_gap(const Growth& a, const Growth& b, Stamp stamp);

/// The turning of wheels and of another sensor at the shift of clocks, up to half a second, at which they
/// agree best.
struct TurnComparison {
  Regression best;               ///< The other sensor's turning by the wheels'.
  double late_s = 0.0;           ///< By how much the wheels' stamps are too late.
  double unexplained = 1.0;      ///< Share of the error at no shift that is left at the best one.
  std::size_t num_enough = 500;  ///< Rates that suffice to say anything.

  /// Whether there was turning enough to say anything: so many rates that differ by more than 0.03 rad/s.
  [[nodiscard]] bool has_curves() const;
  /// Whether both turn together, or against one another.
  [[nodiscard]] bool agrees() const;
};
/// By mean rates within `half_window`.
[[nodiscard]] TurnComparison compare_turns(const Growth& wheels, const Growth& other, Duration half_window);

}  // namespace adit
