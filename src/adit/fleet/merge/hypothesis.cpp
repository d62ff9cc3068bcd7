// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/hypothesis.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "adit/core/picked.hpp"
#include "adit/fleet/search/path.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {
namespace {

/// Metres between where two sets of loops put the other robot, at the loops of the second.
double apart_m(const std::vector<PcmLoop>& first, const std::vector<PcmLoop>& second,
               const LoopsBetween& between) {
  const std::vector<double>& their_path_m = between.theirs.path_m();
  double nearest = std::numeric_limits<double>::infinity();
  for (const PcmLoop& loop : second) {
    const PcmLoop& of_first = nearest_loop(first, their_path_m, loop.b);
    const Vector3 by_first = between.own.pose(of_first.a) *
                             (of_first.T_a_b * between.theirs.between(of_first.b, loop.b)).translation();
    const Vector3 by_second = between.own.pose(loop.a) * loop.T_a_b.translation();
    nearest = std::min(nearest, (by_first - by_second).norm());
  }
  return nearest;
}

std::size_t keyframes_between(const PcmLoop& one, const PcmLoop& other) {
  return one.b > other.b ? one.b - other.b : other.b - one.b;
}

/// Metres by which two loops disagree, with odometry between them.
double disagreement_m(const PcmLoop& loop, const PcmLoop& other, const LoopsBetween& between) {
  const Pose T_a_b =
      between.own.between(loop.a, other.a) * other.T_a_b * between.theirs.between(other.b, loop.b);
  return (T_a_b.translation() - loop.T_a_b.translation()).norm();
}

/// Loops that agree may differ by as much as odometry may drift over the whole path. Those near one another
/// have to agree better, whatever odometry's noise was taken for: loops that most of their neighbours
/// contradict go.
std::vector<std::size_t> without_misplaced(const std::vector<std::size_t>& agreeing,
                                           const LoopsBetween& between, const MergeCheckConfig& config) {
  std::vector<std::size_t> out;
  for (const std::size_t l : agreeing) {
    const PcmLoop& loop = between.loops[l];
    std::vector<std::pair<std::size_t, double>> neighbours;  // keyframes away, metres of disagreement
    for (const std::size_t other : agreeing) {
      const std::size_t keyframes = keyframes_between(loop, between.loops[other]);
      if (other == l || keyframes > static_cast<std::size_t>(config.misplaced_keyframes)) continue;
      neighbours.emplace_back(keyframes, disagreement_m(loop, between.loops[other], between));
    }
    std::ranges::stable_sort(neighbours, {}, &std::pair<std::size_t, double>::first);
    neighbours.resize(std::min(neighbours.size(), static_cast<std::size_t>(config.misplaced_neighbours)));
    const auto num_contradicting = static_cast<std::size_t>(std::ranges::count_if(
        neighbours, [&](const auto& neighbour) { return neighbour.second > config.misplaced_m; }));
    const bool too_few = neighbours.size() < static_cast<std::size_t>(config.misplaced_quorum);
    if (too_few || 2 * num_contradicting <= neighbours.size()) out.push_back(l);
  }
  return out.empty() ? agreeing : out;
}

void plan_comparisons(Hypothesis& hypothesis, const LoopsBetween& between, double reach_m,
                      const AdaptiveConfig& config) {
  const MergeCheckConfig& check = config.merge_check;
  const std::vector<PcmLoop> agreeing = picked(between.loops, hypothesis.loops);
  const ComparisonPlanner planner(between.own, between.theirs, agreeing,
                                  {check.spacing_m, reach_m, config.search.revisit.path_m,
                                   check.discernment.second_look_m, check.wall_spacing_m});
  hypothesis.plan = planner.plan(static_cast<std::size_t>(check.max_checks));
  for (const PlannedComparison& place : hypothesis.plan)
    hypothesis.second_looks.push_back(check.discernment.second_looks ? planner.second_look(place)
                                                                     : std::nullopt);
  hypothesis.wall_plan = planner.between(hypothesis.plan, static_cast<std::size_t>(check.max_wall_checks));
}

}  // namespace

bool Changes::has(const Vector3& place) const {
  return std::ranges::any_of(places_,
                             [&](const Vector3& other) { return (other - place).norm() < reach_m_; });
}

bool Changes::know(const std::vector<Vector3>& seen) { return !seen.empty() && !add(seen); }

bool Changes::add(const std::vector<Vector3>& seen) {
  const std::size_t num_before = places_.size();
  for (const Vector3& place : seen)
    if (!has(place)) places_.push_back(place);
  return places_.size() > num_before;
}

