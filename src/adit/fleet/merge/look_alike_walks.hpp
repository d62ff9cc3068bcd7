// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Follows places of one map that only look alike along both stretches, until they differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/fleet/merge/discernment.hpp"

namespace adit {

/// Scans of one place are compared this far apart, in turns: metres.
inline constexpr std::array<double, 3> kComparedApart = {0.5, 1.0, 2.0};

/// All walks of one map, taken from place to place together.
class LookAlikeWalks {
 public:
  /// `chain`: the odometry of the map. All must outlive it.
  LookAlikeWalks(Discernment& discernment, const OdometryChain& chain, FeatureStore& features,
                 const AdaptiveConfig& config);

  /// Chooses stretches as candidates between robots are chosen, and from each the first candidate that
  /// registration accepts.
  void start(const std::vector<LoopCandidate>& similar);
  /// Follows all to their ends, both ways.
  void follow(Measured& measured);

 private:
  /// Two places that look alike, followed one way.
  struct Walk {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    Pose T_a_b;
    double path_m = 0.0;     ///< Of the present place, from a; negative against the drive.
    double direction = 1.0;  ///< Or -1.
    std::size_t look_alike = 0;
    std::size_t num_passed = 0;  ///< Distinctive places that agreed.
    bool is_over = false;
  };
  /// A place of each walk and what comparing it has shown.
  struct Step {
    std::vector<OwnComparison> asked;
    std::vector<LocalFit> found;
  };
  [[nodiscard]] std::optional<Walk> start_at(const LoopCandidate& candidate) const;
  /// The scans to compare `path_m` along the walk, `apart_m` metres from one another.
  [[nodiscard]] std::optional<OwnComparison> place_at(const Walk& walk, double path_m, double apart_m) const;
  /// Takes every walk to its next place; those at an end are dropped.
  [[nodiscard]] std::vector<OwnComparison> next_places();
  /// Refits the walks that differ a second look on; overwrites `step` where that agrees.
  void look_again(Step& step);

  Discernment& discernment_;
  const OdometryChain& chain_;
  FeatureStore& features_;
  const AdaptiveConfig& config_;
  const std::vector<double>& path_m_;
  std::vector<Walk> walks_;
};

}  // namespace adit
