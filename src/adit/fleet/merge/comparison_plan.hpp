// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// At which places two maps are compared that loops align.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/posegraph/pcm.hpp"

namespace adit {

/// What is asked about a place.
enum class PlaceQuestion : std::uint8_t {
  agreement,  ///< Whether it agrees; and where it does, by what a displacement shows and how the walls stand.
  walls,      ///< How the walls stand, also beside what differs.
  displacement,  ///< By what a displacement would show, although it differs.
};

/// Whether that question asks by what a displacement shows, or how walls stand, at a place that `differs`.
///@{
[[nodiscard]] constexpr bool asks_for_signs(PlaceQuestion question, bool differs) {
  return question == PlaceQuestion::displacement || (question == PlaceQuestion::agreement && !differs);
}
[[nodiscard]] constexpr bool asks_for_walls(PlaceQuestion question, bool differs) {
  return question == PlaceQuestion::walls || (question == PlaceQuestion::agreement && !differs);
}
///@}

/// Two keyframes that stand side by side if the loops are true.
struct PlannedComparison {
  std::uint32_t own = 0;     ///< Index of a keyframe of the own map.
  std::uint32_t theirs = 0;  ///< Of the other robot's map; within one map that of the later keyframe.
  Pose T_own_theirs;         ///< By the nearest loop and the odometries; a guess for the fit.
  PlaceQuestion question = PlaceQuestion::agreement;  ///< What is to be found out.
};

/// Of each place.
///@{
[[nodiscard]] std::vector<std::uint32_t> own_keyframes(const std::vector<PlannedComparison>& places);
[[nodiscard]] std::vector<std::uint32_t> their_keyframes(const std::vector<PlannedComparison>& places);
///@}

/// Lengths along the path, metres.
struct ComparisonSpacing {
  double spacing_m = 3.0;       ///< From one place to the next.
  double reach_m = 50.0;        ///< No place is farther from the nearest loop.
  double revisit_m = 40.0;      ///< Within one map: between the two keyframes (RevisitConfig::path_m).
  double second_look_m = 1.0;   ///< From a place to where it is looked at again.
  double wall_spacing_m = 1.0;  ///< From one pair of scans to the next where walls have to decide.
};

/// Finds pairs of keyframes that stand at most 3 m apart by the nearest loop and the odometries.
class ComparisonPlanner {
 public:
  /// `loops` agree with one another. With the same chain given twice: revisits, the earlier keyframe as
  /// `own`. All must outlive the planner.
  ComparisonPlanner(const OdometryChain& own, const OdometryChain& theirs, const std::vector<PcmLoop>& loops,
                    const ComparisonSpacing& spacing);

  /// At most `max_places`, evenly spaced along the whole stretch that both drove; far apart first, those
  /// between them later.
  [[nodiscard]] std::vector<PlannedComparison> plan(std::size_t max_places) const;
  /// The same place by two other keyframes.
  [[nodiscard]] std::optional<PlannedComparison> second_look(const PlannedComparison& first) const;
  /// Pairs of scans between the places of a plan, in its order: at most `max_pairs`, of keyframes that are in
  /// no other pair.
  [[nodiscard]] std::vector<PlannedComparison> between(const std::vector<PlannedComparison>& plan,
                                                       std::size_t max_pairs) const;

 private:
  /// Their keyframe j beside the own one that is nearest.
  [[nodiscard]] std::optional<PlannedComparison> at(std::uint32_t j) const;

  const OdometryChain& own_;
  const OdometryChain& theirs_;
  const std::vector<double>& own_path_m_;
  const std::vector<double>& their_path_m_;
  const std::vector<PcmLoop>& loops_;
  ComparisonSpacing spacing_;
};

}  // namespace adit
