// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/brightness.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace adit {
namespace {

/// What makes walls dark or bright beside themselves: the law by which a sensor reports intensity, and their
/// place in the cross section.
constexpr Eigen::Index kTerms = 10;
Eigen::Matrix<double, 1, kTerms> terms_of(const ReturnsOfPatch& patch, std::size_t sensor) {
  const WallReturn& seen = patch.by_sensor[sensor];
  const Vector3& n = patch.normal;
  Eigen::Matrix<double, 1, kTerms> terms;
  terms << 1.0, seen.log_range, seen.log_range * seen.log_range, seen.log_cosine, n.y(), n.z(), n.y() * n.y(),
      n.z() * n.z(), patch.left_m, patch.above_m;
  return terms;
}

/// Never 0, so that its logarithm is finite.
double normal_density(double off, double sigma) {
  constexpr double kLeast = 1e-300;
  return std::exp(-0.5 * off * off / (sigma * sigma)) / (sigma * std::sqrt(2.0 * std::numbers::pi)) + kLeast;
}

/// What these leave of one sensor's logarithms. Nothing counts for more than two standard
/// deviations: a sign is one bright patch, not all that is seen. None where the sensor tells nothing apart.
Eigen::VectorXd residuals_of(const std::vector<ReturnsOfPatch>& returns, std::size_t sensor) {
  constexpr double kMostSigmas = 2.0;
  constexpr double kRidge = 1e-6;      // where all patches are equally far, say
  constexpr double kToldApart = 1e-3;  // decades
  const Eigen::Index num = std::ssize(returns);
  Eigen::Matrix<double, Eigen::Dynamic, kTerms> terms(num, kTerms);
  Eigen::VectorXd logs(num);
  for (Eigen::Index i = 0; i < num; ++i) {
    const ReturnsOfPatch& patch = returns[static_cast<std::size_t>(i)];
    logs[i] = patch.by_sensor[sensor].log_intensity;
    terms.row(i) = terms_of(patch, sensor);
  }
  logs.array() -= logs.mean();  // else the ridge would leave a part of a constant, which is alike for both
  const Eigen::Matrix<double, kTerms, kTerms> normal =
      terms.transpose() * terms + kRidge * Eigen::Matrix<double, kTerms, kTerms>::Identity();
  const Eigen::VectorXd left = logs - terms * normal.ldlt().solve(terms.transpose() * logs);
  const double sigma = std::sqrt(left.squaredNorm() / static_cast<double>(num));
  if (!(sigma > kToldApart)) return Eigen::VectorXd::Zero(num);
  return left.cwiseMax(-kMostSigmas * sigma).cwiseMin(kMostSigmas * sigma);
}

/// Sums of the products of two sensors' residuals.
struct Products {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  void add(double a, double b) {
    ab += a * b;
    aa += a * a;
    bb += b * b;
  }
};

}  // namespace

BrightnessMatch brightness_match(const std::vector<ReturnsOfPatch>& returns) {
  if (returns.empty()) return {};
  const Eigen::VectorXd left_a = residuals_of(returns, 0);
  const Eigen::VectorXd left_b = residuals_of(returns, 1);
  // A patch is one piece of wall, however often it is seen.
  struct Patch {
    double a = 0.0;
    double b = 0.0;
    double num = 0.0;
    std::size_t stretch = 0;
  };
  std::map<std::size_t, Patch> patches;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    Patch& patch = patches[returns[i].patch];
    patch.a += left_a[static_cast<Eigen::Index>(i)];
    patch.b += left_b[static_cast<Eigen::Index>(i)];
    patch.num += 1.0;
    patch.stretch = returns[i].stretch;
  }
  if (std::ssize(patches) < 2 * kTerms) return {};
  Products all;
  std::map<std::size_t, Products> stretches;
  for (const auto& [number, patch] : patches) {
    all.add(patch.a / patch.num, patch.b / patch.num);
    stretches[patch.stretch].add(patch.a / patch.num, patch.b / patch.num);
  }
  const double scale = std::sqrt(all.aa * all.bb);
  if (!(scale > 0.0)) return {};
  BrightnessMatch out{patches.size(), all.ab / scale, 0.0};
  // By the derivatives of the correlation, stretch by stretch; no better than so many independent ones are.
  double squares = 0.0;
  for (const auto& [number, sums] : stretches)
    squares += std::pow(sums.ab / scale - 0.5 * out.correlation * (sums.aa / all.aa + sums.bb / all.bb), 2);
  out.sigma = std::max(std::sqrt(squares), 1.0 / std::sqrt(static_cast<double>(stretches.size())));
  return out;
}

void BrightnessMatches::set_same(const BrightnessMatch& match) { same_ = match; }

void BrightnessMatches::add_other(const BrightnessMatch& match) {
  if (match.num_patches >= static_cast<std::size_t>(model_.few_patches)) others_.push_back(match);
}

double BrightnessMatches::evidence(const BrightnessMatch& found, double times) const {
  const auto few = static_cast<std::size_t>(model_.few_patches);
  if (found.num_patches < few || same_.num_patches < few) return 0.0;
  const double sigma = found.sigma / std::sqrt(times);

  double mean = model_.other_correlation * model_.prior_others;
  double num = model_.prior_others;
  for (const BrightnessMatch& other : others_) {
    mean += other.correlation;
    num += 1.0;
  }
  mean /= num;
  if (same_.correlation <= mean) return 0.0;
  double variance = std::pow(model_.other_sigma, 2) * model_.prior_others;
  for (const BrightnessMatch& other : others_)
    variance += std::max(0.0, std::pow(other.correlation - mean, 2) - std::pow(other.sigma, 2));
  // Less than other tunnels have on average tells no more than that, and never for one tunnel.
  const double correlation = std::max(found.correlation, mean);
  const double of_other = normal_density(correlation - mean, std::hypot(sigma, std::sqrt(variance / num)));

  constexpr int kParts = 20;
  double of_same = 0.0;
  for (int i = 0; i < kParts; ++i)
    of_same += normal_density(correlation - same_.correlation * (i + 0.5) / kParts, sigma) / kParts;
  if (found.correlation <= mean) of_same = std::min(of_same, of_other);
  return std::log(((1.0 - model_.changed) * of_same + model_.changed * of_other) /
                  ((1.0 - model_.copied) * of_other + model_.copied * of_same));
}

double BrightnessMatches::most_evidence() const { return std::log((1.0 - model_.changed) / model_.copied); }

}  // namespace adit
