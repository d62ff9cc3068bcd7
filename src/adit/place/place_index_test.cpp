// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/place_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr RobotId kSelf{0};
constexpr RobotId kOther{1};

/// A ring of walls whose distance is a smooth random function of the angle: places look alike, but not the
/// same.
ScanContext random_place(Rng& rng, double turn = 0.0, std::uint64_t seed = 0) {
  Rng shape(seed == 0 ? rng() : seed);
  const double a = shape.uniform(5.0, 25.0);
  const double b = shape.uniform(0.0, 20.0);
  const double phase = shape.uniform(0.0, 6.0);
  const double c = shape.uniform(0.0, 10.0);
  PointCloud cloud;
  for (int i = 0; i < 720; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.3) / 720.0;
    const double radius =
        a + b * (1.0 + std::sin(angle + phase)) + c * (1.0 + std::cos(3.0 * angle)) + rng.uniform(0, 0.2);
    cloud.points.emplace_back(static_cast<float>(radius * std::cos(angle - turn)),
                              static_cast<float>(radius * std::sin(angle - turn)),
                              static_cast<float>(3.0 + std::sin(5.0 * angle + phase)));
  }
  return describe(cloud, {});
}

PlaceIndexConfig config_of(PlaceSearch search, double max_distance = 1.0) {
  PlaceIndexConfig config;
  config.search = search;
  config.max_distance = max_distance;
  return config;
}

void expect_nearest(const std::vector<LoopCandidate>& found, std::vector<LoopCandidate> all,
                    std::size_t wanted) {
  std::ranges::stable_sort(all, {}, &LoopCandidate::distance);
  all.resize(std::min(all.size(), wanted));
  ASSERT_EQ(found.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(found[i].match, all[i].match);
    EXPECT_EQ(found[i].distance, all[i].distance);
    EXPECT_EQ(found[i].yaw, all[i].yaw);
  }
}

TEST(PlaceIndex, FindsThePlaceAndTheTurn) {
  Rng rng(1);
  PlaceIndex index(config_of(PlaceSearch::ring_key, 0.2));
  for (std::uint32_t i = 0; i < 200; ++i) index.add({kOther, i}, random_place(rng, 0.0, 1000 + i));
  EXPECT_EQ(index.size(), 200U);
  for (std::uint32_t i = 0; i < 200; i += 7) {
    const double turn = 0.1 * std::numbers::pi * (i % 20);
    const auto found = index.best_match({kSelf, 9}, random_place(rng, turn, 1000 + i), kOther);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->match, (KeyframeId{kOther, i}));
    EXPECT_EQ(found->query, (KeyframeId{kSelf, 9}));
    EXPECT_NEAR(wrap_angle(found->yaw - turn), 0.0, 0.06);  // Half a sector.
    EXPECT_LT(found->distance, 0.1);
  }
}

/// With a tenth of the sectors seen by neither, one or both; and all of them the same but for the turn.
ScanContext patchy_place(Rng& rng) {
  ScanContext place = random_place(rng, rng.uniform(0.0, 6.0), 77 + rng.below(40));
  std::vector<float> heights;
  for (int s = 0; s < place.num_sectors; ++s) {
    const bool is_seen = rng.uniform() < 0.9;
    for (int r = 0; r < place.num_rings; ++r) heights.push_back(is_seen ? place.height(r, s) : 0.0F);
  }
  return from_heights(place.num_rings, place.num_sectors, heights);
}

TEST(PlaceIndex, BruteForceFindsWhatComparingWithAllFinds) {
  Rng rng(8);
  for (const bool is_patchy : {false, true}) {
    for (const double max_distance : {0.1, 0.4, 1.0}) {
      PlaceIndex brute(config_of(PlaceSearch::brute_force, max_distance));
      const auto place = [&] { return is_patchy ? patchy_place(rng) : random_place(rng); };
      std::vector<ScanContext> places;
      for (std::uint32_t i = 0; i < 300; ++i) {
        places.push_back(i % 7 == 6 ? places[i / 2] : place());  // equal ones too
        brute.add({kOther, i}, places.back());
      }
      for (int round = 0; round < 10; ++round) {
        const ScanContext query = place();
        std::vector<LoopCandidate> all;
        for (std::uint32_t i = 0; i < places.size(); ++i) {
          const ContextMatch match = compare(query, places[i]);
          if (match.distance <= max_distance)
            all.push_back({{kSelf, 0}, {kOther, i}, match.yaw, match.distance});
        }
        for (const std::size_t wanted : {1U, 5U, 1000U})
          expect_nearest(brute.best_matches({kSelf, 0}, query, kOther, wanted), all, wanted);
      }
    }
  }
}

