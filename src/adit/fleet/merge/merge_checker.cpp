// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_checker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/fleet/merge/scan_quality.hpp"
#include "adit/fleet/search/path.hpp"

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

}  // namespace

MergeChecker::MergeChecker(LoopsBetween between, OwnMeasurements own, const AdaptiveConfig& config)
    : hypotheses_(hypotheses_of(between, own.reach_m, config)),
      own_(std::move(own)),
      config_(config.merge_check),
      place_keyframes_(static_cast<std::size_t>(config.search.place_keyframes)),
      needed_(
          std::log(spent_priors(hypotheses_, between.loops, between.earlier, config_.evidence.error_rate) /
                   config_.evidence.error_rate)) {
  loops_ = std::move(between.loops);
}

/// The first of these that holds of the best hypothesis; decision 0010 in this order.
MergeDecision MergeChecker::decide(const std::vector<std::size_t>& best_first, double forgiven) const {
  if (best_first.empty()) return MergeDecision::no_loops;
  const Hypothesis& best = hypotheses_[best_first.front()];

  // Against copies. Scans of one place seldom differ.
  if (differs_too_often(best)) return MergeDecision::scans_differ;
  // What was known before is no reason to do without any comparison.
  if (best.compared.empty()) return MergeDecision::nothing_compared;

  // Against chance. Only places where a displacement along the tunnel would show are evidence, by how seldom
  // look-alikes of the own map agree for as long (Wald's test).
  if (!(evidence(best) + forgiven >= needed_)) {  // NaN refuses, here and among rivals
    if (evidence(best) - evidence_of_walls(best) >= needed_) return MergeDecision::other_walls;
    return best.num_distinctive() == 0 ? MergeDecision::nothing_distinctive
                                       : MergeDecision::too_little_evidence;
  }

  // Against every other hypothesis: the nearest one is the second.
  if (best_first.size() > 1 && are_rivals(best, hypotheses_[best_first[1]])) return MergeDecision::rival;
  return best.is_finished() ? MergeDecision::accepted : MergeDecision::unfinished;
}

bool MergeChecker::differs_too_often(const Hypothesis& h) const {
  // One change is seen from many places: the places themselves are no independent trials. Where nearly all
  // differ, second looks are not waited for: there are as many, and most hypotheses are false.
  const std::size_t num_changes =
      differs_nearly_everywhere(h) ? h.num_changes_unless_explained() : h.num_changes();
  return are_too_many(num_changes, compared_km(h));
}

bool MergeChecker::are_too_many(std::size_t num_changes, double km) const {
  return poisson_tail(num_changes, config_.evidence.changes_at_worst_per_km * km) <
         config_.evidence.refusal_rate;
}

/// By one place more than a true alignment does at worst.
bool MergeChecker::differs_nearly_everywhere(const Hypothesis& h) const {
  const auto num = static_cast<double>(h.compared.size());
  const std::size_t first = std::min(static_cast<std::size_t>(config_.first_checks), h.plan.size());
  return h.compared.size() >= first &&
         static_cast<double>(h.num_differing()) >= config_.evidence.differing_at_worst * num + 1.0;
}

double MergeChecker::compared_km(const Hypothesis& h) const {
  const double by_places = static_cast<double>(h.compared.size()) * config_.evidence.sight_m;
  const double whole = static_cast<double>(h.plan.size()) * config_.spacing_m + config_.evidence.sight_m;
  return std::min(by_places, whole) / 1000.0;
}

bool MergeChecker::are_rivals(const Hypothesis& best, const Hypothesis& other) const {
  const double lead = evidence_among_rivals(best) - evidence_among_rivals(other);
  return !differs_too_often(other) && !(lead >= least_lead());
}

double MergeChecker::least_lead() const { return std::log(1.0 / config_.evidence.rival_rate); }

double MergeChecker::evidence(const Hypothesis& h) const {
  return evidence_of_scans(h) + evidence_of_walls(h);
}

/// Whether loops are few does not tell them apart: the true one may be beside a copy that was found more
/// often.
double MergeChecker::evidence_among_rivals(const Hypothesis& h) const {
  return evidence(h) - evidence_of_few_loops(h);
}

double MergeChecker::prior_evidence(const Hypothesis& h) const {
  const auto num = static_cast<double>(h.loops.size());
  return h.known_before + std::log(num / static_cast<double>(loops_.size())) + evidence_of_few_loops(h);
}

