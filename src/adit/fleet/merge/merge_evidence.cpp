// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_evidence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace adit {

double chance_to_go_on(const ChancesToGoOn& chances, std::size_t passed) {
  const std::size_t phase = std::min<std::size_t>(std::bit_width(passed + 1), chances.size()) - 1;
  return std::clamp(chances[phase], kFleetEvidence.least_chance, kFleetEvidence.agreement_if_true);
}

double evidence_of_agreement(const ChancesToGoOn& chances, std::size_t passed) {
  return std::log(kFleetEvidence.agreement_if_true / chance_to_go_on(chances, passed));
}

std::vector<double> evidence_at_places(const std::vector<TestedPlace>& places, const ChancesToGoOn& chances) {
  std::vector<double> evidence;
  std::size_t passed = 0;  // since places differed
  for (const TestedPlace& place : places) {
    double of_place = 0.0;
    if (place.outcome == PlaceOutcome::differs)
      of_place = std::log((1.0 - kFleetEvidence.agreement_if_true) /
                          (1.0 - chance_to_go_on(chances, std::exchange(passed, 0))));
    else if (place.outcome == PlaceOutcome::distinctive)
      of_place = evidence_of_agreement(chances, passed++);
    evidence.push_back(of_place);
  }
  return evidence;
}

double copied_to_true(std::size_t num_agreed, std::size_t num_differed) {
  const FleetEvidence& fleet = kFleetEvidence;
  const auto one_more = [](double share, double worth, std::size_t num, std::size_t num_all) {
    return (share * worth + static_cast<double>(num)) / (worth + static_cast<double>(num_all));
  };
  double ratio = 1.0;
  for (std::size_t i = 0; i < num_agreed; ++i)
    ratio *= one_more(fleet.agreement_if_copied, fleet.agreement_if_copied_worth, i, i) /
             one_more(fleet.agreement_if_true, fleet.agreement_if_true_worth, i, i);
  for (std::size_t i = 0; i < num_differed; ++i)
    ratio *= one_more(1.0 - fleet.agreement_if_copied, fleet.agreement_if_copied_worth, i, num_agreed + i) /
             one_more(1.0 - fleet.agreement_if_true, fleet.agreement_if_true_worth, i, num_agreed + i);
  return ratio;
}

CountedPlaces counted_places(const std::vector<TestedPlace>& places, const ChancesToGoOn& chances) {
  const std::vector<double> at_places = evidence_at_places(places, chances);
  const auto num = [&](PlaceOutcome outcome) {
    return static_cast<std::size_t>(std::ranges::count(places, outcome, &TestedPlace::outcome));
  };
  return {std::accumulate(at_places.begin(), at_places.end(), 0.0), num(PlaceOutcome::distinctive),
          num(PlaceOutcome::differs)};
}

double share_of_copies(const std::vector<CountedPlaces>& false_ones) {
  const double share = kFleetEvidence.copied;
  const double worth = kFleetEvidence.copied_worth;
  double num_copies = 0.0;
  for (const CountedPlaces& places : false_ones) {
    const double copied = share * copied_to_true(places.num_agreed, places.num_differed);
    num_copies += copied / (copied + (1.0 - share) * std::exp(-places.evidence));
  }
  return (share * worth + num_copies) / (worth + static_cast<double>(false_ones.size()));
}

double unless_copied(const CountedPlaces& places, double share) {
  return -std::log((1.0 - share) * std::exp(-places.evidence) +
                   share * copied_to_true(places.num_agreed, places.num_differed));
}

double poisson_tail(std::size_t k, double mean) {
  double fewer = 0.0;
  double term = std::exp(-mean);
  for (std::size_t i = 0; i < k; ++i) {
    fewer += term;
    term *= mean / static_cast<double>(i + 1);
  }
  return std::max(1.0 - fewer, 0.0);
}

}  // namespace adit
