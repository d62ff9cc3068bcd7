// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/wall_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

// So many patches on ten stretches, each seen twice, with that share of equal signs everywhere.
EqualSignShare found(double share, std::size_t num_patches = 1000) {
  const auto num = static_cast<double>(num_patches);
  EqualSignShare out{num_patches, share, 0.5 / std::sqrt(num)};
  for (int i = 0; i < 10; ++i) out.stretches.push_back({num / 10.0, share * num / 10.0});
  return out;
}

// The same, of which `num_moved` stretches stand in front everywhere.
EqualSignShare with_moved(int num_moved, double share = 0.5) {
  EqualSignShare out = found(share);
  for (int i = 0; i < num_moved; ++i) out.stretches[static_cast<std::size_t>(i)].equal = 100.0;
  out.share = share + (1.0 - share) * num_moved / 10.0;
  return out;
}

double evidence(const EqualSignShare& found, const EqualSignShares& shares = EqualSignShares()) {
  return shares.evidence(found);
}

EqualSignShares where_others_agree(double share, int num_tunnels = 5) {
  EqualSignShares shares;
  for (int i = 0; i < num_tunnels; ++i) shares.add_other(found(share));
  return shares;
}

TEST(WallEvidence, AFewStretchesThatWereMovedDoNotMakeAnotherTunnel) {
  const EqualSignShares shares = where_others_agree(0.75);
  EXPECT_GT(evidence(with_moved(0), shares), 5.0);
  EXPECT_GT(evidence(with_moved(2), shares), 3.0) << "20 m of fresh lining on one side, of 100 m";
  EXPECT_LT(evidence(with_moved(10), shares), -4.0);
  for (int num = 1; num <= 10; ++num)
    EXPECT_LT(evidence(with_moved(num), shares), evidence(with_moved(num - 1), shares)) << num;
  EXPECT_LT(evidence(with_moved(2, 0.75), shares), -3.0) << "the others are those of another tunnel";
}

TEST(WallEvidence, WithoutMovedWallsInTheModelTwoStretchesAreAnotherTunnel) {
  EqualSignShares shares({.lined_anew = 0.0});
  for (int i = 0; i < 5; ++i) shares.add_other(found(0.75));
  EXPECT_LT(evidence(with_moved(2), shares), 0.0);
}

// Decision 0088: tiles-2501, whose blocks are equal.
TEST(WallEvidence, OtherAlignmentsOfTheTwoMapsTellWhetherWallsAreOfOneMould) {
  const EqualSignShares shares = where_others_agree(0.65);
  const double alone = shares.evidence(found(0.5));
  const double beside_the_same = shares.evidence(found(0.5), 1.0, {found(0.5, 300)});
  EXPECT_LT(beside_the_same, alone - 2.0);
  EXPECT_LT(shares.evidence(found(0.5), 1.0, {found(0.5, 300), found(0.51, 300)}), beside_the_same);
  EXPECT_GE(shares.evidence(found(0.5), 1.0, {found(0.65, 300)}), alone - 0.1)
      << "other walls, as on the own map";
  EXPECT_EQ(shares.evidence(found(0.5), 1.0, {found(0.5, 20)}), alone) << "of which too little was seen";
  EXPECT_LE(beside_the_same, shares.most_evidence({found(0.5, 300)}));
  EXPECT_EQ(shares.evidence(found(0.5)), alone) << "and for another check they count no more";
}

TEST(WallEvidence, CountsAsIfSeenSoManyTimes) {
  const EqualSignShares shares = where_others_agree(0.56);
  const EqualSignShare few = found(0.5, 200);
  EXPECT_NEAR(shares.evidence(few, 2.0), shares.evidence(found(0.5, 400)), 0.5);
  EXPECT_GT(shares.evidence(few, 2.0), shares.evidence(few));
  EXPECT_EQ(shares.evidence(few, 0.1), 0.0) << "fewer patches than are evidence";
}

TEST(WallEvidence, TheShareOfOneWallAndTheNumberOfPatchesAreSettings) {
  EXPECT_LT(evidence(found(0.6)), 0.0);
  EXPECT_GT(evidence(found(0.6), EqualSignShares({.same_share = 0.6})), 0.0);
  EXPECT_EQ(evidence(found(0.6), EqualSignShares({.min_patches = 1001})), 0.0);
}

