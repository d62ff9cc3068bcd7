// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstddef>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// One robot's odometry over its keyframes, in space or in the plane. Covariances between any two keyframes
/// compose along it in O(1).
template <class P>
class BasicOdometryChain {
 public:
  using Covariance = typename P::Jacobian;  ///< [translation; rotation].

  /// `step_covariances[k]`: of T_k_(k+1), right perturbation, [translation; rotation]; one less than the
  /// poses, or ContractViolation.
  BasicOdometryChain(std::vector<P> T_odom_keyframe, const std::vector<Covariance>& step_covariances);

  /// Keyframes.
  [[nodiscard]] std::size_t size() const { return T_odom_keyframe_.size(); }
  /// T_odom_keyframe of keyframe i.
  [[nodiscard]] const P& pose(std::size_t i) const { return T_odom_keyframe_[i]; }
  /// T_i_j by odometry.
  [[nodiscard]] P between(std::size_t i, std::size_t j) const { return pose(i).inverse() * pose(j); }
  /// Length of the path up to each keyframe, by the steps from keyframe to keyframe.
  [[nodiscard]] const std::vector<double>& path_m() const { return path_m_; }
  /// Covariance of T_i_j, right perturbation, for i before, after or equal to j.
  [[nodiscard]] Covariance covariance(std::size_t i, std::size_t j) const;
  /// T_0_i: maps may be kept in coordinates of surveyors, whose millions of metres would swallow a
  /// covariance.
  [[nodiscard]] const P& from_first(std::size_t i) const { return T_first_keyframe_[i]; }
  /// What the steps between i and j (any order) add to the covariance, as seen from keyframe 0.
  [[nodiscard]] Covariance covariance_from_first(std::size_t i, std::size_t j) const;

 private:
  std::vector<P> T_odom_keyframe_;
  std::vector<P> T_first_keyframe_;
  std::vector<double> path_m_;
  std::vector<Covariance> prefix_;  ///< prefix_[j]: sum over steps k < j of Ad(T_0_(k+1)) Sigma_k Ad^T.
};
/// In space.
using OdometryChain = BasicOdometryChain<Pose>;

/// Where a node of a graph stands: on which of its `odometry_paths`, and at which place along it.
struct PlaceOnPath {
  std::size_t path = 0;      ///< Index of the path.
  std::size_t position = 0;  ///< Index into its `nodes`.
  auto operator<=>(const PlaceOnPath&) const = default;
};
/// The place of each node. The paths must hold every node once.
[[nodiscard]] std::vector<PlaceOnPath> places_on(const std::vector<OdometryPath>& paths,
                                                 std::size_t num_nodes);

/// The odometry along a path, which begins at the identity. `covariance_of` gives the covariance that belongs
/// to an edge's information matrix.
template <class P, class CovarianceOf>
[[nodiscard]] BasicOdometryChain<P> chain_along(const BasicPoseGraph<P>& graph, const OdometryPath& path,
                                                const CovarianceOf& covariance_of) {
  std::vector<P> poses = {P()};
  std::vector<typename P::Jacobian> covariances;
  for (const std::size_t e : path.steps) {
    poses.push_back(poses.back() * graph.edges[e].T_from_to);
    covariances.push_back(covariance_of(graph.edges[e].information));
  }
  return {std::move(poses), covariances};
}

}  // namespace adit
