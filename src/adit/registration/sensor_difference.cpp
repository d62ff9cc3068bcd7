// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "adit/core/angles.hpp"

namespace adit {
namespace {

/// Rings are taken together by elevation: errors at nodes, linear in between.
constexpr double kNodeSpacing = 4.0 * kDegree;
constexpr int kNodesToEachSide = 8;
constexpr int kNodes = 2 * kNodesToEachSide + 1;
constexpr int kOfSensor = 2 + kNodes;  ///< Bias, walk, nodes.
constexpr int kAll = 2 * kOfSensor;

/// The derivative of an offset by the errors of one sensor, where it is not zero.
struct Terms {
  std::array<int, 4> index;
  std::array<double, 4> value;
};

/// A range that is too long by e puts the wall e times the cosine behind.
Terms terms_of(const PatchView& view, double sign, int first) {
  const auto cosine = static_cast<double>(view.cosine);
  const double moved = -sign * cosine;
  const double place =
      std::clamp(static_cast<double>(view.elevation) / kNodeSpacing + kNodesToEachSide, 0.0, kNodes - 1.001);
  const int node = static_cast<int>(place);
  const double beyond = place - node;
  return {{first, first + 1, first + 2 + node, first + 3 + node},
          {moved, moved * (1.0 - cosine), moved * (1.0 - beyond), moved * beyond}};
}

struct Row {
  std::array<int, 8> index;
  std::array<double, 8> value;

  explicit Row(const SeenOffset& offset) {
    const Terms b = terms_of(offset.by_b, 1.0, kOfSensor);
    const Terms a = terms_of(offset.by_a, -1.0, 0);
    std::ranges::copy(a.index, index.begin());
    std::ranges::copy(b.index, index.begin() + 4);
    std::ranges::copy(a.value, value.begin());
    std::ranges::copy(b.value, value.begin() + 4);
  }
  [[nodiscard]] double times(const Eigen::VectorXd& errors) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < index.size(); ++i) sum += value[i] * errors[index[i]];
    return sum;
  }
};

Eigen::VectorXd prior_weights(const SensorPrior& prior) {
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(kAll, 1.0 / (prior.ring_m * prior.ring_m));
  for (const int first : {0, kOfSensor}) {
    weights[first] = 1.0 / (prior.bias_m * prior.bias_m);
    weights[first + 1] = 1.0 / (prior.walk_m * prior.walk_m);
  }
  return weights;
}

/// Of a normal distribution, from the median of absolute values.
double robust_sigma(std::vector<double> residuals) {
  constexpr double kOfMedian = 1.4826;
  constexpr double kLeast = 1e-4;
  for (double& residual : residuals) residual = std::abs(residual);
  const auto middle = residuals.begin() + std::ssize(residuals) / 2;
  std::ranges::nth_element(residuals, middle);
  return std::max(kOfMedian * *middle, kLeast);
}

}  // namespace

SensorDifference::SensorDifference() : errors_(Eigen::VectorXd::Zero(kAll)) {}

SensorDifference::SensorDifference(std::span<const SeenOffset> offsets, const SensorPrior& prior)
    : SensorDifference() {
  constexpr int kRounds = 5;
  constexpr double kHuber = 1.345;  // sigmas: 95 % efficient where errors are normal
  if (offsets.empty()) return;
  std::vector<Row> rows;
  for (const SeenOffset& offset : offsets) rows.emplace_back(offset);
  std::vector<double> residuals(rows.size());
  const Eigen::VectorXd known_before = prior_weights(prior);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < rows.size(); ++i) residuals[i] = offsets[i].metres - rows[i].times(errors_);
    const double sigma = robust_sigma(residuals);
    Eigen::MatrixXd H = known_before.asDiagonal();
    Eigen::VectorXd g = Eigen::VectorXd::Zero(kAll);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double weight =
          std::min(1.0, kHuber * sigma / std::max(std::abs(residuals[i]), 1e-12)) / (sigma * sigma);
      const auto& [index, value] = rows[i];
      for (std::size_t j = 0; j < index.size(); ++j) {
        g[index[j]] += weight * value[j] * offsets[i].metres;
        for (std::size_t k = 0; k < index.size(); ++k) H(index[j], index[k]) += weight * value[j] * value[k];
      }
    }
    errors_ = H.llt().solve(g);
  }
}

double SensorDifference::explains(const SeenOffset& offset) const { return Row(offset).times(errors_); }

double SensorDifference::bias_m() const {
  const int horizon = 2 + kNodesToEachSide;
  return errors_[kOfSensor] + errors_[kOfSensor + horizon] - errors_[0] - errors_[horizon];
}

}  // namespace adit
