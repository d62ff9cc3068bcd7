// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/chordal.hpp"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

template <class P>
constexpr int kDim = P::kDof == 6 ? 3 : 2;
template <class P>
using Rotation = Eigen::Matrix<double, kDim<P>, kDim<P>>;
template <class P>
using Point = Eigen::Matrix<double, kDim<P>, 1>;
using Scalar = Eigen::Matrix<double, 1, 1>;

constexpr std::size_t kNodesPerPart = 256;  // nodes that one thread takes at a time

Pose pose_of(const Matrix3& R, const Vector3& t) { return {R, t}; }
Pose2 pose_of(const Eigen::Matrix2d& R, const Eigen::Vector2d& t) {
  return {t.x(), t.y(), std::atan2(R(1, 0), R(0, 0))};
}

// Mean information of the rotation part, times the edge's weight.
template <class P>
double rotation_weight(const typename BasicPoseGraph<P>::Edge& edge) {
  constexpr int n = P::kDof - kDim<P>;
  return edge.information.template bottomRightCorner<n, n>().trace() / n;
}

// Both least-squares problems read: sum over edges of |x_to - M x_from - b|^2 in the metric W, unknowns of
// kRows rows and kSides columns.
template <int kRows, int kSides>
struct EdgeModel {
  Eigen::Matrix<double, kRows, kRows> M;
  Eigen::Matrix<double, kRows, kSides> b;
  Eigen::Matrix<double, kRows, kRows> W;
};

template <int kRows, int kSides>
struct LinearSolution {
  std::vector<Eigen::Matrix<double, kRows, kSides>> x;
  double least_pivot;
};

// `x` holds the anchors' values, which move to the right side; `model` gives the EdgeModel of an edge.
template <class P, int kRows, int kSides, class Model>
Result<LinearSolution<kRows, kSides>> solve_linear(const BasicPoseGraph<P>& graph,
                                                   const GraphStructure& structure,
                                                   const std::shared_ptr<const BlockSymbolic>& symbolic,
                                                   std::vector<Eigen::Matrix<double, kRows, kSides>> x,
                                                   const Model& model) {
  using Unknown = Eigen::Matrix<double, kRows, kSides>;
  using Square = Eigen::Matrix<double, kRows, kRows>;
  std::vector<EdgeTerms<kRows>> terms(structure.active_edges.size());
  Eigen::MatrixXd right(static_cast<Eigen::Index>(structure.node_of_variable.size()) * kRows, kSides);
  right.setZero();
  for (std::size_t a = 0; a < terms.size(); ++a) {
    const std::size_t e = structure.active_edges[a];
    const auto& edge = graph.edges[e];
    const EdgeModel<kRows, kSides> m = model(e);
    const Square WM = m.W * m.M;
    terms[a].from_from = m.M.transpose() * WM;
    terms[a].to_to = m.W;
    terms[a].from_to = -WM.transpose();
    const std::size_t from = structure.variable_of_node[edge.from];
    const std::size_t to = structure.variable_of_node[edge.to];
    const auto at = [&](std::size_t v) {
      return right.template middleRows<kRows>(static_cast<Eigen::Index>(v) * kRows);
    };
    if (from == GraphStructure::kFixed) {
      at(to) += m.W * (m.b + m.M * x[edge.from]);
    } else if (to == GraphStructure::kFixed) {
      at(from) += WM.transpose() * Unknown(x[edge.to] - m.b);
    } else {
      at(to) += m.W * m.b;
      at(from) -= WM.transpose() * m.b;
    }
  }
  BlockCholesky cholesky(symbolic, kRows);
  const std::vector<double> matrix = sum_terms<kRows>(structure, terms);
  if (const auto variable = cholesky.factorize(matrix)) {
    const std::size_t node = structure.node_of_variable[*variable];
    return fail("the edges leave node " + std::to_string(graph.nodes[node].key) + " free to move");
  }
  const Eigen::MatrixXd solution = cholesky.solve(right);
  for (std::size_t v = 0; v < structure.node_of_variable.size(); ++v) {
    x[structure.node_of_variable[v]] =
        solution.template middleRows<kRows>(static_cast<Eigen::Index>(v) * kRows);
  }
  return LinearSolution<kRows, kSides>{std::move(x), cholesky.least_pivot(matrix)};
}

}  // namespace

