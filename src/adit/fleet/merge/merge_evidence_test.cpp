// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr ChancesToGoOn kOfLookAlikes = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9};

/// Whether the next place agrees, by what the places before it showed.
using Agrees = std::function<bool(Rng&, const std::vector<TestedPlace>&)>;

/// As often as Polya's urn says of a share that is not known.
Agrees by_urn(double share, double worth) {
  return [=](Rng& rng, const std::vector<TestedPlace>& before) {
    const auto agreed =
        static_cast<double>(std::ranges::count(before, PlaceOutcome::distinctive, &TestedPlace::outcome));
    return rng.uniform() < (share * worth + agreed) / (worth + static_cast<double>(before.size()));
  };
}

bool look_alike_agrees(Rng& rng, const std::vector<TestedPlace>& before) {
  const auto last =
      std::ranges::find(before.rbegin(), before.rend(), PlaceOutcome::differs, &TestedPlace::outcome);
  return rng.uniform() < chance_to_go_on(kOfLookAlikes, static_cast<std::size_t>(last - before.rbegin()));
}

/// The share of drives past 60 places whose evidence reaches `needed` at any place, asked at each.
double share_that_reaches(double needed, double copied, std::uint64_t seed, const Agrees& agrees) {
  constexpr int kDrives = 3000;
  Rng rng(seed);
  int num = 0;
  for (int drive = 0; drive < kDrives; ++drive) {
    std::vector<TestedPlace> places;
    double most = -1e9;
    while (places.size() < 60 && most < needed) {
      places.push_back({.outcome = agrees(rng, places) ? PlaceOutcome::distinctive : PlaceOutcome::differs});
      most = std::max(most, unless_copied(counted_places(places, kOfLookAlikes), copied));
    }
    num += most >= needed;
  }
  return static_cast<double>(num) / kDrives;
}

TEST(MergeEvidence, PoissonTail) {
  EXPECT_DOUBLE_EQ(poisson_tail(0, 2.0), 1.0);
  EXPECT_NEAR(poisson_tail(1, 2.0), 1.0 - std::exp(-2.0), 1e-12);
  EXPECT_NEAR(poisson_tail(3, 2.0), 1.0 - 5.0 * std::exp(-2.0), 1e-12);
  EXPECT_DOUBLE_EQ(poisson_tail(1, 0.0), 0.0);
}

TEST(MergeEvidence, PlacesAloneDoNotTellATunnelFromOneBuiltToTheSamePlan) {
  EXPECT_NEAR(unless_copied({2.0, 5, 0}, kFleetEvidence.copied), 2.0, 0.1);
  EXPECT_NEAR(unless_copied({-20.0, 5, 0}, kFleetEvidence.copied), -20.0, 0.1);
  const double of_rarity = std::log(1.0 / kFleetEvidence.copied);
  EXPECT_LT(unless_copied({30.0, 10, 0}, kFleetEvidence.copied), of_rarity + 1.5);
  EXPECT_GT(unless_copied({30.0, 10, 0}, kFleetEvidence.copied), of_rarity)
      << "copies seldom agree that well";
  EXPECT_LT(unless_copied({1000.0, 200, 0}, kFleetEvidence.copied), of_rarity + 3.1)
      << "but some do, and then everywhere";
}

TEST(MergeEvidence, ManyChangesTellACopyFromATunnelThatHasChanged) {
  // Decision 0079: robots 1 and 3 of metro-copies-2101, merged wrongly.
  EXPECT_LT(unless_copied({28.9, 47, 16}, kFleetEvidence.copied),
            std::log(1.0 / kFleetEvidence.copied) - 1.0);
  for (std::size_t differed = 0; differed < 20; ++differed)
    EXPECT_GT(copied_to_true(30, differed + 1), copied_to_true(30, differed));
  EXPECT_LT(copied_to_true(31, 3), copied_to_true(30, 3));
}

TEST(MergeEvidence, WhereOneLookAlikeIsACopyThereAreMore) {
  const CountedPlaces by_chance = {-12.0, 2, 6};
  const CountedPlaces copy = {23.0, 15, 2};
  EXPECT_EQ(share_of_copies({}), kFleetEvidence.copied);
  EXPECT_LT(share_of_copies({by_chance, by_chance}), kFleetEvidence.copied);
  EXPECT_GT(share_of_copies({by_chance, by_chance}), 0.5 * kFleetEvidence.copied) << "others may be copies";
  const double one = share_of_copies({copy, by_chance});
  EXPECT_NEAR(
      one, (kFleetEvidence.copied * kFleetEvidence.copied_worth + 1.0) / (kFleetEvidence.copied_worth + 2.0),
      1e-3);
  EXPECT_GT(share_of_copies({copy, copy, by_chance}), one);
  EXPECT_LT(share_of_copies({copy, by_chance, by_chance}), one);
  // The own map knows such look-alikes: they need not be copies to agree that long.
  EXPECT_LT(share_of_copies({{1.0, 15, 2}}), 2.0 * kFleetEvidence.copied);
  EXPECT_NEAR(unless_copied(copy, kFleetEvidence.copied) - unless_copied(copy, one),
              std::log(one / kFleetEvidence.copied), 0.01);
}

// What a repeated meeting adds is more places of the same alignment. Likelihood ratios that go on are a
// martingale where the alignment is false: asked at every place, as few reach a threshold as if asked once
// (J. Ville, 1939). So the meetings of two robots spend one error rate, however many they are.
TEST(MergeEvidence, FalseAlignmentsReachAThresholdAsSeldomAsItStatesHoweverOftenTheyAreAsked) {
  const FleetEvidence& fleet = kFleetEvidence;
  const double needed = 3.0;
  for (const double copied : {fleet.copied, 0.2}) {
    const double look_alikes = share_that_reaches(needed, copied, 1, look_alike_agrees);
    const double copies = share_that_reaches(
        needed, copied, 2, by_urn(fleet.agreement_if_copied, fleet.agreement_if_copied_worth));
    EXPECT_LT((1.0 - copied) * look_alikes + copied * copies, std::exp(-needed)) << copied;
    EXPECT_GT(look_alikes + copies, 0.0) << "a threshold that none reaches shows nothing";
  }
  EXPECT_GT(share_that_reaches(needed, fleet.copied, 3,
                               by_urn(fleet.agreement_if_true, fleet.agreement_if_true_worth)),
            0.9);
}

// It does not matter in which order places are counted.
TEST(MergeEvidence, SharesThatAreNotKnownAreThoseOfTheBetaBinomialDistribution) {
  const auto log_of = [](double share, double worth, double agreed, double differed) {
    const double a = share * worth;
    const double b = worth - a;
    const auto log_beta = [](double x, double y) {
      return std::lgamma(x) + std::lgamma(y) - std::lgamma(x + y);
    };
    return log_beta(a + agreed, b + differed) - log_beta(a, b);
  };
  const FleetEvidence& fleet = kFleetEvidence;
  for (const std::size_t agreed : {0U, 1U, 12U, 60U})
    for (const std::size_t differed : {0U, 1U, 9U})
      EXPECT_NEAR(std::log(copied_to_true(agreed, differed)),
                  log_of(fleet.agreement_if_copied, fleet.agreement_if_copied_worth,
                         static_cast<double>(agreed), static_cast<double>(differed)) -
                      log_of(fleet.agreement_if_true, fleet.agreement_if_true_worth,
                             static_cast<double>(agreed), static_cast<double>(differed)),
                  1e-9);
}

}  // namespace
}  // namespace adit
