// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/registration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/registration/verification.hpp"

namespace adit {
namespace {

/// Points spread over the rectangle origin + s u + t v, 0 <= s, t <= 1.
void add_rectangle(PointCloud& cloud, Rng& rng, const Vector3& origin, const Vector3& u, const Vector3& v) {
  constexpr double kDensity = 40.0;  // per square metre
  const auto n = static_cast<int>(kDensity * u.cross(v).norm());
  for (int k = 0; k < n; ++k) {
    const Vector3 noise = 0.01 * Vector3(rng.normal(), rng.normal(), rng.normal());
    cloud.points.push_back((origin + rng.uniform() * u + rng.uniform() * v + noise).cast<float>());
  }
}

void add_box(PointCloud& cloud, Rng& rng, const Vector3& low, const Vector3& size) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 u = Vector3::Unit((axis + 1) % 3) * size[(axis + 1) % 3];
    const Vector3 v = Vector3::Unit((axis + 2) % 3) * size[(axis + 2) % 3];
    add_rectangle(cloud, rng, low, u, v);
    add_rectangle(cloud, rng, low + Vector3::Unit(axis) * size[axis], u, v);
  }
}

/// A hall with boxes standing about; `layout` places them, `sample` draws the points.
PointCloud hall(std::uint64_t layout, std::uint64_t sample) {
  Rng place(layout);
  Rng rng(sample);
  PointCloud cloud;
  add_box(cloud, rng, {-10.0, -8.0, -1.5}, {15.0, 12.0, 4.0});
  for (int k = 0; k < 14; ++k) {
    const Vector3 size(place.uniform(0.6, 4.0), place.uniform(0.6, 4.0), place.uniform(0.6, 3.5));
    add_box(cloud, rng, {place.uniform(-9.0, 1.0), place.uniform(-7.0, 0.0), -1.5}, size);
  }
  return cloud;
}

constexpr double kBendRadius = 18.0;  // metres

/// A smooth tube of 4 m radius that turns to the left, seen from its axis, where it leads along x. Its floor
/// is flat, so that it does not roll.
PointCloud bend(std::uint64_t sample) {
  Rng rng(sample);
  PointCloud cloud;
  for (int k = 0; k < 40000; ++k) {
    const double turned = rng.uniform(-0.8, 0.8);
    const double angle = rng.uniform(0.0, 2.0 * std::numbers::pi);
    const double radius = 4.0 + 0.01 * rng.normal();
    const double from_centre = kBendRadius - radius * std::cos(angle);
    const double up = std::max(radius * std::sin(angle), -2.0 + 0.01 * rng.normal());
    cloud.points.push_back(
        Vector3(from_centre * std::sin(turned), kBendRadius - from_centre * std::cos(turned), up)
            .cast<float>());
  }
  return cloud;
}

/// A straight smooth tube of 4 m radius, seen from its axis, x.
PointCloud tube(std::uint64_t sample) {
  Rng rng(sample);
  PointCloud cloud;
  for (int k = 0; k < 40000; ++k) {
    const double angle = rng.uniform(0.0, 2.0 * std::numbers::pi);
    const double radius = 4.0 + 0.01 * rng.normal();
    cloud.points.push_back(
        Vector3(rng.uniform(-15.0, 15.0), radius * std::cos(angle), radius * std::sin(angle)).cast<float>());
  }
  return cloud;
}

TEST(Registration, FindsHallsUnderAnyRotation) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Rng rng(100 + seed);
    const double angle = std::numbers::pi * static_cast<double>(seed) / 6.0;  // up to half a turn
    const Vector3 axis = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
    const Pose T_b_a(so3::exp(angle * axis), Vector3(1.0, -2.0, 0.3));
    const Registration r = register_clouds(hall(seed, 1), transformed(T_b_a, hall(seed, 2)), {});
    ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;
    const Pose error = T_b_a * *r.T_a_b;
    EXPECT_LT(error.translation().norm(), 0.05) << "seed " << seed;
    EXPECT_LT(error.angle(), 0.01) << "seed " << seed;
    EXPECT_GT(r.overlap, 0.9);
    EXPECT_GT(r.weak_axis, 0.05);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(r.information).eigenvalues()[0], 0.0);
  }
}

