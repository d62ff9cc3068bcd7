// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/registration/descriptor_block.hpp"
#include "adit/registration/descriptor_index.hpp"

namespace adit {
namespace {

/// Around one of a few prototypes, so that there are near, far and equal ones.
std::vector<Descriptor> random_descriptors(std::uint64_t seed, std::size_t n, std::uint64_t spread) {
  Rng rng(seed);
  std::vector<Descriptor> out(n);
  for (Descriptor& descriptor : out) {
    const std::size_t prototype = rng.below(5);
    for (std::size_t d = 0; d < descriptor.size(); ++d) {
      descriptor[d] = static_cast<std::uint8_t>((d % 5 == prototype ? 12U : 0U) + rng.below(spread));
    }
  }
  return out;
}

NearestTwo nearest_by_brute_force(const Descriptor& query, const std::vector<Descriptor>& all) {
  constexpr std::uint32_t kFar = 1000000;
  NearestTwo out{0, kFar, kFar};
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const std::uint32_t distance = squared_distance(query, all[i]);
    if (distance < out.squared_distance) {
      out = {i, distance, out.squared_distance};
    } else {
      out.second_squared_distance = std::min(out.second_squared_distance, distance);
    }
  }
  return out;
}

TEST(DescriptorIndex, AgreesWithBruteForce) {
  for (const std::uint64_t spread : {2U, 4U, 12U}) {  // 2: many exact ties
    const auto all = random_descriptors(1, 777, spread);
    const DescriptorIndex index(all);
    for (const Descriptor& query : random_descriptors(2, 300, spread)) {
      const NearestTwo expected = nearest_by_brute_force(query, all);
      EXPECT_EQ(index.nearest_two(query, 60000), expected);
      EXPECT_FALSE(index.any_nearer(query, expected.squared_distance, expected.index));
      EXPECT_TRUE(index.any_nearer(query, expected.squared_distance + 1, expected.index + 1000));
    }
  }
}

TEST(DescriptorBlock, AgreesWithTheDefinition) {
  const auto all = random_descriptors(7, 13, 45);
  DescriptorBlock block;
  for (std::uint32_t i = 0; i < all.size(); ++i) block.append(all[i], 100 + i);
  for (const Descriptor& descriptor : random_descriptors(8, 50, 45)) {
    const DescriptorQuery query(descriptor);
    std::array<std::uint16_t, DescriptorBlock::kLanes> distances{};
    std::array<std::uint16_t, DescriptorBlock::kLanes> expected{};
    for (const std::uint16_t bound : {std::uint16_t{0}, std::uint16_t{25000}, std::uint16_t{65535}}) {
      EXPECT_EQ(near_lanes(block, query, bound, distances),
                near_lanes_by_definition(block, query, bound, expected));
      EXPECT_EQ(distances, expected);
    }
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(distances[i], squared_distance(descriptor, all[i]));
  }
}

TEST(DescriptorBlock, TakesNoMoreThanItHasLanesFor) {
  DescriptorBlock block;
  for (std::uint32_t i = 0; i < DescriptorBlock::kLanes; ++i) block.append(Descriptor{}, i);
  EXPECT_THROW(block.append(Descriptor{}, 16), ContractViolation);
  EXPECT_EQ(block.count, DescriptorBlock::kLanes);
}

TEST(DescriptorIndex, KeepsToItsBound) {
  Descriptor far{};
  far[0] = 50;
  const DescriptorIndex index({far});
  EXPECT_FALSE(index.nearest_two({}, 2499).has_value());
  EXPECT_EQ(index.nearest_two({}, 2500), (NearestTwo{0, 2500, 2500}));
  EXPECT_EQ(index.nearest_two({}, 3000), (NearestTwo{0, 2500, 3000}));  // no second: the bound
  EXPECT_FALSE(DescriptorIndex({}).nearest_two({}, 60000).has_value());
}

TEST(DescriptorIndex, RefusesDescriptorsWhoseDistancesOverflow) {
  Descriptor huge{};
  huge.fill(255);
  EXPECT_THROW(DescriptorIndex({huge}), ContractViolation);
}

std::vector<Correspondence> matches_by_brute_force(const std::vector<Descriptor>& a,
                                                   const std::vector<Descriptor>& b,
                                                   const RegistrationConfig& config) {
  std::vector<Correspondence> out;  // a is the smaller
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    const NearestTwo there = nearest_by_brute_force(a[i], b);
    if (nearest_by_brute_force(b[there.index], a).index != i) continue;
    const double max_squared = config.max_descriptor_distance * config.max_descriptor_distance;
    if (there.squared_distance > max_squared) continue;
    if (there.squared_distance >= config.max_ratio * there.second_squared_distance) continue;
    out.push_back({i, there.index, 0.0F});
  }
  return out;
}

TEST(Matching, AgreesWithBruteForceInBothDirections) {
  const auto a = random_descriptors(3, 300, 12);
  auto b = random_descriptors(4, 500, 12);
  const auto noise = random_descriptors(5, 200, 3);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    b[i] = a[i + 50];
    for (std::size_t d = 0; d < kDescriptorSize; ++d)
      b[i][d] = static_cast<std::uint8_t>(b[i][d] + noise[i][d] / 3);
  }
  for (const double max_distance : {15.0, 30.0}) {
    RegistrationConfig config;
    config.max_descriptor_distance = max_distance;
    config.max_ratio = 0.95;
    auto expected = matches_by_brute_force(a, b, config);
    auto forward = match_descriptors(a, b, config);
    auto backward = match_descriptors(b, a, config);
    EXPECT_GT(forward.size(), 50U);
    for (Correspondence& c : forward) c.ratio = 0.0F;
    EXPECT_EQ(forward, expected);
    for (Correspondence& c : backward) {
      c.ratio = 0.0F;
      std::swap(c.a, c.b);
    }
    std::sort(backward.begin(), backward.end(),
              [](const Correspondence& x, const Correspondence& y) { return x.a < y.a; });
    EXPECT_EQ(backward, expected);
  }
}

TEST(Matching, KeepsTheMostDistinctive) {
  const auto a = random_descriptors(5, 300, 12);
  auto b = a;
  for (Descriptor& descriptor : b) ++descriptor[7];
  RegistrationConfig config;
  const auto all = match_descriptors(a, b, config);
  config.max_correspondences = 10;
  const auto best = match_descriptors(a, b, config);
  ASSERT_GT(all.size(), 50U);
  ASSERT_EQ(best.size(), 10U);
  float worst = 0.0F;
  for (const Correspondence& c : best) worst = std::max(worst, c.ratio);
  const auto better =
      std::count_if(all.begin(), all.end(), [&](const Correspondence& c) { return c.ratio < worst; });
  EXPECT_LT(better, 10);
}

TEST(Matching, OfNothingIsNothing) {
  const auto some = random_descriptors(6, 5, 12);
  EXPECT_TRUE(match_descriptors({}, some, {}).empty());
  EXPECT_TRUE(match_descriptors(some, {}, {}).empty());
  // all alike: nothing is distinctive
  EXPECT_TRUE(
      match_descriptors(std::vector<Descriptor>(40, some[0]), std::vector<Descriptor>(50, some[0]), {})
          .empty());
}

}  // namespace
}  // namespace adit
