// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/registration/agreement.hpp"
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
  double walk = 0.0;           ///< Squared in 1 - cosine, unlike the model.
  double tenfold = 0.0;        ///< By intensity.
  float unit = 1.0F;           ///< Of the intensities that are stated.
  bool is_half_known = false;  ///< Whether every other return states none.
};

/// Of returns from the drift: rock and shotcrete by turns, every three metres.
double intensity_at(const Eigen::Vector3f& place, double cosine) {
  const int cells = static_cast<int>(std::floor(place.x() / 3.0F) + std::floor(place.z() / 3.0F));
  return (cells % 2 == 0 ? 5.0 : 60.0) * cosine;
}

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
    const double intensity = intensity_at(viewpoint + range * direction.matrix(), 1.0 - off_normal);
    const double error = errors.bias + errors.walk * off_normal * off_normal +
                         errors.tenfold * std::log10(intensity) + 0.01 * rng.normal();
    const bool is_known = !errors.is_half_known || i % 2 == 0;
    cloud.intensities.push_back(is_known ? errors.unit * static_cast<float>(intensity) : 0.0F);
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

/// Of one pair of scans, fitted.
OffsetSystem offsets_between(const RangeErrors& of_a, const RangeErrors& of_b) {
  const SeenSurface a = seen_from(kFromA, of_a, 1);
  const SeenSurface b = seen_from(kFromB, of_b, 2);
  const std::vector<PatchOffset> found = patch_offsets(a, b, fitted(a, b), Pose(), {});
  const Eigen::Index num = std::ssize(found);
  OffsetSystem out{Eigen::VectorXd(num), {num, kSensorErrors}, {num, 6}, {0}};
  Eigen::Matrix<double, Eigen::Dynamic, 2> known(num, 2);
  for (Eigen::Index i = 0; i < num; ++i) {
    const PatchOffset& offset = found[static_cast<std::size_t>(i)];
    out.metres[i] = offset.metres;
    out.by_sensors.row(i) = offset.by_sensors.transpose();
    out.by_fit.row(i) = offset.by_fit.transpose();
    known.row(i) = offset.by_known.transpose();
  }
  centre_intensities(out.by_sensors, known);
  return out;
}

Eigen::VectorXd left_of(const OffsetSystem& offsets) { return taken_apart(offsets, {}).left; }

TEST(SensorDifference, AnErrorOfTheFitIsNoRelief) {
  const OffsetSystem exact = offsets_between({}, {});
  OffsetSystem moved = exact;
  Vector6 error;
  error << 0.02, -0.03, 0.01, 0.002, -0.003, 0.004;
  moved.metres += moved.by_fit * error;
  ASSERT_GT(rms(moved.metres), 2.0 * rms(exact.metres));
  EXPECT_LT(rms(left_of(moved) - left_of(exact)), 0.2 * rms(left_of(exact)));
}

TEST(SensorDifference, SolvesForEachFitAndBothSensorsTogether) {
  // Three pairs against the same normal equations with nothing eliminated.
  OffsetSystem all = offsets_between({}, {0.02, 0.0});
  const OffsetSystem second = offsets_between({}, {0.0, 0.03});
  const OffsetSystem third = offsets_between({0.01, 0.01}, {});
  for (const OffsetSystem* more : {&second, &third}) {
    const Eigen::Index before = all.metres.size();
    const Eigen::Index num = before + more->metres.size();
    all.first_of_pair.push_back(before);
    all.metres.conservativeResize(num);
    all.by_sensors.conservativeResize(num, Eigen::NoChange);
    all.by_fit.conservativeResize(num, Eigen::NoChange);
    all.metres.tail(num - before) = more->metres;
    all.by_sensors.bottomRows(num - before) = more->by_sensors;
    all.by_fit.bottomRows(num - before) = more->by_fit;
  }
  const Eigen::Index num = all.metres.size();
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(num, kSensorErrors + 18);
  design.leftCols(kSensorErrors) = all.by_sensors;
  for (Eigen::Index i = 0; i < num; ++i) {
    const Eigen::Index pair = i < all.first_of_pair[1] ? 0 : i < all.first_of_pair[2] ? 1 : 2;
    design.block<1, 6>(i, kSensorErrors + 6 * pair) = all.by_fit.row(i);
  }
  const OffsetPrior prior;
  Eigen::VectorXd sigmas = Eigen::VectorXd::Constant(design.cols(), prior.ring_m);
  for (const int sensor : {0, kErrorsOfSensor})
    sigmas.segment<3>(sensor) << prior.bias_m, prior.walk_m, prior.per_tenfold_m;
  for (int pair = 0; pair < 3; ++pair)
    sigmas.segment<6>(kSensorErrors + 6 * pair) << Vector3::Constant(prior.fit_m),
        Vector3::Constant(prior.fit_rad);
  // What is left is orthogonal to the design, by the weights that it gives itself and but for the prior.
  const Eigen::VectorXd left = taken_apart(all, prior).left;
  std::vector<double> sizes(left.begin(), left.end());
  for (double& size : sizes) size = std::abs(size);
  std::ranges::nth_element(sizes, sizes.begin() + num / 2);
  const double sigma = 1.4826 * sizes[static_cast<std::size_t>(num / 2)];
  const Eigen::VectorXd weights =
      (1.0 - (left.array() / (4.685 * sigma)).square()).max(0.0).square() / (sigma * sigma);
  const Eigen::MatrixXd weighted = design.transpose() * weights.asDiagonal();
  Eigen::MatrixXd H = weighted * design;
  H.diagonal() += sigmas.array().square().inverse().matrix();
  const Eigen::VectorXd expected = all.metres - design * H.llt().solve(weighted * all.metres);
  EXPECT_LT(rms(left - expected), 0.03 * rms(expected));  // the rounds end before it has settled to less
}

