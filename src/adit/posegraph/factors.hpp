// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The one residual of a pose graph and its exact derivatives.
///
/// E = Z^-1 T_i^-1 T_j and r = (translation of E, Log of the rotation of E), in space and in the plane;
/// metres and radians. Nodes are perturbed on the right, translation and rotation separately: R <- R
/// Exp(phi), t <- t + R rho; to first order that is T <- T Exp([rho; phi]). The Jacobians are exact at any
/// residual (Forster et al., "On-Manifold Preintegration", eq. (26) and (30)-(35) for the calculus).
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// The residual of an edge, and how it changes with the poses of its two nodes.
template <class P>
struct BetweenFactor {
  typename P::Tangent residual;  ///< r, translation first; metres and radians.
  typename P::Jacobian d_from;   ///< d residual / d perturbation of T_i.
  typename P::Jacobian d_to;     ///< d residual / d perturbation of T_j.
};

/// r of the measurement Z = T_from_to.
///@{
[[nodiscard]] Vector6 between_residual(const Pose& T_from_to, const Pose& T_world_from,
                                       const Pose& T_world_to);
[[nodiscard]] Vector3 between_residual(const Pose2& T_from_to, const Pose2& T_world_from,
                                       const Pose2& T_world_to);
///@}

/// r and its derivatives at these poses.
///@{
[[nodiscard]] BetweenFactor<Pose> linearize(const Pose& T_from_to, const Pose& T_world_from,
                                            const Pose& T_world_to);
[[nodiscard]] BetweenFactor<Pose2> linearize(const Pose2& T_from_to, const Pose2& T_world_from,
                                             const Pose2& T_world_to);
///@}

/// The same of poses of which only T_i_j is known: residual and derivatives depend on nothing else.
///@{
[[nodiscard]] BetweenFactor<Pose> linearize(const Pose& T_from_to, const Pose& estimate);
[[nodiscard]] BetweenFactor<Pose2> linearize(const Pose2& T_from_to, const Pose2& estimate);
///@}

/// The perturbation above.
///@{
[[nodiscard]] Pose retract(const Pose& T, const Vector6& step);
[[nodiscard]] Pose2 retract(const Pose2& T, const Vector3& step);
///@}

}  // namespace adit
