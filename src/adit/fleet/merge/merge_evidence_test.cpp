// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

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
