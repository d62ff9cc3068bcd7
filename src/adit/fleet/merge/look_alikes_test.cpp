// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/look_alikes.hpp"

#include <gtest/gtest.h>

#include "adit/fleet/merge/merge_evidence.hpp"

namespace adit {
namespace {

TEST(LookAlikes, GoOnAsBelievedUntilSomethingIsKnown) {
  for (const std::size_t passed : {0U, 1U, 2U, 100U})
    EXPECT_DOUBLE_EQ(chance_to_go_on(LookAlikes({.prior_chance = 0.5}).chances(), passed), 0.5);
}

TEST(LookAlikes, ThatHaveGoneOnForLongAreTrustedToGoOn) {
  LookAlikes seen;
  for (int i = 0; i < 80; ++i) i < 8 ? seen.add_agreed(0) : seen.add_differed(0);  // nine of ten end at once,
  for (int i = 0; i < 80; ++i)
    i < 76 ? seen.add_agreed(7) : seen.add_differed(7);  // and those that passed seven go on
  EXPECT_EQ(chance_to_go_on(seen.chances(), 0), kFleetEvidence.least_chance);
  EXPECT_EQ(chance_to_go_on(seen.chances(), 6), kFleetEvidence.least_chance);
  EXPECT_GT(chance_to_go_on(seen.chances(), 7), 0.8);
  EXPECT_EQ(chance_to_go_on(seen.chances(), 14), chance_to_go_on(seen.chances(), 7));  // one phase
  EXPECT_EQ(chance_to_go_on(seen.chances(), 1000), chance_to_go_on(seen.chances(), 7));
}

TEST(LookAlikes, TheChanceNeverFallsWithTheWayThatTheyHaveGone) {
  LookAlikes seen;
  for (int i = 0; i < 80; ++i) i < 72 ? seen.add_agreed(0) : seen.add_differed(0);
  for (int i = 0; i < 80; ++i) seen.add_differed(3);  // a mere chance of this map
  EXPECT_GT(chance_to_go_on(seen.chances(), 0), 0.8);
  EXPECT_EQ(chance_to_go_on(seen.chances(), 3), chance_to_go_on(seen.chances(), 0));
}

}  // namespace
}  // namespace adit
