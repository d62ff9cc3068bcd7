// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/certificate_matrix.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr std::size_t kItemsAtOnce = 256;  // edges or nodes that one thread takes at a time

// Beyond this angle the tangent grows too steep to be of use: it is taken here instead, and the rest is
// slack.
constexpr double kLargestTangent = 2.8;

template <class P>
using Square = Eigen::Matrix<double, kSpaceOf<P>, kSpaceOf<P>>;
template <class P>
using Position = Eigen::Matrix<double, kSpaceOf<P>, 1>;
template <class P>
constexpr int kTurns = P::kDof - kSpaceOf<P>;
template <class P>
using TurnVector = Eigen::Matrix<double, kTurns<P>, 1>;
template <class P>
using TurnSquare = Eigen::Matrix<double, kTurns<P>, kTurns<P>>;

double smallest_eigenvalue(const Eigen::Matrix<double, 1, 1>& m) { return m(0, 0); }
double smallest_eigenvalue(const Eigen::Matrix2d& m) {
  const double mean = 0.5 * (m(0, 0) + m(1, 1));
  return mean - std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(1, 0));
}
double smallest_eigenvalue(const Matrix3& m) { return symmetric_eigen(m).values.minCoeff(); }

Matrix3 rotation_of(const Vector3& turn) { return so3::exp(turn).toRotationMatrix(); }
Eigen::Matrix2d rotation_of(const Eigen::Matrix<double, 1, 1>& turn) {
  return Eigen::Rotation2Dd(turn(0)).toRotationMatrix();
}
double angle_of(const Matrix3& R) { return so3::log(Eigen::Quaterniond(R)).norm(); }
double angle_of(const Eigen::Matrix2d& R) { return std::abs(std::atan2(R(1, 0), R(0, 0))); }

// The share of both diagonal blocks that stays when the cross blocks are left out:
// information - share * diag(translation block, rotation block) is positive semidefinite.
template <class P>
double share_without_cross_blocks(const typename BasicPoseGraph<P>::Information& information) {
  constexpr int d = kSpaceOf<P>;
  const auto cross = information.template bottomLeftCorner<kTurns<P>, d>();
  if (cross.cwiseAbs().maxCoeff() == 0.0) return 1.0;
  const Eigen::LLT<Square<P>> translation(information.template topLeftCorner<d, d>());
  const Eigen::LLT<TurnSquare<P>> rotation(information.template bottomRightCorner<kTurns<P>, kTurns<P>>());
  if (translation.info() != Eigen::Success || rotation.info() != Eigen::Success) return 0.0;
  Eigen::Matrix<double, kTurns<P>, d> whitened =
      rotation.matrixL().solve(Eigen::Matrix<double, kTurns<P>, d>(cross));
  whitened = translation.matrixL().solve(whitened.transpose()).transpose().eval();
  const TurnSquare<P> correlation = whitened * whitened.transpose();
  const double largest = -smallest_eigenvalue(TurnSquare<P>(-correlation));
  return std::max(0.0, 1.0 - std::sqrt(std::max(0.0, largest)));
}

// The minorant of lambda |r - centre|^2 + r^T Delta r - lambda |centre|^2, with r = Log of the error.
template <class P>
struct Bending {
  Square<P> turn;  // of the error, not yet of R_from^T R_to
  double slack;
};
// |r - centre| is at least the angle psi between the error and Exp(centre): exponential maps of spaces of
// nonnegative curvature do not stretch.
template <class P>
Bending<P> tangent_in_cosine(double lambda, const TurnVector<P>& centre, const TurnVector<P>& r) {
  const Square<P> C = rotation_of(centre);
  const double psi = angle_of(Square<P>(C.transpose() * rotation_of(r)));
  const double at = std::min(psi, kLargestTangent);
  const double slope = at < 1e-4 ? 1.0 + at * at / 6.0 : at / std::sin(at);
  const double touching = at * at + 2.0 * slope * (std::cos(at) - std::cos(psi));
  return {lambda * slope * C, lambda * ((r - centre).squaredNorm() - touching)};
}
// r^T Delta r >= tr(M (I - E)) with M = tr(Delta) I - 2 Delta.
Bending<Pose> excess(const Matrix3& delta, const Vector3& r) {
  const double half = 0.5 * r.norm();
  const double sinc = half < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
  return {delta.trace() * Matrix3::Identity() - 2.0 * delta, (1.0 - sinc * sinc) * r.dot(delta * r)};
}
Bending<Pose2> excess(const Eigen::Matrix<double, 1, 1>&, const Eigen::Matrix<double, 1, 1>&) {
  return {Eigen::Matrix2d::Zero(), 0.0};
}

}  // namespace

