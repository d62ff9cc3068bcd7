// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/search/revisits.hpp"

namespace adit {
namespace {

constexpr double kTrueAtWorst = 0.95;  // least chance that scans do not differ where the alignment is true
// A difference of three times the limit is a niche or a cabinet, not noise: in true alignments only a fit
// that failed leaves it.
constexpr double kGross = 3.0;
constexpr double kTrueGross = 0.005;     // chance of that where the alignment is true
constexpr double kSameAlignment = 3.0;   // metres between two hypotheses that say the same
constexpr std::size_t kFirstChecks = 8;  // of each hypothesis, before the best ones get more

// The chance of `k` or more out of `n` where each comes with chance `p`.
double at_least(std::size_t k, std::size_t n, double p) {
  double chance = 0.0;
  for (std::size_t i = k; i <= n; ++i) {
    const auto x = static_cast<double>(i);
    const auto all = static_cast<double>(n);
    chance += std::exp(std::lgamma(all + 1.0) - std::lgamma(x + 1.0) - std::lgamma(all - x + 1.0) +
                       x * std::log(p) + (all - x) * std::log1p(-p));
  }
  return chance;
}

// Where their keyframe stands in the own odometry's frame, by the loop that is nearest along their way.
Vector3 position_of(std::uint32_t theirs, const OdometryChain& own_chain, const OdometryChain& their_chain,
                    const std::vector<PcmLoop>& loops) {
  const auto& loop = *std::ranges::min_element(
      loops, {}, [&](const PcmLoop& l) { return l.b > theirs ? l.b - theirs : theirs - l.b; });
  return own_chain.pose(loop.a) * (loop.T_a_b * their_chain.between(loop.b, theirs)).translation();
}

std::vector<PcmLoop> picked(const std::vector<PcmLoop>& loops, const std::vector<std::size_t>& indices) {
  std::vector<PcmLoop> out;
  for (const std::size_t i : indices) out.push_back(loops[i]);
  return out;
}

// How far two sets of loops put the other robot from one another, at the loops of the second.
double apart(const std::vector<PcmLoop>& first, const std::vector<PcmLoop>& second, const OdometryChain& own,
             const OdometryChain& theirs) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const PcmLoop& loop : second) {
    const auto j = static_cast<std::uint32_t>(loop.b);
    const Vector3 there = own.pose(loop.a) * loop.T_a_b.translation();
    nearest = std::min(nearest, (position_of(j, own, theirs, first) - there).norm());
  }
  return nearest;
}

// A clique may differ as much as odometry may over the whole way; loops near one another have to agree
// better, whatever odometry's noise was taken for. Without those that most of their neighbours contradict.
std::vector<std::size_t> without_misplaced(const OdometryChain& own, const OdometryChain& theirs,
                                           const std::vector<PcmLoop>& loops,
                                           const std::vector<std::size_t>& clique) {
  constexpr double kOff = 0.75;           // metres
  constexpr std::size_t kNeighbours = 5;  // asked, of those
  constexpr std::size_t kNear = 60;       // keyframes or less away;
  constexpr std::size_t kEnough = 3;      // fewer decide nothing
  std::vector<std::size_t> out;
  for (const std::size_t l : clique) {
    const PcmLoop& loop = loops[l];
    std::vector<std::pair<std::size_t, double>> by_distance;  // and by how much it is contradicted
    for (const std::size_t other : clique) {
      const PcmLoop& that = loops[other];
      const std::size_t keyframes = loop.b > that.b ? loop.b - that.b : that.b - loop.b;
      if (other == l || keyframes > kNear) continue;
      const Pose T_a_b = own.between(loop.a, that.a) * that.T_a_b * theirs.between(that.b, loop.b);
      by_distance.emplace_back(keyframes, (T_a_b.translation() - loop.T_a_b.translation()).norm());
    }
    std::ranges::stable_sort(by_distance, {}, &std::pair<std::size_t, double>::first);
    by_distance.resize(std::min(by_distance.size(), kNeighbours));
    const auto contradicting = static_cast<std::size_t>(
        std::ranges::count_if(by_distance, [](const auto& neighbour) { return neighbour.second > kOff; }));
    if (by_distance.size() < kEnough || 2 * contradicting <= by_distance.size()) out.push_back(l);
  }
  return out.empty() ? clique : out;
}

