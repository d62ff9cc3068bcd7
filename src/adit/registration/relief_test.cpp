// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/relief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/registration/agreement.hpp"
#include "adit/registration/features.hpp"

namespace adit {
namespace {

constexpr double kRadius = 4.0;       // metres, of a tube along x
constexpr double kPointNoise = 0.03;  // metres, of one point
constexpr double kRelief = 0.012;     // metres, of the rock

// The relief of the rock in the tunnel of that seed: waves of a few metres.
double rock(std::uint64_t tunnel, double x, double angle) {
  Rng rng(tunnel);
  double out = 0.0;
  for (int wave = 1; wave <= 4; ++wave) {
    const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
    out += std::sin(x * rng.uniform(0.5, 1.5) + std::round(rng.uniform(-4.0, 4.0)) * angle + phase);
  }
  return kRelief * out / std::sqrt(2.0);
}

// The tunnel seen by a LiDAR on its axis, at x, whose ranges are too long by `bias`.
SeenSurface seen(std::uint64_t tunnel, double x, std::uint64_t noise, double bias = 0.0) {
  Rng rng(noise);
  PointCloud cloud;
  for (int i = 0; i < 6000; ++i) {
    const double along = rng.uniform(-12.0, 12.0);
    const double angle = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const double r = kRadius + rock(tunnel, x + along, angle) + kPointNoise * rng.normal();
    cloud.points.emplace_back(static_cast<float>(along), static_cast<float>(r * std::cos(angle)),
                              static_cast<float>(r * std::sin(angle)));
    cloud.points.back() += static_cast<float>(bias) * cloud.points.back().normalized();
  }
  return {compute_surface(cloud, {}), Vector3::Zero(), RegistrationConfig().voxel_size};
}

// One robot drove through `first`, the other through `second`, which coincide except for the rock; the second
// robot stands `ahead` metres of the first each time, and its ranges are too long by `bias`.
WallOffsets driven(std::uint64_t first, std::uint64_t second, int num_pairs = 8, double ahead = 1.0,
                   double bias = 0.0) {
  WallOffsets offsets;
  for (int i = 0; i < num_pairs; ++i) {
    const double x = 3.0 * i;
    const auto noise = static_cast<std::uint64_t>(2 * i + 100);
    offsets.add(patch_offsets(seen(first, x, noise), seen(second, x + ahead, noise + 1, bias),
                              Pose::translation_of(ahead, 0.0, 0.0), Pose::translation_of(x, 0.0, 0.0), {}));
  }
  return offsets;
}

EqualSignShare found(double share, std::size_t num_patches = 1000) {
  return {num_patches, share, 0.5 / std::sqrt(static_cast<double>(num_patches))};
}

EqualSignShares where_others_agree(double share, int num_stretches = 5) {
  EqualSignShares shares;
  for (int i = 0; i < num_stretches; ++i) shares.add_other(found(share));
  return shares;
}

PatchOffset offset_of(const WallPatch& patch, double metres) { return {patch, metres}; }

// A thousand patches that two pairs saw, `num_equal` of them with equal signs, as many in front as behind.
WallOffsets of_a_thousand(int num_equal) {
  WallOffsets offsets;
  for (int i = 0; i < 1000; ++i) {
    const double metres = i % 2 == 0 ? 0.01 : -0.01;
    for (const double one : {metres, i * 617 % 1000 < num_equal ? metres : -metres})
      offsets.add({offset_of({i % 50, i / 50, 0, 0}, one)});
  }
  return offsets;
}

TEST(Relief, OffsetsOfTheSameWallsHaveRandomSigns) {
  for (const std::uint64_t tunnel : {1U, 2U, 3U}) {
    const WallOffsets offsets = driven(tunnel, tunnel);
    ASSERT_GT(offsets.counted().num_patches, 200U);
    EXPECT_NEAR(offsets.counted().share, 0.5, 0.06);
    EXPECT_GT(offsets.evidence({}), 0.0);
  }
}

TEST(Relief, OffsetsOfOtherWallsHaveEqualSignsInAllScansThoughNoiseIsLarger) {
  static_assert(kRelief < 0.5 * kPointNoise);
  for (const std::uint64_t tunnel : {1U, 2U, 3U}) {
    const WallOffsets offsets = driven(tunnel, tunnel + 10, 24);
    EXPECT_GT(offsets.counted().share, 0.6);
    EXPECT_LT(offsets.evidence({}), 0.0);
  }
}

TEST(Relief, ASensorWhoseRangesAreTooLongIsNoOtherWall) {
  for (const double bias : {-0.03, -0.005, 0.01, 0.03, 0.06}) {
    const WallOffsets same = driven(1, 1, 12, 1.0, bias);
    EXPECT_NEAR(same.counted().share, 0.5, 0.06) << bias;
    EXPECT_GT(same.evidence({}), 0.0) << bias;
    const WallOffsets other = driven(1, 11, 12, 1.0, bias);
    EXPECT_GT(other.counted().share, 0.6) << bias;
    EXPECT_LT(other.evidence({}), 0.0) << bias;
  }
}

TEST(Relief, SaysHowMuchOfTheOffsetsTheSensorsExplain) {
  EXPECT_EQ(WallOffsets().share_of_sensors(), 0.0);
  for (const std::uint64_t second : {1U, 11U}) {
    EXPECT_LT(driven(1, second, 12).share_of_sensors(), 0.2) << "neither noise nor rock is a sensor";
    EXPECT_GT(driven(1, second, 12, 1.0, 0.03).share_of_sensors(), 0.3);
    EXPECT_GT(driven(1, second, 12, 1.0, 0.06).share_of_sensors(), 0.5);
  }
}

// The share does not depend on how many scans saw a patch, so short stretches compare with long ones.
TEST(Relief, TheShareIsTheSameForFewPairsOfScansAndForMany) {
  const WallOffsets few = driven(1, 11, 3);
  const WallOffsets many = driven(1, 11, 12);
  EXPECT_NEAR(few.counted().share, many.counted().share, 0.08);
  EXPECT_LT(many.counted().sigma, 0.6 * few.counted().sigma);
}

TEST(Relief, SpeaksForOneTunnelAndAgainstTheOther) {
  EXPECT_GT(driven(1, 1, 24).evidence(where_others_agree(0.65)), 3.0);
  EXPECT_LT(driven(1, 11, 24).evidence(where_others_agree(0.65)), -3.0);
}

TEST(Relief, OnePairOfScansSaysNothing) {
  const WallOffsets offsets = driven(1, 11, 1);
  EXPECT_EQ(offsets.counted().num_patches, 0U);
  EXPECT_EQ(offsets.evidence(where_others_agree(0.65)), 0.0);
}

TEST(Relief, LargeOffsetsAreNotRelief) {
  // A step of 0.3 m: seen by `agreement`, not here.
  const SeenSurface a = seen(1, 0.0, 1);
  OrientedPoints points = a.points();
  for (Eigen::Vector3f& p : points.points) p.tail<2>() *= 3.7F / 4.0F;
  EXPECT_TRUE(patch_offsets(a, {points, Vector3::Zero(), RegistrationConfig().voxel_size}, Pose(), Pose(), {})
                  .empty());
}

TEST(Relief, OffsetsAreTowardsTheFreeSide) {
  const SeenSurface a = seen(1, 0.0, 1);
  OrientedPoints bulged = a.points();  // inwards, for a metre on one side
  const auto is_bulged = [](const Eigen::Vector3f& p) {
    return p.y() > 3.0F && p.x() > 2.0F && p.x() < 3.0F;
  };
  for (Eigen::Vector3f& p : bulged.points)
    if (is_bulged(p)) p.tail<2>() *= 3.95F / 4.0F;
  int num = 0;
  for (const PatchOffset& one :
       patch_offsets(a, {bulged, Vector3::Zero(), RegistrationConfig().voxel_size}, Pose(), Pose(), {})) {
    const bool is_there = one.patch[0] == 2 && one.patch[1] == 3;
    EXPECT_NEAR(one.metres, is_there ? 0.05 : 0.0, 0.01);
    num += is_there ? 1 : 0;
  }
  EXPECT_GE(num, 2);
}

TEST(Relief, PatchesStayWhereTheyAreInTheMap) {
  // The same surface, looked at from a frame that stands elsewhere and is turned round.
  const SeenSurface a = seen(1, 0.0, 1);
  const SeenSurface b = seen(1, 0.0, 2);
  const Pose T_map_a = Pose::planar(7.0, -3.0, 1.0);
  const std::vector<PatchOffset> found = patch_offsets(a, b, Pose(), T_map_a, {});
  ASSERT_GT(found.size(), 100U);
  for (const PatchOffset& one : found) {
    const Vector3 middle(one.patch[0] + 0.5, one.patch[1] + 0.5, one.patch[2] + 0.5);
    const double from_axis = (T_map_a.inverse() * middle).tail<2>().norm();
    EXPECT_NEAR(from_axis, kRadius, 1.0);
  }
}

TEST(WallOffsets, EveryTwoPairsThatSawAPatchAreCompared) {
  WallOffsets offsets;
  const WallPatch lasting{0, 0, 0, 0}, changing{1, 0, 0, 0}, once{2, 0, 0, 0};
  offsets.add({offset_of(lasting, 0.01), offset_of(changing, 0.01)});
  EXPECT_EQ(offsets.counted().num_patches, 0U);
  offsets.add({offset_of(lasting, 0.02), offset_of(changing, -0.01), offset_of(once, 0.01)});
  EXPECT_EQ(offsets.counted().num_patches, 2U);
  EXPECT_DOUBLE_EQ(offsets.counted().share, 0.5);
  offsets.add(
      {offset_of(lasting, -0.005)});  // one of three combinations still agrees; the patch weighs as two
  EXPECT_DOUBLE_EQ(offsets.counted().share, (2.0 / 3.0 + 0.0) / (2.0 + 1.0));
}

// 80 m of wall seen twice, of which the patches from 0 to `moved_m` stand in front both times.
EqualSignShare with_moved(double moved_m, Visits visits = Visits::two) {
  WallOffsets offsets({}, visits);
  for (int i = 0; i < 80; ++i)
    for (int k = 0; k < 10; ++k) {
      const double second = i < moved_m || (i + k) % 2 == 0 ? 0.01 : -0.01;
      offsets.add({offset_of({i, k, 0, 0}, 0.01)});
      offsets.add({offset_of({i, k, 0, 0}, second)});
    }
  return offsets.counted();
}

TEST(WallOffsets, AStretchThatWasMovedAsAWholeDoesNotCount) {
  EXPECT_NEAR(with_moved(0.0).share, 0.5, 1e-9);
  EXPECT_NEAR(with_moved(20.0).share, 0.5, 1e-9) << "fresh lining over 20 m";
  EXPECT_EQ(with_moved(20.0).num_patches, 800U);
  EXPECT_NEAR(with_moved(20.0, Visits::one).share, 0.625, 1e-9) << "nothing moves during one visit";
  EXPECT_GT(with_moved(80.0).share, 0.99) << "more than half: other walls";
}

TEST(WallOffsets, SmallOffsetsHaveNoSign) {
  const auto num_patches = [](double metres) {
    WallOffsets offsets({.min_offset_m = 0.002});
    for (int i = 0; i < 100; ++i)
      for (int pair = 0; pair < 2; ++pair)
        offsets.add({offset_of({i, 0, 0, 0}, (i + pair) % 2 == 0 ? metres : -metres)});
    return offsets.counted().num_patches;
  };
  EXPECT_EQ(num_patches(0.0019), 0U);
  EXPECT_EQ(num_patches(0.0021), 100U);
}

TEST(WallOffsets, TheShareOfOneWallAndTheNumberOfPatchesAreSettings) {
  EXPECT_LT(of_a_thousand(600).evidence({}), 0.0);
  EXPECT_GT(of_a_thousand(600).evidence(EqualSignShares({.same_share = 0.6})), 0.0);
  EXPECT_EQ(of_a_thousand(600).evidence(EqualSignShares({.min_patches = 1001})), 0.0);
}

TEST(WallOffsets, TheShareIsAsUncertainAsTheTossOfACoin) {
  Rng rng(3);
  std::vector<double> off;  // in sigmas
  for (int trial = 0; trial < 200; ++trial) {
    WallOffsets offsets;
    for (int i = 0; i < 200; ++i)
      for (int pair = 0; pair < 2 + i % 4; ++pair) offsets.add({offset_of({i, 0, 0, 0}, rng.normal())});
    const EqualSignShare counted = offsets.counted();
    off.push_back((counted.share - 0.5) / counted.sigma);
  }
  double squares = 0.0;
  for (const double one : off) squares += one * one / 200.0;
  EXPECT_LT(squares, 1.2);
  EXPECT_GT(squares, 0.4) << "stated a little too large: several pairs that saw one patch are no coins";
}

TEST(WallOffsets, SpeakForOtherWallsWhenMoreSignsAreEqualThanOnTheSame) {
  EXPECT_GT(of_a_thousand(540).evidence({}), 0.0);
  EXPECT_LT(of_a_thousand(600).evidence({}), 0.0);
  EqualSignShares cluttered;  // at edges signs are equal even of one place
  cluttered.set_same(found(0.6));
  EXPECT_GT(of_a_thousand(600).evidence(cluttered), 0.0);
  EXPECT_LT(of_a_thousand(680).evidence(cluttered), 0.0);
}

TEST(WallOffsets, WallsMayHaveChangedHoweverMuchTheyDiffer) {
  const double floor = std::log(ReliefModel().changed);
  for (const EqualSignShares& shares : {EqualSignShares(), where_others_agree(0.65)}) {
    EXPECT_NEAR(of_a_thousand(1000).evidence(shares), floor, 0.1);
    EXPECT_GE(of_a_thousand(700).evidence(shares), floor);
    EXPECT_LE(of_a_thousand(700).evidence(shares), of_a_thousand(580).evidence(shares));
  }
}

TEST(WallOffsets, AShareBelowHalfCountsAsChance) {
  EXPECT_NEAR(of_a_thousand(400).evidence(where_others_agree(0.65)),
              of_a_thousand(500).evidence(where_others_agree(0.65)), 0.5);
}

TEST(EqualSignShares, UseWhatWasMeasuredOrElseTheSetting) {
  EqualSignShares shares;
  const double believed = shares.same().mean;
  EXPECT_GT(believed, 0.5);
  EXPECT_FALSE(shares.other());
  shares.set_same(found(0.45));
  EXPECT_EQ(shares.same().mean, believed) << "less than chance is chance";
  shares.set_same(found(0.9, 50));
  EXPECT_EQ(shares.same().mean, believed) << "too few patches";
  shares.set_same(found(0.6));
  EXPECT_EQ(shares.same().mean, 0.6);
}

TEST(EqualSignShares, MoreLookAlikesSharpenThePredictionForOtherWalls) {
  const auto one = where_others_agree(0.65, 1).other();
  const auto many = where_others_agree(0.65, 20).other();
  ASSERT_TRUE(one && many);
  EXPECT_NEAR(one->mean_log, std::log(0.15), 1e-12);
  EXPECT_LT(many->sigma_log, 0.6 * one->sigma_log);
  EqualSignShares uneven;
  for (const double share : {0.58, 0.62, 0.7, 0.8}) uneven.add_other(found(share));
  EXPECT_GT(uneven.other()->sigma_log, where_others_agree(0.65, 4).other()->sigma_log);
}

TEST(WallOffsets, FewerEqualSignsThanOnTheOwnMapSpeakForOneWall) {
  EqualSignShares cluttered;
  cluttered.set_same(found(0.59));
  EXPECT_GE(of_a_thousand(500).evidence(cluttered), of_a_thousand(500).evidence({}) - 1e-9);
  EXPECT_GT(of_a_thousand(500).evidence(cluttered), 2.0);
}

TEST(EqualSignShares, UnderMoreNoiseOtherWallsShowLess) {
  EqualSignShares shares;
  EqualSignShare other = found(0.7);
  other.noise_m = 0.01;
  shares.add_other(other);
  const auto share_under = [&](double noise_m) { return 0.5 + std::exp(shares.other(noise_m)->mean_log); };
  EXPECT_NEAR(share_under(0.01), 0.7, 1e-12);
  EXPECT_NEAR(share_under(0.0), 0.7, 1e-12) << "unknown: as measured";
  EXPECT_LT(share_under(0.03), 0.56);
  // Signs of relief of 1 sigma and noise, drawn.
  Rng rng(5);
  const auto drawn = [&](double noise) {
    int num_equal = 0;
    for (int i = 0; i < 40000; ++i) {
      const double relief = rng.normal();
      const double one = relief + noise * rng.normal();
      num_equal += (one > 0.0) == (relief + noise * rng.normal() > 0.0) ? 1 : 0;
    }
    return num_equal / 40000.0;
  };
  EqualSignShares of_drawn;
  EqualSignShare measured = found(drawn(1.0));
  measured.noise_m = 1.0;
  of_drawn.add_other(measured);
  EXPECT_NEAR(0.5 + std::exp(of_drawn.other(2.0)->mean_log), drawn(2.0), 0.01);
}

TEST(WallOffsets, TheNoiseOfAnOffsetIsMeasured) {
  Rng rng(7);
  WallOffsets offsets;
  std::vector<double> relief;
  for (int i = 0; i < 500; ++i) relief.push_back(0.05 * rng.normal());
  for (int pair = 0; pair < 6; ++pair)
    for (int i = 0; i < 500; ++i)
      offsets.add({offset_of({i, 0, 0, 0}, relief[static_cast<std::size_t>(i)] + 0.01 * rng.normal())});
  EXPECT_NEAR(offsets.counted().noise_m, 0.01, 0.001);
}

TEST(EqualSignShares, TheMoreLookAlikesHaveTheSameWallsTheLessSpeaksForAMerge) {
  EqualSignShares shares = where_others_agree(0.65);
  const double none = of_a_thousand(500).evidence(shares);
  EXPECT_GT(none, 5.0);
  EXPECT_LE(none, std::log(1.0 / ReliefModel().moulded));
  shares.add_other(found(0.9, 50));  // hardly seen: not counted
  EXPECT_EQ(of_a_thousand(500).evidence(shares), none);
  shares.add_other(found(0.51));  // cast in one mould
  EXPECT_LT(of_a_thousand(500).evidence(shares), 0.5 * none);
  EXPECT_LT(of_a_thousand(650).evidence(shares), -1.0) << "other walls still speak against";
  for (int i = 0; i < 20; ++i) shares.add_other(found(0.51));
  EXPECT_LT(of_a_thousand(500).evidence(shares), 0.5);
}

TEST(EqualSignShares, ALookAlikeSeenTooShortlyToTellHardlyCounts) {
  EqualSignShares shares = where_others_agree(0.8, 3);
  const double none = of_a_thousand(500).evidence(shares);
  shares.add_other(found(0.56, 110));  // as likely by the same walls as by others
  EXPECT_GT(of_a_thousand(500).evidence(shares), 0.7 * none);
}

TEST(EqualSignShares, LookAlikesThatEachMayHaveTheSameWallsTogetherDo) {
  const auto chance = [](int num_ambiguous) {
    EqualSignShares shares = where_others_agree(0.8, 3);
    for (int i = 0; i < num_ambiguous; ++i) shares.add_other(found(0.54, 110));
    return shares.chance_of_one_mould();
  };
  EXPECT_LT(chance(1), ReliefModel().prior_moulded);
  EXPECT_GT(chance(15), 0.5);
}

TEST(EqualSignShares, WhereAllLookAlikesHaveTheSameWallsNothingSpeaksForAMerge) {
  const EqualSignShares shares = where_others_agree(0.5, 10);
  EXPECT_GT(shares.chance_of_one_mould(), 0.7);
  EXPECT_LT(of_a_thousand(500).evidence(shares), 0.4);
}

}  // namespace
}  // namespace adit
