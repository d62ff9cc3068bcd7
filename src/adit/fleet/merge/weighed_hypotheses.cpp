// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/weighed_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace adit {

WeighedHypotheses::WeighedHypotheses(LoopsBetween between, OwnMeasurements own, const AdaptiveConfig& config)
    : hypotheses_(hypotheses_of(between, own.reach_m, config)),
      own_(std::move(own)),
      config_(config.merge_check),
      needed_(
          std::log(spent_priors(hypotheses_, between.loops, between.earlier, config_.evidence.error_rate) /
                   config_.evidence.error_rate)) {
  loops_ = std::move(between.loops);
}

double WeighedHypotheses::apart_m(std::size_t one, std::size_t other) const {
  return one == other ? 0.0 : hypotheses_[std::max(one, other)].apart_m[std::min(one, other)];
}

bool WeighedHypotheses::differs_too_often(const Hypothesis& h) const {
  // One change is seen from many places: the places themselves are no independent trials. Where nearly all
  // differ, second looks are not waited for: there are as many, and most hypotheses are false.
  const std::size_t num_changes =
      differs_nearly_everywhere(h) ? h.num_changes_unless_explained() : h.num_changes();
  return are_too_many(num_changes, compared_km(h));
}

bool WeighedHypotheses::are_too_many(std::size_t num_changes, double km) const {
  return poisson_tail(num_changes, config_.evidence.changes_at_worst_per_km * km) <
         config_.evidence.refusal_rate;
}

/// By one place more than a true alignment does at worst.
bool WeighedHypotheses::differs_nearly_everywhere(const Hypothesis& h) const {
  const auto num = static_cast<double>(h.compared.size());
  const std::size_t first = std::min(static_cast<std::size_t>(config_.first_checks), h.plan.size());
  return h.compared.size() >= first &&
         static_cast<double>(h.num_differing()) >= config_.evidence.differing_at_worst * num + 1.0;
}

double WeighedHypotheses::compared_km(const Hypothesis& h) const {
  const double by_places = static_cast<double>(h.compared.size()) * config_.evidence.sight_m;
  const double whole = static_cast<double>(h.plan.size()) * config_.spacing_m + config_.evidence.sight_m;
  return std::min(by_places, whole) / 1000.0;
}

double WeighedHypotheses::evidence(const Hypothesis& h) const {
  return evidence_of_scans(h) + evidence_of_walls(h);
}

/// Whether loops are few does not tell them apart: the true one may be beside a copy that was found more
/// often.
double WeighedHypotheses::evidence_among_rivals(const Hypothesis& h) const {
  return evidence(h) - evidence_of_few_loops(h);
}

double WeighedHypotheses::prior_evidence(const Hypothesis& h) const {
  const auto num = static_cast<double>(h.loops.size());
  return h.known_before + std::log(num / static_cast<double>(loops_.size())) + evidence_of_few_loops(h);
}

/// Where robots shared a tunnel, search seldom finds it once or twice alone. That many loops agree is no
/// evidence in turn: where tunnels are copies they do, too.
double WeighedHypotheses::evidence_of_few_loops(const Hypothesis& h) const {
  const EvidenceModel& model = config_.evidence;
  return static_cast<double>(h.loops.size()) > model.few_loops
             ? 0.0
             : std::min(0.0, std::log(model.few_loops_if_true / model.few_loops_if_false));
}

double WeighedHypotheses::evidence_of_scans(const Hypothesis& h) const {
  return prior_evidence(h) + evidence_of_places(h.places(), share_of_copies_if_true(h));
}

/// Places not yet compared are taken to agree, each as if none had agreed before, and other alignments to be
/// no copies.
double WeighedHypotheses::most_evidence_of_scans(const Hypothesis& h) const {
  const std::size_t num_left = h.plan.size() - h.compared.size();
  CountedPlaces places = counted_places(h.places_at_best(), chances());
  places.evidence += static_cast<double>(num_left) * evidence_of_agreement(chances(), 0);
  places.num_agreed += num_left;
  const CountedPlaces no_copy = {-std::numeric_limits<double>::infinity()};
  const std::vector<CountedPlaces> others(hypotheses_.size() - 1, no_copy);
  return prior_evidence(h) + evidence_of_places(places, share_of_copies(others));
}

double WeighedHypotheses::evidence_of_places(const std::vector<TestedPlace>& places, double copies) const {
  return evidence_of_places(counted_places(places, chances()), copies);
}

double WeighedHypotheses::evidence_of_places(const CountedPlaces& places, double copies) const {
  return config_.relief ? unless_copied(places, copies) : places.evidence;
}

double WeighedHypotheses::share_of_copies_if_true(const Hypothesis& h) const {
  std::vector<CountedPlaces> others;
  for (const Hypothesis& other : hypotheses_)
    if (&other != &h && !other.compared.empty()) others.push_back(counted_places(other.places(), chances()));
  return share_of_copies(others);
}

double WeighedHypotheses::evidence_of_walls(const Hypothesis& h, double times) const {
  return config_.relief ? own_.measured().walls.evidence(h.offsets.counted(), times, walls_elsewhere(h))
                        : 0.0;
}

double WeighedHypotheses::most_evidence_of_walls(const Hypothesis& h) const {
  return config_.relief ? own_.measured().walls.most_evidence(walls_elsewhere(h)) : 0.0;
}

std::vector<EqualSignShare> WeighedHypotheses::walls_elsewhere(const Hypothesis& h) const {
  std::vector<EqualSignShare> shares;
  for (const Hypothesis& other : hypotheses_)
    if (&other != &h && !other.compared.empty()) shares.push_back(other.offsets.counted());
  return shares;
}

double WeighedHypotheses::lead(const Hypothesis& best, const Hypothesis& other) const {
  return evidence_among_rivals(best) - evidence_among_rivals(other);
}

double WeighedHypotheses::least_lead() const { return std::log(1.0 / config_.evidence.rival_rate); }

bool WeighedHypotheses::are_rivals(const Hypothesis& best, const Hypothesis& other) const {
  const double found = lead(best, other);
  return !differs_too_often(other) && !(found >= least_lead());
}

}  // namespace adit
