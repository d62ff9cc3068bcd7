// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The merge check: whether the loops between two robots may join their maps. A test with a stated error
/// rate, measured against what the robot has seen itself, so that nothing is tuned to a site.
///
/// Loops that agree with one another align the maps: a hypothesis. Where it is true, the scans of both robots
/// agree all along the stretch that both drove; where one tunnel only looks like another, they agree for a
/// while and then one has a niche, a bend or a side passage that the other has not. How long look-alikes
/// agree differs from site to site, and each robot measures it on its own map (Discernment).
///
/// The decision is Wald's sequential probability ratio test ("Sequential tests of statistical hypotheses",
/// 1945): log likelihood ratios add up over the distinctive places and have to reach log(1 / error_rate),
/// together with those of the relief of walls (WallOffsets) and the prior, the share of all loops that
/// speak for this alignment. Checks that are repeated share that rate: where later ones put forward further
/// alignments, all have to reach more (`spent_priors`). It is one-sided against copies: scans that differ may
/// not be more than true places would leave. And every other hypothesis has to stay behind by
/// log(1 / rival_rate). `decide` (merge_decision.hpp) reads in that order; docs/decisions/0010 tells why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/hypothesis.hpp"
#include "adit/fleet/merge/merge_advice.hpp"
#include "adit/fleet/merge/weighed_hypotheses.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Asks for comparisons until it knows.
class MergeChecker {
 public:
  /// The chains of `between` and its earlier check are read here and not kept; what `own.measured` refers to
  /// must outlive the checker.
  MergeChecker(LoopsBetween between, OwnMeasurements own, const AdaptiveConfig& config);

  /// The next comparisons, at most `num`, each with another keyframe of theirs; none when the check is over.
  /// Asked again without `add` in between it answers the same.
  [[nodiscard]] std::vector<PlannedComparison> next(std::size_t num) const;
  /// What came of the comparisons that `next` asked for, in that order.
  void add(const std::vector<ComparedPlace>& places);
  /// What has been found, about the robots `a` (own) and `b`. The reason of a refusal ends with `remedy`,
  /// half a sentence, or where that is empty with what would help anywhere.
  [[nodiscard]] MergeCheck verdict(RobotId a, RobotId b, const std::string& remedy = {}) const;
  /// What more evidence would decide; none where maps are joined, nothing aligns them or could be compared,
  /// or another tunnel or a sensor is taken to be the reason. Valid as long as the checker.
  [[nodiscard]] std::optional<UndecidedStretch> undecided() const;

 private:
  /// What is compared of a hypothesis, in this order; signs whenever what differs at a place is explained.
  enum class Stage : std::uint8_t { places, second_looks, signs, walls };
  struct Step {
    Stage stage = Stage::places;
    std::size_t hypothesis = 0;
  };

  [[nodiscard]] std::optional<std::size_t> to_go_on_with() const;
  /// Where all have been compared: the best hypothesis if more pairs of its walls could decide, or another
  /// one that is not refuted and whose walls were hardly seen, if the best would be accepted or walls
  /// elsewhere could give what it lacks.
  [[nodiscard]] std::optional<std::size_t> whose_walls_to_compare(
      const std::vector<std::size_t>& order) const;
  /// None when the check is over.
  [[nodiscard]] std::optional<Step> next_step() const;
  [[nodiscard]] std::vector<PlannedComparison> planned(const Step& step, std::size_t num) const;

  [[nodiscard]] const MergeCheckConfig& config() const { return hypotheses_.config(); }

  WeighedHypotheses hypotheses_;
};

}  // namespace adit
