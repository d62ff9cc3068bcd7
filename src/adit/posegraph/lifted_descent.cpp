// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/lifted_descent.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/posegraph/certificate_matrix.hpp"
#include "adit/posegraph/chordal.hpp"

namespace adit {
namespace {

constexpr int kMaxExtraRanks = 3;
constexpr int kMaxLiftedRounds = 40;  // of conjugate gradients, per rank
constexpr int kMaxHalvings = 20;      // of one step
constexpr double kArmijo = 1e-4;      // share of the slope that a step has to gain
constexpr double kLiftedSettled =
    1e-7;  // squared gradient in the metric of the preconditioner, relative to the start's
constexpr int kModeSteps = 12;  // of Lanczos

// Unknowns: one block of kBlockOf rows per variable, (Y_i | p_i)^T with Y_i r x d and p_i in r dimensions.
template <class P>
class LiftedSearch {
 public:
  LiftedSearch(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
               const std::vector<double>& weights, const std::vector<P>& poses)
      : graph_(graph), structure_(structure), symbolic_(analyze(structure.pattern)), poses_(poses) {
    std::vector<EdgeTerms<D>> metric;
    for (const std::size_t e : structure.active_edges) {
      const EdgeMinorant<P> m = chordal(graph.edges[e], weights.empty() ? 1.0 : weights[e]);
      terms_.push_back(quadratic_form(m));
      metric.push_back(definite(m));
    }
    Q_ = sum_terms<D>(structure, terms_);
    metric_.emplace(sum_terms<D>(structure, metric), structure.pattern, symbolic_, D);
  }

  [[nodiscard]] bool is_sound() { return !metric_->factorize(0.0); }

  [[nodiscard]] std::optional<std::vector<P>> run() {
    Eigen::MatrixXd X = unlifted();
    for (int extra = 0; extra <= kMaxExtraRanks; ++extra) {
      set_anchors(X.cols());
      X = descend(std::move(X));
      if (extra == kMaxExtraRanks) break;
      ShiftedMatrix S(certificate_values(X), structure_.pattern, symbolic_, D);
      if (!S.factorize(0.0)) break;  // the chordal cost has no lower minimum
      const std::optional<double> shift = S.factorize_with_least_shift();
      if (!shift) return std::nullopt;
      X = lifted_along(std::move(X), S.softest_mode(*shift, kModeSteps).vector);
    }
    return rounded(X);
  }

 private:
  static constexpr int d = kSpaceOf<P>;
  static constexpr int D = kBlockOf<P>;
  using Square = Eigen::Matrix<double, d, d>;

  // stiffness |t_to - t_from - R_from t|^2 + bending / 2 |R_to - R_from R|^2 with mean weights, less a
  // constant.
  static EdgeMinorant<P> chordal(const typename BasicPoseGraph<P>::Edge& edge, double weight) {
    constexpr int turns = P::kDof - d;
    const double stiffness = weight * edge.information.template topLeftCorner<d, d>().trace() / d;
    const double bending =
        weight * edge.information.template bottomRightCorner<turns, turns>().trace() / turns;
    return {stiffness, stiffness * edge.T_from_to.translation(), bending * edge.T_from_to.rotation_matrix(),
            0.0};
  }
  // The form plus what is constant where rows are orthonormal: positive semidefinite, the preconditioner.
  static EdgeTerms<D> definite(const EdgeMinorant<P>& m) {
    EdgeTerms<D> q = quadratic_form(m);
    const Square bending = 0.5 * m.turn.col(0).norm() * Square::Identity();
    q.from_from.template topLeftCorner<d, d>() += bending;
    if (m.stiffness > 0.0)
      q.from_from.template topLeftCorner<d, d>() += m.lever * m.lever.transpose() / m.stiffness;
    q.to_to.template topLeftCorner<d, d>() += bending;
    return q;
  }

  static Eigen::Index at(std::size_t variable) { return static_cast<Eigen::Index>(variable) * D; }
  static auto rows(Eigen::MatrixXd& X, std::size_t v) { return X.middleRows(at(v), d); }
  static auto rows(const Eigen::MatrixXd& X, std::size_t v) { return X.middleRows(at(v), d); }
  [[nodiscard]] std::size_t size() const { return structure_.node_of_variable.size(); }