/// Where robots shared a tunnel, search seldom finds it once or twice alone, unless much looks alike; then it
/// finds it where it is looked for. That many loops agree is no evidence in turn: where tunnels are copies
/// they do, too.
double MergeChecker::evidence_of_few_loops(const Hypothesis& h) const {
  const EvidenceModel& model = config_.evidence;
  const std::size_t found_again = h.num_found_again > h.num_not_found ? h.num_found_again : 0;
  return static_cast<double>(h.loops.size() + found_again) > model.few_loops
             ? 0.0
             : std::min(0.0, std::log(model.few_loops_if_true / model.few_loops_if_false));
}

double MergeChecker::evidence_of_scans(const Hypothesis& h) const {
  return prior_evidence(h) + evidence_of_places(h.places(), share_of_copies_if_true(h));
}

/// Places not yet compared are taken to agree, each as if none had agreed before, and other alignments to be
/// no copies.
double MergeChecker::most_evidence_of_scans(const Hypothesis& h) const {
  const std::size_t num_left = h.plan.size() - h.compared.size();
  CountedPlaces places = counted_places(h.places_at_best(), chances());
  places.evidence += static_cast<double>(num_left) * evidence_of_agreement(chances(), 0);
  places.num_agreed += num_left;
  const CountedPlaces no_copy = {-std::numeric_limits<double>::infinity()};
  const std::vector<CountedPlaces> others(hypotheses_.size() - 1, no_copy);
  return prior_evidence(h) + evidence_of_places(places, share_of_copies(others));
}

double MergeChecker::evidence_of_places(const std::vector<TestedPlace>& places, double copies) const {
  return evidence_of_places(counted_places(places, chances()), copies);
}

double MergeChecker::evidence_of_places(const CountedPlaces& places, double copies) const {
  return config_.relief ? unless_copied(places, copies) : places.evidence;
}

double MergeChecker::share_of_copies_if_true(const Hypothesis& h) const {
  std::vector<CountedPlaces> others;
  for (const Hypothesis& other : hypotheses_)
    if (&other != &h && !other.compared.empty()) others.push_back(counted_places(other.places(), chances()));
  return share_of_copies(others);
}

double MergeChecker::evidence_of_walls(const Hypothesis& h, double times) const {
  return config_.relief ? own_.measured().walls.evidence(h.offsets.counted(), times, walls_elsewhere(h))
                        : 0.0;
}

std::vector<EqualSignShare> MergeChecker::walls_elsewhere(const Hypothesis& h) const {
  std::vector<EqualSignShare> shares;
  for (const Hypothesis& other : hypotheses_)
    if (&other != &h && !other.compared.empty()) shares.push_back(other.offsets.counted());
  return shares;
}

bool MergeChecker::lacks_walls(const Hypothesis& h, int num_patches) const {
  return h.num_walls_compared < h.wall_plan.size() &&
         h.offsets.counted().num_patches < static_cast<std::size_t>(num_patches);
}

std::optional<std::size_t> MergeChecker::to_go_on_with() const {
  double best_finished = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_)
    if (h.is_finished() && !differs_too_often(h))
      best_finished = std::max(best_finished, evidence_of_scans(h) - evidence_of_few_loops(h));
  const auto can_no_longer_be_a_rival = [&](const Hypothesis& h) {
    return std::isfinite(best_finished) &&
           most_evidence_of_scans(h) - evidence_of_few_loops(h) < best_finished - least_lead();
  };
  // Ranked by what needs no measuring of the own map: many a check ends with all refuted.
  const auto share_differing = [](const Hypothesis& h) {
    return static_cast<double>(h.num_differing()) / static_cast<double>(h.compared.size());
  };
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    if (h.is_finished() || differs_too_often(h)) continue;
    if (h.compared.empty()) return i;
    if (can_no_longer_be_a_rival(h)) continue;
    if (!found || share_differing(h) < share_differing(hypotheses_[*found])) found = i;
  }
  return found;
}

bool MergeChecker::is_left_unfinished(const Hypothesis& best) const {
  return !best.is_finished() && !differs_too_often(best);
}

