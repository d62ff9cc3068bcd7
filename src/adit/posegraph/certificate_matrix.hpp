// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The certificate matrix of a pose graph. Private to this folder; certificate.hpp says what it is for.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "adit/posegraph/normal_equations.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Dimension of the space that poses live in: 2 or 3.
template <class P>
inline constexpr int kSpaceOf = P::kDof == 6 ? 3 : 2;

/// A function of the poses that lies below chi2 of an edge everywhere and (nearly) touches it at one value
/// y = (e, r) of the residual:
///   stiffness |v|^2 - 2 lever . v - tr(turn^T R_from^T R_to) + constant,   v = R_from^T (t_to - t_from).
/// It is quadratic in the entries of rotation matrices and translations, which is what duality needs.
/// Translations, where only the smallest eigenvalue of the information may stay: the tangent paraboloid.
/// Rotations: theta^2 is convex in 1 - cos(theta), so that its tangent in 1 - cos(theta) lies below; what the
/// information exceeds its smallest eigenvalue by, Delta, becomes 2 (1 - cos(theta)) n^T Delta n.
/// The cross blocks of the information cost both parts the share 1 - (largest canonical correlation).
template <class P>
struct EdgeMinorant {
  double stiffness = 0.0;  ///< Information of the translation along every direction, not negative.
  Eigen::Matrix<double, kSpaceOf<P>, 1> lever;  ///< Seen from the node at which the edge starts, as v.
  Eigen::Matrix<double, kSpaceOf<P>, kSpaceOf<P>> turn;  ///< 0 where the minorant says nothing of rotations.
  double slack = 0.0;                                    ///< chi2 less the minorant at y, not negative.
};
/// The minorant of an edge that touches its chi2 at this residual y. The edge's weight does not count.
template <class P>
[[nodiscard]] EdgeMinorant<P> minorant_at(const typename BasicPoseGraph<P>::Edge& edge,
                                          const typename P::Tangent& residual);

/// The unknowns of a node are the columns of (R_i | t_i): blocks of this size.
template <class P>
inline constexpr int kBlockOf = kSpaceOf<P> + 1;

/// The blocks of a minorant's quadratic form.
template <class P>
[[nodiscard]] EdgeTerms<kBlockOf<P>> quadratic_form(const EdgeMinorant<P>& minorant);

/// The quadratic form of all minorants, and its stationarity at the poses. Anchors are held, so that the form
/// is regular.
struct CertificateMatrix {
  std::vector<double> values;  ///< Blocks of S = Q - Lambda in the order of the structure's pattern.
  Eigen::MatrixXd residual;    ///< G = S (R | t)^T with the anchors' part: zero at a stationary point.
  double slack = 0.0;          ///< chi2 less the sum of the minorants at the poses.
};
/// `minorants`: one per active edge of `structure`, already multiplied by the edges' weights.
template <class P>
[[nodiscard]] CertificateMatrix certificate_matrix(const BasicPoseGraph<P>& graph,
                                                   const GraphStructure& structure,
                                                   const std::vector<P>& poses,
                                                   const std::vector<EdgeMinorant<P>>& minorants);

/// A certificate matrix S with shifts: S + shift on the diagonal of the rotations.
class ShiftedMatrix {
 public:
  /// `values`: blocks of `block_size` in the order of `pattern`, which must outlive this object.
  ShiftedMatrix(std::vector<double> values, const BlockPattern& pattern,
                const std::shared_ptr<const BlockSymbolic>& symbolic, std::size_t block_size);

  /// Nothing where S + shift is positive definite, else the variable at which this fails.
  [[nodiscard]] std::optional<std::size_t> factorize(double shift);
  /// Factorizes with the smallest of a few shifts that makes S positive definite; nothing where all fail,
  /// the largest of which is a hundred times S's mean diagonal.
  [[nodiscard]] std::optional<double> factorize_with_least_shift();
  /// Of what was factorized last.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right_sides) const;

  /// Of S with the translations eliminated: smallest eigenvalue, from above, and its vector with the
  /// translations that belong to it. By Lanczos' method on the inverse of what was factorized with `shift`.
  struct Mode {
    double eigenvalue = 0.0;  ///< Of S itself, without the shift.
    Eigen::VectorXd vector;   ///< Rows as those of S; of any length.
  };
  /// `shift`: that of what was factorized last; `steps`: of Lanczos' method, at most, one solution each.
  [[nodiscard]] Mode softest_mode(double shift, int steps) const;

 private:
  template <class Visit>
  void for_diagonal(const Visit& visit) const;
  void keep_rotations(Eigen::VectorXd& x) const;
  [[nodiscard]] double mean_rotation_diagonal() const;

  std::vector<double> values_;
  const BlockPattern& pattern_;
  std::size_t block_size_;
  BlockCholesky cholesky_;
};

}  // namespace adit
