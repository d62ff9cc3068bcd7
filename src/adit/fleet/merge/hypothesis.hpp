// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Loops that agree with one another align two maps: a hypothesis, to be tested by comparing scans all along
/// the stretch that both robots then drove.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/comparison_plan.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

/// What comparing the scans of one place has shown.
struct ComparedPlace {
  double difference = 0.0;      ///< Over the limit of Discernment: above 1 the scans cannot be of one place.
  bool is_distinctive = false;  ///< A displacement along the tunnel would have shown, where it was asked for.
  std::vector<PatchOffset> offsets = {};  ///< Of their walls from the own ones, where that was asked.
  /// Where structure differs by more than the limit, and where one robot met what may come and go; own
  /// odometry frame, metres.
  ///@{
  std::vector<Vector3> structures = {};
  std::vector<Vector3> things = {};
  ///@}
  /// By what a displacement would show (Discernment); none where that was not asked, as it is of places that
  /// differ only once what differs is explained.
  std::optional<DisplacementSigns> signs = {};
  bool is_explained = false;  ///< What differs was counted before, at another place, or was not seen again.
  /// Share of the returns of either scan that nothing confirmed (RobotMap::unconfirmed).
  ///@{
  std::optional<float> unconfirmed_own = {};
  std::optional<float> unconfirmed_theirs = {};
  ///@}
  /// Whether the scans cannot be of one place; those with nothing in common differ.
  [[nodiscard]] bool differs() const { return !(difference <= 1.0); }
};

/// What has changed between two visits, each object counted once however often it is seen.
class Changes {
 public:
  /// `reach_m`: what is seen within this of where an object was first seen belongs to it.
  explicit Changes(double reach_m) : reach_m_(reach_m) {}
  /// Adds them; true if there are any and all were known before.
  bool know(const std::vector<Vector3>& seen);
  /// Adds them; true if one of them was not known before.
  bool add(const std::vector<Vector3>& seen);
  /// Whether that place belongs to an object that is known.
  [[nodiscard]] bool has(const Vector3& place) const;
  /// Objects known.
  [[nodiscard]] std::size_t num() const { return places_.size(); }

 private:
  double reach_m_;
  std::vector<Vector3> places_;  ///< Where each was seen first.
};

/// Loops that agree, the places to be compared along them, and what was found there so far.
struct Hypothesis {
  Hypothesis() = default;
  /// Without loops and places yet.
  explicit Hypothesis(const AdaptiveConfig& config)
      : model(config.merge_check.evidence), offsets(config.registration.relief) {}

  EvidenceModel model;                                         ///< Says which differences are one object.
  std::vector<std::size_t> loops;                              ///< Indices, ascending.
  std::vector<PlannedComparison> plan;                         ///< Places of the claimed overlap.
  std::vector<std::optional<PlannedComparison>> second_looks;  ///< Of each place of the plan, until taken.
  std::vector<PlannedComparison> wall_plan;     ///< Pairs between the places, where walls have to decide.
  std::size_t num_walls_compared = 0;           ///< Of the first pairs of that plan.
  std::vector<ComparedPlace> compared;          ///< Of the first places of the plan, without their offsets.
  WallOffsets offsets;                          ///< Of all compared walls.
  Changes structures{model.structure_reach_m};  ///< Doors, blocked or worked tunnels.
  Changes things{model.thing_reach_m};          ///< Vehicles and the like.
  std::vector<double> apart_m;    ///< To each hypothesis before this one: where they put the other robot.
  double known_before = 0.0;      ///< Evidence that does not come from comparing scans.
  std::size_t num_unlocated = 0;  ///< Places that differ as a whole, by a second look, too.

  /// Whether all places of the plan were compared, those that differ a second time where they can be.
  [[nodiscard]] bool is_finished() const;
  /// Places that differ and have a second look left, once all have been seen: one fit in many fails.
  [[nodiscard]] std::vector<std::size_t> to_look_at_again() const;
  /// Places of which it is not known yet by what a displacement would show, although they count since what
  /// differs there is explained.
  [[nodiscard]] std::vector<std::size_t> to_ask_for_signs() const;
  /// What comparing a place has shown; the places of the plan in turn.
  void add(const ComparedPlace& place);
  /// What a second look at a place that differed has shown.
  void add_second_look(std::size_t which, const ComparedPlace& place);
  /// Of a pair of scans whose place was seen from beside, so that only its walls count: where the scans
  /// agree, or differ by changes alone that are known.
  void add_walls(const ComparedPlace& place);
  /// By what a displacement would show at a place that differs.
  void add_signs(std::size_t which, const ComparedPlace& place);
  /// Compared places that differ.
  [[nodiscard]] std::size_t num_differing() const;
  /// Changes of structure, and places that differ as a whole.
  [[nodiscard]] std::size_t num_changes() const { return structures.num() + num_unlocated; }
  /// The same if all second looks that are left confirmed what the first ones saw.
  [[nodiscard]] std::size_t num_changes_unless_explained() const;
  /// Compared places that agree, but for what is explained; and those of them where a displacement would have
  /// shown beside that.
  ///@{
  [[nodiscard]] std::size_t num_agreeing() const;
  [[nodiscard]] std::size_t num_distinctive() const;
  ///@}
  /// What was found at each place; what differs elsewhere leaves the rest of a place to agree. In the order
  /// driven by the own robot.
  [[nodiscard]] std::vector<TestedPlace> places() const;
  /// The same if all second looks that are left showed that places agree, and are distinctive.
  [[nodiscard]] std::vector<TestedPlace> places_at_best() const;
  /// Of the scans that were compared, the own ones as `a`.
  [[nodiscard]] UnconfirmedShares unconfirmed() const;

 private:
  [[nodiscard]] bool waits_for_second_look(std::size_t which) const;
  [[nodiscard]] PlaceOutcome outcome(const ComparedPlace& place) const;
  [[nodiscard]] bool shows_beside_changes(const ComparedPlace& place) const;
  /// Counts what differs at a place; true if there is something and all of it had been counted before.
  bool note_changes(const std::vector<Vector3>& differing);
};

/// Two maps and the loops between them. With the same chain given twice: a map and its revisits.
struct LoopsBetween {
  const OdometryChain& own;     ///< Must outlive this.
  const OdometryChain& theirs;  ///< Must outlive this. For revisits `own` itself, no copy of it.
  std::vector<PcmLoop> loops;   ///< All that registration accepted.
  std::vector<double> known_before =
      {};  ///< Evidence of each that does not come from comparing scans; or empty.
  const MergeCheck* earlier = nullptr;  ///< The last one of these robots, if any; read and not kept.
};

/// Disjoint sets of loops that agree, the largest first, without loops that most of their neighbours
/// contradict and without sets that put the other robot where one before does. Places are compared up to
/// `reach_m` along the path from the nearest loop.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of(const LoopsBetween& between, double reach_m,
                                                    const AdaptiveConfig& config);

/// Factor by which the checks of two robots together could exceed the stated error rate, if each shared out a
/// prior of one among its alignments anew: what the earlier checks came to, and of each alignment the share
/// of the loops by which it has more than in the check before. 1 in a first check; alignments that are
/// checked again with the same shares add nothing. An alignment is one of the check before if they have a
/// loop in common.
[[nodiscard]] double spent_priors(const std::vector<Hypothesis>& hypotheses,
                                  const std::vector<PcmLoop>& loops, const MergeCheck* earlier,
                                  double error_rate);

}  // namespace adit
