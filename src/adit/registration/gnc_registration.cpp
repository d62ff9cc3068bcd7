// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/gnc_registration.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/robust_kernel.hpp"

namespace adit {
namespace {

struct WeightedRotation {
  Matrix3 R_a_b;
  bool is_unique;  ///< False when the weighted directions are all parallel.
};

/// The rotation that maximises sum w a . R b (Kabsch; Umeyama's sign keeps it a rotation).
WeightedRotation weighted_rotation(std::span<const Vector3> a, std::span<const Vector3> b,
                                   std::span<const double> weights) {
  constexpr double kMinRelativeSingularValue = 1e-9;
  Matrix3 moment = Matrix3::Zero();
  for (std::size_t k = 0; k < a.size(); ++k) moment += weights[k] * a[k] * b[k].transpose();
  const auto [u, s, v] = svd(moment);
  const double sign = u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0;
  return {u * Vector3(1.0, 1.0, sign).asDiagonal() * v.transpose(),
          s[1] > kMinRelativeSingularValue * s[0] && s[0] > 0.0};
}

/// Differences along closed chains through all points: one chain where stride and number of points have no
/// common divisor, else as many as the greatest one. Points come in spatial order, so the next link is not
/// the next point but one farther down the list, by its golden section: differences of neighbours are short,
/// and a short lever constrains a rotation little.
std::vector<Vector3> chained_differences(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kGoldenPermille = 382;  // (3 - sqrt(5)) / 2
  const std::size_t stride = std::max<std::size_t>(1, points.size() * kGoldenPermille / 1000);
  std::vector<Vector3> out;
  out.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    out.push_back((points[(k + stride) % points.size()] - points[k]).cast<double>());
  }
  return out;
}

}  // namespace

std::optional<GncRotation> gnc_rotation(std::span<const Vector3> a, std::span<const Vector3> b, double bound,
                                        const RegistrationConfig& config) {
  ADIT_CHECK(a.size() == b.size() && bound > 0.0, "pairs of vectors and a positive bound");
  const double squared_bound = bound * bound;
  GncRotation out{.weights = std::vector<double>(a.size(), 1.0)};
  if (a.size() < 2) return std::nullopt;
  double mu = 0.0;
  double previous_cost = std::numeric_limits<double>::infinity();
  for (; out.iterations < config.gnc_max_iterations; ++out.iterations) {
    const WeightedRotation best = weighted_rotation(a, b, out.weights);
    if (!best.is_unique) return std::nullopt;
    out.R_a_b = best.R_a_b;
    double largest = 0.0;
    double cost = 0.0;
    std::vector<double> squared_residuals(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      squared_residuals[k] = (a[k] - out.R_a_b * b[k]).squaredNorm();
      largest = std::max(largest, squared_residuals[k]);
      cost += out.weights[k] * squared_residuals[k];
    }
    if (out.iterations == 0) {
      if (2.0 * largest <= squared_bound) break;  // all are inliers already
      mu = 1.0 / (2.0 * largest / squared_bound - 1.0);
    }
    for (std::size_t k = 0; k < a.size(); ++k) {
      out.weights[k] = tls_weight(squared_residuals[k], squared_bound, mu);
    }
    if (std::abs(cost - previous_cost) < config.gnc_tolerance) break;
    previous_cost = cost;
    mu *= config.gnc_factor;
  }
  return out;
}

double truncated_mean(std::span<const double> values, double bound) {
  ADIT_CHECK(!values.empty() && bound > 0.0, "values and a positive bound");
  struct End {
    double at;
    double value;
    double enters;  ///< +1: the value joins the consensus here; -1: it leaves.
  };
  std::vector<End> ends;
  ends.reserve(2 * values.size());
  // relative to the first value: sums of squares of large coordinates would cancel
  for (const double value : values) {
    const double v = value - values.front();
    ends.push_back({v - bound, v, 1.0});
    ends.push_back({v + bound, v, -1.0});
  }
  std::sort(ends.begin(), ends.end(), [](const End& x, const End& y) {
    return x.at != y.at ? x.at < y.at : x.enters > y.enters;  // touching intervals do meet
  });
  double count = 0.0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double best_gain = 0.0;
  double best = 0.0;
  for (const End& end : ends) {
    count += end.enters;
    sum += end.enters * end.value;
    sum_of_squares += end.enters * end.value * end.value;
    if (count < 0.5) continue;
    const double mean = sum / count;
    // how much the cost falls below that of no inlier at all
    const double gain = count * bound * bound - (sum_of_squares - sum * mean);
    if (gain > best_gain) {
      best_gain = gain;
      best = mean;
    }
  }
  return best + values.front();
}

std::optional<GlobalSolution> align_robustly(std::span<const Eigen::Vector3f> points_a,
                                             std::span<const Eigen::Vector3f> points_b, double bound,
                                             const RegistrationConfig& config) {
  ADIT_CHECK(points_a.size() == points_b.size(), "a correspondence has a point in either cloud");
  if (points_a.size() < 3) return std::nullopt;
  const auto rotation =
      gnc_rotation(chained_differences(points_a), chained_differences(points_b), 2.0 * bound, config);
  if (!rotation) return std::nullopt;
  std::vector<Vector3> offsets;
  offsets.reserve(points_a.size());
  for (std::size_t k = 0; k < points_a.size(); ++k) {
    offsets.push_back(points_a[k].cast<double>() - rotation->R_a_b * points_b[k].cast<double>());
  }
  Vector3 translation;
  std::vector<double> values(offsets.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < offsets.size(); ++k) values[k] = offsets[k][axis];
    translation[axis] = truncated_mean(values, bound);
  }
  GlobalSolution out{Pose(rotation->R_a_b, translation), {}};
  for (std::uint32_t k = 0; k < offsets.size(); ++k) {
    if (((offsets[k] - translation).array().abs() <= bound).all()) out.inliers.push_back(k);
  }
  return out;
}

}  // namespace adit
