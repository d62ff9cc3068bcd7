// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/icp_refine.hpp"

#include <algorithm>
#include <limits>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/registration/plane_aligner.hpp"

namespace adit {
namespace {

constexpr std::size_t kPointsPerPart = 512;  ///< Points per part of the parallel loop.
/// Points: more do not improve the answer.
constexpr std::size_t kSample = 2500;
/// Points: enough to find which minimum a start leads to.
constexpr std::size_t kSearchSample = 600;
constexpr double kLastStepOfSearch = 2e-3;  ///< Norm of a step [m; rad] that ends a search.
constexpr double kArrived = 0.01;  ///< Norm of the last step [m; rad] of a search that found a minimum.

/// Proportional to the mean diagonal of the translational and of the rotational block: free of units.
Vector6 gauss_newton_step(const PlaneEquations& sum) {
  constexpr double kDamping = 1e-3;
  Matrix6 H = sum.H;
  H.diagonal().head<3>().array() += kDamping * sum.H.diagonal().head<3>().mean() + 1e-12;
  H.diagonal().tail<3>().array() += kDamping * sum.H.diagonal().tail<3>().mean() + 1e-12;
  return -solve_symmetric(H, sum.g);
}

std::size_t stride_for(std::size_t num_points, std::size_t sample) { return num_points / sample + 1; }

struct Minimum {
  Pose T_a_b;
  double last_step = std::numeric_limits<double>::infinity();
  double misfit = 1.0;  ///< 0: all points on the other cloud's planes; a point without partner counts 1.
};

/// Iterates until the steps are shorter than `last_step`.
Minimum descend(PlaneAligner aligner, const Pose& T_a_b, double last_step, const RegistrationConfig& config) {
  constexpr double kMinPairs = 12.0;
  const double kernel = config.refine_kernel_voxels * config.voxel_size;
  Minimum out{T_a_b};
  for (int iteration = 0; iteration < config.refine_max_iterations; ++iteration) {
    const PlaneEquations equations = aligner.linearize(out.T_a_b, kernel);
    if (equations.num_pairs < kMinPairs) break;
    out.misfit = 1.0 - equations.fit / static_cast<double>(aligner.sample_size());
    const Vector6 step = gauss_newton_step(equations);
    if (!step.allFinite()) break;
    out.T_a_b = out.T_a_b * Pose::exp(step);
    out.last_step = step.norm();
    if (out.last_step < last_step) break;
  }
  return out;
}

/// The global result itself, and turned by a degree or so about each axis, in both directions.
std::vector<Pose> starts_around(const Pose& T_a_b) {
  constexpr double kTurn = 0.02;  // radians: usual error of a global result that is not exact
  std::vector<Pose> starts{T_a_b};
  for (int axis = 3; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0})
      starts.push_back(T_a_b * Pose::exp(sign * kTurn * Vector6::Unit(axis)));
  }
  return starts;
}

}  // namespace

std::vector<PointPair> associate(const PointGrid& grid_a, const OrientedPoints& b, const Pose& T_a_b,
                                 double max_distance) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  std::vector<PointPair> pairs(b.size());
  parallel_for_each(
      b.size(),
      [&](std::size_t j) {
        const auto nearest = grid_a.nearest(R * b.points[j] + t, static_cast<float>(max_distance));
        pairs[j] = {nearest ? nearest->index : kNone, static_cast<std::uint32_t>(j)};
      },
      kPointsPerPart);
  std::erase_if(pairs, [](const PointPair& pair) { return pair.a == kNone; });
  return pairs;
}

Pose align_to_planes(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b,
                     const Pose& T_a_b, const RegistrationConfig& config) {
  constexpr double kLastStep = 1e-4;
  const double max_distance = config.refine_distance_voxels * config.voxel_size;
  PlaneAligner aligner(a, grid_a, b, stride_for(b.size(), kSample), max_distance);
  return descend(std::move(aligner), T_a_b, kLastStep, config).T_a_b;
}

Approach approach_planes(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b,
                         const Pose& T_a_b, const RegistrationConfig& config) {
  const double max_distance = config.refine_distance_voxels * config.voxel_size;
  PlaneAligner aligner(a, grid_a, b, stride_for(b.size(), kSearchSample), max_distance);
  const Minimum found = descend(std::move(aligner), T_a_b, kLastStepOfSearch, config);
  return {found.T_a_b, found.last_step < kArrived};
}

Pose refine_point_to_plane(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b,
                           const Pose& T_a_b, const RegistrationConfig& config) {
  const double max_distance = config.refine_distance_voxels * config.voxel_size;
  const PlaneAligner aligner(a, grid_a, b, stride_for(b.size(), kSearchSample), max_distance);
  std::vector<Minimum> minima;
  for (const Pose& start : starts_around(T_a_b)) minima.push_back({start});
  parallel_for_each(minima.size(), [&](std::size_t s) {
    minima[s] = descend(aligner, minima[s].T_a_b, kLastStepOfSearch, config);
  });
  const auto best = std::ranges::min_element(minima, {}, &Minimum::misfit);
  return align_to_planes(a, grid_a, b, best->T_a_b, config);
}

}  // namespace adit
