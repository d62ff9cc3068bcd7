// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

/// Residuals beyond these (metres) are of other surfaces; one step each.
constexpr std::array kGates{1.0, 1.0, 0.5, 0.5, 0.3, 0.3, 0.2, 0.2};
constexpr double kHopeless = 0.3;   ///< Share of rays that differ after the first steps of what will not fit.
constexpr double kUnlikely = 0.03;  ///< The same at the end, seen by some of the rays.
constexpr std::size_t kHopelessAt = 2;
/// Stiffness that holds what the surface leaves free, such as motion along a smooth tube: of one ray in 1e4.
constexpr double kStiffness = 1e-4;

constexpr std::size_t kAll = 1;
constexpr std::size_t kSome = 2;
struct Thoroughness {
  std::size_t every = kAll;  ///< Of the samples, and of the rays of each.
  double gate = 0.0;         ///< Farther surfaces take no part in the alignment, metres.
};

/// One step's normal equations, and how many rays met something else.
struct SurfaceComparison {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  std::size_t num_rays = 0;
  std::size_t num_differing = 0;

  [[nodiscard]] double differing() const {
    return static_cast<double>(num_differing) / static_cast<double>(num_rays);
  }
};

/// The rays of one sample where they are cast.
struct View {
  Eigen::Vector3f origin;
  Eigen::Matrix3f rotation;
};

/// Every `step`th ray from `first` on.
RayBlock cast_from(const Raycaster& world, const View& view, std::size_t first, std::size_t step) {
  RayBlock block;
  for (std::size_t ray = first; ray < kRays; ray += step) {
    const Eigen::Vector3f direction = view.rotation * ray_directions()[ray];
    const std::size_t i = block.size++;
    block.origins.x[i] = view.origin.x();
    block.origins.y[i] = view.origin.y();
    block.origins.z[i] = view.origin.z();
    block.directions.x[i] = direction.x();
    block.directions.y[i] = direction.y();
    block.directions.z[i] = direction.z();
  }
  world.cast(block, kRayReach);
  return block;
}

/// Compares the rays of one sample. A step is a twist of the stretch about `centre`, world frame.
void compare(const Raycaster& world, const SurfaceSample& sample, const Pose& T_there_here,
             const Vector3& centre, Thoroughness how, SurfaceComparison& sum) {
  const Pose T_there_view = T_there_here * sample.T_world_view;
  const View view{T_there_view.translation().cast<float>(), T_there_view.rotation_matrix().cast<float>()};
  const std::size_t step = how.every;
  const RayBlock block = cast_from(world, view, 0, step);
  for (std::size_t i = 0; i < block.size; ++i) {
    const std::size_t ray = i * step;
    const Vector3 direction = (view.rotation * ray_directions()[ray]).cast<double>();
    const Vector3 normal = (view.rotation * sample.normals[ray]).cast<double>();
    const bool is_met = block.distances[i] < kRayReach;
    const double range = static_cast<double>(sample.ranges[ray]);
    const double longer = (is_met ? static_cast<double>(block.distances[i]) : kRayReach) - range;
    const double along_normal = longer * normal.dot(direction);
    const double cosine =
        std::max(is_met ? static_cast<double>(block.cosines[i]) : 0.0, std::abs(normal.dot(direction)));
    ++sum.num_rays;
    if (std::abs(longer) * cosine > kSurfaceTolerance) ++sum.num_differing;
    if (!is_met || normal.isZero() || std::abs(along_normal) > how.gate) continue;
    const Vector3 point = T_there_view.translation() + range * direction - centre;
    Vector6 jacobian;
    jacobian << normal, point.cross(normal);
    sum.information.noalias() += jacobian * jacobian.transpose();
    sum.gradient.noalias() += jacobian * along_normal;
  }
}

SurfaceComparison compare(const Raycaster& world, std::span<const SurfaceSample> stretch,
                          const Pose& T_there_here, Thoroughness how) {
  SurfaceComparison sum;
  const Vector3 centre = T_there_here * stretch[stretch.size() / 2].T_world_view.translation();
  for (std::size_t i = 0; i < stretch.size(); i += how.every)
    compare(world, stretch[i], T_there_here, centre, how, sum);
  return sum;
}

/// The twist about the stretch's middle that brings its surface nearest to the other, to first order.
Pose stepped(const SurfaceComparison& sum, const Pose& T_there_here, const Vector3& centre) {
  Matrix6 information = sum.information;
  information.diagonal().array() += kStiffness * static_cast<double>(sum.num_rays);
  const Vector6 step = information.ldlt().solve(sum.gradient);
  const Pose to_centre = Pose::translation_of(centre.x(), centre.y(), centre.z());
  return to_centre * Pose::exp(step) * to_centre.inverse() * T_there_here;
}

}  // namespace

SurfaceFit fit_surface(const Raycaster& world, std::span<const SurfaceSample> stretch,
                       const Pose& T_there_here) {
  ADIT_CHECK(!stretch.empty(), "a stretch has a sample at least");
  SurfaceFit fit{T_there_here, 1.0};
  const Vector3 middle = stretch[stretch.size() / 2].T_world_view.translation();
  for (std::size_t i = 0; i < kGates.size(); ++i) {
    const SurfaceComparison sum = compare(world, stretch, fit.T_there_here, {kSome, kGates[i]});
    fit.differing = sum.differing();
    if (fit.differing > (i < kHopelessAt ? 1.0 : i + 1 < kGates.size() ? kHopeless : kUnlikely)) return fit;
    fit.T_there_here = stepped(sum, fit.T_there_here, fit.T_there_here * middle);
  }
  fit.differing = compare(world, stretch, fit.T_there_here, {kAll, 0.0}).differing();
  return fit;
}

}  // namespace adit
