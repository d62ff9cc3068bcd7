// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_advice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "adit/fleet/merge/merge_evidence.hpp"
#include "support/loop_information.hpp"
#include "support/opposite_drives.hpp"

namespace adit {
namespace {

using test::along_x;

constexpr double kSpacing = 3.0;
constexpr double kStep = 0.5;  // metres from keyframe to keyframe
constexpr ChancesToGoOn kChances = {0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.9, 0.9};

/// The own robot drove 200 m straight on, the other one along the same line from `first_m` to `last_m`.
struct Met {
  OdometryChain own = along_x(401);
  OdometryChain theirs;
  UndecidedStretch stretch;
  std::set<std::uint32_t> asked;  // keyframes of which it was asked whether they are distinctive

  Met(double first_m, double last_m)
      : theirs(along_x(static_cast<std::size_t>((last_m - first_m) / kStep) + 1)) {
    const auto first = static_cast<std::uint32_t>(first_m / kStep);
    const auto last = static_cast<std::uint32_t>(last_m / kStep);
    for (std::uint32_t k = first; k <= last; k += 6) {
      stretch.shared.push_back(k);
      stretch.places.push_back({k, k - first, PlaceOutcome::distinctive});
    }
    const std::size_t middle = (first + last) / 2;
    stretch.loops = {{middle, middle - first, Pose(), test::loop_information()}};
    stretch.chances = kChances;
    stretch.evidence = [](const std::vector<TestedPlace>& places) {
      const std::vector<double> at_places = evidence_at_places(places, kChances);
      return std::accumulate(at_places.begin(), at_places.end(), 0.0);
    };
    stretch.missing = 1.0;
  }
  [[nodiscard]] std::size_t num_passed() const { return stretch.places.size(); }