  static Eigen::MatrixXd block_of(const P& pose, Eigen::Index rank) {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(D, rank);
    block.leftCols(d) << pose.rotation_matrix().transpose(), pose.translation().transpose();
    return block;
  }
  [[nodiscard]] Eigen::MatrixXd unlifted() const {
    Eigen::MatrixXd X(at(size()), d);
    for (std::size_t v = 0; v < size(); ++v)
      X.middleRows(at(v), D) = block_of(poses_[structure_.node_of_variable[v]], d);
    return X;
  }
  // What the anchors add to the gradient.
  void set_anchors(Eigen::Index rank) {
    anchors_ = Eigen::MatrixXd::Zero(at(size()), rank);
    for (std::size_t a = 0; a < terms_.size(); ++a) {
      const auto& edge = graph_.edges[structure_.active_edges[a]];
      const std::size_t from = structure_.variable_of_node[edge.from];
      const std::size_t to = structure_.variable_of_node[edge.to];
      if (from == GraphStructure::kFixed)
        anchors_.middleRows(at(to), D) += terms_[a].from_to.transpose() * block_of(poses_[edge.from], rank);
      if (to == GraphStructure::kFixed)
        anchors_.middleRows(at(from), D) += terms_[a].from_to * block_of(poses_[edge.to], rank);
    }
  }
  [[nodiscard]] Eigen::MatrixXd times_Q(const Eigen::MatrixXd& X) const {
    Eigen::MatrixXd out(X.rows(), X.cols());
    for (Eigen::Index c = 0; c < X.cols(); ++c) out.col(c) = times<D>(structure_.pattern, Q_, X.col(c));
    return out;
  }
  static double dot(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a.array() * b.array()).sum();
  }

  // Half the cost's Euclidean gradient, and Lambda of each node.
  [[nodiscard]] Eigen::MatrixXd gradient(const Eigen::MatrixXd& X) const { return times_Q(X) + anchors_; }
  [[nodiscard]] double cost(const Eigen::MatrixXd& X) const {
    return dot(X, times_Q(X)) + 2.0 * dot(X, anchors_);
  }
  static Square multiplier(const Eigen::MatrixXd& X, const Eigen::MatrixXd& G, std::size_t v) {
    const Square product = rows(G, v) * rows(X, v).transpose();
    return 0.5 * (product + product.transpose());
  }
  // Onto the directions that keep rows orthonormal to first order.
  [[nodiscard]] Eigen::MatrixXd tangent(const Eigen::MatrixXd& X, Eigen::MatrixXd V) const {
    for (std::size_t v = 0; v < size(); ++v) rows(V, v) -= (multiplier(X, V, v) * rows(X, v)).eval();
    return V;
  }
  [[nodiscard]] Eigen::MatrixXd retracted(Eigen::MatrixXd X) const {
    for (std::size_t v = 0; v < size(); ++v) {
      const Square gram = rows(X, v) * rows(X, v).transpose();
      const Eigen::SelfAdjointEigenSolver<Square> eigen(gram);
      const Square root = eigen.operatorInverseSqrt();
      rows(X, v) = (root * rows(X, v)).eval();
    }
    return X;
  }
  [[nodiscard]] std::vector<double> certificate_values(const Eigen::MatrixXd& X) const {
    std::vector<double> values = Q_;
    const Eigen::MatrixXd G = gradient(X);
    for (std::size_t v = 0; v < size(); ++v) {
      Eigen::Map<Eigen::Matrix<double, D, D>> block(values.data() +
                                                    structure_.pattern.column_start[v] * D * D);
      block.template topLeftCorner<d, d>() -= multiplier(X, G, v);
    }
    return values;
  }

  // Along `V` from X, by halving; X itself where the cost does not fall.
  [[nodiscard]] std::pair<Eigen::MatrixXd, bool> stepped(const Eigen::MatrixXd& X, const Eigen::MatrixXd& V,
                                                         double length, double slope) const {
    const double before = cost(X);
    for (int i = 0; i < kMaxHalvings; ++i, length *= 0.5) {
      Eigen::MatrixXd next = retracted(X + length * V);
      if (cost(next) < before + kArmijo * length * slope) return {std::move(next), true};
    }
    return {X, false};
  }