std::size_t num_differing(const std::vector<CheckedPlace>& places, double by_more_than = 1.0) {
  return static_cast<std::size_t>(std::ranges::count_if(
      places, [&](const CheckedPlace& place) { return !(place.difference <= by_more_than); }));
}

}  // namespace

Fields fields_of(MergeCheckConfig& c) {
  Fields fields = {
      {"error_rate", &c.error_rate, "", 1e-12, 0.5, "chance that a wrong merge passes"},
      {"refusal_rate", &c.refusal_rate, "", 1e-12, 0.5,
       "chance that a true merge is refused because scans differ"},
      {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "way between two places where maps are compared"},
      {"max_checks", &c.max_checks, "", 1, 10000, "places that are compared at most, of one hypothesis"},
      {"max_hypotheses", &c.max_hypotheses, "", 1, 1000,
       "sets of consistent loops that are tested, the largest ones"},
      {"min_loops", &c.min_loops, "", 1, 1000, "loops that have to agree in a hypothesis that joins maps"},
      {"odometry_slack", &c.odometry_slack, "", 1.0, 100.0,
       "loops make one hypothesis if they agree within this many times the noise of odometry"},
      {"distinctive_only", &c.distinctive_only, "", 0, 0,
       "agreement counts only where a displacement along the way would show"},
      {"relief", &c.relief, "", 0, 0,
       "walls that stand off one another alike in all scans are not the same walls"}};
  append(fields, "discernment", fields_of(c.discernment));
  return fields;
}

MergeTest::MergeTest(const OdometryChain& own, const OdometryChain& theirs, const std::vector<PcmLoop>& loops,
                     double reach_m, MeasuredWhenAsked measured, const MergeCheckConfig& config,
                     const std::vector<double>& known_before)
    : loops_(loops), measured_(std::move(measured)), config_(config) {
  std::vector<std::size_t> rest(loops.size());
  for (std::size_t l = 0; l < rest.size(); ++l) rest[l] = l;
  while (!rest.empty() && hypotheses_.size() < static_cast<std::size_t>(config.max_hypotheses)) {
    Hypothesis hypothesis;
    for (const std::size_t l : pcm(own, theirs, picked(loops, rest)).largest)
      hypothesis.loops.push_back(rest[l]);
    std::erase_if(rest, [&](std::size_t l) { return std::ranges::binary_search(hypothesis.loops, l); });
    hypothesis.loops = without_misplaced(own, theirs, loops, hypothesis.loops);
    const std::vector<PcmLoop> agreeing = picked(loops, hypothesis.loops);
    for (const Hypothesis& other : hypotheses_)
      hypothesis.apart_m.push_back(apart(picked(loops, other.loops), agreeing, own, theirs));
    if (std::ranges::any_of(hypothesis.apart_m, [](double metres) { return metres <= kSameAlignment; }))
      continue;
    const CheckPlanner planner(own, theirs, agreeing, reach_m);
    hypothesis.plan = planner.plan(config.spacing_m, static_cast<std::size_t>(config.max_checks));
    for (const PlannedCheck& check : hypothesis.plan)
      hypothesis.second_looks.push_back(config.discernment.second_looks ? planner.again(check)
                                                                        : std::nullopt);
    if (!known_before.empty()) {
      const auto known = [&](std::size_t l) { return known_before[l]; };
      hypothesis.known_before = known(*std::ranges::min_element(hypothesis.loops, {}, known));
    }
    hypotheses_.push_back(std::move(hypothesis));
  }
}

double MergeTest::needed() const { return std::log(1.0 / config_.error_rate); }