  template <class IsDistinctive>
  std::optional<MergeAdvice> advice(const IsDistinctive& is_distinctive) {
    const auto distinctive = [&](const std::vector<std::uint32_t>& keyframes) {
      std::vector<bool> out;
      for (const std::uint32_t k : keyframes) {
        asked.insert(k);
        out.push_back(is_distinctive(kStep * k));
      }
      return out;
    };
    return where_to_drive(stretch, own, theirs, kSpacing, {distinctive, differ});
  }
  std::function<std::vector<bool>(const std::vector<OwnComparison>&)> differ =
      [](const std::vector<OwnComparison>&) -> std::vector<bool> { throw std::logic_error("no rival"); };
};

constexpr auto kEverywhere = [](double) { return true; };
constexpr auto kNowhere = [](double) { return false; };

double gain_of(std::size_t num, std::size_t passed) {
  double sum = 0.0;
  for (std::size_t i = 0; i < num; ++i) sum += evidence_of_agreement(kChances, passed + i);
  return sum;
}

TEST(MergeAdvice, LeadsBeyondWhatBothDroveAndSumsUpThePlacesThere) {
  Met met(90.0, 120.0);
  const std::optional<MergeAdvice> advice = met.advice([](double m) { return m > 100.0; });
  ASSERT_TRUE(advice);
  EXPECT_DOUBLE_EQ(advice->from_m, 120.0);
  EXPECT_EQ(advice->from, Vector3(120.0, 0.0, 0.0));
  EXPECT_GT(advice->to_m, advice->from_m);
  EXPECT_GE(advice->gain, advice->missing);
  // Places lie every 3 m; those within a tunnel's width of where the other robot stopped have been passed.
  const auto num = static_cast<std::size_t>(std::lround((advice->to_m - 125.0) / kSpacing)) + 1;
  EXPECT_NEAR(advice->gain, gain_of(num, met.num_passed()), 1e-12);
  EXPECT_LT(gain_of(num - 1, met.num_passed()), advice->missing) << "no further than needed";
  EXPECT_LE(met.asked.size(), 70U);
  for (const std::uint32_t k : met.asked) EXPECT_TRUE(k < 180 || k > 240) << k;
}

TEST(MergeAdvice, ChoosesTheEndThatDecidesInFewerMetres) {
  Met met(90.0, 120.0);
  const std::optional<MergeAdvice> back = met.advice([](double m) { return m < 90.0 || m > 150.0; });
  ASSERT_TRUE(back);
  EXPECT_DOUBLE_EQ(back->from_m, 90.0);
  EXPECT_LT(back->to_m, back->from_m);
  const std::optional<MergeAdvice> on = met.advice([](double m) { return m < 60.0 || m > 120.0; });
  ASSERT_TRUE(on);
  EXPECT_GT(on->to_m, on->from_m);
}

TEST(MergeAdvice, WhereNoEndDecidesItTakesTheOneThatBringsMore) {
  Met met(90.0, 120.0);
  met.stretch.missing = 1000.0;
  const std::optional<MergeAdvice> advice =
      met.advice([](double m) { return (m > 70.0 && m < 80.0) || (m > 180.0 && m < 200.0); });
  ASSERT_TRUE(advice);
  EXPECT_LT(advice->gain, advice->missing);
  EXPECT_GT(advice->to_m, 180.0);
  EXPECT_LE(advice->to_m, 200.0);
}

TEST(MergeAdvice, KnowsNoPlaceWhereTheOwnPathEndsOrNothingWouldTell) {
  EXPECT_FALSE(Met(0.0, 200.0).advice(kEverywhere));
  EXPECT_FALSE(Met(90.0, 120.0).advice(kNowhere));
  Met to_the_end(90.0, 200.0);
  const std::optional<MergeAdvice> only_back = to_the_end.advice(kEverywhere);
  ASSERT_TRUE(only_back);
  EXPECT_DOUBLE_EQ(only_back->from_m, 90.0);
}

TEST(MergeAdvice, SendsNobodyWhereItHasBeenAlready) {
  Met met(90.0, 150.0);  // but only 30 m of that are compared
  std::erase_if(met.stretch.shared, [](std::uint32_t k) { return k > 240; });
  std::erase_if(met.stretch.places, [](const TestedPlace& place) { return place.a > 240; });
  const std::optional<MergeAdvice> advice = met.advice([](double m) { return m > 120.0; });
  ASSERT_TRUE(advice);
  EXPECT_GT(advice->to_m, 150.0);
  for (const std::uint32_t k : met.asked) EXPECT_TRUE(kStep * k < 90.0 || kStep * k > 150.0) << k;
}

TEST(MergeAdvice, CountsAPlaceOnceWhereTheOwnRobotTurned) {
  std::vector<Pose> poses;  // on to 140 m and back again
  for (int k = 0; k <= 280; ++k) poses.push_back(Pose::translation_of(kStep * k, 0.0, 0.0));
  for (int k = 279; k >= 0; --k) poses.push_back(Pose::translation_of(kStep * k, 1.0, 0.0));
  Met met(90.0, 120.0);
  met.stretch.missing = 1000.0;
  met.own = OdometryChain(poses, std::vector<Matrix6>(poses.size() - 1, Matrix6::Identity() * 1e-4));
  const std::optional<MergeAdvice> advice = met.advice([](double m) { return m > 120.0; });
  ASSERT_TRUE(advice);
  EXPECT_LE(advice->to_m, 150.0);
  EXPECT_LE(advice->gain, gain_of(7, met.num_passed()) + 1e-12);  // from 125 to 140 m, and where it turned
}

TEST(MergeAdvice, ADifferenceInTheStretchMakesLookAlikesBeginAnew) {
  Met met(90.0, 120.0);
  met.stretch.places.back().outcome = PlaceOutcome::differs;
  const std::optional<MergeAdvice> advice = met.advice([](double m) { return m > 120.0; });
  ASSERT_TRUE(advice);
  const auto num = static_cast<std::size_t>(std::lround((advice->to_m - 125.0) / kSpacing)) + 1;
  EXPECT_NEAR(advice->gain, gain_of(num, 0), 1e-12);
}

TEST(MergeAdvice, GoesOnForTheMetresWhereTheyAreMissingToo) {
  Met met(90.0, 120.0);
  const auto ahead = [](double m) { return m > 120.0 && m < 177.0; };
  const double needed_m = met.advice(ahead)->to_m - 120.0;
  met.stretch.least_m = 60.0;
  const std::optional<MergeAdvice> advice = met.advice(ahead);
  ASSERT_TRUE(advice);
  EXPECT_LT(needed_m, 60.0);
  EXPECT_GE(advice->to_m - advice->from_m, 60.0);
  EXPECT_LT(advice->to_m - advice->from_m, 60.0 + kSpacing);
}

TEST(MergeAdvice, BetweenRivalsOnlyPlacesThatLookDifferentCount) {
  Met met(60.0, 80.0);
  PcmLoop rival = met.stretch.loops.front();
  rival.T_a_b = Pose::translation_of(20.0, 0.0, 0.0);
  met.stretch.rival_loops = {rival};
  // Own places 20 m apart look alike, but for one niche at 130 m.
  met.differ = [&](const std::vector<OwnComparison>& pairs) {
    std::vector<bool> out;
    for (const OwnComparison& pair : pairs) {
      EXPECT_NEAR(kStep * pair.b - kStep * pair.a, 20.0, 1e-9);
      EXPECT_LT(pair.T_a_b.translation().norm(), 1e-9) << "one scan beside the other";
      out.push_back(std::abs(kStep * pair.b - 130.0) < 2.0 || std::abs(kStep * pair.a - 130.0) < 2.0);
    }
    return out;
  };
  const std::optional<MergeAdvice> advice = met.advice([](double m) { return m > 80.0; });
  ASSERT_TRUE(advice);
  EXPECT_NEAR(advice->to_m, 110.0, kSpacing) << "where the rival would show the niche";
  const double loss =
      std::log((1.0 - chance_to_go_on(kChances, 0)) / (1.0 - kFleetEvidence.agreement_if_true));
  EXPECT_NEAR(advice->gain, loss + gain_of(1, met.num_passed()), 1e-12);
}

/// A map of 200 m of which the descriptors of 100 to 140 m are like no others.
struct Own {
  OdometryChain chain = along_x(401);
  std::vector<std::uint32_t> shared;
  std::size_t num_asked = 0;

