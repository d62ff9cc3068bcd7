// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A path out of local minima, through spaces of more dimensions. Private to this folder.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "adit/posegraph/normal_equations.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Poses from which another search may find a lower minimum, or nothing where none was found. The chordal
/// cost (SE-Sync's, with the mean information of translations and of rotations) is minimised from `poses`
/// over d x r matrices with orthonormal rows; where its certificate matrix has a negative eigenvalue, r grows
/// by one and the search goes on along the eigenvector; at the end all is projected back to rotations.
/// Anchors keep their poses. Source: the Riemannian staircase of SE-Sync (Rosen et al., IJRR 2019, algorithms
/// 1 and 2); minimisation here is by preconditioned conjugate gradients.
template <class P>
[[nodiscard]] std::optional<std::vector<P>> lifted_descent(const BasicPoseGraph<P>& graph,
                                                           const std::vector<P>& poses,
                                                           const std::vector<double>& edge_weights);

}  // namespace adit
