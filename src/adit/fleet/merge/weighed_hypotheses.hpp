// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What speaks for each alignment of two maps, and what against it: the evidence that merge_checker.hpp tells
/// of, added up for one hypothesis among the others.
#pragma once

#include <cstddef>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/hypothesis.hpp"
#include "adit/fleet/merge/look_alikes.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// What a robot has measured on its own map, for a merge check.
struct OwnMeasurements {
  double reach_m = 0.0;        ///< Discernment::reach_m.
  MeasuredWhenAsked measured;  ///< Called only where scans leave a hypothesis to be weighed.
};

/// The hypotheses of one merge check. What is asked of a `hypothesis` is asked of one of these.
class WeighedHypotheses {
 public:
  /// The chains of `between` and its earlier check are read here and not kept; what `own.measured` refers to
  /// must outlive this.
  WeighedHypotheses(LoopsBetween between, OwnMeasurements own, const AdaptiveConfig& config);

  /// In the order of `hypotheses_of`.
  ///@{
  [[nodiscard]] const std::vector<Hypothesis>& all() const { return hypotheses_; }
  [[nodiscard]] const Hypothesis& operator[](std::size_t which) const { return hypotheses_[which]; }
  [[nodiscard]] Hypothesis& operator[](std::size_t which) { return hypotheses_[which]; }
  ///@}
  /// Those that Hypothesis::loops names.
  [[nodiscard]] const std::vector<PcmLoop>& loops() const { return loops_; }
  /// As given.
  [[nodiscard]] const MergeCheckConfig& config() const { return config_; }
  /// Evidence that joins maps.
  [[nodiscard]] double needed() const { return needed_; }
  /// Metres between where two of them put the other robot.
  [[nodiscard]] double apart_m(std::size_t one, std::size_t other) const;

  /// Whether it is refuted: more has changed than a true alignment would leave.
  [[nodiscard]] bool differs_too_often(const Hypothesis& hypothesis) const;
  /// More changes than a true alignment would leave on such a stretch but once in 1 / refusal_rate.
  [[nodiscard]] bool are_too_many(std::size_t num_changes, double km) const;
  /// Kilometres of tunnel that were in view.
  [[nodiscard]] double compared_km(const Hypothesis& hypothesis) const;

  /// All of it: scans with the prior, and walls.
  [[nodiscard]] double evidence(const Hypothesis& hypothesis) const;
  /// What tells it from the others.
  [[nodiscard]] double evidence_among_rivals(const Hypothesis& hypothesis) const;
  /// With the prior.
  [[nodiscard]] double evidence_of_scans(const Hypothesis& hypothesis) const;
  /// What that can become when all that is left to compare speaks for it.
  [[nodiscard]] double most_evidence_of_scans(const Hypothesis& hypothesis) const;
  /// Against it, where few loops found it; part of the prior.
  [[nodiscard]] double evidence_of_few_loops(const Hypothesis& hypothesis) const;
  /// That of the relief of walls, if `times` as many patches had been compared.
  [[nodiscard]] double evidence_of_walls(const Hypothesis& hypothesis, double times = 1.0) const;
  /// What that can become, whatever is seen of its walls.
  [[nodiscard]] double most_evidence_of_walls(const Hypothesis& hypothesis) const;
  /// In the order driven by the own robot, where `copies` is the share of copies.
  [[nodiscard]] double evidence_of_places(const std::vector<TestedPlace>& places, double copies) const;
  /// Of the look-alikes between both maps, if this alignment is the true one: then all others are false.
  [[nodiscard]] double share_of_copies_if_true(const Hypothesis& hypothesis) const;
  /// How often look-alikes of the own map go on agreeing.
  [[nodiscard]] ChancesToGoOn chances() const { return own_.measured().look_alikes.chances(); }

  /// By how much evidence among rivals `best` leads `other`.
  [[nodiscard]] double lead(const Hypothesis& best, const Hypothesis& other) const;
  /// Evidence by which a hypothesis has to lead every other one.
  [[nodiscard]] double least_lead() const;
  /// Whether the best one leads `other` by less, and `other` is not refuted.
  [[nodiscard]] bool are_rivals(const Hypothesis& best, const Hypothesis& other) const;

 private:
  [[nodiscard]] bool differs_nearly_everywhere(const Hypothesis& hypothesis) const;
  [[nodiscard]] double prior_evidence(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_of_places(const CountedPlaces& places, double copies) const;
  /// What the other alignments show of the walls: false ones, if this one is true.
  [[nodiscard]] std::vector<EqualSignShare> walls_elsewhere(const Hypothesis& hypothesis) const;

  std::vector<PcmLoop> loops_;
  std::vector<Hypothesis> hypotheses_;
  OwnMeasurements own_;
  MergeCheckConfig config_;
  double needed_;
};

}  // namespace adit
