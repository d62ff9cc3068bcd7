// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/verification.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/geometry/point_to_plane.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/registration/icp_refine.hpp"

namespace adit {
namespace {

/// How far apart two scans of one place can be, one standard deviation: what is known of a registration along
/// directions that the scene leaves open.
constexpr double kSlide = 3.0;  // metres
constexpr double kTurn = 0.5;   // radians

/// Metres: the edge of a region whose residuals err alike. Of 2, 4 and 8 m that which made the loops of a
/// LiDAR with 16 rings the least too confident (decision 0034).
constexpr double kRegion = 8.0;

/// Sums over point pairs, all weights 1.
struct PairSums {
  Matrix6 cross_hessian = Matrix6::Zero();
  Matrix6 hessian = Matrix6::Zero();
  Matrix6 displacements = Matrix6::Zero();  ///< Squares of how far the points move, per twist of frame b.
  std::map<VoxelKey, Vector6> gradients;    ///< By region of cloud b.
  double squared_residuals = 0.0;
  double num_pairs = 0.0;
};

PairSums sum_over_pairs(const Features& a, const Features& b, const std::vector<PointPair>& pairs,
                        const Pose& T_a_b, double max_residual) {
  PairSums sums;
  const VoxelGrid regions(kRegion);
  const Matrix3 R = T_a_b.rotation_matrix();
  for (const auto [i, j] : pairs) {
    const Vector3 p_b = b.points[j].cast<double>();
    const Plane plane{a.points[i].cast<double>(), a.normals[i].cast<double>()};
    const PlaneResidual r = plane_residual(R, T_a_b.translation(), plane, p_b);
    const std::optional<VoxelKey> region = regions.key_of(b.points[j]);
    if (std::abs(r.value) > max_residual || !region) continue;
    Vector3 n_b = b.normals[j].cast<double>();
    if (r.jacobian.head<3>().dot(n_b) < 0.0) n_b = -n_b;  // each was turned to its own sensor
    Vector6 jacobian_b;
    jacobian_b << n_b, p_b.cross(n_b);
    sums.cross_hessian += r.jacobian * jacobian_b.transpose();
    sums.hessian += r.jacobian * r.jacobian.transpose();
    Eigen::Matrix<double, 3, 6> moved;
    moved << Matrix3::Identity(), -so3::hat(p_b);
    sums.displacements += moved.transpose() * moved;
    sums.gradients.try_emplace(*region, Vector6::Zero()).first->second += r.value * r.jacobian;
    sums.squared_residuals += r.value * r.value;
    sums.num_pairs += 1.0;
  }
  sums.cross_hessian = (0.5 * (sums.cross_hessian + sums.cross_hessian.transpose())).eval();
  return sums;
}

/// The nearest positive semi-definite matrix, with metres and radians made comparable by the diagonal first.
Matrix6 without_negative_part(const Matrix6& H) {
  const double lever = std::sqrt(std::max(H.diagonal().tail<3>().mean(), 1e-12) /
                                 std::max(H.diagonal().head<3>().mean(), 1e-12));
  Vector6 scale = Vector6::Ones();
  scale.tail<3>().setConstant(1.0 / lever);
  const auto [values, vectors] = symmetric_eigen(Matrix6(scale.asDiagonal() * H * scale.asDiagonal()));
  const Matrix6 root =
      scale.cwiseInverse().asDiagonal() * vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return root * root.transpose();
}

/// What is known without residuals: both scans are of one place.
Matrix6 of_one_place() {
  Vector6 sigma;
  sigma << Vector3::Constant(kSlide), Vector3::Constant(kTurn);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

/// What the residuals say of the pose: independent noise, and what the residuals of one region have in
/// common, as walls are rough and normals from few rings are off.
Matrix6 information_of(const PairSums& sums, double variance) {
  Matrix6 squares = variance * (sums.hessian + of_one_place());  // positive definite in any scene
  for (const auto& [region, gradient] : sums.gradients) squares += gradient * gradient.transpose();
  const Matrix6 H = without_negative_part(sums.cross_hessian);
  const Matrix6 information = H * inverse(squares) * H;
  return 0.5 * (information + information.transpose());
}

/// The information where the pose may also be off along `twist` (frame b) by `kSlide` of it, by Woodbury's
/// identity.
Matrix6 sliding_along(const Vector6& twist, const Matrix6& information) {
  const Vector6 v = information * twist;
  return information - v * v.transpose() / (1.0 / (kSlide * kSlide) + twist.dot(v));
}

/// The information where the clouds are free to slide: along a straight tube, along a bend, about the axis of
/// a round one (slippable motions, N. Gelfand and L. J. Guibas, "Shape Segmentation Using Local Slippage
/// Analysis", SGP 2004, eq. 4). Along such a motion the points hardly move against the walls, and what their
/// residuals say of it comes from the sampling of the clouds, which is not independent from point to point.
Matrix6 without_slippable(const PairSums& sums, double held, Matrix6 information) {
  // Twists by which the points move by one metre in the mean square, of which `values` is against the walls:
  // their share of all directions, as in Evidence::weak_axis.
  const Eigen::LLT<Matrix6> displacement(sums.displacements / sums.num_pairs);
  if (displacement.info() != Eigen::Success) return information;
  const Matrix6 onto_twists = displacement.matrixU().solve(Matrix6::Identity());
  const auto [values, vectors] =
      symmetric_eigen(Matrix6(onto_twists.transpose() * (sums.cross_hessian / held) * onto_twists));
  for (int i = 0; i < 6 && values[i] < kWeakAxis; ++i)
    information = sliding_along(onto_twists * vectors.col(i), information);
  return information;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string holding(const Registration& r) {
  if (r.weak_axis >= kWeakAxis) return {};
  const Vector3& d = r.weak_direction;
  return format("; free to slide along ({:.2f}, {:.2f}, {:.2f})", d.x(), d.y(), d.z());
}

}  // namespace

Evidence gather_evidence(const Features& a, const PointGrid& grid_a, const Features& b,
                         const PointGrid& grid_b, const Pose& T_a_b, const RegistrationConfig& config) {
  const double overlap_distance = config.overlap_distance_voxels * config.voxel_size;
  const double min_sigma = 0.03 * config.voxel_size;  // two copies of one cloud are not infinitely certain
  const std::vector<PointPair> pairs = associate(grid_a, b, T_a_b, overlap_distance);
  const std::size_t num_back = associate(grid_b, a, T_a_b.inverse(), overlap_distance).size();
  Evidence out{.overlap = std::min(share(pairs.size(), b.size()), share(num_back, a.size()))};
  const PairSums sums = sum_over_pairs(a, b, pairs, T_a_b, config.refine_kernel_voxels * config.voxel_size);
  if (sums.num_pairs < 1.0) return out;

  const double variance = std::max(sums.squared_residuals / sums.num_pairs, min_sigma * min_sigma);
  out.information = information_of(sums, variance) + of_one_place();
  const auto [values, directions] = symmetric_eigen(Matrix3(sums.cross_hessian.topLeftCorner<3, 3>()));
  const double trace = values.cwiseMax(0.0).sum();
  out.weak_direction = T_a_b.rotation() * directions.col(0);
  if (!(trace > 0.0)) return out;
  out.weak_axis = std::max(values[0], 0.0) / trace;
  out.information = without_slippable(sums, trace, out.information);
  return out;
}

Registration judged(Registration r, const RegistrationConfig& config) {
  const auto conclude = [&](LoopVerdict verdict, std::string reason) {
    r.verdict = verdict;
    r.reason = std::move(reason);
    return r;
  };
  if (r.num_inliers < config.min_inliers) {
    return conclude(LoopVerdict::rejected, format("{} inliers of {} correspondences, {} needed",
                                                  r.num_inliers, r.num_correspondences, config.min_inliers));
  }
  const std::string agreement = format("{} inliers, overlap {:.2f}", r.num_inliers, r.overlap);
  if (r.overlap < config.min_overlap) {
    return conclude(LoopVerdict::rejected, format("{}, {:.2f} needed", agreement, config.min_overlap));
  }
  return conclude(LoopVerdict::accepted, agreement + holding(r));
}

}  // namespace adit