TEST(PlaceIndex, RingKeysFindNothingNearerThanBruteForceAndOftenTheSame) {
  Rng rng(2);
  PlaceIndex brute(config_of(PlaceSearch::brute_force));
  PlaceIndex fast(config_of(PlaceSearch::ring_key));
  for (std::uint32_t i = 0; i < 150; ++i) {
    const ScanContext place = random_place(rng);
    brute.add({kOther, i}, place);
    fast.add({kOther, i}, place);
  }
  int agreed = 0;
  for (int round = 0; round < 30; ++round) {
    const ScanContext query = random_place(rng);
    const auto exact = brute.best_match({kSelf, 0}, query, kOther);
    const auto quick = fast.best_match({kSelf, 0}, query, kOther);
    ASSERT_TRUE(exact && quick);
    EXPECT_GE(quick->distance, exact->distance);
    agreed += exact->match == quick->match ? 1 : 0;
  }
  EXPECT_GT(agreed, 3);
}

TEST(PlaceIndex, ManyCandidatesAreBruteForce) {
  Rng rng(3);
  PlaceIndexConfig config = config_of(PlaceSearch::ring_key);
  config.num_candidates = 1000;
  PlaceIndex all(config);
  PlaceIndex brute(config_of(PlaceSearch::brute_force));
  for (std::uint32_t i = 0; i < 60; ++i) {
    const ScanContext place = random_place(rng);
    all.add({kOther, i}, place);
    brute.add({kOther, i}, place);
  }
  const ScanContext query = random_place(rng);
  const auto a = all.best_matches({kSelf, 0}, query, kOther, 60);
  const auto b = brute.best_matches({kSelf, 0}, query, kOther, 60);
  ASSERT_EQ(a.size(), 60U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].match, b[i].match);
    if (i > 0) {
      EXPECT_GE(a[i].distance, a[i - 1].distance);
    }
  }
}

TEST(PlaceIndex, TiesGoToTheSmallestIdInAnyOrderOfAdding) {
  Rng rng(4);
  const ScanContext same = random_place(rng);
  std::vector<std::uint32_t> order = {7, 3, 99, 12, 4, 50, 41, 42, 43, 44, 45, 46, 47, 48};
  for (int round = 0; round < 4; ++round) {
    PlaceIndex index({});
    for (const std::uint32_t i : order) index.add({kOther, i}, same);
    EXPECT_EQ(index.best_match({kSelf, 0}, same, kOther)->match.index, 3U);
    std::rotate(order.begin(), order.begin() + 3, order.end());
  }
}

TEST(PlaceIndex, RecentKeyframesOfTheSameRobotAreLeftOut) {
  Rng rng(5);
  const ScanContext same = random_place(rng);
  PlaceIndex index({});
  for (std::uint32_t i = 0; i <= 120; ++i) index.add({kSelf, i}, same);
  EXPECT_EQ(index.best_match({kSelf, 120}, same, kSelf)->match.index, 0U);
  const auto of_sixty = index.best_matches({kSelf, 60}, same, kSelf, 1000);
  for (const LoopCandidate& candidate : of_sixty) {
    EXPECT_GT(std::abs(static_cast<int>(candidate.match.index) - 60), 50);
  }
  EXPECT_FALSE(index.best_match({kSelf, 60}, same, kOther));
  EXPECT_TRUE(
      index.best_match({kOther, 60}, same, kSelf));  // Nearness in index means nothing between robots.
  PlaceIndex young({});
  for (std::uint32_t i = 0; i <= 50; ++i) young.add({kSelf, i}, same);
  EXPECT_FALSE(young.best_match({kSelf, 50}, same, kSelf));
}

TEST(PlaceIndex, NothingBeyondTheThresholdAndNothingFromNothing) {
  Rng rng(6);
  PlaceIndex index(config_of(PlaceSearch::ring_key, 0.0));
  EXPECT_FALSE(index.best_match({kSelf, 0}, random_place(rng), kOther));
  index.add({kOther, 0}, random_place(rng));
  EXPECT_FALSE(index.best_match({kSelf, 0}, random_place(rng), kOther));
  PlaceIndex lenient(config_of(PlaceSearch::ring_key, 1.0));
  const ScanContext empty = describe({}, {});
  lenient.add({kOther, 0}, empty);
  EXPECT_FALSE(lenient.best_match({kSelf, 0}, random_place(rng), kOther));
  EXPECT_FALSE(lenient.best_match({kSelf, 0}, empty, kOther));
  EXPECT_EQ(lenient.size(), 1U);
}

TEST(PlaceIndex, MisuseIsABug) {
  Rng rng(7);
  PlaceIndex index({});
  index.add({kOther, 0}, random_place(rng));
  EXPECT_THROW(index.add({kOther, 0}, random_place(rng)), ContractViolation);
  EXPECT_THROW(index.add({kOther, 1}, describe({}, {.num_rings = 10})), ContractViolation);
  EXPECT_THROW(index.add({kOther, 1}, ScanContext{}), ContractViolation);
  EXPECT_THROW(PlaceIndex(config_of(PlaceSearch::ring_key, -1.0)), ContractViolation);
}

}  // namespace
}  // namespace adit
