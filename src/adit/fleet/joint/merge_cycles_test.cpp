// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/merge_cycles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "adit/core/rng.hpp"
#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "support/loop_information.hpp"

namespace adit {
namespace {

constexpr std::size_t kNodesOfChain = 200;
using Pair = std::pair<std::uint8_t, std::uint8_t>;

/// Robots that wind through a plane, with odometry that drifts as its covariances say, or `drift` times that.
struct RandomFleet {
  Rng rng;
  std::vector<std::vector<Pose>> truth;
  std::map<RobotId, OdometryChain> chains;
  std::vector<Merge> merges;
  std::vector<Merge> refuted;

  RandomFleet(std::uint64_t seed, int num_robots, double drift = 1.0) : rng(seed) {
    const Matrix6 covariance = random_walk({}, 1.0);
    for (std::uint8_t r = 0; r < num_robots; ++r) {
      std::vector<Pose> poses{
          Pose::planar(rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), rng.uniform(-3.0, 3.0))};
      std::vector<Pose> odometry{Pose()};
      for (std::size_t k = 1; k < kNodesOfChain; ++k) {
        const Pose step = Pose::planar(1.0, 0.0, 0.05 * rng.normal());
        poses.push_back(poses.back() * step);
        Vector6 noise;
        for (int i = 0; i < 6; ++i) noise(i) = drift * std::sqrt(covariance(i, i)) * rng.normal();
        odometry.push_back(odometry.back() * step * Pose::exp(noise));
      }
      truth.push_back(std::move(poses));
      chains.emplace(RobotId{r},
                     OdometryChain(odometry, std::vector<Matrix6>(kNodesOfChain - 1, covariance)));
    }
  }

  /// Loops along one stretch of 20 m; with `displaced` robot b is put elsewhere.
  void merge(Pair robots, double evidence, const Pose& displaced = {}) {
    Merge merge{{robots.first}, {robots.second}, evidence, {}};
    const std::size_t from_a = rng.below(kNodesOfChain - 20);
    const std::size_t from_b = rng.below(kNodesOfChain - 20);
    for (std::size_t k = 0; k < 20; k += 4) {
      const Pose T_a_b =
          truth[robots.first][from_a + k].inverse() * displaced * truth[robots.second][from_b + k];
      merge.loops.push_back({from_a + k, from_b + k, T_a_b, test::loop_information()});
    }
    merges.push_back(std::move(merge));
  }

  /// The same about a pair that did not merge.
  void refute(Pair robots, const Pose& displaced = {}) {
    merge(robots, -20.0, displaced);
    refuted.push_back(std::move(merges.back()));
    merges.pop_back();
  }

  /// The pairs that are taken back.
  [[nodiscard]] std::vector<Pair> taken_back() const {
    std::vector<Pair> out;
    for (const Contradiction& one : contradictions(merges, refuted, chains))
      out.emplace_back(merges[one.merge].a.value, merges[one.merge].b.value);
    return out;
  }
};

Pose elsewhere(Rng& rng) {
  const double heading = rng.uniform(-3.0, 3.0);
  const double by = rng.uniform(40.0, 120.0);
  return Pose::translation_of(by * std::cos(heading), by * std::sin(heading), 0.0);
}

TEST(MergeCycles, TrueMergesStay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const double drift : {0.3, 1.0, 2.5}) {
      RandomFleet fleet(seed, 5, drift);
      for (std::uint8_t a = 0; a < 5; ++a)
        for (std::uint8_t b = a + 1; b < 5; ++b) fleet.merge({a, b}, 10.0);
      EXPECT_TRUE(fleet.taken_back().empty()) << "seed " << seed << ", drift " << drift;
    }
}

TEST(MergeCycles, TheWrongOneOfATriangleGoesWhenItHasTheLeastEvidence) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 3);
    fleet.merge({0, 1}, 30.0);
    fleet.merge({1, 2}, 10.0, elsewhere(fleet.rng));
    fleet.merge({0, 2}, 20.0);
    EXPECT_EQ(fleet.taken_back(), (std::vector<Pair>{{1, 2}})) << "seed " << seed;
  }
}

TEST(MergeCycles, ASquareContradictsLikeATriangle) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 4);
    fleet.merge({0, 1}, 30.0);
    fleet.merge({1, 2}, 25.0);
    fleet.merge({2, 3}, 10.0, elsewhere(fleet.rng));
    fleet.merge({0, 3}, 20.0);
    const std::vector<Contradiction> found = contradictions(fleet.merges, {}, fleet.chains);
    ASSERT_EQ(found.size(), 1U) << "seed " << seed;
    EXPECT_EQ(found[0].merge, 2U);
    std::vector<std::size_t> others = found[0].others;
    std::ranges::sort(others);
    EXPECT_EQ(others, (std::vector<std::size_t>{0, 1, 3}));
    EXPECT_GT(found[0].miss_m, 20.0);
  }
}

TEST(MergeCycles, TheEdgeThatTwoTrianglesShareExplainsBothWhateverItsEvidence) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 4);
    fleet.merge({0, 1}, 10.0);
    fleet.merge({1, 2}, 10.0);
    fleet.merge({0, 2}, 50.0, elsewhere(fleet.rng));
    fleet.merge({2, 3}, 10.0);
    fleet.merge({0, 3}, 10.0);
    EXPECT_EQ(fleet.taken_back(), (std::vector<Pair>{{0, 2}})) << "seed " << seed;
  }
}