double MergeTest::walls_evidence(const Hypothesis& hypothesis) const {
  return config_.relief ? hypothesis.offsets.evidence(measured_().walls) : 0.0;
}

double MergeTest::evidence(const Hypothesis& hypothesis) const {
  return evidence_along_the_way(hypothesis) + walls_evidence(hypothesis);
}

double MergeTest::evidence_along_the_way(const Hypothesis& hypothesis) const {
  const std::vector<double> at_places =
      evidence_at_places(along_the_way(hypothesis), measured_().look_alikes.chances());
  const double share = static_cast<double>(hypothesis.loops.size()) / static_cast<double>(loops_.size());
  return hypothesis.known_before + std::log(share) + std::accumulate(at_places.begin(), at_places.end(), 0.0);
}

std::vector<TestedPlace> MergeTest::along_the_way(const Hypothesis& hypothesis) const {
  std::vector<TestedPlace> places;
  for (std::size_t i = 0; i < hypothesis.checked.size(); ++i) {
    const CheckedPlace& place = hypothesis.checked[i];
    const bool tells = place.is_distinctive || !config_.distinctive_only;
    places.push_back({hypothesis.plan[i].own, hypothesis.plan[i].theirs,
                      place.differs() ? PlaceOutcome::differs
                      : tells         ? PlaceOutcome::tells
                                      : PlaceOutcome::agrees});
  }
  std::ranges::stable_sort(places, {}, &TestedPlace::a);
  return places;
}

bool MergeTest::has_other_walls(const Hypothesis& h) const {
  // Looked at again and again: before the end only what leaves little doubt counts.
  const double rate = is_finished(h) ? config_.refusal_rate : config_.refusal_rate / 100.0;
  // What was measured only raises the share that one wall may have.
  return config_.relief && h.offsets.are_of_other_walls({}, rate) &&
         h.offsets.are_of_other_walls(measured_().walls, rate);
}

bool MergeTest::is_refuted(const Hypothesis& h) const {
  const std::size_t num = h.checked.size();
  return at_least(num_differing(h.checked), num, 1.0 - kTrueAtWorst) < config_.refusal_rate ||
         at_least(num_differing(h.checked, kGross), num, kTrueGross) < config_.refusal_rate ||
         has_other_walls(h);
}

bool MergeTest::is_finished(const Hypothesis& h) {
  return h.checked.size() == h.plan.size() && to_look_at_again(h).empty();
}

std::vector<std::size_t> MergeTest::to_look_at_again(const Hypothesis& h) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < h.checked.size(); ++i)
    if (h.checked[i].differs() && h.second_looks[i]) out.push_back(i);
  return out;
}

std::optional<std::size_t> MergeTest::to_go_on_with() const {
  double best_finished = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : hypotheses_)
    if (is_finished(h) && !is_refuted(h)) best_finished = std::max(best_finished, evidence_along_the_way(h));
  // It can no longer become a rival.
  const auto is_too_late = [&](const Hypothesis& h) {
    const auto num_left = static_cast<double>(h.plan.size() - h.checked.size());
    return std::isfinite(best_finished) &&
           evidence_along_the_way(h) +
                   num_left * evidence_of_agreement(measured_().look_alikes.chances(), 0) <
               best_finished - needed();
  };
  // By what needs no measuring of the own map: many a test ends with all refuted.
  const auto share_differing = [](const Hypothesis& h) {
    return static_cast<double>(num_differing(h.checked)) / static_cast<double>(h.checked.size());
  };
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    if (is_finished(h) || is_refuted(h)) continue;
    if (h.checked.empty()) return i;
    if (is_too_late(h)) continue;
    if (!found || share_differing(h) < share_differing(hypotheses_[*found])) found = i;
  }
  return found;
}

