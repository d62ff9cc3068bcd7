// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where driving on would decide a merge that was refused, and how much evidence is to be expected there. The
/// other robot should drive where the own one has been, beyond the stretch that both drove: there the own map
/// says already at which places a displacement would show (docs/decisions/0042).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// A hypothesis that more evidence would decide.
struct UndecidedStretch {
  std::vector<std::uint32_t> shared;  ///< Own keyframes along the stretch that both drove, by the plan.
  std::vector<TestedPlace> places;    ///< Hypothesis::places.
  ChancesToGoOn chances{};            ///< Of look-alikes.
  /// Of the hypothesis, if these places had been found and as many more walls like those seen.
  std::function<double(const std::vector<TestedPlace>& places)> evidence;
  std::vector<PcmLoop> loops;             ///< That align the maps; at least one.
  std::vector<PcmLoop> rival_loops = {};  ///< Of the hypothesis that explains as much; empty without one.
  double missing = 0.0;                   ///< Evidence, or lead before the rival.
  double least_m = 0.0;                   ///< So much has to be driven, whatever it is worth.
  /// Rather than metres without a change, or a lead before a rival.
  [[nodiscard]] bool lacks_evidence_alone() const {
    return missing > 0.0 && least_m == 0.0 && rival_loops.empty();
  }
};

/// What is asked of the own map, for each end of what both drove.
struct OwnMapKnows {
  /// Discernment::distinctive.
  std::function<std::vector<bool>(const std::vector<std::uint32_t>& keyframes)> distinctive;
  /// Whether the scans of two own keyframes differ; asked where there is a rival.
  std::function<std::vector<bool>(const std::vector<OwnComparison>& pairs)> differ;
};
/// By that discernment, which must outlive the answer.
[[nodiscard]] OwnMapKnows what_own_map_knows(Discernment& discernment);

/// Of all ways to go on beyond an end of what both drove, up to 100 m of own path each, the one that brings
/// what is missing in the fewest metres; if none does, the one that brings most. None where the own robot has
/// been to no place beyond that would be evidence and that the other has not passed. Asks about at most 70
/// keyframes; places lie `spacing_m` apart, as those of a merge check (MergeCheckConfig).
[[nodiscard]] std::optional<MergeAdvice> where_to_drive(const UndecidedStretch& stretch,
                                                        const OdometryChain& own, const OdometryChain& theirs,
                                                        double spacing_m, const OwnMapKnows& own_map);

/// What the own map knows of places at which another robot could be recognised.
struct OwnLandmarks {
  std::vector<double> distances;  ///< Of each keyframe's descriptor to the most similar other place (0 to 1).
  ChancesToGoOn chances{};        ///< Of look-alikes.
  /// Discernment::distinctive.
  std::function<std::vector<bool>(const std::vector<std::uint32_t>& keyframes)> distinctive;
};
/// By that discernment, which must outlive the answer.
[[nodiscard]] OwnLandmarks landmarks_of(std::vector<double> distances, Discernment& discernment);

/// Where nothing beyond the own keyframes `shared`, if any, is known to be shared: of all stretches of the
/// own path, up to 60 m each, the one whose places stand out most from the rest of the map, up to where they
/// are worth `missing`. Their worth is that of their scans; walls are not known before they are met. None
/// where no place there would be evidence. Asks about keyframes `spacing_m` apart.
[[nodiscard]] std::optional<MergeAdvice> where_to_be_recognised(const OdometryChain& own,
                                                                const std::vector<std::uint32_t>& shared,
                                                                double missing, double spacing_m,
                                                                const OwnLandmarks& landmarks);

/// Half a sentence: who should drive where, and what that is worth.
[[nodiscard]] std::string in_words(const MergeAdvice& advice, std::string_view name_a,
                                   std::string_view name_b);

}  // namespace adit
