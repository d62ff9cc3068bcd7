// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/discernment.hpp"

#include "adit/fleet/merge/merge_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/fleet/merge/place_comparer.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"
#include "support/cancel_after.hpp"
#include "support/tube_drive.hpp"

namespace adit {
namespace {

using test::in_a_tube;
using test::kTubeStep;

std::vector<LoopCandidate> similar_places(const std::shared_ptr<const RobotMap>& map) {
  const SelfSimilarity others(map, chain_of(graph_of(*map)), {});
  std::vector<LoopCandidate> found;
  for (std::uint32_t k = 0; k < map->keyframes.size(); ++k)
    if (const auto match = others.most_similar(k); match && k < match->match.index) found.push_back(*match);
  return found;
}

struct OnAMap {
  explicit OnAMap(const std::shared_ptr<const RobotMap>& map)
      : discernment(map, chain_of(graph_of(*map)), [map] { return similar_places(map); },
                    std::make_shared<FeatureStore>(map, RegistrationConfig{}, SubmapConfig{}), {}) {}
  Discernment discernment;
};

TEST(Discernment, ADisplacementDoesNotShowInASmoothTubeAndDoesBesideABlock) {
  OnAMap smooth(in_a_tube({}));
  const std::vector<std::uint32_t> places = {40, 50, 60, 70};
  for (const bool is_distinctive : smooth.discernment.distinctive(places)) EXPECT_FALSE(is_distinctive);
  OnAMap with_block(in_a_tube({{{29.0, 1.5, -4.0}, {31.0, 4.0, 4.0}}}));
  const std::vector<bool> near = with_block.discernment.distinctive({56, 64});
  EXPECT_TRUE(near[0]);
  EXPECT_TRUE(near[1]);
}

// Stopped anywhere it remembers no place as compared that was not, in one of the two ways alone either.
TEST(Discernment, WhereComparingIsBrokenOffItIsDoneAgain) {
  const auto map = in_a_tube({{{29.0, 1.5, -4.0}, {31.0, 4.0, 4.0}}});
  const std::vector<std::uint32_t> places = {56, 64};
  const std::vector<bool> expected = OnAMap(map).discernment.distinctive(places);
  EXPECT_EQ(expected, (std::vector<bool>{true, true}));
  OnAMap broken_off(map);
  std::size_t num_stops = 0;
  for (bool is_done = false; !is_done; ++num_stops) {
    test::CancelAfter observer(num_stops);
    const ObserverScope scope(observer);
    try {
      EXPECT_EQ(broken_off.discernment.distinctive(places), expected) << num_stops;
      is_done = true;
    } catch (const Cancelled&) {
    }
  }
  EXPECT_GT(num_stops, 2U);
}

TEST(Discernment, ScansOfOnePlaceDoNotDifferAndThoseOfAnotherDo) {
  const auto map = in_a_tube({{{29.0, 1.5, -4.0}, {31.0, 4.0, 4.0}}});
  OnAMap measured(map);
  EXPECT_GT(measured.discernment.limit(), 0.0);
  EXPECT_LT(measured.discernment.limit(), 30.0);
  ViewStore& views = measured.discernment.views();
  views.prepare({20, 56, 58});
  const auto fit = [&](std::uint32_t a, std::uint32_t b, const Pose& T_a_b) {
    return fit_near(views.at(a), views.at(b), T_a_b, measured.discernment.limit(), {}).agreement;
  };
  EXPECT_FALSE(measured.discernment.differ(fit(56, 58, Pose::translation_of(1.0, 0, 0))));
  EXPECT_TRUE(measured.discernment.differ(fit(20, 56, Pose())));
}

// Wherever it stands it sees exactly the same.
TEST(Discernment, WhereNeighboursAgreePerfectlyThereIsALimitStill) {
  auto map = std::make_shared<RobotMap>(*in_a_tube({}));
  for (Keyframe& keyframe : map->keyframes) keyframe.cloud = map->keyframes.front().cloud;
  OnAMap measured(map);
  const AdaptiveConfig config;
  const double voxel = config.registration.voxel_size;
  EXPECT_EQ(measured.discernment.limit(), config.merge_check.evidence.least_difference_m2 / (voxel * voxel));
  PlaceComparer comparer(*map, measured.discernment, config.registration);
  EXPECT_EQ(comparer.within_own_map({{30, 80, Pose()}}).front().difference, 0.0);
}

TEST(Discernment, BlocksThatRepeatGoOnLongerThanBlocksThatDoNot) {
  std::vector<test::Box> repeating;
  std::vector<test::Box> irregular;
  Rng rng(4);
  for (double x = -40.0; x < 110.0; x += 10.0) {
    repeating.push_back({{x, 1.5, -4.0}, {x + 2.0, 4.0, 4.0}});
    const double at = x + rng.uniform(0.0, 6.0);
    const double side = rng.uniform() < 0.5 ? -4.0 : 1.5;
    irregular.push_back({{at, side, -4.0}, {at + rng.uniform(0.8, 3.0), side + 2.5, 4.0}});
  }
  OnAMap tiles(in_a_tube(repeating));
  const LookAlikes with_tiles = tiles.discernment.measured().look_alikes;
  const LookAlikes without = OnAMap(in_a_tube(irregular)).discernment.measured().look_alikes;
  for (const std::size_t passed : {0U, 1U, 5U, 40U}) {
    EXPECT_GT(chance_to_go_on(with_tiles.chances(), passed), 0.7);
    EXPECT_LT(chance_to_go_on(without.chances(), passed), 0.6);
  }
  // All of them were cast in one mould: their walls say little.
  EXPECT_LT(tiles.discernment.measured().walls.most_evidence(), 2.5);
}

TEST(Discernment, AHeadingThatWandersLeadsLessFar) {
  const auto straight = in_a_tube({});
  EXPECT_EQ(OnAMap(straight).discernment.reach_m(), 150.0);
  auto wandering = std::make_shared<RobotMap>(*straight);
  Rng rng(5);
  Pose T_odom_base;
  for (std::size_t k = 0; k < wandering->keyframes.size(); ++k) {
    if (k > 0) T_odom_base = T_odom_base * Pose::planar(kTubeStep, 0.0, 0.004 * rng.normal());
    wandering->keyframes[k].T_odom_base = T_odom_base;
  }
  const double reach = OnAMap(wandering).discernment.reach_m();
  EXPECT_LT(reach, 100.0);
  EXPECT_GE(reach, 50.0);
}

TEST(SelfSimilarity, NamesThePlaceThatLooksAlikeAndNoneNearBy) {
  const auto map = in_a_tube({{{15.0, 1.5, -2.0}, {17.0, 4.0, 1.0}}, {{45.0, 1.5, -2.0}, {47.0, 4.0, 1.0}}});
  const SelfSimilarity others(map, chain_of(graph_of(*map)), {});
  const auto match = others.most_similar(30);
  ASSERT_TRUE(match.has_value());
  EXPECT_NEAR(kTubeStep * match->match.index, 45.0, 4.0);  // 30 m farther, at the other block
  const std::vector<double> distances = others.distances();
  ASSERT_EQ(distances.size(), map->keyframes.size());
  EXPECT_EQ(distances[30], match->distance);
}

}  // namespace
}  // namespace adit