std::vector<PlannedCheck> MergeTest::next(std::size_t num) const {
  const auto which = to_go_on_with();
  if (!which) return {};
  const Hypothesis& h = hypotheses_[*which];
  const std::size_t from = h.checked.size();
  if (from == h.plan.size()) {
    std::vector<PlannedCheck> again;
    for (const std::size_t i : to_look_at_again(h))
      if (again.size() < num) again.push_back(*h.second_looks[i]);
    return again;
  }
  const std::size_t to = std::min(h.plan.size(), from + (from == 0 ? std::min(num, kFirstChecks) : num));
  return {h.plan.begin() + static_cast<std::ptrdiff_t>(from),
          h.plan.begin() + static_cast<std::ptrdiff_t>(to)};
}

void MergeTest::add(const std::vector<CheckedPlace>& places) {
  const auto which = to_go_on_with();
  ADIT_CHECK(which, "only what was asked for is added");
  Hypothesis& h = hypotheses_[*which];
  if (h.checked.size() == h.plan.size()) return add_second_looks(h, places);
  ADIT_CHECK(h.checked.size() + places.size() <= h.plan.size(), "only what was asked for is added");
  for (const CheckedPlace& place : places) {
    h.offsets.add(place.offsets);
    h.checked.push_back({place.difference, place.is_distinctive});
  }
}

void MergeTest::add_second_looks(Hypothesis& h, const std::vector<CheckedPlace>& places) {
  const std::vector<std::size_t> again = to_look_at_again(h);
  ADIT_CHECK(places.size() <= again.size(), "only what was asked for is added");
  for (std::size_t i = 0; i < places.size(); ++i) {
    h.second_looks[again[i]].reset();
    if (places[i].differs()) continue;
    h.offsets.add(places[i].offsets);
    h.checked[again[i]] = {places[i].difference, places[i].is_distinctive};
  }
}

double MergeTest::apart_m(std::size_t one, std::size_t other) const {
  return one == other ? 0.0 : hypotheses_[std::max(one, other)].apart_m[std::min(one, other)];
}

std::vector<std::size_t> MergeTest::best_first() const {
  std::vector<std::size_t> order(hypotheses_.size());
  for (std::size_t h = 0; h < order.size(); ++h) order[h] = h;
  std::ranges::stable_sort(order, [&](std::size_t one, std::size_t other) {
    const Hypothesis& a = hypotheses_[one];
    const Hypothesis& b = hypotheses_[other];
    if (is_refuted(a) || is_refuted(b)) return is_refuted(a) < is_refuted(b);
    return evidence(a) > evidence(b);
  });
  return order;
}

std::string MergeTest::what_is_missing(const Hypothesis& h, std::size_t num_distinctive) const {
  constexpr double kFarthest = 1000.0;  // metres that it makes sense to ask for
  const double num_places = std::ceil(
      (needed() - evidence(h)) / evidence_of_agreement(measured_().look_alikes.chances(), num_distinctive));
  const double share = static_cast<double>(num_distinctive) / static_cast<double>(h.checked.size());
  const double metres = 10.0 * std::ceil(num_places * config_.spacing_m / share / 10.0);
  if (!(metres <= kFarthest))
    return "tunnels here look alike for too long; drive the same stretch past a junction or a niche";
  return format("drive the same stretch for about another {:.0f} m", metres);
}

