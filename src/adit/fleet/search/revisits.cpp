// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/revisits.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/decompositions.hpp"
#include "adit/posegraph/gnc.hpp"

namespace adit {
namespace {

/// How far apart two keyframes of one place may seem by odometry, metres.
double reach_m(const OdometryChain& chain, std::size_t k, std::size_t later, const RevisitConfig& config) {
  const double drift = std::sqrt(chain.covariance(k, later).topLeftCorner<3, 3>().trace());
  return config.near_m + config.sigmas * drift;
}

/// No less than reach_m, whatever either rounds, in a fraction of its time: of the covariance it computes no
/// more than the variances of the position. A long drive has hundreds of millions of pairs.
double longest_reach_m(const OdometryChain& chain, std::size_t k, std::size_t later,
                       const RevisitConfig& config) {
  constexpr double kRounding = 1e-12;  // of the largest terms; sums of so few lose a tenth of that
  const Matrix6 covariance = chain.covariance_from_first(k, later);
  Eigen::Matrix<double, 3, 6> position;  // what moves the origin of keyframe `later`, in axes of the first
  position << Matrix3::Identity(), -so3::hat(chain.from_first(later).translation());
  const double sum = (position * covariance).cwiseProduct(position).sum();
  const double rounding = kRounding * position.squaredNorm() * covariance.cwiseAbs().maxCoeff();
  return (config.near_m + config.sigmas * std::sqrt(std::max(sum, 0.0) + rounding)) * (1.0 + kRounding);
}

}  // namespace

std::vector<std::uint32_t> possible_revisits(const OdometryChain& chain, std::uint32_t k,
                                             const RevisitConfig& config) {
  const std::vector<double>& path_m = chain.path_m();
  std::vector<std::uint32_t> out;
  for (std::uint32_t later = k + 1; later < chain.size(); ++later) {
    if (path_m[later] - path_m[k] < config.path_m) continue;
    const double apart_m = chain.between(k, later).translation().norm();
    if (apart_m < longest_reach_m(chain, k, later, config) && apart_m < reach_m(chain, k, later, config))
      out.push_back(later);
  }
  return out;
}

bool fits_odometry(const OdometryChain& chain, const PcmLoop& loop, const RevisitConfig& config) {
  const Matrix6 covariance =
      chain.covariance(loop.a, loop.b) + Eigen::LLT<Matrix6>(loop.information).solve(Matrix6::Identity());
  const Vector6 error = (chain.between(loop.a, loop.b).inverse() * loop.T_a_b).log();
  return error.dot(solve_symmetric(covariance, error)) <
         config.sigmas * config.sigmas * chi2_quantile(config.probability, 6);
}

double odometry_evidence(const OdometryChain& chain, const PcmLoop& loop, const RevisitConfig& config) {
  const Eigen::Matrix2d covariance = chain.covariance(loop.a, loop.b).topLeftCorner<2, 2>();
  const Eigen::Vector2d error =
      (chain.between(loop.a, loop.b).inverse() * loop.T_a_b).translation().head<2>();
  const double radius = reach_m(chain, loop.a, loop.b, config);
  return std::log(std::numbers::pi * radius * radius) -
         std::log(2.0 * std::numbers::pi * std::sqrt(covariance.determinant())) -
         0.5 * error.dot(covariance.inverse() * error);
}

}  // namespace adit
