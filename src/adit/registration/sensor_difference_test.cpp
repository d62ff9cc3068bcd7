// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

struct Errors {
  double bias = 0.0;
  double walk = 0.0;  ///< Squared in 1 - cosine, unlike the model.
  double tilt = 0.0;  ///< Of ranges, per radian of elevation: rings differ.
  [[nodiscard]] double of(const PatchView& view) const {
    const auto cosine = static_cast<double>(view.cosine);
    return bias + walk * std::pow(1.0 - cosine, 2) + tilt * static_cast<double>(view.elevation);
  }
};

PatchView random_view(Rng& rng) {
  const double cosine = rng.uniform(0.2, 1.0);
  const double elevation = rng.uniform(-0.3, 0.3);
  return {static_cast<float>(cosine), static_cast<float>(elevation)};
}

/// Two scans of patches all around that stand `relief` apart, by turns in front and behind, fitted to one
/// another as a whole.
struct TwoScans {
  std::vector<SeenOffset> offsets;

  TwoScans(const Errors& a, const Errors& b, double relief, double noise) : offsets(3000) {
    Rng rng(5);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      SeenOffset& one = offsets[i];
      one.by_a = random_view(rng);
      one.by_b = random_view(rng);
      one.normal = -random_direction(rng);
      one.point = -5.0F * one.normal + random_direction(rng);
      one.metres = a.of(one.by_a) * static_cast<double>(one.by_a.cosine) -
                   b.of(one.by_b) * static_cast<double>(one.by_b.cosine) + (i % 2 == 0 ? relief : -relief) +
                   noise * rng.normal();
    }
    fit();
  }

  [[nodiscard]] Eigen::VectorXd metres() const {
    Eigen::VectorXd out(std::ssize(offsets));
    for (std::size_t i = 0; i < offsets.size(); ++i) out[static_cast<Eigen::Index>(i)] = offsets[i].metres;
    return out;
  }
  /// Root mean square of what the sensors do not explain.
  [[nodiscard]] double rms_left() const {
    const Eigen::VectorXd left = metres() - explained_by_sensors(sensor_terms(offsets), metres(), {});
    return std::sqrt(left.squaredNorm() / static_cast<double>(left.size()));
  }

 private:
  static Eigen::Vector3f random_direction(Rng& rng) {
    const auto x = static_cast<float>(rng.normal());
    const auto y = static_cast<float>(rng.normal());
    const auto z = static_cast<float>(rng.normal());
    return Eigen::Vector3f(x, y, z).normalized();
  }
  /// Point to plane: moves b by what makes the offsets least.
  void fit() {
    Eigen::MatrixXd motion(std::ssize(offsets), 6);
    for (Eigen::Index i = 0; i < motion.rows(); ++i) {
      const SeenOffset& one = offsets[static_cast<std::size_t>(i)];
      motion.row(i) << one.normal.cast<double>().transpose(),
          one.point.cross(one.normal).cast<double>().transpose();
    }
    const Eigen::VectorXd moved = motion * motion.colPivHouseholderQr().solve(metres());
    for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i].metres -= moved[static_cast<Eigen::Index>(i)];
  }
};

double rms(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

TEST(SensorDifference, ExplainsWhatUnitsOfASensorDifferIn) {
  const TwoScans scans({-0.02, 0.0, -0.02}, {0.03, 0.03, 0.02}, 0.0, 0.005);
  EXPECT_GT(rms(scans.metres()), 0.02);
  EXPECT_LT(scans.rms_left(), 0.0055);
}

// Half of the patches see the error, so a fit of the scans tilts and moves by a part of it.
TEST(SensorDifference, WhatTheFitOfTheScansTookOverIsFoundToo) {
  TwoScans scans({}, {}, 0.0, 0.0);
  for (SeenOffset& one : scans.offsets) {
    one.by_a = one.by_b = {one.normal.z() < 0.0F ? 1.0F : 0.1F, 0.0F};
    one.metres = -0.03 * static_cast<double>(one.by_b.cosine);
  }
  const SensorTerms terms = sensor_terms(scans.offsets);
  EXPECT_LT(rms(terms.col(0)), 0.9 * rms(scans.metres()) / 0.03) << "a part is motion";
  const Eigen::VectorXd fitted = -0.03 * terms.col(0);  // what is left after the fit
  EXPECT_LT(rms(fitted - explained_by_sensors(terms, fitted, {})), 1e-3);
}

TEST(SensorDifference, ReliefIsNotOfTheSensors) {
  EXPECT_NEAR(TwoScans({}, {}, 0.01, 0.002).rms_left(), 0.01, 0.001);
}

TEST(SensorDifference, ChangedPlacesDoNotDisturbIt) {
  TwoScans scans({}, {0.02, 0.0, 0.0}, 0.0, 0.005);
  for (std::size_t i = 0; i < scans.offsets.size(); i += 5) scans.offsets[i].metres += 0.1;
  const SensorTerms terms = sensor_terms(scans.offsets);
  const Eigen::VectorXd left = scans.metres() - explained_by_sensors(terms, scans.metres(), {});
  std::vector<double> unchanged;
  for (std::size_t i = 1; i < scans.offsets.size(); i += 5)
    unchanged.push_back(std::abs(left[static_cast<Eigen::Index>(i)]));
  std::ranges::nth_element(unchanged, unchanged.begin() + std::ssize(unchanged) / 2);
  EXPECT_LT(unchanged[unchanged.size() / 2], 0.008);
}

TEST(SensorDifference, FewOffsetsLeaveThePrior) {
  EXPECT_EQ(explained_by_sensors({}, {}, {}).size(), 0);
  const std::vector<SeenOffset> one(1, {0.5});
  EXPECT_LT(std::abs(explained_by_sensors(sensor_terms(one), Eigen::VectorXd::Constant(1, 0.5), {})[0]), 0.5);
}

}  // namespace
}  // namespace adit