std::string MergeTest::reason(std::size_t which, std::optional<std::size_t> rival) const {
  const Hypothesis& h = hypotheses_[which];
  const std::size_t differing = num_differing(h.checked);
  const auto distinctive = static_cast<std::size_t>(std::ranges::count_if(
      h.checked, [](const CheckedPlace& place) { return place.is_distinctive && !place.differs(); }));
  if (has_other_walls(h)) {
    const StandingShare walls = h.offsets.counted();
    return format(
        "walls stand off one another: scan after scan puts {:.0f} % of {} patches on one side, of which "
        "noise leaves half; other tunnels, built alike; drive on until one passes where the other has truly "
        "been",
        100.0 * walls.share, walls.num_patches);
  }
  if (is_refuted(h))
    return format(
        "scans differ at {} of {} places along the stretch that {} loops lay over one another: "
        "tunnels that only look alike; drive on until one passes where the other has truly been",
        differing, h.checked.size(), h.loops.size());
  if (evidence(h) < needed() && distinctive == 0)
    return format(
        "shared stretch has no along-axis constraint: {} places agree, none of which would show a "
        "displacement; drive on until both pass a junction or a niche",
        h.checked.size() - differing);
  if (evidence(h) < needed())
    return format("evidence {:.1f} of {:.1f}: {} of {} places agree, {} of them distinctive; {}", evidence(h),
                  needed(), h.checked.size() - differing, h.checked.size(), distinctive,
                  what_is_missing(h, distinctive));
  if (std::ssize(h.loops) < config_.min_loops)
    return format("{} loops agree, {} are needed; drive the same stretch on", h.loops.size(),
                  config_.min_loops);
  if (rival)
    return format(
        "two hypotheses {:.0f} m apart along the tunnel have similar support, evidence {:.1f} and "
        "{:.1f}; drive on until both pass something that only one of them explains",
        apart_m(which, *rival), evidence(h), evidence(hypotheses_[*rival]));
  return format(
      "{} of {} places along the shared stretch agree, {} of them distinctive: evidence {:.1f}, "
      "needed {:.1f}",
      h.checked.size() - differing, h.checked.size(), distinctive, evidence(h), needed());
}

MergeHypothesis MergeTest::described(std::size_t which, std::size_t best) const {
  const Hypothesis& h = hypotheses_[which];
  MergeHypothesis out;
  out.evidence = is_refuted(h) ? 0.0 : evidence(h);
  out.num_checked = static_cast<std::uint32_t>(h.checked.size());
  out.num_passed = static_cast<std::uint32_t>(h.checked.size() - num_differing(h.checked));
  out.from_best_m = apart_m(which, best);
  for (const std::size_t l : h.loops)
    out.loops.emplace_back(static_cast<std::uint32_t>(loops_[l].a), static_cast<std::uint32_t>(loops_[l].b));
  const auto is_near = [&] { return evidence(hypotheses_[best]) - evidence(h) < needed(); };
  if (!is_refuted(h)) {
    out.places = along_the_way(h);
    out.walls = walls_evidence(h);
  }
  out.outcome = is_refuted(h)   ? HypothesisOutcome::refuted
                : which == best ? HypothesisOutcome::unsure
                : is_near()     ? HypothesisOutcome::rival
                                : HypothesisOutcome::behind;
  return out;
}

MergeCheck MergeTest::verdict(RobotId a, RobotId b) const {
  MergeCheck out;
  out.a = a;
  out.b = b;
  out.needed = needed();
  const std::vector<std::size_t> order = best_first();
  if (order.empty()) {
    out.reason = "no loop was accepted; drive on until both robots have passed the same place";
    return out;
  }
  for (const std::size_t h : std::span(order).first(std::min(order.size(), kHypothesesPerCheck)))
    out.hypotheses.push_back(described(h, order.front()));
  MergeHypothesis& best = out.hypotheses.front();
  if (best.outcome != HypothesisOutcome::refuted) out.goes_on = measured_().look_alikes.chances();
  const bool has_rival = out.hypotheses.size() > 1 && out.hypotheses[1].outcome == HypothesisOutcome::rival;
  out.accepted = best.outcome != HypothesisOutcome::refuted && !has_rival &&
                 std::ssize(best.loops) >= config_.min_loops && is_finished(hypotheses_[order.front()]) &&
                 best.evidence >= out.needed;
  if (out.accepted) best.outcome = HypothesisOutcome::accepted;
  if (has_rival && best.evidence >= out.needed) best.outcome = HypothesisOutcome::rival;
  out.evidence = best.evidence;
  out.num_checked = best.num_checked;
  out.num_passed = best.num_passed;
  out.loops = best.loops;
  out.reason = reason(order.front(), has_rival ? std::optional(order[1]) : std::nullopt);
  return out;
}

}  // namespace adit