TEST(MergeCycles, AConsistentTriangleClearsTheEdgeThatItShares) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 4);
    fleet.merge({0, 1}, 20.0);
    fleet.merge({1, 2}, 12.0, elsewhere(fleet.rng));
    fleet.merge({0, 2}, 10.0);  // has the least evidence, but robot 3 confirms it
    fleet.merge({2, 3}, 20.0);
    fleet.merge({0, 3}, 20.0);
    EXPECT_EQ(fleet.taken_back(), (std::vector<Pair>{{1, 2}})) << "seed " << seed;
  }
}

// Two networks that look alike, two robots in each: the only merge between them closes no cycle, and three
// other pairs have seen that it is none.
TEST(MergeCycles, WhatOtherPairsRefutedTakesAWrongMergeBack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 4);
    const Pose copy = elsewhere(fleet.rng);
    fleet.merge({0, 1}, 20.0);
    fleet.merge({2, 3}, 20.0);
    fleet.merge({0, 3}, 40.0, copy);
    fleet.refute({0, 2}, copy);
    EXPECT_TRUE(fleet.taken_back().empty()) << "one refutation may be an error, seed " << seed;
    fleet.refute({1, 2}, copy);
    fleet.refute({1, 3}, copy);
    EXPECT_EQ(fleet.taken_back(), (std::vector<Pair>{{0, 3}})) << "seed " << seed;
  }
}

TEST(MergeCycles, RefutedHypothesesThatNoMergesImplyTakeNothingBack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFleet fleet(seed, 4);
    fleet.merge({0, 1}, 20.0);
    fleet.merge({2, 3}, 20.0);
    fleet.merge({0, 3}, 10.0);
    for (const Pair& pair : {Pair{0, 2}, Pair{1, 2}, Pair{1, 3}}) fleet.refute(pair, elsewhere(fleet.rng));
    EXPECT_TRUE(fleet.taken_back().empty()) << "seed " << seed;
  }
}

TEST(MergeCycles, AWrongMergeInNoCycleStays) {
  RandomFleet fleet(7, 5);
  fleet.merge({0, 1}, 30.0);
  fleet.merge({1, 2}, 30.0);
  fleet.merge({0, 2}, 30.0);
  fleet.merge({2, 3}, 10.0, elsewhere(fleet.rng));
  fleet.merge({3, 4}, 10.0);
  EXPECT_TRUE(fleet.taken_back().empty());
}

TEST(MergeCycles, TwoWrongMergesGoAndTheOrderOfArrivalMakesNoDifference) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomFleet fleet(seed, 5);
    const std::set<Pair> wrong = {{0, 3}, {1, 4}};
    for (std::uint8_t a = 0; a < 5; ++a)
      for (std::uint8_t b = a + 1; b < 5; ++b)
        fleet.merge({a, b}, fleet.rng.uniform(10.0, 50.0),
                    wrong.contains({a, b}) ? elsewhere(fleet.rng) : Pose());
    const std::vector<Pair> found = fleet.taken_back();
    EXPECT_EQ(std::set<Pair>(found.begin(), found.end()), wrong) << "seed " << seed;
    std::ranges::reverse(fleet.merges);
    EXPECT_EQ(fleet.taken_back(), found);
    std::rotate(fleet.merges.begin(), fleet.merges.begin() + 3, fleet.merges.end());
    EXPECT_EQ(fleet.taken_back(), found);
  }
}

TEST(MergeCycles, OneBadLoopCondemnsNoMerge) {
  RandomFleet fleet(3, 3);
  fleet.merge({0, 1}, 10.0);
  fleet.merge({1, 2}, 10.0);
  fleet.merge({0, 2}, 10.0);
  for (const std::size_t l : {std::size_t{0}, fleet.merges[0].loops.size() - 1}) {
    RandomFleet bad = fleet;
    bad.merges[0].loops[l].T_a_b = bad.merges[0].loops[l].T_a_b * Pose::planar(3.0, 1.0, 0.2);
    EXPECT_TRUE(bad.taken_back().empty());
  }
}

TEST(MergeCycles, ASlipOfTenSigmasIsDrift) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomFleet fleet(seed, 3);
    const OdometryChain& chain = fleet.chains.at({1});
    std::vector<Pose> slipped;
    for (std::size_t k = 0; k < kNodesOfChain; ++k)
      slipped.push_back(k < kNodesOfChain / 2
                            ? chain.pose(k)
                            : chain.pose(kNodesOfChain / 2) * Pose::translation_of(1.5, 0.0, 0.0) *
                                  chain.between(kNodesOfChain / 2, k));
    fleet.chains.erase({1});
    fleet.chains.emplace(
        RobotId{1}, OdometryChain(slipped, std::vector<Matrix6>(kNodesOfChain - 1, random_walk({}, 1.0))));
    fleet.merge({0, 1}, 10.0);
    fleet.merge({1, 2}, 10.0);
    fleet.merge({0, 2}, 10.0);
    EXPECT_TRUE(fleet.taken_back().empty()) << "seed " << seed;
  }
}

TEST(MergeCycles, ARefutationThatCannotBeComputedTakesNothingBack) {
  RandomFleet fleet(1, 4);
  fleet.merge({0, 1}, 20.0);
  fleet.merge({2, 3}, 20.0);
  fleet.merge({0, 3}, 10.0);
  for (const Pair& pair : {Pair{0, 2}, Pair{1, 2}, Pair{1, 3}}) fleet.refute(pair);
  EXPECT_FALSE(fleet.taken_back().empty());
  for (Merge& hypothesis : fleet.refuted)
    for (PcmLoop& loop : hypothesis.loops) loop.information.setZero();
  EXPECT_TRUE(fleet.taken_back().empty());
}

}  // namespace
}  // namespace adit
