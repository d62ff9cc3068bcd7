// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/registration/features.hpp"
#include "adit/registration/relief.hpp"

namespace adit {
namespace {

/// A drift with a flat floor, seen from a metre above it: a range error moves walls and roof, and hardly the
/// floor.
const Eigen::Array3f kLow(-9.0F, -2.5F, -1.0F);
const Eigen::Array3f kHigh(9.0F, 3.0F, 4.0F);

struct RangeErrors {
  double bias = 0.0;
  double walk = 0.0;  ///< Squared in 1 - cosine, unlike the model.
};

/// Ranges of a LiDAR at that place in the drift, in its own frame.
SeenSurface seen_from(const Eigen::Vector3f& viewpoint, const RangeErrors& errors, std::uint64_t seed) {
  Rng rng(seed);
  PointCloud cloud;
  for (int i = 0; i < 9000; ++i) {
    const auto azimuth = static_cast<float>(rng.uniform(-3.1416, 3.1416));
    const auto elevation = static_cast<float>(rng.uniform(-0.7, 0.7));
    const Eigen::Array3f direction(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const Eigen::Array3f reach = ((direction > 0.0F).select(kHigh, kLow) - viewpoint.array()) / direction;
    Eigen::Index wall = 0;
    const float range = reach.minCoeff(&wall);
    const auto off_normal = static_cast<double>(1.0F - std::abs(direction[wall]));
    const double error = errors.bias + errors.walk * off_normal * off_normal + 0.01 * rng.normal();
    cloud.points.emplace_back((range + static_cast<float>(error)) * direction.matrix());
  }
  return {compute_surface(cloud, {}), Vector3::Zero(), RegistrationConfig().voxel_size};
}

const Eigen::Vector3f kFromA(0.0F, 0.0F, 0.0F);
const Eigen::Vector3f kFromB(1.0F, 0.4F, 0.0F);
const Pose kT_a_b = Pose::translation_of(1.0, 0.4, 0.0);

Pose fitted(const SeenSurface& a, const SeenSurface& b) {
  return fit_near(a, b, kT_a_b, 0.0, {}, FitFrom::guess).T_a_b;
}

double rms(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

struct Offsets {
  Eigen::VectorXd metres;
  Eigen::MatrixXd terms;
  [[nodiscard]] Eigen::VectorXd left() const { return metres - explained_by_sensors(terms, metres, {}); }
};

Offsets offsets_between(const RangeErrors& of_a, const RangeErrors& of_b) {
  const SeenSurface a = seen_from(kFromA, of_a, 1);
  const SeenSurface b = seen_from(kFromB, of_b, 2);
  const std::vector<PatchOffset> found = patch_offsets(a, b, fitted(a, b), Pose(), {});
  Offsets out{Eigen::VectorXd(std::ssize(found)), Eigen::MatrixXd(std::ssize(found), kSensorErrors)};
  for (std::size_t i = 0; i < found.size(); ++i) {
    out.metres[static_cast<Eigen::Index>(i)] = found[i].metres;
    out.terms.row(static_cast<Eigen::Index>(i)) = found[i].terms.transpose();
  }
  return out;
}

TEST(SensorDifference, TheFitShiftsAsItSays) {
  constexpr double kBias = 0.04;
  constexpr int kTrials = 20;  // a bias moves points into other voxels: noise
  Vector3 shifted = Vector3::Zero();
  Vector3 predicted = Vector3::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto seed = static_cast<std::uint64_t>(2 * trial);
    const SeenSurface a = seen_from(kFromA, {}, seed);
    const SeenSurface b = seen_from(kFromB, {kBias, 0.0}, seed + 1);
    const Pose T_with = fitted(a, b);
    shifted += (T_with.translation() - fitted(a, seen_from(kFromB, {}, seed + 1)).translation()) / kTrials;
    const Vector6 shift = kBias * fit_shift(a, b, T_with, {}).col(kErrorsOfSensor);  // the bias of b
    // In the frame of a: the rotation moves the origin of b, too.
    predicted += (shift.head<3>() + shift.tail<3>().cross(T_with.translation())) / kTrials;
  }
  ASSERT_GT(shifted.norm(), 0.005) << "roof and floor pull apart";
  EXPECT_LT((predicted - shifted).norm(), 0.25 * shifted.norm())
      << predicted.transpose() << ", was " << shifted.transpose();
}

TEST(SensorDifference, ExplainsWhatUnitsDifferIn) {
  const double noise = rms(offsets_between({}, {}).left());
  ASSERT_LT(noise, 0.006);
  for (const RangeErrors& of_b : {RangeErrors{0.03, 0.0}, {-0.02, 0.02}, {0.06, 0.0}, {0.0, 0.03}}) {
    const Offsets offsets = offsets_between({-0.01, 0.0}, of_b);
    EXPECT_GT(rms(offsets.metres), 1.5 * noise) << of_b.bias;
    EXPECT_LT(rms(offsets.left()), 1.25 * noise) << of_b.bias;
  }
}

TEST(SensorDifference, ReliefIsNotOfTheSensors) {
  Offsets offsets = offsets_between({}, {});
  Rng rng(3);
  for (double& metres : offsets.metres) metres += rng.uniform() < 0.5 ? 0.01 : -0.01;
  EXPECT_GT(rms(offsets.left()), 0.009);
}

TEST(SensorDifference, ChangedPlacesDoNotDisturbIt) {
  const Offsets of_units = offsets_between({}, {0.03, 0.0});
  const Eigen::VectorXd before = of_units.left();
  for (const auto& [every, metres] : {std::pair(8, 0.1), {5, 0.045}}) {  // a fifth of the walls lined anew
    Offsets offsets = of_units;
    for (Eigen::Index i = 0; i < offsets.metres.size(); i += every) offsets.metres[i] += metres;
    const Eigen::VectorXd after = offsets.left();
    std::vector<double> moved;
    for (Eigen::Index i = 1; i < after.size(); i += every) moved.push_back(std::abs(after[i] - before[i]));
    std::ranges::nth_element(moved, moved.begin() + std::ssize(moved) / 2);
    EXPECT_LT(moved[moved.size() / 2], 0.002) << every;
  }
}

TEST(SensorDifference, FewOffsetsLeaveThePrior) {
  EXPECT_EQ(explained_by_sensors(Eigen::MatrixXd(0, kSensorErrors), Eigen::VectorXd(0), {}).size(), 0);
  Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(1, kSensorErrors);
  terms(0, kErrorsOfSensor) = -1.0;
  const Eigen::VectorXd far = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_LT(std::abs(explained_by_sensors(terms, far, {})[0]), 0.1);
}

}  // namespace
}  // namespace adit
