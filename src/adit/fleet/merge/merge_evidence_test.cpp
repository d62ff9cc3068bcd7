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
  EXPECT_NEAR(unless_copied(2.0, 5.0), 2.0, 0.1);
  EXPECT_NEAR(unless_copied(-20.0, 5.0), -20.0, 0.1);
  EXPECT_LT(unless_copied(30.0, 10.0), std::log(1.0 / kFleetEvidence.copied) + 0.6);
  EXPECT_GT(unless_copied(100.0, 150.0), std::log(1e3)) << "but no plan was built twice all over";
}

}  // namespace
}  // namespace adit