/// The mean squared Mahalanobis distance of the errors is six where the reported covariance is right. Half
/// and twice that pass: a sigma that is off by a factor of sqrt(2) either way.
TEST(Registration, CovarianceIsOfTheSizeOfTheErrors) {
  double squared_mahalanobis = 0.0;
  const int num_runs = 12;
  for (std::uint64_t seed = 1; seed <= num_runs; ++seed) {
    const Registration r = register_clouds(hall(3, 2 * seed), hall(3, 2 * seed + 1), {});
    ASSERT_TRUE(r.T_a_b.has_value());
    const Vector6 error = r.T_a_b->log();
    squared_mahalanobis += error.dot(r.information * error) / num_runs;
  }
  EXPECT_LT(squared_mahalanobis, 2.0 * 6.0) << "too confident";
  EXPECT_GT(squared_mahalanobis, 0.5 * 6.0) << "too cautious";
}

TEST(Registration, ThePlainPipelineNeedsNoRefinement) {
  RegistrationConfig config;
  config.refine = false;
  config.min_overlap = 0.0;
  const Pose T_b_a = Pose::planar(2.0, 1.0, 2.0);
  const Registration r = register_clouds(hall(4, 1), transformed(T_b_a, hall(4, 2)), config);
  ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;
  const Pose error = T_b_a * *r.T_a_b;
  EXPECT_LT(error.translation().norm(), 0.3);
  EXPECT_LT(error.angle(), 0.05);
}

TEST(Registration, AlignsCloudsFromAGuess) {
  RegistrationConfig config;
  config.refine_distance_voxels = 4.0;
  const Pose T_b_a = Pose::planar(0.4, -0.3, 0.05);
  const Pose T_a_b = align_clouds(hall(4, 1), transformed(T_b_a, hall(4, 2)), Pose(), config);
  EXPECT_LT((T_b_a * T_a_b).translation().norm(), 0.01);
  EXPECT_LT((T_b_a * T_a_b).angle(), 0.002);
  const Pose guess = Pose::planar(3.0, 0.0, 0.0);
  EXPECT_EQ(align_clouds({}, hall(4, 2), guess, config).matrix(), guess.matrix());
  EXPECT_EQ(align_clouds(hall(4, 1), {}, guess, config).matrix(), guess.matrix());
}

TEST(Registration, CliquePruningFindsTheSamePose) {
  RegistrationConfig config;
  config.pruning = Pruning::clique;
  const Pose T_b_a = Pose::planar(2.0, 1.0, -2.0);
  const Registration r = register_clouds(hall(2, 1), transformed(T_b_a, hall(2, 2)), config);
  ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;
  EXPECT_LT((T_b_a * *r.T_a_b).translation().norm(), 0.05);
}

TEST(Registration, KnowsThatATubeIsOpenAlongItsAxis) {
  RegistrationConfig config;
  config.min_inliers = 3;
  const Registration r = register_clouds(tube(17), tube(18), config);
  ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;  // by so few inliers
  EXPECT_LT(r.weak_axis, 0.01);
  EXPECT_GT(std::abs(r.weak_direction.x()), 0.99);
  EXPECT_NE(r.reason.find("slide along"), std::string::npos) << r.reason;
}

TEST(Registration, KnowsThatABendIsOpenAlongItsArc) {
  RegistrationConfig config;
  config.min_inliers = 3;
  const Registration r = register_clouds(bend(17), bend(18), config);
  ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;
  EXPECT_GT(r.weak_axis, 0.01) << "a translation alone meets walls";
  const Matrix6 covariance = inverse(r.information);
  EXPECT_GT(std::sqrt(covariance(0, 0)), 1.0);
  EXPECT_NEAR(covariance(5, 0) / covariance(0, 0), 1.0 / kBendRadius, 0.2 / kBendRadius)
      << "who is farther along has turned farther";
  EXPECT_LT(std::sqrt(covariance(2, 2)), 0.05) << "upwards, it is held";
}

TEST(Registration, DifferentPlacesAreRejectedBecauseNothingLooksAlike) {
  const RegistrationConfig config;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Registration r = register_clouds(hall(seed, 1), tube(seed), config);
    EXPECT_EQ(r.verdict, LoopVerdict::rejected);
    EXPECT_LT(r.num_correspondences, config.min_inliers);
    EXPECT_NE(r.reason.find("look alike"), std::string::npos) << r.reason;
  }
}

