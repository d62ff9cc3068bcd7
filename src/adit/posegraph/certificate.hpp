// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Proof that poses are a global minimum of chi2, or how far from one they can be at most.
///
/// The problem certified is the one that `optimize` solves: chi2 with the logarithm of rotations and full
/// information matrices, over all poses at once. chi2 itself has no useful dual. So each edge gets a minorant
/// (certificate_matrix.hpp): a function below the edge's chi2 everywhere, equal to it at the given poses, and
/// quadratic in the entries of rotation matrices and translations, like the cost of SE-Sync. For the sum of
/// the minorants, Lagrangian duality over R_i^T R_i = I gives the certificate matrix S = Q - Lambda. With the
/// anchors held, if S is positive definite, then for all poses
///   chi2 >= bound = chi2(given) - slack - tr(G^T S^-1 G),
/// where G = S (R | t)^T vanishes at a stationary point and `slack` is what the minorants lose at the given
/// poses. In the plane, and in space where the rotation block of each information matrix is isotropic and
/// its cross blocks are zero, the slack is zero and the bound is tight; else it is about theta^2 / 12 of
/// chi2, for residual angles theta. If S is not positive definite nothing is proved either way: the
/// relaxation may be loose. Then S + eta I on the rotations gives a weaker bound, 8 eta per node below.
///
/// Sources: Rosen, Carlone, Bandeira, Leonard, "SE-Sync" (IJRR 2019), theorem 7; Carlone, Rosen, Calafiore,
/// Leonard, Dellaert, "Lagrangian duality in 3D SLAM" (IROS 2015). The minorants are adit's (decision 0025).
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Whether any poses cost less than the given ones.
enum class Optimality {
  globally_optimal,  ///< No poses cost less than the given ones by more than `max_gap`.
  cannot_tell,       ///< The bound is further off than that, and no better poses were found.
  not_optimal,       ///< Better poses were found. Only `improved` searches for them.
};
[[nodiscard]] std::string_view to_string(Optimality optimality);  ///< "globally optimal", ...

/// What is proved of some poses: a lower bound of the cost of all others, and the verdict that it allows.
struct Certificate {
  Optimality optimality = Optimality::cannot_tell;  ///< By `gap`; never not_optimal where `certify` made it.
  double cost = 0.0;                                ///< chi2 of the given poses.
  double lower_bound = 0.0;                         ///< No poses cost less; at least 0.
  double gap = 0.0;  ///< (cost - lower_bound) / cost; 0 where the cost is rounding.
  /// Of S with the translations eliminated and the anchors held, in units of rotational information; from
  /// a few steps of Lanczos' method, so that the true one may be slightly smaller. The verdict rests on the
  /// factorization of S, not on this number. Infinite where no node is free, minus infinity where S is too
  /// indefinite to measure.
  double smallest_eigenvalue = std::numeric_limits<double>::infinity();
  std::string reason;  ///< In one sentence.
};

/// When a gap counts as none, and how long better poses are looked for.
struct CertificateConfig {
  double max_gap = 1e-3;  ///< Largest gap, relative to the cost, that counts as globally optimal.
  int max_descents = 3;   ///< Of `improved`: searches for better poses, at most.
};

/// Certifies `poses` (T_world_node, one per node; each component's anchor has any pose). `edge_weights` as in
/// `optimize`: multiplies information; edges of weight 0 are left out, so that after GNC the certificate
/// speaks of the edges kept and not of the choice of edges. All components are judged together: one that
/// fails makes the whole fail. Costs about one factorization with blocks of 4 (plane: 3). The same bytes with
/// any number of threads. Positive definite means: the Cholesky factorization succeeds after the diagonal was
/// lowered by 1e-12 of itself, which exceeds its rounding errors (Rump, "Verification of positive
/// definiteness", BIT 2006).
template <class P>
[[nodiscard]] Certificate certify(const BasicPoseGraph<P>& graph, const std::vector<P>& poses,
                                  const CertificateConfig& config = {},
                                  const std::vector<double>& edge_weights = {});

/// A solution, replaced where it was shown not to be optimal, and its certificate.
template <class P>
struct Certified {
  Solution<P> solution;                        ///< The one given, or the best of those found from it.
  Certificate certificate;                     ///< Of `solution`.
  Optimality given = Optimality::cannot_tell;  ///< Of the solution given: not_optimal where it was replaced.
  int descents = 0;                            ///< How often better poses were found.
};
/// Tries to improve a solution of `graph` whose certificate does not say globally optimal; returns others
/// unchanged. Descends along the negative direction of the chordal problem's certificate matrix in a space of
/// one dimension more, projects back and optimizes from there; a lower minimum replaces the solution and is
/// certified in turn. Takes a few times as long as solving. Source: SE-Sync's Riemannian staircase.
template <class P>
[[nodiscard]] Certified<P> improved(const BasicPoseGraph<P>& graph, Certified<P> known,
                                    const OptimizerConfig& optimizer = {},
                                    const CertificateConfig& config = {});
/// The certificate of a solution of `graph`, with its edge weights, before any search for a better one.
template <class P>
[[nodiscard]] Certified<P> certified(const BasicPoseGraph<P>& graph, Solution<P> solution,
                                     const CertificateConfig& config = {});

}  // namespace adit