TEST(WallEvidence, SpeakForOtherWallsWhenMoreSignsAreEqualThanOnTheSame) {
  EXPECT_GT(evidence(found(0.54)), 0.0);
  EXPECT_LT(evidence(found(0.6)), 0.0);
  EqualSignShares cluttered;  // at edges signs are equal even of one place
  cluttered.set_same(found(0.6));
  EXPECT_GT(evidence(found(0.6), cluttered), 0.0);
  EXPECT_LT(evidence(found(0.68), cluttered), 0.0);
}

TEST(WallEvidence, WallsMayHaveChangedHoweverMuchTheyDiffer) {
  const double floor = std::log(ReliefModel().changed);
  for (const EqualSignShares& shares : {EqualSignShares(), where_others_agree(0.65)}) {
    EXPECT_NEAR(evidence(found(1), shares), floor, 0.1);
    EXPECT_GE(evidence(found(0.7), shares), floor);
    EXPECT_LE(evidence(found(0.7), shares), evidence(found(0.58), shares));
  }
}

TEST(WallEvidence, AShareBelowHalfCountsAsChance) {
  EXPECT_NEAR(evidence(found(0.4), where_others_agree(0.65)), evidence(found(0.5), where_others_agree(0.65)),
              0.5);
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

TEST(WallEvidence, FewerEqualSignsThanOnTheOwnMapSpeakForOneWall) {
  EqualSignShares cluttered;
  cluttered.set_same(found(0.59));
  EXPECT_NEAR(evidence(found(0.5), cluttered), evidence(found(0.5)), 0.1);
  EXPECT_GT(evidence(found(0.5), cluttered), 2.0);
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

TEST(EqualSignShares, TheMoreLookAlikesHaveTheSameWallsTheLessSpeaksForAMerge) {
  EqualSignShares shares = where_others_agree(0.65);
  const double none = evidence(found(0.5), shares);
  EXPECT_GT(none, 5.0);
  EXPECT_LE(none, std::log(1.0 / ReliefModel().moulded));
  shares.add_other(found(0.9, 50));  // hardly seen: not counted
  EXPECT_EQ(evidence(found(0.5), shares), none);
  shares.add_other(found(0.51));  // cast in one mould
  EXPECT_LT(evidence(found(0.5), shares), 0.5 * none);
  EXPECT_LT(evidence(found(0.65), shares), -1.0) << "other walls still speak against";
  for (int i = 0; i < 20; ++i) shares.add_other(found(0.51));
  EXPECT_LT(evidence(found(0.5), shares), 0.5);
}

TEST(EqualSignShares, AnswerAsIfAskedForTheFirstTime) {
  EqualSignShares asked;
  std::vector<EqualSignShare> added;
  const auto expect_same_as_anew = [&](const EqualSignShare& same) {
    EqualSignShares anew;
    anew.set_same(same);
    for (const EqualSignShare& one : added) anew.add_other(one);
    EXPECT_EQ(asked.chance_of_one_mould(), anew.chance_of_one_mould());
    for (int round = 0; round < 2; ++round)
      for (int i = 0; i < 12; ++i) {
        const EqualSignShare walls = with_moved(i % 6, 0.5 + 0.01 * i);
        for (const double times : {1.0, 2.5}) {
          const EqualSignShares unasked = anew;
          EXPECT_EQ(asked.evidence(walls, times), unasked.evidence(walls, times)) << i;
        }
      }
  };
  expect_same_as_anew({});
  for (const double share : {0.65, 0.51, 0.7}) {
    added.push_back(found(share));
    asked.add_other(added.back());
    expect_same_as_anew({});
  }
  asked.set_same(found(0.56));
  expect_same_as_anew(found(0.56));
}

TEST(EqualSignShares, TellApartWallsThatDifferInOneStretchOnly) {
  const EqualSignShares shares = where_others_agree(0.65);
  EqualSignShare walls = found(0.55);
  const double before = shares.evidence(walls);
  walls.stretches.back().equal = walls.stretches.back().num;
  EXPECT_LT(shares.evidence(walls), before);
  EXPECT_EQ(shares.evidence(walls), where_others_agree(0.65).evidence(walls));
  EXPECT_EQ(shares.evidence(found(0.55)), before);
}

TEST(EqualSignShares, ALookAlikeSeenTooShortlyToTellHardlyCounts) {
  EqualSignShares shares = where_others_agree(0.8, 3);
  const double none = evidence(found(0.5), shares);
  shares.add_other(found(0.56, 110));  // as likely by the same walls as by others
  EXPECT_GT(evidence(found(0.5), shares), 0.7 * none);
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
  EXPECT_LT(evidence(found(0.5), shares), 0.4);
}

}  // namespace
}  // namespace adit
