// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/posegraph/normal_equations.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// The rotation nearest to `m` in the Frobenius norm.
///@{
[[nodiscard]] Matrix3 nearest_rotation(const Matrix3& m);
[[nodiscard]] Eigen::Matrix2d nearest_rotation(const Eigen::Matrix2d& m);
///@}

/// Poses to start from that need no initial guess: rotations by linear least squares over unconstrained
/// matrices, each then projected to the nearest rotation; translations by linear least squares given these.
/// Anchors keep their poses; the poses of other nodes are ignored. Source: Carlone, Tron, Daniilidis,
/// Dellaert, "Initialization techniques for 3D SLAM" (ICRA 2015), section III.B (chordal relaxation). Error:
/// the edges do not constrain some node.
template <class P>
[[nodiscard]] Result<std::vector<P>> chordal_poses(const BasicPoseGraph<P>& graph,
                                                   const std::vector<double>& edge_weights = {});

/// Poses of `chordal_poses`, and how firmly the edges hold them.
template <class P>
struct ChordalStart {
  std::vector<P> poses;      ///< T_world_node, one per node; anchors as given.
  double least_pivot = 1.0;  ///< Of the system for the translations, see `BlockCholesky::least_pivot`.
};
/// The same as `chordal_poses` where the structure of the graph with these weights is known already.
template <class P>
[[nodiscard]] Result<ChordalStart<P>> chordal_start(const BasicPoseGraph<P>& graph,
                                                    const std::vector<double>& edge_weights,
                                                    const GraphStructure& structure,
                                                    const std::shared_ptr<const BlockSymbolic>& symbolic);

}  // namespace adit