  // Preconditioned conjugate gradients (Polak and Ribiere, restarted where the slope is not downwards).
  [[nodiscard]] Eigen::MatrixXd descend(Eigen::MatrixXd X) const {
    Eigen::MatrixXd V;
    Eigen::MatrixXd last;
    double last_gz = 0.0;
    double first_gz = 0.0;
    for (int round = 0; round < kMaxLiftedRounds; ++round) {
      const Eigen::MatrixXd E = gradient(X);
      const Eigen::MatrixXd g = tangent(X, E);
      const Eigen::MatrixXd z = tangent(X, metric_->solve(g));
      const double gz = dot(g, z);
      if (round == 0) first_gz = gz;
      if (!(gz > kLiftedSettled * first_gz)) break;
      const double beta = round == 0 ? 0.0 : std::max(0.0, (gz - dot(last, z)) / last_gz);
      V = round == 0 ? Eigen::MatrixXd(-z) : Eigen::MatrixXd(-z + beta * tangent(X, std::move(V)));
      if (!(dot(g, V) < 0.0)) V = -z;
      const double slope = dot(g, V);
      Eigen::MatrixXd SV = times_Q(V);
      for (std::size_t v = 0; v < size(); ++v) rows(SV, v) -= (multiplier(X, E, v) * rows(V, v)).eval();
      const double curvature = dot(V, SV);
      auto [next, falls] = stepped(X, V, curvature > 0.0 ? -slope / curvature : 1.0, 2.0 * slope);
      if (!falls) break;
      X = std::move(next);
      last = g;
      last_gz = gz;
    }
    return X;
  }

  // X with one column more, moved along `mode` in it.
  [[nodiscard]] Eigen::MatrixXd lifted_along(Eigen::MatrixXd X, const Eigen::VectorXd& mode) {
    X.conservativeResize(Eigen::NoChange, X.cols() + 1);
    X.col(X.cols() - 1).setZero();
    set_anchors(X.cols());
    double largest = 0.0;
    for (std::size_t v = 0; v < size(); ++v) largest = std::max(largest, mode.segment<d>(at(v)).norm());
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(X.rows(), X.cols());
    V.col(V.cols() - 1) = mode / largest;
    return stepped(X, V, 1.0, 0.0).first;
  }

  // The d dimensions that hold most of the rotations, turned back to the anchors' poses.
  [[nodiscard]] std::vector<P> rounded(const Eigen::MatrixXd& X) const {
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(X.cols(), X.cols());
    for (std::size_t v = 0; v < size(); ++v) gram += rows(X, v).transpose() * rows(X, v);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
    Eigen::MatrixXd basis = eigen.eigenvectors().rightCols(d);
    double sign = 0.0;
    for (std::size_t v = 0; v < size(); ++v) sign += Square(rows(X, v) * basis).determinant();
    if (sign < 0.0) basis.col(0) *= -1.0;
    // The anchors span the first d axes; the nearest rotation turns their image onto them.
    const Square turn = nearest_rotation(Square(basis.topRows(d)));
    std::vector<P> poses = poses_;
    for (std::size_t v = 0; v < size(); ++v) {
      const Eigen::MatrixXd block = X.middleRows(at(v), D) * basis * turn.transpose();
      const Square R = nearest_rotation(Square(block.topRows(d).transpose()));
      poses[structure_.node_of_variable[v]] = pose_of(R, block.row(d).transpose());
    }
    return poses;
  }
  static Pose pose_of(const Matrix3& R, const Vector3& t) { return {R, t}; }
  static Pose2 pose_of(const Eigen::Matrix2d& R, const Eigen::Vector2d& t) {
    return {t.x(), t.y(), std::atan2(R(1, 0), R(0, 0))};
  }

  const BasicPoseGraph<P>& graph_;
  const GraphStructure& structure_;
  std::shared_ptr<const BlockSymbolic> symbolic_;
  const std::vector<P>& poses_;
  std::vector<EdgeTerms<D>> terms_;
  std::vector<double> Q_;
  std::optional<ShiftedMatrix> metric_;
  Eigen::MatrixXd anchors_;
};

}  // namespace

template <class P>
std::optional<std::vector<P>> lifted_descent(const BasicPoseGraph<P>& graph, const std::vector<P>& poses,
                                             const std::vector<double>& edge_weights) {
  const GraphStructure structure =
      structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  if (structure.pattern.size() == 0) return std::nullopt;
  LiftedSearch<P> search(graph, structure, edge_weights, poses);
  if (!search.is_sound()) return std::nullopt;
  return search.run();
}

template std::optional<std::vector<Pose>> lifted_descent(const PoseGraph&, const std::vector<Pose>&,
                                                         const std::vector<double>&);
template std::optional<std::vector<Pose2>> lifted_descent(const PoseGraph2&, const std::vector<Pose2>&,
                                                          const std::vector<double>&);

}  // namespace adit