std::optional<std::size_t> MergeChecker::whose_walls_to_compare(const std::vector<std::size_t>& order) const {
  if (!config_.relief) return {};
  const Hypothesis& best = hypotheses_[order.front()];
  std::vector<std::size_t> others;  // whose walls would tell whether all here are of one mould
  for (const std::size_t other : order)
    if (other != order.front() && !differs_too_often(hypotheses_[other]) &&
        lacks_walls(hypotheses_[other], config_.evidence.walls.few_patches))
      others.push_back(other);
  const MergeDecision decision = decide(order);
  if (decision == MergeDecision::accepted) {
    // Copies agree at all places: none is accepted whose walls were hardly seen, if more can be, nor before
    // those of the other alignments have been.
    if (lacks_walls(best, config_.evidence.walls.min_patches)) return order.front();
    return others.empty() ? std::nullopt : std::optional(others.front());
  }
  const double forgivable = has_places_to_find_again(best) ? -evidence_of_few_loops(best) : 0.0;
  // Walls that speak against it are looked at more closely, too, before anything is forgiven.
  const bool may_decide = decision == MergeDecision::too_little_evidence ||
                          (decision == MergeDecision::other_walls && forgivable > 0.0);
  if (!may_decide) return {};
  const double missing = needed_ - evidence(best) - forgivable;
  const double possible =
      own_.measured().walls.most_evidence(walls_elsewhere(best)) - evidence_of_walls(best);
  if (best.num_walls_compared < best.wall_plan.size() && possible >= missing) return order.front();
  // The more look-alikes have other walls, the fewer are of one mould, beside the one that the prior stands
  // for.
  const double others_possible = std::log1p(static_cast<double>(others.size()));
  return !others.empty() && others_possible >= missing ? std::optional(others.front()) : std::nullopt;
}

std::vector<PlannedComparison> MergeChecker::to_find_again(const Hypothesis& h) const {
  const auto is_one_place = [&](std::size_t a, std::size_t b) {
    return (a > b ? a - b : b - a) < place_keyframes_;
  };
  std::vector<PlannedComparison> places;
  for (const PlannedComparison& place : h.distinctive()) {
    // Scans beside those of a loop, or of one another, would be the same finding a second time.
    const bool is_beside_a_loop = std::ranges::any_of(h.loops, [&](std::size_t l) {
      return is_one_place(place.own, loops_[l].a) || is_one_place(place.theirs, loops_[l].b);
    });
    if (!is_beside_a_loop && (places.empty() || !is_one_place(place.theirs, places.back().theirs)))
      places.push_back(place);
  }
  std::vector<PlannedComparison> out;
  for (const std::uint32_t i :
       evenly_spread(places.size(), static_cast<std::size_t>(config_.max_found_again))) {
    out.push_back(places[i]);
    out.back().question = PlaceQuestion::registration;
  }
  const bool may_be_many = static_cast<double>(h.loops.size() + out.size()) > config_.evidence.few_loops;
  return may_be_many ? out : std::vector<PlannedComparison>();
}

bool MergeChecker::has_places_to_find_again(const Hypothesis& h) const {
  return static_cast<double>(h.loops.size()) <= config_.evidence.few_loops &&
         h.num_looked_for < to_find_again(h).size();
}

/// All places are looked for, also once enough have been found: to stop then would be to choose.
std::optional<std::size_t> MergeChecker::whose_places_to_find_again(
    const std::vector<std::size_t>& order) const {
  const Hypothesis& best = hypotheses_[order.front()];
  if (!has_places_to_find_again(best)) return {};
  const bool is_needed = best.num_looked_for > 0 || decide(order) != MergeDecision::accepted;
  const bool would_do = decide(order, -evidence_of_few_loops(best)) == MergeDecision::accepted;
  return is_needed && would_do ? std::optional(order.front()) : std::nullopt;
}

std::optional<MergeChecker::Step> MergeChecker::next_step() const {
  // At once, of refuted hypotheses too: all that is decided and told reads it.
  for (std::size_t i = 0; i < hypotheses_.size(); ++i)
    if (!hypotheses_[i].to_ask_for_signs().empty()) return Step{Stage::signs, i};
  const auto going_on_with = [&](std::size_t which) {
    const Hypothesis& h = hypotheses_[which];
    return Step{h.compared.size() < h.plan.size() ? Stage::places : Stage::second_looks, which};
  };
  if (const auto which = to_go_on_with()) return going_on_with(*which);
  const std::vector<std::size_t> order = best_first();
  if (order.empty()) return std::nullopt;
  if (is_left_unfinished(hypotheses_[order.front()])) return going_on_with(order.front());
  if (const auto which = whose_walls_to_compare(order)) return Step{Stage::walls, *which};
  if (const auto which = whose_places_to_find_again(order)) return Step{Stage::find_again, *which};
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
      const auto first = static_cast<std::size_t>(config_.first_checks);
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
    case Stage::find_again:
      return part_of(to_find_again(h), h.num_looked_for, num);
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
    case Stage::find_again:
      for (const ComparedPlace& place : places) {
        ++h.num_looked_for;
        h.num_found_again += place.found_again == FoundAgain::there;
        h.num_not_found += place.found_again == FoundAgain::elsewhere;
      }
      break;
  }
}

