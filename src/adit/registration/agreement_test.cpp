// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/registration/features.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

// The robot standing still at x; its frame is that of the sensor.
SeenSurface seen_at(const test::Scene& scene, double x, std::uint64_t seed) {
  test::Lidar lidar{64, 512, 0.6, 60.0, 0.01};
  lidar.jitter = 0.5;
  lidar.seed = seed;
  const test::Drive still{Pose::planar(x, 0.0, 0.0), Vector6::Zero()};
  return {compute_surface(test::scan_of(scene, lidar, Pose(), still, 0).cloud, {}), Vector3::Zero(),
          RegistrationConfig().voxel_size};
}

test::Scene with_block(double x = 5.0) {
  test::Scene scene = test::smooth_tube();
  scene.boxes.push_back({{x, 1.0, -2.0}, {x + 3.0, 4.0, 1.5}});
  return scene;
}

Agreement between(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b) {
  return agreement(a, b, T_a_b, {});
}

constexpr double kNoise = 12.0;  // points of a patch that noise and beams leave

TEST(Agreement, OneSceneSeenFromTwoPlacesIsConfirmed) {
  const Agreement found =
      between(seen_at(with_block(), 0.0, 1), seen_at(with_block(), 2.0, 2), Pose::planar(2.0, 0.0, 0.0));
  EXPECT_TRUE(found.is_comparable());
  EXPECT_GT(found.confirmed, 0.95);
  EXPECT_LT(found.largest_difference, kNoise);
}

TEST(Agreement, ABlockThatOnlyOneOfThemHasIsADifference) {
  const SeenSurface empty = seen_at(test::smooth_tube(), 0.0, 1);
  const Pose T_a_b = Pose::planar(2.0, 0.0, 0.0);
  const Agreement there = between(empty, seen_at(with_block(), 2.0, 2), T_a_b);
  const Agreement same = between(empty, seen_at(test::smooth_tube(), 2.0, 3), T_a_b);
  EXPECT_GT(there.largest_difference, 5.0 * kNoise);
  EXPECT_LT(same.largest_difference, kNoise);
  EXPECT_LT(there.confirmed, same.confirmed);
}

// Beside the wall on the floor of the tube (2.5 m below the sensor at its lowest), clear of wall and roof.
test::Scene with_vehicle(double height = 1.6) {
  test::Scene scene = test::smooth_tube();
  scene.boxes.push_back({{5.0, 0.4, -2.4}, {8.5, 1.6, -2.4 + height}});
  return scene;
}

DifferingPatch largest_thing(const Agreement& found) {
  DifferingPatch largest;
  for (const DifferingPatch& thing : found.things)
    if (thing.num_points > largest.num_points) largest = thing;
  return largest;
}

TEST(Agreement, AVehicleThatOnlyOneOfThemMetIsAThing) {
  const Pose T_a_b = Pose::planar(2.0, 0.0, 0.0);
  const SeenSurface empty = seen_at(test::smooth_tube(), 0.0, 1);
  const SeenSurface met = seen_at(with_vehicle(), 2.0, 2);
  const Agreement found = between(empty, met, T_a_b);
  EXPECT_LT(found.largest_difference, kNoise);
  EXPECT_GT(largest_thing(found).num_points, 2.0 * kNoise);
  EXPECT_NEAR(largest_thing(found).position.x(), 6.5, 2.0);
  const Agreement back = between(met, empty, T_a_b.inverse());
  EXPECT_NEAR(largest_thing(back).position.x(), 4.5, 2.0);
}

TEST(Agreement, DoesNotDependOnWhichScanIsFirst) {
  const SeenSurface a = seen_at(test::smooth_tube(), 0.0, 1);
  const SeenSurface b = seen_at(with_block(), 2.0, 2);
  const Pose T_a_b = Pose::planar(2.1, 0.1, 0.02);
  const Agreement forth = between(a, b, T_a_b);
  const Agreement back = between(b, a, T_a_b.inverse());
  EXPECT_NEAR(forth.confirmed, back.confirmed, 1e-3);
  EXPECT_GT(back.largest_difference, 5.0 * kNoise);
  EXPECT_GT(forth.largest_difference, 5.0 * kNoise);
}