TEST(SensorDifference, ExplainsWhatUnitsDifferIn) {
  const double noise = rms(left_of(offsets_between({}, {})));
  ASSERT_LT(noise, 0.006);
  for (const RangeErrors& of_b :
       {RangeErrors{0.03, 0.0}, {-0.02, 0.02}, {0.06, 0.0}, {0.0, 0.03}, {0.0, 0.0, 0.02}}) {
    const OffsetSystem offsets = offsets_between({-0.01, 0.0}, of_b);
    EXPECT_GT(rms(offsets.metres), 1.4 * noise) << of_b.bias;  // there is something to explain
    EXPECT_LT(rms(left_of(offsets)), 1.25 * noise) << of_b.bias;
  }
}

TEST(SensorDifference, DarkAndBrightWallsAreNoRelief) {
  const OffsetSystem offsets = offsets_between({}, {0.0, 0.0, 0.02});
  OffsetSystem without = offsets;
  for (const int sensor : {0, kErrorsOfSensor}) without.by_sensors.col(sensor + kIntensityError).setZero();
  EXPECT_GT(rms(left_of(without)), 1.25 * rms(left_of(offsets)));
}

TEST(SensorDifference, TheUnitOfIntensitiesDoesNotMatter) {
  const OffsetSystem one = offsets_between({}, {0.0, 0.0, 0.02});
  const OffsetSystem other = offsets_between({}, {0.0, 0.0, 0.02, 1000.0F});
  EXPECT_LT(rms(left_of(one) - left_of(other)), 1e-5);
}

TEST(SensorDifference, ReturnsOfUnknownIntensitySayNothing) {
  EXPECT_TRUE(
      offsets_between({}, {0.0, 0.0, 0.0, 0.0F}).by_sensors.col(kErrorsOfSensor + kIntensityError).isZero());
  // Patches whose returns are known in part are explained in part.
  const double without = rms(left_of(offsets_between({}, {0.0, 0.0, 0.02, 0.0F})));
  EXPECT_LT(rms(left_of(offsets_between({}, {0.0, 0.0, 0.02, 100.0F, true}))), 0.95 * without);
}

TEST(SensorDifference, ReliefIsNotOfTheSensors) {
  OffsetSystem offsets = offsets_between({}, {});
  Rng rng(3);
  for (double& metres : offsets.metres) metres += rng.uniform() < 0.5 ? 0.01 : -0.01;
  EXPECT_GT(rms(left_of(offsets)), 0.009);
}

TEST(SensorDifference, ChangedPlacesDoNotDisturbIt) {
  const OffsetSystem of_units = offsets_between({}, {0.03, 0.0});
  const Eigen::VectorXd before = left_of(of_units);
  for (const auto& [every, metres] : {std::pair(8, 0.1), {5, 0.045}}) {  // a fifth of the walls lined anew
    OffsetSystem offsets = of_units;
    for (Eigen::Index i = 0; i < offsets.metres.size(); i += every) offsets.metres[i] += metres;
    const Eigen::VectorXd after = left_of(offsets);
    std::vector<double> moved;
    for (Eigen::Index i = 1; i < after.size(); i += every) moved.push_back(std::abs(after[i] - before[i]));
    std::ranges::nth_element(moved, moved.begin() + std::ssize(moved) / 2);
    EXPECT_LT(moved[moved.size() / 2], 0.002) << every;
  }
}

// The same patches seen twice, with other noise, of which two in five stand 45 mm off both times.
TEST(SensorDifference, WhatRepeatsTellsMovedWallsFromNoise) {
  constexpr double kNoise = 0.004;
  const OffsetSystem once = offsets_between({}, {0.03, 0.0});
  const Eigen::Index num = once.metres.size();
  OffsetSystem twice{Eigen::VectorXd(2 * num), {2 * num, kSensorErrors}, {2 * num, 6}, {0, num}};
  twice.by_sensors << once.by_sensors, once.by_sensors;
  twice.by_fit << once.by_fit, once.by_fit;
  Rng rng(4);
  for (Eigen::Index i = 0; i < 2 * num; ++i)
    twice.metres[i] = once.metres[i % num] + (i % num % 5 < 2 ? 0.045 : 0.0) + kNoise * rng.normal();
  const auto median_of_unmoved = [&](const OffsetSystem& offsets) {
    const Eigen::VectorXd left = left_of(offsets);
    std::vector<double> sizes;
    for (Eigen::Index i = 0; i < 2 * num; ++i)
      if (i % num % 5 >= 2) sizes.push_back(std::abs(left[i]));
    std::ranges::nth_element(sizes, sizes.begin() + std::ssize(sizes) / 2);
    return sizes[sizes.size() / 2];
  };
  const double without = median_of_unmoved(twice);
  for (Eigen::Index i = 0; i < num; ++i) twice.repeated.push_back({i, num + i});
  EXPECT_LT(median_of_unmoved(twice), 0.7 * without);
  EXPECT_NEAR(taken_apart(twice, {}).noise_m, kNoise, 0.1 * kNoise);
}

TEST(SensorDifference, FewOffsetsLeaveThePrior) {
  EXPECT_EQ(taken_apart({Eigen::VectorXd(0), {0, kSensorErrors}, {0, 6}, {}}, {}).left.size(), 0);
  OffsetSystem far{Eigen::VectorXd::Constant(1, 0.5), {1, kSensorErrors}, {1, 6}, {0}};
  far.by_sensors.setZero();
  far.by_fit.setZero();
  far.by_sensors(0, kErrorsOfSensor) = -1.0;
  EXPECT_LT(std::abs(taken_apart(far, {}).by_sensors[0]), 0.1);
}

}  // namespace
}  // namespace adit
