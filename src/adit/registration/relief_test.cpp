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

// Shotcrete as thick as `metres` on one wall, along 10 m.
double lining(double metres, double x, double angle) {
  return x > 5.0 && x < 15.0 && std::abs(angle) < 0.6 ? metres : 0.0;
}

// The tunnel seen by a LiDAR on its axis, at x, whose ranges are too long by `bias`.
SeenSurface seen(std::uint64_t tunnel, double x, std::uint64_t noise, double bias = 0.0, double lined = 0.0) {
  Rng rng(noise);
  PointCloud cloud;
  for (int i = 0; i < 6000; ++i) {
    const double along = rng.uniform(-12.0, 12.0);
    const double angle = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const double r = kRadius + rock(tunnel, x + along, angle) - lining(lined, x + along, angle) +
                     kPointNoise * rng.normal();
    cloud.points.emplace_back(static_cast<float>(along), static_cast<float>(r * std::cos(angle)),
                              static_cast<float>(r * std::sin(angle)));
    cloud.points.back() += static_cast<float>(bias) * cloud.points.back().normalized();
  }
  return {compute_surface(cloud, {}), Vector3::Zero(), RegistrationConfig().voxel_size};
}

// One robot drove through `first`, the other through `second`, which coincide except for the rock; the second
// robot stands `ahead` metres of the first each time, and its ranges are too long by `bias`; when it came,
// one wall was `lined`.
WallOffsets driven(std::uint64_t first, std::uint64_t second, int num_pairs = 8, double ahead = 1.0,
                   double bias = 0.0, double lined = 0.0) {
  WallOffsets offsets;
  for (int i = 0; i < num_pairs; ++i) {
    const double x = 3.0 * i;
    const std::uint64_t noise = 100 + 2 * static_cast<std::uint64_t>(i);
    offsets.add(patch_offsets(seen(first, x, noise), seen(second, x + ahead, noise + 1, bias, lined),
                              Pose::translation_of(ahead, 0.0, 0.0), Pose::translation_of(x, 0.0, 0.0), {}));
  }
  return offsets;
}

double evidence_of(const WallOffsets& offsets, const EqualSignShares& shares = EqualSignShares()) {
  return shares.evidence(offsets.counted());
}

EqualSignShares of_rough_walls() {
  EqualSignShares shares;
  for (int i = 0; i < 5; ++i) shares.add_other({1000, 0.65, 0.016});
  return shares;
}

PatchOffset offset_of(const WallPatch& patch, double metres) { return {patch, metres}; }

TEST(Relief, OffsetsOfTheSameWallsHaveRandomSigns) {
  for (const std::uint64_t tunnel : {1U, 2U, 3U}) {
    const WallOffsets offsets = driven(tunnel, tunnel);
    ASSERT_GT(offsets.counted().num_patches, 200U);
    EXPECT_NEAR(offsets.counted().share, 0.5, 0.06);
    EXPECT_GT(evidence_of(offsets), 0.0);
  }
}

TEST(Relief, OffsetsOfOtherWallsHaveEqualSignsInAllScansThoughNoiseIsLarger) {
  static_assert(kRelief < 0.5 * kPointNoise);
  for (const std::uint64_t tunnel : {1U, 2U, 3U}) {
    const WallOffsets offsets = driven(tunnel, tunnel + 10, 24);
    EXPECT_GT(offsets.counted().share, 0.6);
    EXPECT_LT(evidence_of(offsets), 0.0);
  }
}

