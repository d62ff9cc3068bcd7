// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/revisits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "support/loop_information.hpp"

namespace adit {
namespace {

/// Steps of one metre, each turning by `turn` radians.
OdometryChain drive(std::size_t num, double turn) {
  std::vector<Pose> poses{Pose()};
  while (poses.size() < num) poses.push_back(poses.back() * Pose::planar(1.0, 0.0, turn));
  return {poses, std::vector<Matrix6>(num - 1, random_walk({}, 1.0))};
}

constexpr double kRound = 2.0 * std::numbers::pi / 200.0;  // a circle of 200 m

TEST(Revisits, NoneOnAStraightDriveOrBesideItself) {
  for (const double turn : {0.0, 0.5 * kRound}) {
    const OdometryChain chain = drive(200, turn);
    for (std::uint32_t k = 0; k < chain.size(); ++k) EXPECT_TRUE(possible_revisits(chain, k).empty()) << k;
  }
}

TEST(Revisits, TheSecondRoundMayMeetTheFirst) {
  const OdometryChain chain = drive(300, kRound);
  const std::vector<std::uint32_t> found = possible_revisits(chain, 40);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found.front(), 200U);
  EXPECT_LE(found.front(), 236U);
  EXPECT_GE(found.back(), 244U);
  EXPECT_LT(found.back(), 280U);
}

// As the plain rule says, far from the origin of the odometry too, where terms of its covariance cancel.
TEST(Revisits, AreAllThatOdometryAllows) {
  Rng rng(3);
  for (const double origin_m : {0.0, 3000.0}) {
    std::vector<Pose> poses{Pose::translation_of(origin_m, -origin_m, 0.0)};
    while (poses.size() < 400) {
      const double turn = kRound * (1.0 + 3.0 * rng.normal());
      poses.push_back(poses.back() * Pose::planar(1.0, 0.0, turn, 0.02 * rng.normal()));
    }
    const OdometryChain chain(poses, std::vector<Matrix6>(poses.size() - 1, random_walk({}, 1.0)));
    const RevisitConfig config;
    std::size_t num = 0;
    for (std::uint32_t k = 0; k < chain.size(); ++k) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t later = k + 1; later < chain.size(); ++later) {
        const double drift = std::sqrt(chain.covariance(k, later).topLeftCorner<3, 3>().trace());
        if (chain.path_m()[later] - chain.path_m()[k] >= config.path_m &&
            chain.between(k, later).translation().norm() < config.near_m + config.sigmas * drift)
          expected.push_back(later);
      }
      ASSERT_EQ(possible_revisits(chain, k, config), expected) << k;
      num += expected.size();
    }
    EXPECT_GT(num, 100U);
    EXPECT_LT(num, chain.size() * chain.size() / 4);
  }
}

TEST(Revisits, OdometryAcceptsItsDriftAndExcludesWhatIsFarBeyond) {
  const OdometryChain chain = drive(300, kRound);
  const auto loop = [&](double ahead) {
    return PcmLoop{40, 240, chain.between(40, 240) * Pose::translation_of(ahead, 0.0, 0.0),
                   test::loop_information()};
  };
  EXPECT_TRUE(fits_odometry(chain, loop(0.0)));
  EXPECT_TRUE(fits_odometry(chain, loop(4.0)));
  EXPECT_FALSE(fits_odometry(chain, loop(40.0)));
  EXPECT_GT(odometry_evidence(chain, loop(0.0)), odometry_evidence(chain, loop(4.0)));
  EXPECT_LT(odometry_evidence(chain, loop(40.0)), 0.0);
}

TEST(Revisits, OfLookAlikesTheEvidenceIsNoneOnAverage) {
  const OdometryChain chain = drive(300, kRound);
  const double radius = 5.0 + 3.0 * std::sqrt(chain.covariance(40, 240).topLeftCorner<3, 3>().trace());
  Rng rng(1);
  double sum = 0.0;
  int num = 0;
  for (int i = 0; i < 40000; ++i) {
    const double x = rng.uniform(-radius, radius);
    const double y = rng.uniform(-radius, radius);
    if (std::hypot(x, y) > radius) continue;
    const Pose T_a_b = chain.between(40, 240) * Pose::translation_of(x, y, 0.0);
    sum += std::exp(odometry_evidence(chain, {40, 240, T_a_b, test::loop_information()}));
    ++num;
  }
  EXPECT_NEAR(sum / num, 1.0, 0.1);  // a likelihood ratio: Wald's error rate stands
}

}  // namespace
}  // namespace adit
