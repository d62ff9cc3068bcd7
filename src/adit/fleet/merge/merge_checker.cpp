// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_checker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/fleet/merge/merge_decision.hpp"
#include "adit/fleet/merge/merge_refusal.hpp"
#include "adit/fleet/merge/merge_verdict.hpp"

namespace adit {
namespace {

std::vector<PlannedComparison> part_of(const std::vector<PlannedComparison>& plan, std::size_t from,
                                       std::size_t num) {
  const auto first = plan.begin() + static_cast<std::ptrdiff_t>(from);
  return {first, first + static_cast<std::ptrdiff_t>(std::min(num, plan.size() - from))};
}

std::vector<PlannedComparison> asking(PlaceQuestion question, std::vector<PlannedComparison> places) {
  for (PlannedComparison& place : places) place.question = question;
  return places;
}

/// Whether more pairs of its walls have to be compared before they can be called seen.
bool lacks_walls(const Hypothesis& h, int num_patches) {
  return h.num_walls_compared < h.wall_plan.size() &&
         h.offsets.counted().num_patches < static_cast<std::size_t>(num_patches);
}

}  // namespace

MergeChecker::MergeChecker(LoopsBetween between, OwnMeasurements own, const AdaptiveConfig& config)
    : hypotheses_(std::move(between), std::move(own), config) {}

std::optional<std::size_t> MergeChecker::to_go_on_with() const {
  double best_finished = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_.all())
    if (h.is_finished() && !hypotheses_.differs_too_often(h))
      best_finished =
          std::max(best_finished, hypotheses_.evidence_of_scans(h) - hypotheses_.evidence_of_few_loops(h));
  const auto can_no_longer_be_a_rival = [&](const Hypothesis& h) {
    return std::isfinite(best_finished) &&
           hypotheses_.most_evidence_of_scans(h) - hypotheses_.evidence_of_few_loops(h) <
               best_finished - hypotheses_.least_lead();
  };
  // Ranked by what needs no measuring of the own map: many a check ends with all refuted.
  const auto share_differing = [](const Hypothesis& h) {
    return static_cast<double>(h.num_differing()) / static_cast<double>(h.compared.size());
  };
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < hypotheses_.all().size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    if (h.is_finished() || hypotheses_.differs_too_often(h)) continue;
    if (h.compared.empty()) return i;
    if (can_no_longer_be_a_rival(h)) continue;
    if (!found || share_differing(h) < share_differing(hypotheses_[*found])) found = i;
  }
  return found;
}

std::optional<std::size_t> MergeChecker::whose_walls_to_compare(const std::vector<std::size_t>& order) const {
  if (!config().relief) return {};
  const Hypothesis& best = hypotheses_[order.front()];
  std::vector<std::size_t> others;  // whose walls would tell whether all here are of one mould
  for (const std::size_t other : order)
    if (other != order.front() && !hypotheses_.differs_too_often(hypotheses_[other]) &&
        lacks_walls(hypotheses_[other], config().evidence.walls.few_patches))
      others.push_back(other);
  const MergeDecision decision = decide(hypotheses_, order);
  if (decision == MergeDecision::accepted) {
    // Copies agree at all places: none is accepted whose walls were hardly seen, if more can be, nor before
    // those of the other alignments have been.
    if (lacks_walls(best, config().evidence.walls.min_patches)) return order.front();
    return others.empty() ? std::nullopt : std::optional(others.front());
  }
  if (decision != MergeDecision::too_little_evidence) return {};
  const double missing = hypotheses_.needed() - hypotheses_.evidence(best);
  const double possible = hypotheses_.most_evidence_of_walls(best) - hypotheses_.evidence_of_walls(best);
  if (best.num_walls_compared < best.wall_plan.size() && possible >= missing) return order.front();
  // The more look-alikes have other walls, the fewer are of one mould, beside the one that the prior stands
  // for.
  const double others_possible = std::log1p(static_cast<double>(others.size()));
  return !others.empty() && others_possible >= missing ? std::optional(others.front()) : std::nullopt;
}

std::optional<MergeChecker::Step> MergeChecker::next_step() const {
  // At once, of refuted hypotheses too: all that is decided and told reads it.
  for (std::size_t i = 0; i < hypotheses_.all().size(); ++i)
    if (!hypotheses_[i].to_ask_for_signs().empty()) return Step{Stage::signs, i};
  const auto going_on_with = [&](std::size_t which) {
    const Hypothesis& h = hypotheses_[which];
    return Step{h.compared.size() < h.plan.size() ? Stage::places : Stage::second_looks, which};
  };
  if (const auto which = to_go_on_with()) return going_on_with(*which);
  const std::vector<std::size_t> order = best_first(hypotheses_);
  if (order.empty()) return std::nullopt;
  // By its scans alone the best one was far behind, and the walls of those ahead put it in front.
  const Hypothesis& best = hypotheses_[order.front()];
  if (!best.is_finished() && !hypotheses_.differs_too_often(best)) return going_on_with(order.front());
  if (const auto which = whose_walls_to_compare(order)) return Step{Stage::walls, *which};
  return std::nullopt;
}

std::vector<PlannedComparison> MergeChecker::next(std::size_t num) const {
  const auto step = next_step();
  return step ? planned(*step, num) : std::vector<PlannedComparison>();
}

std::vector<PlannedComparison> MergeChecker::planned(const Step& step, std::size_t num) const {
  const Hypothesis& h = hypotheses_[step.hypothesis];
  switch (step.stage) {
    case Stage::places: {
      const auto first = static_cast<std::size_t>(config().first_checks);
      return part_of(h.plan, h.compared.size(), h.compared.empty() ? std::min(num, first) : num);
    }
    case Stage::second_looks: {
      std::vector<PlannedComparison> again;
      for (const std::size_t i : h.to_look_at_again()) again.push_back(*h.second_looks[i]);
      return part_of(again, 0, num);
    }
    case Stage::signs: {
      std::vector<PlannedComparison> explained;
      for (const std::size_t i : h.to_ask_for_signs()) explained.push_back(h.plan[i]);
      return asking(PlaceQuestion::displacement, part_of(explained, 0, num));
    }
    case Stage::walls:
      return asking(PlaceQuestion::walls, part_of(h.wall_plan, h.num_walls_compared, num));
  }
  return {};
}

void MergeChecker::add(const std::vector<ComparedPlace>& places) {
  if (places.empty()) return;
  const auto step = next_step();
  ADIT_CHECK(step && places.size() <= planned(*step, places.size()).size(),
             "only what was asked for is added");
  Hypothesis& h = hypotheses_[step->hypothesis];
  switch (step->stage) {
    case Stage::places:
      for (const ComparedPlace& place : places) h.add(place);
      break;
    case Stage::second_looks: {
      const std::vector<std::size_t> again = h.to_look_at_again();
      for (std::size_t i = 0; i < places.size(); ++i) h.add_second_look(again[i], places[i]);
      break;
    }
    case Stage::signs: {
      const std::vector<std::size_t> explained = h.to_ask_for_signs();
      for (std::size_t i = 0; i < places.size(); ++i) h.add_signs(explained[i], places[i]);
      break;
    }
    case Stage::walls:
      for (const ComparedPlace& place : places) h.add_walls(place);
      break;
  }
}

MergeCheck MergeChecker::verdict(RobotId a, RobotId b, const std::string& remedy) const {
  return verdict_of(judgement_of(hypotheses_), a, b, remedy);
}

std::optional<UndecidedStretch> MergeChecker::undecided() const {
  return undecided_stretch(judgement_of(hypotheses_));
}

}  // namespace adit