TEST(Relief, ASensorWhoseRangesAreTooLongIsNoOtherWall) {
  for (const double bias : {-0.03, -0.005, 0.01, 0.03, 0.06}) {
    const WallOffsets same = driven(1, 1, 12, 1.0, bias);
    EXPECT_NEAR(same.counted().share, 0.5, 0.06) << bias;
    EXPECT_GT(evidence_of(same), 0.0) << bias;
    const WallOffsets other = driven(1, 11, 12, 1.0, bias);
    EXPECT_GT(other.counted().share, 0.6) << bias;
    EXPECT_LT(evidence_of(other), 0.0) << bias;
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

TEST(WallOffsets, WhatWasCountedBeforeMoreIsAddedDoesNotStay) {
  const auto all_at_once = [](std::size_t num_pairs) {
    return driven(1, 11, static_cast<int>(num_pairs), 1.0, 0.03);
  };
  WallOffsets grown = all_at_once(6);
  const WallOffsets whole = all_at_once(7);
  const double before = grown.share_of_sensors();
  EXPECT_EQ(grown.share_of_sensors(), before);
  const WallOffsets copy = grown;
  const double x = 3.0 * 6;
  grown.add(patch_offsets(seen(1, x, 112), seen(11, x + 1.0, 113, 0.03), Pose::translation_of(1.0, 0.0, 0.0),
                          Pose::translation_of(x, 0.0, 0.0), {}));
  EXPECT_EQ(grown.share_of_sensors(), whole.share_of_sensors());
  EXPECT_EQ(grown.counted(), whole.counted());
  EXPECT_NE(grown.share_of_sensors(), before);
  EXPECT_EQ(copy.share_of_sensors(), before);
  EXPECT_EQ(copy.counted(), all_at_once(6).counted());
}

// The share does not depend on how many scans saw a patch, so short stretches compare with long ones.
TEST(Relief, TheShareIsTheSameForFewPairsOfScansAndForMany) {
  const WallOffsets few = driven(1, 11, 3);
  const WallOffsets many = driven(1, 11, 12);
  EXPECT_NEAR(few.counted().share, many.counted().share, 0.08);
  EXPECT_LT(many.counted().sigma, 0.6 * few.counted().sigma);
}

TEST(Relief, SpeaksForOneTunnelAndAgainstTheOther) {
  EXPECT_GT(evidence_of(driven(1, 1, 24), of_rough_walls()), 3.0);
  EXPECT_LT(evidence_of(driven(1, 11, 24), of_rough_walls()), -3.0);
}

TEST(Relief, AWallThatWasLinedIsNoOtherTunnel) {
  const EqualSignShare before = driven(1, 1).counted();
  for (const double lined : {0.06, 0.12}) {
    const EqualSignShare after = driven(1, 1, 8, 1.0, 0.0, lined).counted();
    EXPECT_LT(after.share, before.share + 0.03) << lined;
    EXPECT_GT(after.num_patches, before.num_patches / 2) << lined;
  }
}

TEST(Relief, OnePairOfScansSaysNothing) {
  const WallOffsets offsets = driven(1, 11, 1);
  EXPECT_EQ(offsets.counted().num_patches, 0U);
  EXPECT_EQ(evidence_of(offsets, of_rough_walls()), 0.0);
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

// Rings of points around a tube of that radius, `apart` metres of arc from one another.
SearchableSurface ringed(double radius, double apart, double first_angle) {
  OrientedPoints tube;
  for (double x = -3.0; x < 3.0; x += 0.1)
    for (double angle = first_angle; angle < 2.0 * std::numbers::pi; angle += apart / radius) {
      const Eigen::Vector3f inwards(0.0F, -static_cast<float>(std::cos(angle)),
                                    -static_cast<float>(std::sin(angle)));
      tube.points.emplace_back(static_cast<float>(x) * Eigen::Vector3f::UnitX() -
                               static_cast<float>(radius) * inwards);
      tube.normals.push_back(inwards);
    }
  return {tube, Vector3::Zero(), RegistrationConfig().voxel_size};
}

TEST(Relief, AWallThatCurvesIsNotInFrontOfItself) {
  constexpr double kNarrow = 2.0;
  constexpr double kApart = 0.3;
  const std::vector<PatchOffset> found = patch_offsets(
      ringed(kNarrow, kApart, 0.0), ringed(kNarrow, kApart, 0.5 * kApart / kNarrow), Pose(), Pose(), {});
  ASSERT_GT(found.size(), 20U);
  for (const PatchOffset& one : found) EXPECT_NEAR(one.metres, 0.0, 1e-4);  // off each plane: 5.6 mm
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
EqualSignShare with_moved(double moved_m) {
  WallOffsets offsets;
  for (int i = 0; i < 80; ++i)
    for (int k = 0; k < 10; ++k) {
      const double second = i < moved_m || (i + k) % 2 == 0 ? 0.01 : -0.01;
      offsets.add({offset_of({i, k, 0, 0}, 0.01)});
      offsets.add({offset_of({i, k, 0, 0}, second)});
    }
  return offsets.counted();
}

TEST(WallOffsets, EverySideOfTenMetresHasItsShare) {
  const EqualSignShare counted = with_moved(20.0);
  EXPECT_EQ(counted.num_patches, 800U);
  EXPECT_NEAR(counted.share, 0.625, 1e-9);
  ASSERT_EQ(counted.stretches.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(counted.stretches[i].num, 100.0, 1e-9);
    EXPECT_NEAR(counted.stretches[i].share(), i < 2 ? 1.0 : 0.5, 1e-9);
  }
}

// Twelve stretches seen four times, each `off` by what the function says.
template <class Off>
EqualSignShare twelve_stretches(const Off& off) {
  Rng rng(5);
  WallOffsets offsets;
  for (int pair = 0; pair < 4; ++pair) {
    std::vector<PatchOffset> seen;
    for (int i = 0; i < 120; ++i)
      for (int k = 0; k < 3; ++k) seen.push_back(offset_of({i, 0, k, 0}, off(i / 10) + 0.008 * rng.normal()));
    offsets.add(seen);
  }
  return offsets.counted();
}

TEST(WallOffsets, AStretchThatWasMovedDoesNotCount) {
  const EqualSignShare counted = twelve_stretches([](int stretch) { return stretch == 4 ? 0.03 : 0.0; });
  EXPECT_LT(counted.num_patches, 331U);
  EXPECT_EQ(counted.stretches.size(), 11U);
  EXPECT_NEAR(counted.share, 0.5, 0.03);
}

TEST(WallOffsets, StretchesThatAllDifferWereNotMoved) {
  const EqualSignShare counted = twelve_stretches([](int stretch) { return 0.006 * (stretch % 5 - 2); });
  EXPECT_EQ(counted.stretches.size(), 12U);
  EXPECT_GT(counted.share, 0.6);
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

}  // namespace
}  // namespace adit