TEST(Registration, EachThresholdRejectsWhatIsJustBelowItAndSaysSo) {
  const PointCloud a = hall(2, 1);
  PointCloud b = hall(2, 2);
  std::erase_if(b.points,
                [](const Eigen::Vector3f& p) { return p.x() > 1.0F; });  // so that overlap is partial
  const Registration accepted = register_clouds(a, b, {});
  ASSERT_EQ(accepted.verdict, LoopVerdict::accepted) << accepted.reason;
  ASSERT_LT(accepted.overlap, 0.95);

  RegistrationConfig inliers;
  inliers.min_inliers = accepted.num_inliers;
  EXPECT_EQ(register_clouds(a, b, inliers).verdict, LoopVerdict::accepted);
  ++inliers.min_inliers;
  const Registration too_few = register_clouds(a, b, inliers);
  EXPECT_EQ(too_few.verdict, LoopVerdict::rejected);
  EXPECT_NE(too_few.reason.find(format("{} needed", inliers.min_inliers)), std::string::npos)
      << too_few.reason;

  RegistrationConfig overlap;
  overlap.min_overlap = accepted.overlap;
  EXPECT_EQ(register_clouds(a, b, overlap).verdict, LoopVerdict::accepted);
  overlap.min_overlap = std::nextafter(accepted.overlap, 1.0);
  const Registration too_little = register_clouds(a, b, overlap);
  EXPECT_EQ(too_little.verdict, LoopVerdict::rejected);
  EXPECT_NE(too_little.reason.find("overlap"), std::string::npos) << too_little.reason;
}

TEST(Registration, DegenerateCloudsAreRejectedWithoutATransform) {
  const PointCloud good = hall(1, 1);
  PointCloud three;
  three.points = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  PointCloud line;
  PointCloud copies;
  PointCloud broken;
  for (int k = 0; k < 500; ++k) {
    line.points.emplace_back(0.1F * static_cast<float>(k), 2.0F, 0.0F);
    copies.points.emplace_back(1.0F, 2.0F, 3.0F);
    broken.points.emplace_back(std::nanf(""), 2.0F, std::numeric_limits<float>::infinity());
  }
  for (const PointCloud& bad : {PointCloud{}, three, line, copies, broken}) {
    for (const Registration& r :
         {register_clouds(good, bad, {}), register_clouds(bad, good, {}), register_clouds(bad, bad, {})}) {
      EXPECT_EQ(r.verdict, LoopVerdict::rejected);
      EXPECT_FALSE(r.T_a_b.has_value());
      EXPECT_FALSE(r.reason.empty());
    }
  }
}

TEST(Registration, APlaneAloneIsRejectedAndItsEvidenceIsOpenInTwoDirections) {
  Rng rng(1);
  PointCloud plane;
  add_rectangle(plane, rng, {-10.0, -10.0, -1.5}, {20.0, 0.0, 0.0}, {0.0, 20.0, 0.0});
  const Pose T_b_a = Pose::planar(1.0, 1.0, 1.0);
  const PointCloud moved = transformed(T_b_a, plane);
  EXPECT_EQ(register_clouds(plane, moved, {}).verdict, LoopVerdict::rejected);

  const Features a = compute_features(plane, {});
  const Features b = compute_features(moved, {});
  const Evidence evidence =
      gather_evidence(a, PointGrid(a.points, 1.0), b, PointGrid(b.points, 1.0), T_b_a.inverse(), {});
  EXPECT_GT(evidence.overlap, 0.9);
  EXPECT_LT(evidence.weak_axis, kWeakAxis);
  EXPECT_LT(std::abs(evidence.weak_direction.z()), 0.1) << "it slides in the plane, not out of it";
  const Eigen::SelfAdjointEigenSolver<Matrix3> translation(evidence.information.topLeftCorner<3, 3>());
  EXPECT_LT(translation.eigenvalues()[1], 0.01 * translation.eigenvalues()[2]) << "two open directions";
}

TEST(Registration, NanPointsChangeNothing) {
  const PointCloud a = hall(5, 1);
  const PointCloud b = hall(5, 2);
  PointCloud with_nan = b;
  with_nan.points.insert(with_nan.points.begin() + 10, Eigen::Vector3f::Constant(std::nanf("")));
  const Registration clean = register_clouds(a, b, {});
  const Registration dirty = register_clouds(a, with_nan, {});
  ASSERT_TRUE(clean.T_a_b.has_value());
  EXPECT_EQ(clean.T_a_b->matrix(), dirty.T_a_b->matrix());
}

TEST(RegistrationConfig, DefaultsAreInRange) {
  RegistrationConfig config;
  EXPECT_TRUE(check_fields(fields_of(config)).has_value());
}

}  // namespace
}  // namespace adit
