// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Merge checks of two robots in one straight tunnel, whose comparisons a test answers.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/fleet/merge/merge_checker.hpp"
#include "support/opposite_drives.hpp"

namespace adit::test {

/// That go on with this chance, however long they have.
inline LookAlikes look_alikes(double chance_to_go_on) {
  return LookAlikes({.prior_chance = chance_to_go_on});
}

/// What was measured beforehand.
inline MeasuredWhenAsked measured(const LookAlikes& look_alikes, const EqualSignShares& walls = {}) {
  return [all = Measured{look_alikes, walls}]() -> const Measured& { return all; };
}

/// Without walls, and no tunnel was built to the plan of another.
inline MergeCheckConfig by_places() {
  MergeCheckConfig config;
  config.relief = false;
  return config;
}

inline MergeChecker checker_of(const std::vector<PcmLoop>& loops, MeasuredWhenAsked measured,
                               const MergeCheckConfig& config = by_places(),
                               const OdometryChain& chain = along_x(kNum),
                               const MergeCheck* earlier = nullptr) {
  AdaptiveConfig all;
  all.merge_check = config;
  const OdometryChain other = chain;  // another robot: the same chain twice would mean revisits
  return {{chain, other, loops, {}, earlier}, {50.0, std::move(measured)}, all};
}

inline MergeChecker a_check(const std::vector<PcmLoop>& loops, double chance_to_go_on = 0.5,
                            const MergeCheckConfig& config = by_places()) {
  return checker_of(loops, measured(look_alikes(chance_to_go_on)), config);
}

/// Answers all that the test asks for.
template <class Answer>
MergeCheck run(MergeChecker& checker, const Answer& answer) {
  for (std::vector<PlannedComparison> asked = checker.next(16); !asked.empty(); asked = checker.next(16)) {
    EXPECT_LE(asked.size(), 16U);
    std::vector<ComparedPlace> places;
    for (const PlannedComparison& check : asked) places.push_back(answer(check));
    checker.add(places);
  }
  return checker.verdict({0}, {1});
}

inline constexpr ComparedPlace kAgrees{0.5, true};
inline constexpr ComparedPlace kDiffers{1.5, true};
inline constexpr ComparedPlace kSilent{0.5, false};
inline constexpr ComparedPlace kHasANiche{5.0, true};

/// A place that agrees, whose 100 patches of wall are off by `relief_m` (standard deviation) and all of them
/// by `range_error_m`, which an error of range may be; each seen twice with noise of 1 cm. Metres.
inline ComparedPlace agreeing_with_relief(std::uint32_t theirs, double relief_m, double range_error_m = 0.0) {
  ComparedPlace place = kAgrees;
  Rng rng(theirs);
  for (int i = 0; i < 100; ++i) {
    const double relief = relief_m * rng.normal();
    for (int scan = 0; scan < 2; ++scan) {
      place.offsets.push_back(
          {{static_cast<int>(theirs), i, 0, 0}, range_error_m + relief + 0.01 * rng.normal()});
      place.offsets.back().by_sensors[0] = 1.0;
    }
  }
  return place;
}

}  // namespace adit::test
