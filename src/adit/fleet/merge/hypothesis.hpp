// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Loops that agree with one another align two maps: a hypothesis, to be tested by comparing scans all along
/// the stretch that both robots then drove.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/comparison_plan.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

/// What comparing the scans of one place has shown.
struct ComparedPlace {
  double difference = 0.0;      ///< Over the limit of Discernment: above 1 the scans cannot be of one place.
  bool is_distinctive = false;  ///< A displacement along the tunnel would have shown.
  std::vector<PatchOffset> offsets = {};  ///< Of their walls from the own ones; none where it differs.
  std::vector<Vector3> things = {};  ///< Where one robot met what may come and go; own odometry frame, metres.
  [[nodiscard]] bool differs() const { return !(difference <= 1.0); }
};

/// Things that one robot met and the other did not, each counted once however often it was seen.
class ChangedThings {
 public:
  void add(const std::vector<Vector3>& seen);
  [[nodiscard]] std::size_t num() const { return places_.size(); }

 private:
  std::vector<Vector3> places_;  ///< Where each was seen first.
};

struct Hypothesis {
  std::vector<std::size_t> loops;                              ///< Indices, ascending.
  std::vector<PlannedComparison> plan;                         ///< Places of the claimed overlap.
  std::vector<std::optional<PlannedComparison>> second_looks;  ///< Of each place of the plan, until taken.
  std::vector<ComparedPlace> compared;  ///< Of the first places of the plan, without their offsets.
  WallOffsets offsets;                  ///< Of all compared walls.
  ChangedThings things;                 ///< At all compared places.
  std::vector<double> apart_m;  ///< To each hypothesis before this one: where they put the other robot.
  double known_before = 0.0;    ///< Evidence that does not come from comparing scans.

  [[nodiscard]] bool is_finished() const;
  /// Places that differ and have a second look left, once all have been seen: one fit in many fails.
  [[nodiscard]] std::vector<std::size_t> to_look_at_again() const;
  /// Compared places that differ by more than this times the limit.
  [[nodiscard]] std::size_t num_differing(double by_more_than = 1.0) const;
  /// Compared places that agree where a displacement would have shown.
  [[nodiscard]] std::size_t num_distinctive() const;
  /// What was found at each place, in the order driven by the own robot; where not `distinctive_only` every
  /// place that agrees counts as distinctive.
  [[nodiscard]] std::vector<TestedPlace> places(bool distinctive_only) const;
};

/// Two maps and the loops between them. With the same chain given twice: a map and its revisits.
struct LoopsBetween {
  const OdometryChain& own;
  const OdometryChain& theirs;
  std::vector<PcmLoop> loops;  ///< All that registration accepted.
  std::vector<double> known_before =
      {};  ///< Evidence of each that does not come from comparing scans; or empty.
};

/// Disjoint sets of loops that agree, the largest first, without loops that most of their neighbours
/// contradict and without sets that put the other robot where one before does. Places are compared up to
/// `reach_m` along the path from the nearest loop.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of(const LoopsBetween& between, double reach_m,
                                                    const AdaptiveConfig& config);

}  // namespace adit