bool Hypothesis::note_changes(const std::vector<Vector3>& differing) {
  if (differing.empty()) ++num_unlocated;
  return structures.know(differing);
}

void Hypothesis::add(const ComparedPlace& place) {
  offsets.add(place.offsets);
  things.add(place.things);
  compared.push_back(place);
  compared.back().offsets.clear();
  compared.back().things.clear();
  // What a second look confirms counts then.
  if (place.differs() && !second_looks[compared.size() - 1])
    compared.back().is_explained = note_changes(place.structures);
}

void Hypothesis::add_second_look(std::size_t which, const ComparedPlace& place) {
  const PlannedComparison look = *std::exchange(second_looks[which], std::nullopt);
  ComparedPlace& first = compared[which];
  if (!place.differs()) {
    // Offsets of one pair that count twice would have equal signs.
    std::erase_if(wall_plan, [&](const PlannedComparison& pair) {
      return pair.own == look.own || pair.theirs == look.theirs;
    });
    offsets.add(place.offsets);
    things.add(place.things);
    first = {place.difference, place.is_distinctive, {}, {}, {}, place.signs, false};
    first.unconfirmed_own = place.unconfirmed_own;
    first.unconfirmed_theirs = place.unconfirmed_theirs;
    plan[which] = look;
    return;
  }
  std::vector<Vector3> seen_again;
  for (const Vector3& one : first.structures)
    if (std::ranges::any_of(place.structures,
                            [&](const Vector3& other) { return (other - one).norm() < model.same_object_m; }))
      seen_again.push_back(one);
  const bool has_moved = seen_again.empty() && !first.structures.empty() && !place.structures.empty();
  if (has_moved && std::min(first.difference, place.difference) < model.gross) {
    first.is_explained = true;  // by chance: the place says nothing
    first.signs = DisplacementSigns();
    return;
  }
  first.is_explained = note_changes(seen_again);
}

void Hypothesis::add_walls(const ComparedPlace& place) {
  const auto is_known = [&](const Vector3& change) { return structures.has(change); };
  const bool shows_known_changes =
      !place.structures.empty() && std::ranges::all_of(place.structures, is_known);
  if (!place.differs() || shows_known_changes) offsets.add(place.offsets);
  ++num_walls_compared;
}

void Hypothesis::add_signs(std::size_t which, const ComparedPlace& place) {
  compared[which].signs = place.signs.value_or(DisplacementSigns());
}

bool Hypothesis::is_finished() const { return compared.size() == plan.size() && to_look_at_again().empty(); }

bool Hypothesis::waits_for_second_look(std::size_t which) const {
  return compared[which].differs() && second_looks[which];
}

std::vector<std::size_t> Hypothesis::to_ask_for_signs() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < compared.size(); ++i)
    if (compared[i].differs() && compared[i].is_explained && !compared[i].signs) out.push_back(i);
  return out;
}

std::vector<std::size_t> Hypothesis::to_look_at_again() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < compared.size(); ++i)
    if (waits_for_second_look(i)) out.push_back(i);
  return out;
}

std::size_t Hypothesis::num_changes_unless_explained() const {
  Changes all = structures;
  std::size_t unlocated = num_unlocated;
  for (std::size_t i = 0; i < compared.size(); ++i) {
    if (!waits_for_second_look(i)) continue;
    if (compared[i].structures.empty()) ++unlocated;
    all.add(compared[i].structures);
  }
  return all.num() + unlocated;
}

std::size_t Hypothesis::num_differing() const {
  return static_cast<std::size_t>(std::ranges::count_if(compared, &ComparedPlace::differs));
}

std::size_t Hypothesis::num_agreeing() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      compared, [](const ComparedPlace& place) { return !place.differs() || place.is_explained; }));
}

std::size_t Hypothesis::num_distinctive() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      compared, [&](const ComparedPlace& place) { return outcome(place) == PlaceOutcome::distinctive; }));
}

bool Hypothesis::shows_beside_changes(const ComparedPlace& place) const {
  const auto is_beside = [&](const Vector3& sign) { return !structures.has(sign); };
  const auto shows_beside = [&](const std::vector<Vector3>& one_way) {
    return std::ranges::any_of(one_way, is_beside);
  };
  return place.signs && !place.signs->empty() && std::ranges::all_of(*place.signs, shows_beside);
}