template <class P>
EdgeMinorant<P> minorant_at(const typename BasicPoseGraph<P>::Edge& edge, const typename P::Tangent& y) {
  constexpr int d = kSpaceOf<P>;
  const double share = share_without_cross_blocks<P>(edge.information);
  const typename P::Tangent force = edge.information * y;
  const Square<P> R = edge.T_from_to.rotation_matrix();
  const Position<P> v = edge.T_from_to.translation() + R * y.template head<d>();
  EdgeMinorant<P> m;
  m.stiffness =
      std::max(0.0, share * smallest_eigenvalue(Square<P>(edge.information.template topLeftCorner<d, d>())));
  m.lever = m.stiffness * v - R * force.template head<d>();
  const TurnSquare<P> bending = share * edge.information.template bottomRightCorner<kTurns<P>, kTurns<P>>();
  const double lambda = smallest_eigenvalue(bending);
  const TurnVector<P> r = y.template tail<kTurns<P>>();
  const TurnVector<P> tilt =
      force.template tail<kTurns<P>>() - bending * r;  // 2 tilt . r comes from the cross blocks
  if (!(lambda > 0.0)) {
    m.turn.setZero();
    m.slack = r.dot(bending * r) + 2.0 * (tilt.dot(r) + std::numbers::pi * tilt.norm());
    return m;
  }
  const Bending<P> main = tangent_in_cosine<P>(lambda, -tilt / lambda, r);
  const Bending<P> rest = excess(TurnSquare<P>(bending - lambda * TurnSquare<P>::Identity()), r);
  m.turn = R * (main.turn + rest.turn);
  m.slack = std::max(0.0, main.slack) + std::max(0.0, rest.slack);
  return m;
}

template <class P>
EdgeTerms<kBlockOf<P>> quadratic_form(const EdgeMinorant<P>& m) {
  constexpr int d = kSpaceOf<P>;
  EdgeTerms<d + 1> q;
  q.from_from.setZero();
  q.from_from.template topRightCorner<d, 1>() = m.lever;
  q.from_from.template bottomLeftCorner<1, d>() = m.lever.transpose();
  q.from_from(d, d) = m.stiffness;
  q.to_to.setZero();
  q.to_to(d, d) = m.stiffness;
  q.from_to << -0.5 * m.turn, -m.lever, Position<P>::Zero().transpose(), -m.stiffness;
  return q;
}

template <class P>
CertificateMatrix certificate_matrix(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
                                     const std::vector<P>& poses,
                                     const std::vector<EdgeMinorant<P>>& minorants) {
  constexpr int d = kSpaceOf<P>;
  constexpr int D = d + 1;
  using Block = Eigen::Matrix<double, D, d>;  // rows of Q (R | t)^T
  const std::size_t num_edges = structure.active_edges.size();
  std::vector<EdgeTerms<D>> terms(num_edges);
  std::vector<Block> at_from(num_edges);
  std::vector<Block> at_to(num_edges);
  parallel_for_each(
      num_edges,
      [&](std::size_t a) {
        const auto& edge = graph.edges[structure.active_edges[a]];
        const EdgeTerms<D>& q = terms[a] = quadratic_form(minorants[a]);
        Block from;
        Block to;
        // Only differences of translations count: near the origin these are exact.
        const Position<P> t = poses[edge.to].translation() - poses[edge.from].translation();
        from << poses[edge.from].rotation_matrix().transpose(), Position<P>::Zero().transpose();
        to << poses[edge.to].rotation_matrix().transpose(), t.transpose();
        at_from[a] = q.from_from * from + q.from_to * to;
        at_to[a] = q.from_to.transpose() * from + q.to_to * to;
      },
      kItemsAtOnce);
  CertificateMatrix out{sum_terms<D>(structure, terms), {}, 0.0};
  for (const EdgeMinorant<P>& m : minorants) out.slack += m.slack;
  out.residual.resize(static_cast<Eigen::Index>(structure.node_of_variable.size() * D), d);
  parallel_for_each(
      structure.node_of_variable.size(),
      [&](std::size_t v) {
        const std::size_t diagonal = structure.pattern.column_start[v];
        Block sum = Block::Zero();
        for (std::size_t t = structure.term_start[diagonal]; t < structure.term_start[diagonal + 1]; ++t) {
          const GraphStructure::Term& term = structure.terms[t];
          const bool from = term.part == GraphStructure::Term::Part::from_from;
          sum += from ? at_from[term.active_edge] : at_to[term.active_edge];
        }
        const Square<P> R = poses[structure.node_of_variable[v]].rotation_matrix();
        const Square<P> product = sum.template topRows<d>() * R;
        const Square<P> multiplier = 0.5 * (product + product.transpose());
        sum.template topRows<d>() -= multiplier * R.transpose();
        out.residual.template middleRows<D>(static_cast<Eigen::Index>(v * D)) = sum;
        Eigen::Map<Eigen::Matrix<double, D, D>> block(out.values.data() + diagonal * D * D);
        block.template topLeftCorner<d, d>() -= multiplier;
      },
      kItemsAtOnce);
  return out;
}

template EdgeMinorant<Pose> minorant_at<Pose>(const PoseGraph::Edge&, const Vector6&);
template EdgeMinorant<Pose2> minorant_at<Pose2>(const PoseGraph2::Edge&, const Vector3&);
template EdgeTerms<4> quadratic_form(const EdgeMinorant<Pose>&);
template EdgeTerms<3> quadratic_form(const EdgeMinorant<Pose2>&);
template CertificateMatrix certificate_matrix(const PoseGraph&, const GraphStructure&,
                                              const std::vector<Pose>&,
                                              const std::vector<EdgeMinorant<Pose>>&);
template CertificateMatrix certificate_matrix(const PoseGraph2&, const GraphStructure&,
                                              const std::vector<Pose2>&,
                                              const std::vector<EdgeMinorant<Pose2>>&);

}  // namespace adit