  template <class IsDistinctive>
  std::optional<MergeAdvice> advice(double missing, const IsDistinctive& is_distinctive) {
    OwnLandmarks landmarks;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const double m = kStep * static_cast<double>(k);
      landmarks.distances.push_back(m >= 100.0 && m <= 140.0 ? 0.6 : 0.2);
    }
    landmarks.chances = kChances;
    landmarks.distinctive = [&](const std::vector<std::uint32_t>& keyframes) {
      num_asked += keyframes.size();
      std::vector<bool> out;
      for (const std::uint32_t k : keyframes) out.push_back(is_distinctive(kStep * k));
      return out;
    };
    return where_to_be_recognised(chain, shared, missing, kSpacing, landmarks);
  }
};

TEST(MergeAdvice, WhereNothingIsSharedItLeadsToWhatStandsOutMost) {
  Own own;
  const std::optional<MergeAdvice> advice = own.advice(100.0, kEverywhere);
  ASSERT_TRUE(advice);
  EXPECT_LE(advice->from_m, 100.0 + kSpacing);
  EXPECT_GE(advice->to_m, 140.0 - kSpacing);
  EXPECT_NEAR(advice->from.x(), advice->from_m, 1e-9);
  EXPECT_LE(advice->to_m - advice->from_m, 60.0);
  EXPECT_EQ(own.num_asked, 21U);
  EXPECT_NEAR(advice->gain, gain_of(21, 0), 1e-12);
  EXPECT_EQ(advice->missing, 100.0);
}

TEST(MergeAdvice, WhereNothingIsSharedItEndsWhereEnoughIsToBeExpected) {
  Own own;
  const std::optional<MergeAdvice> advice = own.advice(1.0, [](double m) { return m > 110.0; });
  ASSERT_TRUE(advice);
  EXPECT_GE(advice->gain, 1.0);
  EXPECT_LT(advice->gain, 1.0 + gain_of(1, 0));
  EXPECT_GT(advice->to_m, 110.0);
  EXPECT_LT(advice->to_m, 125.0);
}

TEST(MergeAdvice, ItLeadsFromOnePlaceToAnotherAtLeast) {
  Own own;
  const std::optional<MergeAdvice> advice = own.advice(1e-3, kEverywhere);
  ASSERT_TRUE(advice);
  EXPECT_NEAR(advice->to_m - advice->from_m, kSpacing, 1e-9);
  Own hardly_driven;
  hardly_driven.chain = along_x(4);
  EXPECT_FALSE(hardly_driven.advice(1.0, kEverywhere));
}

TEST(MergeAdvice, ItLeadsToNoPlaceThatIsSharedOrWouldTellNothing) {
  Own own;
  EXPECT_FALSE(own.advice(1.0, kNowhere));
  for (std::uint32_t k = 160; k <= 320; k += 4) own.shared.push_back(k);  // 80 to 160 m
  const std::optional<MergeAdvice> advice = own.advice(100.0, kEverywhere);
  ASSERT_TRUE(advice);
  EXPECT_TRUE(advice->to_m < 80.0 || advice->from_m > 160.0) << advice->from_m << " to " << advice->to_m;
  for (std::uint32_t k = 0; k < own.chain.size(); ++k) own.shared.push_back(k);
  EXPECT_FALSE(own.advice(1.0, kEverywhere));
}

TEST(MergeAdvice, NamesRobotsPlaceMetresAndGain) {
  const MergeAdvice on{143.2, 183.0, {51.23, -8.04, 0.0}, 5.11, 4.0};
  EXPECT_EQ(
      in_words(on, "robot_0", "robot_2"),
      "let robot_2 drive along the path of robot_0 from 143 m (x 51.2, y -8.0 m of its odometry) to 183 "
      "m: these 40 m are worth 5.1, where 4.0 is missing");
  MergeAdvice back = on;
  back.to_m = 100.0;
  EXPECT_NE(in_words(back, "a", "b").find(" back to 100 m: these 43 m"), std::string::npos);
}

}  // namespace
}  // namespace adit
