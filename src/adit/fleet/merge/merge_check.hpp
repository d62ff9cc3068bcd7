// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether the loops between two robots may join their maps: a test with a stated error rate, measured
/// against what the robot has seen itself, so that nothing is tuned to a site.
///
/// Loops that agree with one another lay one map over the other: a hypothesis. Where it is true, the scans of
/// both agree all along the stretch that both drove; where one tube only looks like another, they agree for a
/// while and then one has a niche, a bend or a side passage that the other has not. How long they agree by
/// chance differs from site to site, and each robot can measure it (Discernment).
///
/// The decision is Wald's sequential probability ratio test ("Sequential tests of statistical hypotheses",
/// 1945) in two directions. Against chance: the logarithms of likelihood ratios add up over the places that
/// are distinctive, and have to reach log(1 / error_rate) together with what walls say (StandingOffsets) and
/// the logarithm of the alignment's prior: the share of all loops that speak for it. Against copies: scans
/// that differ may not be more than true places would leave, nor may walls stand off one another more often
/// than one wall does. And against every other hypothesis: it must stay behind by as much.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/merge/check_plan.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

struct MergeCheckConfig {
  double error_rate = 1e-3;
  double refusal_rate = 0.01;
  double spacing_m = 3.0;
  int max_checks = 200;
  int max_hypotheses = 12;
  int min_loops = 1;
  double odometry_slack = 1.0;
  bool distinctive_only = true;
  bool relief = true;
  DiscernmentConfig discernment;
};
Fields fields_of(MergeCheckConfig& config);

/// One place where two maps were compared.
struct CheckedPlace {
  double difference = 0.0;      ///< Over the limit of Discernment: above 1 the scans cannot be of one place.
  bool is_distinctive = false;  ///< A displacement along the way would have shown.
  std::vector<PatchOffset> offsets = {};  ///< Where it does not differ: of their walls from the own.
  [[nodiscard]] bool differs() const { return !(difference <= 1.0); }
};

/// The test of two robots' loops: asks for comparisons until it knows.
class MergeTest {
 public:
  /// `loops`: all that registration accepted, with those that say something else; of those that agree, the
  /// ones that most of their neighbours contradict are left out. `known_before`: evidence for each that does
  /// not come from comparing scans; of a hypothesis the least of its loops' counts. `measured` is asked only
  /// where scans leave a hypothesis to be weighed.
  MergeTest(const OdometryChain& own, const OdometryChain& theirs, const std::vector<PcmLoop>& loops,
            double reach_m, MeasuredWhenAsked measured, const MergeCheckConfig& config,
            const std::vector<double>& known_before = {});

  /// The next comparisons, at most `num`, each with another keyframe of theirs; none when the test is over.
  /// Asked again without `add` in between it answers the same.
  [[nodiscard]] std::vector<PlannedCheck> next(std::size_t num) const;
  /// What came of the comparisons that `next` asked for, in that order.
  void add(const std::vector<CheckedPlace>& places);
  [[nodiscard]] MergeCheck verdict(RobotId a, RobotId b) const;

 private:
  struct Hypothesis {
    std::vector<std::size_t> loops;
    std::vector<PlannedCheck> plan;
    std::vector<std::optional<PlannedCheck>> second_looks;  ///< Of each place of the plan, until taken.
    std::vector<CheckedPlace> checked;
    StandingOffsets offsets;
    std::vector<double> apart_m;  ///< From each hypothesis before this one: where theirs would stand.
    double known_before = 0.0;
  };
  [[nodiscard]] double evidence(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_along_the_way(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool has_other_walls(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool is_refuted(const Hypothesis& hypothesis) const;
  [[nodiscard]] static bool is_finished(const Hypothesis& hypothesis);
  /// Places that differ, when all have been seen once. One fit in many fails.
  [[nodiscard]] static std::vector<std::size_t> to_look_at_again(const Hypothesis& hypothesis);
  [[nodiscard]] std::optional<std::size_t> to_go_on_with() const;
  static void add_second_looks(Hypothesis& hypothesis, const std::vector<CheckedPlace>& places);
  [[nodiscard]] std::vector<std::size_t> best_first() const;
  [[nodiscard]] double apart_m(std::size_t one, std::size_t other) const;
  [[nodiscard]] std::string reason(std::size_t hypothesis, std::optional<std::size_t> rival) const;
  [[nodiscard]] std::string what_is_missing(const Hypothesis& hypothesis, std::size_t num_distinctive) const;
  [[nodiscard]] MergeHypothesis described(std::size_t hypothesis, std::size_t best) const;
  [[nodiscard]] double needed() const;
  [[nodiscard]] double walls_evidence(const Hypothesis& hypothesis) const;
  [[nodiscard]] std::vector<TestedPlace> along_the_way(const Hypothesis& hypothesis) const;

  std::vector<PcmLoop> loops_;
  std::vector<Hypothesis> hypotheses_;
  MeasuredWhenAsked measured_;
  MergeCheckConfig config_;
};

}  // namespace adit
