// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robust_kernel.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

// Black-Rangarajan duality: the weight minimises w r^2 + mu (1 - w) / (mu + w) c^2 over w in [0, 1] (RA-L
// 2020, equations 7 and 13). Here by trying all weights.
double tls_weight_by_search(double squared_residual, double squared_bound, double mu) {
  double best = 0.0;
  double least = 1e300;
  for (int k = 0; k <= 100000; ++k) {
    const double w = k * 1e-5;
    const double cost = w * squared_residual + mu * (1.0 - w) / (mu + w) * squared_bound;
    if (cost < least) {
      least = cost;
      best = w;
    }
  }
  return best;
}

TEST(TlsWeight, MinimisesTheSurrogateCost) {
  for (const double mu : {0.05, 1.0, 20.0}) {
    for (const double squared_residual : {0.0, 0.05, 0.5, 0.97, 1.0, 1.04, 1.9, 5.0, 30.0}) {
      EXPECT_NEAR(tls_weight(squared_residual, 1.0, mu), tls_weight_by_search(squared_residual, 1.0, mu),
                  1e-5)
          << "mu " << mu << ", r^2 " << squared_residual;
      EXPECT_NEAR(tls_weight(4.0 * squared_residual, 4.0, mu), tls_weight(squared_residual, 1.0, mu), 1e-12);
    }
  }
}

TEST(GemanMcClure, RootSquaredIsTheSlopeOfTheCost) {
  const double k = 0.04;
  const auto cost = [&](double squared) { return k * squared / (k + squared); };
  for (const double squared : {0.0, 0.01, 0.04, 0.5}) {
    const double root = geman_mcclure_root(k, squared);
    EXPECT_NEAR(root * root, (cost(squared + 1e-7) - cost(squared)) / 1e-7, 1e-4);
  }
  EXPECT_EQ(geman_mcclure_root(1.0F, 3.0F), 0.25F);
}

}  // namespace
}  // namespace adit
