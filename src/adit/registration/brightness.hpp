// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether walls that look alike are the same walls, by how strongly they send light back: rock, shotcrete,
/// stains, seams and signs are dark and bright, and stay where they are when a smooth tube shows nothing
/// else (docs/decisions/0082-dark-and-bright-walls.md).
///
/// What a sensor reports as intensity follows a law of its own: raw or corrected by range, linear or not, in
/// units of its own. And in every tunnel floor, roof and sides differ from one another. So range, incidence,
/// scale and the place in the cross section are taken off, for each of both sensors by itself, and of the
/// rest only the correlation over the patches of wall that both have seen counts.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// What one sensor reports of a patch of wall; decimal logarithms of means over its points.
struct WallReturn {
  double log_intensity = 0.0;  ///< In the unit of the sensor.
  double log_range = 0.0;      ///< Metres.
  double log_cosine = 0.0;     ///< Of the incidence.
};

/// A patch that two sensors saw from one place.
struct ReturnsOfPatch {
  std::size_t patch = 0;                     ///< Counted from 0; may be seen again from another place.
  std::size_t stretch = 0;                   ///< One side of 10 m of tunnel, counted from 0.
  std::array<WallReturn, 2> by_sensor = {};  ///< Of the first robot, then of the other.
  /// Where in the cross section, in the frame of the first robot: x ahead, y to the left, z up.
  ///@{
  Vector3 normal = Vector3::Zero();  ///< Of the wall, towards free space; unit length.
  double left_m = 0.0;               ///< Of the sensor.
  double above_m = 0.0;
  ///@}
};

/// How alike two sensors find the brightness of walls.
struct BrightnessMatch {
  std::size_t num_patches = 0;  ///< Seen by both.
  double correlation = 0.0;     ///< Over patches, of what is left, -1 to 1.
  double sigma = 1.0;  ///< Standard deviation of that, by how stretches differ and how many they are.
  bool operator==(const BrightnessMatch&) const = default;
};

/// Without patches where there are fewer than 20, or where one sensor reports the same of all.
[[nodiscard]] BrightnessMatch brightness_match(const std::vector<ReturnsOfPatch>& returns);

/// The matches that a robot found in its own map.
class BrightnessMatches {
 public:
  BrightnessMatches() = default;
  /// As long as nothing is measured, what `model` states counts.
  explicit BrightnessMatches(const BrightnessModel& model) : model_(model) {}

  /// That of the robot's own walls, seen twice: between two visits it is no better.
  void set_same(const BrightnessMatch& match);
  /// That of a tunnel that only looks like another one; left out where it has fewer than `few_patches`.
  void add_other(const BrightnessMatch& match);

  /// Log likelihood ratio of what was found between two maps, one tunnel to another; 0 if fewer than
  /// `few_patches` patches were seen, here or on the own walls, or where those match no better than others.
  /// Of one tunnel any correlation may be found from none up to that of the own walls, as the visits are
  /// apart and the sensors two; at the rate `changed` it is that of other tunnels. Those may be as bright as
  /// the first by their plan, at the rate `copied`. So it lies between log(changed / (1 - copied)) and log((1
  /// - changed) / copied). `times`: as if there were so many times as many stretches, with the same
  /// correlation.
  [[nodiscard]] double evidence(const BrightnessMatch& found, double times = 1.0) const;
  /// The most that `evidence` can be.
  [[nodiscard]] double most_evidence() const;

 private:
  BrightnessModel model_;
  BrightnessMatch same_;
  std::vector<BrightnessMatch> others_;
};

}  // namespace adit
