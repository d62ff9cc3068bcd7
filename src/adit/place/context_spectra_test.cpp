// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/context_spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// Cells rise and fall smoothly along the sectors, with noise; `share_seen` of the sectors are not empty.
ScanContext random_context(int num_rings, int num_sectors, double share_seen, Rng& rng) {
  std::vector<float> heights;
  const double phase = rng.uniform(0.0, 6.0);
  for (int s = 0; s < num_sectors; ++s) {
    const bool is_seen = rng.uniform() < share_seen;
    for (int r = 0; r < num_rings; ++r) {
      const double wave = 1.0 + std::sin(phase + 6.2832 * (r % 3 + 1) * s / num_sectors);
      heights.push_back(is_seen ? static_cast<float>(wave + 0.3 * rng.uniform()) : 0.0F);
    }
  }
  return from_heights(num_rings, num_sectors, heights);
}

void expect_bounds(int num_rings, int num_sectors, double share_seen) {
  Rng rng(static_cast<std::uint64_t>(num_rings * num_sectors));
  ContextSpectra spectra(num_rings, num_sectors);
  std::vector<ScanContext> contexts;
  for (std::size_t i = 0; i < 40; ++i) {
    contexts.insert(contexts.begin() + static_cast<std::ptrdiff_t>(i / 2),
                    random_context(num_rings, num_sectors, share_seen, rng));
    spectra.insert(i / 2, contexts[i / 2]);  // in the middle
  }
  for (int round = 0; round < 5; ++round) {
    const ScanContext context = random_context(num_rings, num_sectors, share_seen, rng);
    const ContextSpectra::Query query = spectra.query_of(context);
    std::vector<double> least;
    for (const ScanContext& other : contexts) least.push_back(compare_all_shifts(context, other).distance);
    auto all = spectra.candidates(query, 2.0F);
    std::vector<float> before(contexts.size(), -1e9F);
    for (std::size_t step = 0;; ++step) {
      for (const auto& candidate : all) {
        EXPECT_LE(candidate.bound, least[candidate.position]);
        EXPECT_GE(candidate.bound, before[candidate.position] - 1e-3F);  // one more frequency tells more
        before[candidate.position] = candidate.bound;
      }
      if (step == query.frequencies.size()) break;
      spectra.narrow(query, step, 2.0F, all);
    }
    for (std::size_t i = 0; i < contexts.size(); ++i) {
      const std::vector<float> most = spectra.most_by_shift(query, i);
      ASSERT_EQ(most.size(), static_cast<std::size_t>(num_sectors));
      for (int shift = 0; shift < num_sectors; ++shift) {
        double cosines = 0.0;
        const auto n = static_cast<std::size_t>(num_sectors);
        for (std::size_t s = 0; s < n; ++s) {
          const std::size_t t = (s + static_cast<std::size_t>(shift)) % n;
          for (std::size_t r = 0; r < static_cast<std::size_t>(num_rings); ++r)
            cosines +=
                static_cast<double>(context.unit_columns[s * static_cast<std::size_t>(num_rings) + r]) *
                static_cast<double>(contexts[i].unit_columns[t * static_cast<std::size_t>(num_rings) + r]);
        }
        EXPECT_GE(most[static_cast<std::size_t>(shift)], cosines);
      }
    }
  }
}

TEST(ContextSpectra, BoundsAreNeverAboveTheDistance) {
  expect_bounds(20, 60, 1.0);
  expect_bounds(20, 60, 0.8);
  expect_bounds(20, 60, 0.2);
  expect_bounds(7, 5, 0.9);
  expect_bounds(1, 3, 1.0);
  expect_bounds(40, 12, 0.9);  // half the sectors is a frequency of its own
}

TEST(ContextSpectra, FewFrequenciesTellSmoothContextsApart) {
  Rng rng(3);
  ContextSpectra spectra(20, 60);
  std::vector<ScanContext> contexts;
  for (std::size_t i = 0; i < 100; ++i) {
    contexts.push_back(random_context(20, 60, 1.0, rng));
    spectra.insert(i, contexts.back());
  }
  const auto query = spectra.query_of(contexts[17]);
  auto near = spectra.candidates(query, 0.01F);
  for (std::size_t step = 0; step < query.frequencies.size(); ++step)
    spectra.narrow(query, step, 0.01F, near);
  EXPECT_LT(near.size(), 100U);
  EXPECT_TRUE(std::ranges::any_of(near, [](const auto& candidate) { return candidate.position == 17; }));
}

TEST(ContextSpectra, EmptyContextsAreNoCandidates) {
  ContextSpectra spectra(20, 60);
  spectra.insert(0, from_heights(20, 60, std::vector<float>(1200, 0.0F)));
  Rng rng(4);
  EXPECT_TRUE(spectra.candidates(spectra.query_of(random_context(20, 60, 1.0, rng)), 1.0F).empty());
}

}  // namespace
}  // namespace adit