TEST(Agreement, HiddenPointsDoNotCount) {
  // Seen from behind the block, the tube on its other side is hidden; nothing of it counts against the pose.
  const Agreement found =
      between(seen_at(with_block(), 0.0, 1), seen_at(with_block(), 12.0, 2), Pose::planar(12.0, 0.0, 0.0));
  EXPECT_LT(found.largest_difference, kNoise);
}

TEST(Agreement, FreeSpaceBeginsAtTheSensor) {
  // The same surfaces, one of them with a viewpoint beyond the block: beams seem to have passed through it.
  const SeenSurface a = seen_at(with_block(), 0.0, 1);
  const SeenSurface b = seen_at(with_block(), 2.0, 2);
  const Vector3 wrong(6.5, 3.5, 0.0);
  const Agreement right = between(a, b, Pose::planar(2.0, 0.0, 0.0));
  const Agreement from_elsewhere =
      between({a.points(), wrong, RegistrationConfig().voxel_size}, b, Pose::planar(2.0, 0.0, 0.0));
  EXPECT_GT(from_elsewhere.largest_difference, right.largest_difference);
}

TEST(Agreement, OfNothingIsNotComparable) {
  const SeenSurface a = seen_at(with_block(), 0.0, 1);
  const SeenSurface nothing({}, Vector3::Zero(), RegistrationConfig().voxel_size);
  EXPECT_FALSE(between(a, nothing, Pose()).is_comparable());
  EXPECT_FALSE(between(nothing, a, Pose()).is_comparable());
  EXPECT_FALSE(fit_near(a, nothing, Pose(), kNoise, {}).agreement.is_comparable());
}

TEST(FitNear, CorrectsAGuess) {
  const SeenSurface a = seen_at(with_block(), 0.0, 1);
  const SeenSurface b = seen_at(with_block(), 2.0, 2);
  const LocalFit fit = fit_near(a, b, Pose::planar(2.4, 0.2, 0.02), kNoise, {});
  EXPECT_LT((fit.T_a_b.translation() - Vector3(2.0, 0.0, 0.0)).norm(), 0.05);
  EXPECT_LT(fit.agreement.largest_difference, kNoise);
}

TEST(FitNear, LooksFartherAlongThePathWhereTheGuessDoesNotFit) {
  // The ends of the block are 1.8 m off, more than points are matched over.
  const SeenSurface a = seen_at(with_block(), 0.0, 1);
  const SeenSurface b = seen_at(with_block(), 2.0, 2);
  const Pose guess = Pose::planar(3.8, 0.0, 0.0);
  const LocalFit once = fit_near(a, b, guess, kNoise, {}, FitFrom::guess);
  const LocalFit anew = fit_near(a, b, guess, kNoise, {});
  EXPECT_GT(once.agreement.largest_difference, kNoise);
  EXPECT_LT(anew.agreement.largest_difference, kNoise);
  EXPECT_NEAR(anew.T_a_b.translation().x(), 2.0, 0.1);
}

TEST(FitNear, DoesNotMatchTwoBlocksThatAreFarApart) {
  const SeenSurface a = seen_at(with_block(5.0), 0.0, 1);
  const SeenSurface b = seen_at(with_block(10.0), 0.0, 2);
  EXPECT_GT(fit_near(a, b, Pose(), kNoise, {}).agreement.largest_difference, 2.0 * kNoise);
}

TEST(AgreeingFit, IsTheFitFromTheGuessWhereThatAgrees) {
  const SeenSurface a = seen_at(with_block(), 0.0, 1);
  const SeenSurface b = seen_at(with_block(), 2.0, 2);
  const SeenSurface nothing({}, Vector3::Zero(), RegistrationConfig().voxel_size);
  std::size_t num_agreeing = 0;
  for (const double x : {1.0, 1.6, 2.0, 2.4, 2.9, 3.4, 3.8, 6.0}) {
    const LocalFit fit = fit_near(a, b, Pose::planar(x, 0.1, 0.01), kNoise, {}, FitFrom::guess);
    const std::optional<Pose> agreeing = agreeing_fit(a, b, Pose::planar(x, 0.1, 0.01), kNoise, {});
    ASSERT_EQ(agreeing.has_value(), fit.agreement.largest_difference <= kNoise) << x;
    if (!agreeing) continue;
    ++num_agreeing;
    EXPECT_EQ(agreeing->matrix(), fit.T_a_b.matrix());
  }
  EXPECT_GT(num_agreeing, 1U);
  EXPECT_LT(num_agreeing, 8U);
  constexpr double kAny = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(agreeing_fit(a, nothing, Pose(), kAny, {}).has_value());
}