PlaceOutcome Hypothesis::outcome(const ComparedPlace& place) const {
  if (place.differs() && !place.is_explained) return PlaceOutcome::differs;
  const bool is_distinctive = place.differs() ? shows_beside_changes(place) : place.is_distinctive;
  return is_distinctive ? PlaceOutcome::distinctive : PlaceOutcome::agrees;
}

std::vector<TestedPlace> Hypothesis::places() const {
  std::vector<TestedPlace> places;
  for (std::size_t i = 0; i < compared.size(); ++i)
    places.push_back({plan[i].own, plan[i].theirs, outcome(compared[i])});
  std::ranges::stable_sort(places, {}, &TestedPlace::a);
  return places;
}

std::vector<TestedPlace> Hypothesis::places_at_best() const {
  std::vector<TestedPlace> places;
  for (std::size_t i = 0; i < compared.size(); ++i)
    places.push_back({plan[i].own, plan[i].theirs,
                      waits_for_second_look(i) ? PlaceOutcome::distinctive : outcome(compared[i])});
  std::ranges::stable_sort(places, {}, &TestedPlace::a);
  return places;
}

UnconfirmedShares Hypothesis::unconfirmed() const {
  std::vector<std::optional<float>> own;
  std::vector<std::optional<float>> theirs;
  for (const ComparedPlace& place : compared) {
    own.push_back(place.unconfirmed_own);
    theirs.push_back(place.unconfirmed_theirs);
  }
  return {mean_of_judged(own), mean_of_judged(theirs)};
}

std::vector<Hypothesis> hypotheses_of(const LoopsBetween& between, double reach_m,
                                      const AdaptiveConfig& config) {
  const MergeCheckConfig& check = config.merge_check;
  const PcmConfig agreeing{.probability = check.loops_agree};
  std::vector<Hypothesis> hypotheses;
  std::vector<std::size_t> rest(between.loops.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  while (!rest.empty() && hypotheses.size() < static_cast<std::size_t>(check.max_hypotheses)) {
    Hypothesis hypothesis(config);
    for (const std::size_t l :
         pcm(between.own, between.theirs, picked(between.loops, rest), agreeing).largest)
      hypothesis.loops.push_back(rest[l]);
    std::erase_if(rest, [&](std::size_t l) { return std::ranges::binary_search(hypothesis.loops, l); });
    hypothesis.loops = without_misplaced(hypothesis.loops, between, check);
    for (const Hypothesis& other : hypotheses)
      hypothesis.apart_m.push_back(
          apart_m(picked(between.loops, other.loops), picked(between.loops, hypothesis.loops), between));
    const auto is_same = [&](double metres) { return metres <= check.same_alignment_m; };
    if (std::ranges::any_of(hypothesis.apart_m, is_same)) continue;
    plan_comparisons(hypothesis, between, reach_m, config);
    if (!between.known_before.empty()) {
      const auto known = [&](std::size_t l) { return between.known_before[l]; };
      hypothesis.known_before = known(*std::ranges::min_element(hypothesis.loops, {}, known));
    }
    hypotheses.push_back(std::move(hypothesis));
  }
  return hypotheses;
}

double spent_priors(const std::vector<Hypothesis>& hypotheses, const std::vector<PcmLoop>& loops,
                    const MergeCheck* earlier, double error_rate) {
  if (earlier == nullptr || earlier->hypotheses.empty()) return 1.0;  // loops stay: there were none
  const auto num_loops = [](const auto& alignments) {
    std::size_t num = 0;
    for (const auto& alignment : alignments) num += alignment.loops.size();
    return std::max(static_cast<double>(num), 1.0);
  };
  const double num_now = num_loops(hypotheses);
  const double num_before = num_loops(earlier->hypotheses);
  double spent = std::max(1.0, error_rate * std::exp(earlier->needed));
  for (const Hypothesis& h : hypotheses) {
    const auto is_of_it = [&](const std::pair<std::uint32_t, std::uint32_t>& keyframes) {
      return std::ranges::any_of(h.loops, [&](std::size_t l) {
        return loops[l].a == keyframes.first && loops[l].b == keyframes.second;
      });
    };
    double before = 0.0;
    for (const MergeHypothesis& other : earlier->hypotheses)
      if (std::ranges::any_of(other.loops, is_of_it))
        before += static_cast<double>(other.loops.size()) / num_before;
    const double now = static_cast<double>(h.loops.size()) / num_now;
    spent += std::max(0.0, now - before);
  }
  return spent;
}

}  // namespace adit
