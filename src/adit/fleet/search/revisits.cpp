// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/revisits.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "adit/posegraph/gnc.hpp"

namespace adit {
namespace {

constexpr double kSlack = 3.0;         // sigmas, and factor on them
constexpr double kNear = 5.0;          // metres between two keyframes of one place
constexpr double kProbability = 0.99;  // that a true loop agrees

// How far apart two keyframes of one place may seem.
double reach(const OdometryChain& chain, std::size_t k, std::size_t later) {
  return kNear + kSlack * std::sqrt(chain.covariance(k, later).topLeftCorner<3, 3>().trace());
}

}  // namespace

std::vector<std::uint32_t> possible_revisits(const OdometryChain& chain, const std::vector<double>& way,
                                             std::uint32_t k) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t later = k + 1; later < chain.size(); ++later) {
    if (way[later] - way[k] < kRevisitWay) continue;
    if (chain.between(k, later).translation().norm() < reach(chain, k, later)) out.push_back(later);
  }
  return out;
}

bool fits_odometry(const OdometryChain& chain, const PcmLoop& loop) {
  const Matrix6 covariance =
      chain.covariance(loop.a, loop.b) + Eigen::LLT<Matrix6>(loop.information).solve(Matrix6::Identity());
  const Vector6 error = (chain.between(loop.a, loop.b).inverse() * loop.T_a_b).log();
  return error.dot(covariance.ldlt().solve(error)) < kSlack * kSlack * chi2_quantile(kProbability, 6);
}

double odometry_evidence(const OdometryChain& chain, const PcmLoop& loop) {
  const Eigen::Matrix2d covariance = chain.covariance(loop.a, loop.b).topLeftCorner<2, 2>();
  const Eigen::Vector2d error =
      (chain.between(loop.a, loop.b).inverse() * loop.T_a_b).translation().head<2>();
  const double radius = reach(chain, loop.a, loop.b);
  return std::log(std::numbers::pi * radius * radius) -
         std::log(2.0 * std::numbers::pi * std::sqrt(covariance.determinant())) -
         0.5 * error.dot(covariance.inverse() * error);
}

}  // namespace adit