double MergeChecker::apart_m(std::size_t one, std::size_t other) const {
  return one == other ? 0.0 : hypotheses_[std::max(one, other)].apart_m[std::min(one, other)];
}

std::vector<std::size_t> MergeChecker::best_first() const {
  std::vector<std::size_t> order;
  std::vector<std::size_t> differing;
  for (std::size_t h = 0; h < hypotheses_.size(); ++h)
    (differs_too_often(hypotheses_[h]) ? differing : order).push_back(h);
  if (order.size() > 1) {  // the own map is not measured to rank a single one
    std::vector<double> evidence_of(hypotheses_.size(), 0.0);
    // NaN, which has no place in an order, comes first, where it refuses.
    const auto has_more = [&](std::size_t one, std::size_t other) {
      const bool is_nan = std::isnan(evidence_of[one]);
      const bool other_is = std::isnan(evidence_of[other]);
      return is_nan || other_is ? is_nan && !other_is : evidence_of[one] > evidence_of[other];
    };
    for (const std::size_t h : order) evidence_of[h] = evidence(hypotheses_[h]);
    std::ranges::stable_sort(order, has_more);
    for (const std::size_t h : order) evidence_of[h] = evidence_among_rivals(hypotheses_[h]);
    std::stable_sort(order.begin() + 1, order.end(), has_more);
  }
  order.insert(order.end(), differing.begin(), differing.end());
  return order;
}

HypothesisCounts MergeChecker::counts(const Hypothesis& h) const {
  const EqualSignShare& walls = h.offsets.counted();
  return {static_cast<std::uint32_t>(h.num_distinctive()),
          static_cast<std::uint32_t>(h.num_changes_unless_explained()),
          static_cast<std::uint32_t>(h.things.num()),
          static_cast<std::uint32_t>(walls.num_patches),
          static_cast<std::uint32_t>(h.num_looked_for),
          static_cast<std::uint32_t>(h.num_found_again),
          static_cast<std::uint32_t>(h.num_not_found),
          1000.0 * compared_km(h),
          walls.share,
          walls.sigma};
}

MergeHypothesis MergeChecker::described(std::size_t which, std::size_t best) const {
  const Hypothesis& h = hypotheses_[which];
  MergeHypothesis out;
  out.num_checked = static_cast<std::uint32_t>(h.compared.size());
  out.num_passed = static_cast<std::uint32_t>(h.num_agreeing());
  out.from_best_m = apart_m(which, best);
  out.counts = counts(h);
  for (const std::size_t l : h.loops)
    out.loops.emplace_back(static_cast<std::uint32_t>(loops_[l].a), static_cast<std::uint32_t>(loops_[l].b));
  if (differs_too_often(h)) return out;
  out.evidence = evidence(h);
  out.places = h.places();
  out.walls = evidence_of_walls(h);
  out.outcome = which == best                      ? HypothesisOutcome::unsure
                : are_rivals(hypotheses_[best], h) ? HypothesisOutcome::rival
                                                   : HypothesisOutcome::behind;
  return out;
}

MergeCheck MergeChecker::verdict(RobotId a, RobotId b, const std::string& remedy) const {
  const std::vector<std::size_t> order = best_first();
  const MergeDecision decision = decide(order);
  MergeCheck out;
  out.a = a;
  out.b = b;
  out.needed = needed_;
  out.accepted = decision == MergeDecision::accepted;
  out.refused_kind = refused_kind(decision, order);
  if (!order.empty()) out.unconfirmed = hypotheses_[order.front()].unconfirmed();
  out.reason = why(decision, order) + what_dust_may_have_done(out.refused_kind, out.unconfirmed);
  if (!out.accepted) out.reason += "; " + (remedy.empty() ? this->remedy(decision, order) : remedy);
  if (order.empty()) return out;
  for (const std::size_t h : std::span(order).first(std::min(order.size(), kHypothesesPerCheck)))
    out.hypotheses.push_back(described(h, order.front()));
  MergeHypothesis& best = out.hypotheses.front();
  if (best.outcome != HypothesisOutcome::refuted) {
    const bool has_rival = out.hypotheses.size() > 1 && out.hypotheses[1].outcome == HypothesisOutcome::rival;
    if (out.accepted) best.outcome = HypothesisOutcome::accepted;
    if (has_rival && best.evidence >= out.needed) best.outcome = HypothesisOutcome::rival;
  }
  out.evidence = best.evidence;
  out.num_checked = best.num_checked;
  out.num_passed = best.num_passed;
  out.loops = best.loops;
  return out;
}

}  // namespace adit