// Newton's iteration for the polar factor, X <- (X + X^-T) / 2, keeps the sign of the determinant and doubles
// the correct digits each time (Higham, "Functions of Matrices", section 8.3); what is far from a rotation or
// turned inside out takes the decomposition.
Matrix3 nearest_rotation(const Matrix3& m) {
  constexpr int kRounds = 10;
  // Least squares shrinks the matrices where the graph is loose; scaled to volume 1 they are near rotations.
  const double volume = m.determinant();
  Matrix3 X = volume > 0.0 ? Matrix3(m / std::cbrt(volume)) : m;
  for (int i = 0; i < kRounds && X.determinant() > 0.1; ++i) {
    const Matrix3 next = 0.5 * (X + X.inverse().transpose());
    const double change = (next - X).squaredNorm();
    X = next;
    if (change < 1e-26) return X;
  }
  auto [u, singular_values, v] = svd(m);
  if ((u * v.transpose()).determinant() < 0.0) u.col(2) *= -1.0;
  return u * v.transpose();
}
Eigen::Matrix2d nearest_rotation(const Eigen::Matrix2d& m) {
  const double angle = std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
  return Eigen::Rotation2Dd(angle).toRotationMatrix();
}

template <class P>
Result<std::vector<P>> chordal_poses(const BasicPoseGraph<P>& graph,
                                     const std::vector<double>& edge_weights) {
  const GraphStructure structure =
      structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  return chordal_start(graph, edge_weights, structure, analyze(structure.pattern))
      .map([](ChordalStart<P>&& start) { return std::move(start.poses); });
}

template <class P>
Result<ChordalStart<P>> chordal_start(const BasicPoseGraph<P>& graph, const std::vector<double>& edge_weights,
                                      const GraphStructure& structure,
                                      const std::shared_ptr<const BlockSymbolic>& symbolic) {
  constexpr int D = kDim<P>;
  const auto weight = [&](std::size_t e) { return edge_weights.empty() ? 1.0 : edge_weights[e]; };

  // R_to = R_from Z, transposed so that the unknowns stand on the right: R_to^T = Z^T R_from^T.
  std::vector<Rotation<P>> x;
  for (const auto& node : graph.nodes) x.push_back(node.pose.rotation_matrix().transpose());
  const auto rotation_model = [&](std::size_t e) -> EdgeModel<D, D> {
    const auto& edge = graph.edges[e];
    return {edge.T_from_to.rotation_matrix().transpose(), Rotation<P>::Zero(),
            weight(e) * rotation_weight<P>(edge) * Rotation<P>::Identity()};
  };
  auto transposed = solve_linear<P, D, D>(graph, structure, symbolic, std::move(x), rotation_model);
  if (!transposed) return tl::unexpected(transposed.error());
  std::vector<Rotation<P>>& rotations = transposed->x;
  parallel_for_each(
      rotations.size(),
      [&](std::size_t i) { rotations[i] = nearest_rotation(Rotation<P>(rotations[i].transpose())); },
      kNodesPerPart);

  // t_to = t_from + R_from t_Z, with the mean weight of all directions: then all coordinates share one matrix
  // of numbers.
  std::vector<Eigen::Matrix<double, 1, D>> t;
  for (const auto& node : graph.nodes) t.push_back(node.pose.translation().transpose());
  const auto translation_model = [&](std::size_t e) -> EdgeModel<1, D> {
    const auto& edge = graph.edges[e];
    const double mean = edge.information.template topLeftCorner<D, D>().trace() / D;
    return {Scalar::Ones(), (rotations[edge.from] * edge.T_from_to.translation()).transpose(),
            Scalar::Constant(weight(e) * mean)};
  };
  const auto translations =
      solve_linear<P, 1, D>(graph, structure, symbolic, std::move(t), translation_model);
  if (!translations) return tl::unexpected(translations.error());
  ChordalStart<P> start{poses_of(graph), translations->least_pivot};
  for (const std::size_t node : structure.node_of_variable) {
    start.poses[node] = pose_of(rotations[node], Point<P>(translations->x[node].transpose()));
  }
  return start;
}

template Result<ChordalStart<Pose>> chordal_start(const PoseGraph&, const std::vector<double>&,
                                                  const GraphStructure&,
                                                  const std::shared_ptr<const BlockSymbolic>&);
template Result<ChordalStart<Pose2>> chordal_start(const PoseGraph2&, const std::vector<double>&,
                                                   const GraphStructure&,
                                                   const std::shared_ptr<const BlockSymbolic>&);
template Result<std::vector<Pose>> chordal_poses(const PoseGraph&, const std::vector<double>&);
template Result<std::vector<Pose2>> chordal_poses(const PoseGraph2&, const std::vector<double>&);

}  // namespace adit
