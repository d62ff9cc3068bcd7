// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/registration/plane_aligner.hpp"

namespace adit {
namespace {

constexpr double kNodeSpacing = 4.0 * kDegree;
constexpr double kLastNode = 2.0 * kElevationNodesToEachSide;

/// A range that is too long by e moves the wall back by e times the cosine of incidence. `towards`: from the
/// wall to the sensor, whose robot stands upright along `up`.
void add_view(const Eigen::Vector3f& towards, const Eigen::Vector3f& up, const Eigen::Vector3f& normal,
              double weight, Eigen::Ref<Eigen::Matrix<double, kErrorsOfSensor, 1>> sum) {
  const Eigen::Vector3f direction = towards.normalized();
  const auto cosine = static_cast<double>(std::abs(normal.dot(direction)));
  const auto elevation = static_cast<double>(std::asin(std::clamp(-direction.dot(up), -1.0F, 1.0F)));
  const double place =
      std::clamp(elevation / kNodeSpacing + kElevationNodesToEachSide, 0.0, kLastNode - 1e-9);
  const auto node = static_cast<Eigen::Index>(place);
  const double beyond = place - static_cast<double>(node);
  const double moved = weight * cosine;
  sum[0] += moved;
  sum[1] += moved * (1.0 - cosine);
  sum[2 + node] += moved * (1.0 - beyond);
  sum[3 + node] += moved * beyond;
}

Eigen::VectorXd prior_weights(const SensorPrior& prior) {
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(kSensorErrors, 1.0 / (prior.ring_m * prior.ring_m));
  for (const int first : {0, kErrorsOfSensor}) {
    weights[first] = 1.0 / (prior.bias_m * prior.bias_m);
    weights[first + 1] = 1.0 / (prior.walk_m * prior.walk_m);
  }
  return weights;
}

/// Of a normal distribution, from the median of absolute values.
double robust_sigma(const Eigen::VectorXd& residuals) {
  constexpr double kOfMedian = 1.4826;
  constexpr double kLeast = 1e-4;
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const auto middle = sizes.begin() + std::ssize(sizes) / 2;
  std::ranges::nth_element(sizes, middle);
  return std::max(kOfMedian * *middle, kLeast);
}

}  // namespace

SensorTermsOf::SensorTermsOf(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b)
    : viewpoint_a_(a.viewpoint()),
      viewpoint_b_((T_a_b * b.viewpoint().cast<double>()).cast<float>()),
      up_a_(Eigen::Vector3f::UnitZ()),
      up_b_(T_a_b.rotation_matrix().col(2).cast<float>()) {}

void SensorTermsOf::add(const WallPair& pair, double weight, SensorTerms& sum) const {
  add_view(viewpoint_a_ - pair.seen_by_a, up_a_, pair.normal, weight, sum.head<kErrorsOfSensor>());
  add_view(viewpoint_b_ - pair.seen_by_b, up_b_, pair.normal, -weight, sum.tail<kErrorsOfSensor>());
}

Vector6 motion_terms(const WallPair& pair) {
  const Vector3 normal = pair.normal.cast<double>();
  Vector6 terms;
  terms << normal, pair.seen_by_b.cast<double>().cross(normal);
  return terms;
}

FitShift fit_shift(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                   const RegistrationConfig& config) {
  constexpr double kDamping = 1e-3;  // as of align_to_planes: along open directions nothing moves
  const auto distance = static_cast<float>(config.refine_distance_voxels * config.voxel_size);
  const double squared_kernel = std::pow(config.refine_kernel_voxels * config.voxel_size, 2);
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  const SensorTermsOf terms_of(a, b, T_a_b);
  Matrix6 H = Matrix6::Zero();
  FitShift moved = FitShift::Zero();
  const OrientedPoints& sample = b.some();
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const Eigen::Vector3f p = R * sample.points[i] + t;
    const auto near = a.tree().nearest(p, distance);
    if (!near) continue;
    const Eigen::Vector3f& p_a = a.points().points[near->index];
    const Eigen::Vector3f& normal_a = a.points().normals[near->index];
    const Eigen::Vector3f normal_b = R * sample.normals[i];
    if (std::abs(normal_a.dot(normal_b)) < kAgreeingNormals) continue;
    for (const Eigen::Vector3f& normal : {normal_a, normal_b}) {
      const WallPair pair{p_a, p, normal};
      const auto off = static_cast<double>(normal.dot(p - p_a));
      const double weight = std::pow(squared_kernel / (squared_kernel + off * off), 2);  // Geman and McClure
      const Vector6 motion = motion_terms(pair);
      SensorTerms terms = SensorTerms::Zero();
      terms_of.add(pair, weight, terms);
      H += weight * motion * motion.transpose();
      moved += motion * terms.transpose();
    }
  }
  H.diagonal().head<3>().array() += kDamping * H.diagonal().head<3>().mean() + 1e-12;
  H.diagonal().tail<3>().array() += kDamping * H.diagonal().tail<3>().mean() + 1e-12;
  return -H.ldlt().solve(moved);
}

Eigen::VectorXd explained_by_sensors(const Eigen::MatrixXd& terms, const Eigen::VectorXd& offsets,
                                     const SensorPrior& prior) {
  constexpr int kRounds = 5;
  constexpr double kHuber = 1.345;  // sigmas: 95 % efficient where errors are normal,
  constexpr double kTukey = 4.685;  // and so is the biweight, to which walls that were moved are nothing
  if (offsets.size() == 0) return offsets;
  const Eigen::VectorXd known_before = prior_weights(prior);
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(kSensorErrors);
  for (int round = 0; round < 2 * kRounds; ++round) {
    const Eigen::VectorXd residuals = offsets - terms * errors;
    const double sigma = robust_sigma(residuals);
    const Eigen::ArrayXd off = residuals.array().abs() / sigma;
    const Eigen::ArrayXd huber = (kHuber * off.max(1e-12).inverse()).min(1.0);
    const Eigen::ArrayXd tukey = (1.0 - (off / kTukey).square()).max(0.0).square();
    const Eigen::VectorXd weights = (round < kRounds ? huber : tukey) / (sigma * sigma);
    const Eigen::MatrixXd weighted = terms.transpose() * weights.asDiagonal();
    Eigen::MatrixXd H = weighted * terms;
    H.diagonal() += known_before;
    errors = H.llt().solve(weighted * offsets);
  }
  return terms * errors;
}

}  // namespace adit
