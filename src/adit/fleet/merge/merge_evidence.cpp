// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_evidence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace adit {
namespace {

constexpr double kTrueCheck = 0.99;  // chance that scans do not differ where the alignment is true

}  // namespace

double chance_to_go_on(const ChancesToGoOn& chances, std::size_t passed) {
  const std::size_t phase = std::min<std::size_t>(std::bit_width(passed + 1), chances.size()) - 1;
  return std::min(chances[phase], kTrueCheck);
}

double evidence_of_agreement(const ChancesToGoOn& chances, std::size_t passed) {
  return std::log(kTrueCheck / chance_to_go_on(chances, passed));
}

std::vector<double> evidence_at_places(const std::vector<TestedPlace>& along_the_way,
                                       const ChancesToGoOn& chances) {
  std::vector<double> evidence;
  std::size_t passed = 0;  // since places differed
  for (const TestedPlace& place : along_the_way) {
    double of_place = 0.0;
    if (place.outcome == PlaceOutcome::differs)
      of_place = std::log((1.0 - kTrueCheck) / (1.0 - chance_to_go_on(chances, std::exchange(passed, 0))));
    else if (place.outcome == PlaceOutcome::tells)
      of_place = evidence_of_agreement(chances, passed++);
    evidence.push_back(of_place);
  }
  return evidence;
}

}  // namespace adit
