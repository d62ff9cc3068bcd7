// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/chordal.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <string>

#include "adit/posegraph/normal_equations.hpp"

namespace adit {
namespace {

template <class P>
constexpr int kDim = P::kDof == 6 ? 3 : 2;
template <class P>
using Rotation = Eigen::Matrix<double, kDim<P>, kDim<P>>;
template <class P>
using Point = Eigen::Matrix<double, kDim<P>, 1>;

Matrix3 nearest_rotation(const Matrix3& m) {
  const Eigen::JacobiSVD<Matrix3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  return U * svd.matrixV().transpose();
}
Eigen::Matrix2d nearest_rotation(const Eigen::Matrix2d& m) {
  const double angle = std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
  return Eigen::Rotation2Dd(angle).toRotationMatrix();
}

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
// kDim rows. Each fills in M, b and W of an edge; anchors' values move to the right side.
template <class P, class EdgeModel>
Result<std::vector<Eigen::MatrixXd>> solve_linear(const BasicPoseGraph<P>& graph,
                                                  const GraphStructure& structure,
                                                  const std::shared_ptr<const BlockSymbolic>& symbolic,
                                                  std::vector<Eigen::MatrixXd> x, const EdgeModel& model) {
  constexpr int D = kDim<P>;
  const Eigen::Index sides = x.front().cols();
  std::vector<EdgeTerms<D>> terms(structure.active_edges.size());
  Eigen::MatrixXd right(static_cast<Eigen::Index>(structure.node_of_variable.size()) * D, sides);
  right.setZero();
  for (std::size_t a = 0; a < terms.size(); ++a) {
    const std::size_t e = structure.active_edges[a];
    const auto& edge = graph.edges[e];
    const auto [M, b, W] = model(e);
    const Rotation<P> WM = W * M;
    terms[a].from_from = M.transpose() * WM;
    terms[a].to_to = W;
    terms[a].from_to = -WM.transpose();
    const std::size_t from = structure.variable_of_node[edge.from];
    const std::size_t to = structure.variable_of_node[edge.to];
    const auto at = [&](std::size_t v) { return right.middleRows(static_cast<Eigen::Index>(v) * D, D); };
    if (from == GraphStructure::kFixed) {
      at(to) += W * (b + M * x[edge.from]);
    } else if (to == GraphStructure::kFixed) {
      at(from) += WM.transpose() * (x[edge.to] - b);
    } else {
      at(to) += W * b;
      at(from) -= WM.transpose() * b;
    }
  }
  BlockCholesky cholesky(symbolic, D);
  if (const auto variable = cholesky.factorize(sum_terms<D>(structure, terms))) {
    const std::size_t node = structure.node_of_variable[*variable];
    return fail("the edges leave node " + std::to_string(graph.nodes[node].key) + " free to move");
  }
  const Eigen::MatrixXd solution = cholesky.solve(right);
  for (std::size_t v = 0; v < structure.node_of_variable.size(); ++v) {
    x[structure.node_of_variable[v]] = solution.middleRows(static_cast<Eigen::Index>(v) * D, D);
  }
  return x;
}

}  // namespace

template <class P>
Result<std::vector<P>> chordal_poses(const BasicPoseGraph<P>& graph,
                                     const std::vector<double>& edge_weights) {
  constexpr int D = kDim<P>;
  if (graph.nodes.empty()) return std::vector<P>{};
  const GraphStructure structure =
      structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  const auto symbolic = analyze(structure.pattern);
  const auto weight = [&](std::size_t e) { return edge_weights.empty() ? 1.0 : edge_weights[e]; };
  struct Model {
    Rotation<P> M;
    Eigen::MatrixXd b;
    Rotation<P> W;
  };

  // R_to = R_from Z, transposed so that the unknowns stand on the right: R_to^T = Z^T R_from^T.
  std::vector<Eigen::MatrixXd> x;
  for (const auto& node : graph.nodes) x.push_back(node.pose.rotation_matrix().transpose());
  const auto rotation_model = [&](std::size_t e) -> Model {
    const auto& edge = graph.edges[e];
    return {edge.T_from_to.rotation_matrix().transpose(), Eigen::MatrixXd::Zero(D, D),
            weight(e) * rotation_weight<P>(edge) * Rotation<P>::Identity()};
  };
  auto transposed = solve_linear(graph, structure, symbolic, std::move(x), rotation_model);
  if (!transposed) return tl::unexpected(transposed.error());
  std::vector<Rotation<P>> rotations;
  for (const Eigen::MatrixXd& m : *transposed) {
    rotations.push_back(nearest_rotation(Rotation<P>(m.transpose())));
  }

  // t_to = t_from + R_from t_Z, in the metric of the residual: r_t = (R_from Z)^T (t_to - t_from - R_from
  // t_Z).
  x.clear();
  for (const auto& node : graph.nodes) x.emplace_back(node.pose.translation());
  const auto translation_model = [&](std::size_t e) -> Model {
    const auto& edge = graph.edges[e];
    const Rotation<P> R = rotations[edge.from] * edge.T_from_to.rotation_matrix();
    const Rotation<P> information = edge.information.template topLeftCorner<D, D>();
    return {Rotation<P>::Identity(), rotations[edge.from] * edge.T_from_to.translation(),
            weight(e) * R * information * R.transpose()};
  };
  const auto translations = solve_linear(graph, structure, symbolic, std::move(x), translation_model);
  if (!translations) return tl::unexpected(translations.error());
  std::vector<P> poses = poses_of(graph);
  for (const std::size_t node : structure.node_of_variable) {
    poses[node] = pose_of(rotations[node], Point<P>((*translations)[node]));
  }
  return poses;
}

template Result<std::vector<Pose>> chordal_poses(const PoseGraph&, const std::vector<double>&);
template Result<std::vector<Pose2>> chordal_poses(const PoseGraph2&, const std::vector<double>&);

}  // namespace adit
