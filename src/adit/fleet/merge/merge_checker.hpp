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
/// log(1 / rival_rate). `MergeChecker::decide` reads in that order; docs/decisions/0010 tells why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/hypothesis.hpp"
#include "adit/fleet/merge/look_alikes.hpp"
#include "adit/fleet/merge/merge_advice.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// What a robot has measured on its own map, for a merge check.
struct OwnMeasurements {
  double reach_m = 0.0;        ///< Discernment::reach_m.
  MeasuredWhenAsked measured;  ///< Called only where scans leave a hypothesis to be weighed.
};

/// Why maps are joined or not.
enum class MergeDecision : std::uint8_t {
  no_loops,             ///< No loop aligns the maps.
  nothing_compared,     ///< No keyframes of both stand side by side along the stretch that loops align.
  scans_differ,         ///< At more places than a true alignment leaves.
  nothing_distinctive,  ///< All places that agree would agree if displaced along the tunnel, too.
  other_walls,          ///< The evidence would do if the relief of the walls did not speak against it.
  too_little_evidence,  ///< Less than needed, although some places are distinctive.
  rival,                ///< Another hypothesis has nearly as much evidence.
  unfinished,           ///< Not all places were compared.
  accepted,             ///< Every test was passed.
};

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
  enum class Stage : std::uint8_t { places, second_looks, signs, walls, find_again };
  struct Step {
    Stage stage = Stage::places;
    std::size_t hypothesis = 0;
  };

  /// `forgiven`: evidence that the best hypothesis is spared.
  [[nodiscard]] MergeDecision decide(const std::vector<std::size_t>& best_first, double forgiven = 0.0) const;
  [[nodiscard]] bool differs_too_often(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool differs_nearly_everywhere(const Hypothesis& hypothesis) const;
  /// More changes than a true alignment would leave on such a stretch but once in 1 / refusal_rate.
  [[nodiscard]] bool are_too_many(std::size_t num_changes, double km) const;
  [[nodiscard]] double compared_km(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool are_rivals(const Hypothesis& best, const Hypothesis& other) const;

  /// Evidence by which a hypothesis has to lead every other one.
  [[nodiscard]] double least_lead() const;
  [[nodiscard]] double evidence(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_among_rivals(const Hypothesis& hypothesis) const;
  [[nodiscard]] double prior_evidence(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_of_few_loops(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_of_scans(const Hypothesis& hypothesis) const;
  /// In the order driven by the own robot, where `copies` is the share of copies.
  [[nodiscard]] double evidence_of_places(const std::vector<TestedPlace>& places, double copies) const;
  [[nodiscard]] double evidence_of_places(const CountedPlaces& places, double copies) const;
  /// Of the look-alikes between both maps, if this alignment is the true one: then all others are false.
  [[nodiscard]] double share_of_copies_if_true(const Hypothesis& hypothesis) const;
  /// As if so many times the walls had been seen.
  [[nodiscard]] double evidence_of_walls(const Hypothesis& hypothesis, double times = 1.0) const;
  /// What the other alignments show of the walls: false ones, if this one is true.
  [[nodiscard]] std::vector<EqualSignShare> walls_elsewhere(const Hypothesis& hypothesis) const;
  /// Whether more pairs of its walls have to be compared before they can be called seen.
  [[nodiscard]] bool lacks_walls(const Hypothesis& hypothesis, int num_patches) const;
  /// What a hypothesis can reach when all that is left to compare speaks for it.
  [[nodiscard]] double most_evidence_of_scans(const Hypothesis& hypothesis) const;
  [[nodiscard]] ChancesToGoOn chances() const { return own_.measured().look_alikes.chances(); }

  [[nodiscard]] std::optional<std::size_t> to_go_on_with() const;
  /// By its scans alone the best hypothesis was far behind, and the walls of those ahead put it in front.
  [[nodiscard]] bool is_left_unfinished(const Hypothesis& best) const;
  /// Where all have been compared: the best hypothesis if more pairs of its walls could decide, or another
  /// one that is not refuted and whose walls were hardly seen, if the best would be accepted or walls
  /// elsewhere could give what it lacks.
  [[nodiscard]] std::optional<std::size_t> whose_walls_to_compare(
      const std::vector<std::size_t>& best_first) const;
  /// The best hypothesis, where it lacks only what having few loops takes away.
  [[nodiscard]] std::optional<std::size_t> whose_places_to_find_again(
      const std::vector<std::size_t>& best_first) const;
  /// Distinctive places away from its loops, evenly spread; none where they could not make few loops many.
  [[nodiscard]] std::vector<PlannedComparison> to_find_again(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool has_places_to_find_again(const Hypothesis& hypothesis) const;
  /// None when the check is over.
  [[nodiscard]] std::optional<Step> next_step() const;
  [[nodiscard]] std::vector<PlannedComparison> planned(const Step& step, std::size_t num) const;
  /// The best hypothesis, then the others by how near they are to being its rival; refuted ones last.
  [[nodiscard]] std::vector<std::size_t> best_first() const;
  [[nodiscard]] double apart_m(std::size_t one, std::size_t other) const;
  [[nodiscard]] HypothesisCounts counts(const Hypothesis& hypothesis) const;
  [[nodiscard]] MergeHypothesis described(std::size_t hypothesis, std::size_t best) const;
  /// merge_refusal.cpp has the rules.
  [[nodiscard]] RefusalKind refused_kind(MergeDecision decision,
                                         const std::vector<std::size_t>& best_first) const;
  [[nodiscard]] RefusalKind kind_where_evidence_is_missing(const Hypothesis& hypothesis) const;
  [[nodiscard]] RefusalKind kind_where_scans_differ(const Hypothesis& hypothesis) const;
  [[nodiscard]] RefusalKind kind_where_walls_differ(const Hypothesis& hypothesis) const;
  /// Of a stretch that has to be longer for that many changes; metres.
  [[nodiscard]] double metres_for_changes(const Hypothesis& hypothesis) const;

  [[nodiscard]] std::string why(MergeDecision decision, const std::vector<std::size_t>& best_first) const;
  [[nodiscard]] std::string remedy(MergeDecision decision, const std::vector<std::size_t>& best_first) const;
  [[nodiscard]] std::string what_is_missing(const Hypothesis& hypothesis) const;

  std::vector<PcmLoop> loops_;
  std::vector<Hypothesis> hypotheses_;
  OwnMeasurements own_;
  MergeCheckConfig config_;
  std::size_t place_keyframes_;  ///< Nearer than this, keyframes are of one place (SearchConfig).
  double needed_;                ///< Evidence that joins maps.
};

}  // namespace adit