// By the definition: about seven points lie within 1.5 voxels on a plane without gaps.
double thinness_by_brute_force(const std::vector<Eigen::Vector3f>& points, float voxel) {
  const float reach = 1.5F * voxel;
  std::vector<std::ptrdiff_t> counts;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(points.size() / 64, 1)) {
    if (points[i].norm() > 10.0F) continue;
    counts.push_back(std::ranges::count_if(points, [&](const Eigen::Vector3f& other) {
      return (other - points[i]).squaredNorm() < reach * reach;
    }));
  }
  if (counts.empty()) return 1.0;
  std::ranges::sort(counts);
  const auto middle = static_cast<double>(counts[counts.size() / 2]);
  return std::clamp(std::numbers::pi * 1.5 * 1.5 / middle, 1.0, 4.0);
}

// Around the sensor, on a tube: at random, or on 16 rings as a sparse LiDAR sees them.
OrientedPoints on_a_tube(std::uint64_t seed, std::size_t num, bool on_rings) {
  Rng rng(seed);
  OrientedPoints out;
  while (out.size() < num) {
    const double angle = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const double ring = 0.035 * (static_cast<double>(rng.below(16)) - 7.5);
    const double slope = on_rings ? std::abs(std::tan(ring) / std::sin(angle)) : 1.0;
    const double along = on_rings ? 4.0 / std::max(slope, 0.1) : rng.uniform(-20.0, 20.0);
    out.points.emplace_back(static_cast<float>(along), static_cast<float>(4.0 * std::cos(angle)),
                            static_cast<float>(4.0 * std::sin(angle) + 0.01 * rng.normal()));
    out.normals.push_back(-Eigen::Vector3f(0.0F, out.points.back().y(), out.points.back().z()).normalized());
  }
  return out;
}

TEST(SeenSurface, IsAsThinAsItsPointsAreFew) {
  std::set<double> values;
  for (const bool on_rings : {false, true})
    for (const std::size_t num : {0U, 1U, 60U, 1000U, 6000U})
      for (const float voxel : {0.1F, 0.2F, 0.3F, 0.5F}) {
        const OrientedPoints points = on_a_tube(num + 1, num, on_rings);
        const double expected = thinness_by_brute_force(points.points, voxel);
        const SeenSurface seen(points, Vector3::Zero(), static_cast<double>(voxel));
        EXPECT_EQ(seen.thinness(), expected) << on_rings << ' ' << num << ' ' << voxel;
        values.insert(expected);
      }
  EXPECT_GT(values.size(), 4U);
}

TEST(SeenSurface, WasSeenInTheCellOfADirection) {
  // By the definition: cells of three degrees.
  const auto cell = [](double degrees) { return static_cast<int>(std::floor(degrees / 3.0)); };
  OrientedPoints one;
  one.points = {{10.0F, 0.1F, 0.1F}};
  one.normals = {-Eigen::Vector3f::UnitX()};
  for (const double elevation : {-0.5, 0.5}) {  // the point lies between: what is beyond the view is empty
    one.points.push_back({-20.0F, 0.0F, static_cast<float>(20.0 * std::tan(elevation))});
    one.normals.push_back(Eigen::Vector3f::UnitX());
  }
  const SeenSurface seen(one, Vector3::Zero(), 0.3);
  const double at = std::atan2(0.1, 10.0) * 180.0 / std::numbers::pi;
  for (int step = -3600; step < 3600; ++step) {
    const double degrees = 0.02501 * step;
    const double radians = degrees * std::numbers::pi / 180.0;
    const Eigen::Vector3f direction(static_cast<float>(std::cos(radians)),
                                    static_cast<float>(std::sin(radians)), 0.01F);
    const bool was_seen = cell(degrees) == cell(at);
    EXPECT_EQ(!seen.towards(direction).empty(), was_seen) << degrees;
    if (was_seen) {
      EXPECT_FLOAT_EQ(seen.towards(direction).farthest, one.points.front().norm());
    }
  }
}

}  // namespace
}  // namespace adit
