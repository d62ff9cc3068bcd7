// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/certificate_matrix.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/lifted_descent.hpp"

namespace adit {
namespace {

constexpr std::size_t kEdgesAtOnce = 256;     // edges that one thread takes at a time
constexpr double kRoundingChi2 = 1e-16;       // chi2 per edge that is rounding
constexpr double kLargestRotationStep = 8.0;  // |R - R'|^2 of two rotations, at most
constexpr int kLanczosSteps = 4;
constexpr double kLowerBy = 1e-6;  // of the cost: less does not make another minimum

// The bound where S is indefinite, from the smallest shift that makes it definite.
void bound_by_shift(ShiftedMatrix& S, const CertificateMatrix& matrix, double num_nodes, Certificate& c) {
  std::optional<double> shift = S.factorize_with_least_shift();
  c.smallest_eigenvalue = -std::numeric_limits<double>::infinity();
  if (!shift) return;
  c.smallest_eigenvalue = S.softest_mode(*shift, 2 * kLanczosSteps).eigenvalue;
  const double decrement = (matrix.residual.array() * S.solve(matrix.residual).array()).sum();
  c.lower_bound = c.cost - matrix.slack - decrement - kLargestRotationStep * *shift * num_nodes;
}

}  // namespace

std::string_view to_string(Optimality optimality) {
  switch (optimality) {
    case Optimality::globally_optimal:
      return "globally optimal";
    case Optimality::cannot_tell:
      return "cannot tell";
    case Optimality::not_optimal:
      return "not optimal";
  }
  return "unknown";
}

template <class P>
Certificate certify(const BasicPoseGraph<P>& graph, const std::vector<P>& poses,
                    const CertificateConfig& config, const std::vector<double>& edge_weights) {
  graph.check();
  ADIT_CHECK(poses.size() == graph.nodes.size(), "one pose per node");
  ADIT_CHECK(edge_weights.empty() || edge_weights.size() == graph.edges.size(),
             "one weight per edge, or none");
  Certificate c;
  const GraphStructure structure =
      structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  std::vector<EdgeMinorant<P>> minorants(structure.active_edges.size());
  std::vector<double> costs(minorants.size());
  parallel_for_each(
      minorants.size(),
      [&](std::size_t a) {
        const std::size_t e = structure.active_edges[a];
        const auto& edge = graph.edges[e];
        const double w = edge_weights.empty() ? 1.0 : edge_weights[e];
        const typename P::Tangent y = between_residual(edge.T_from_to, poses[edge.from], poses[edge.to]);
        costs[a] = w * y.dot(edge.information * y);
        const EdgeMinorant<P> m = minorant_at<P>(edge, y);
        minorants[a] = {w * m.stiffness, w * m.lever, w * m.turn, w * m.slack};
      },
      kEdgesAtOnce);
  for (const double cost : costs) c.cost += cost;
  if (structure.pattern.size() == 0) {
    c.optimality = Optimality::globally_optimal;
    c.lower_bound = c.cost;
    c.reason = "no node is free to move";
    return c;
  }
  const CertificateMatrix matrix = certificate_matrix(graph, structure, poses, minorants);
  ShiftedMatrix S(matrix.values, structure.pattern, analyze(structure.pattern), kBlockOf<P>);
  if (const auto failed = S.factorize(0.0)) {
    c.reason = format("the certificate matrix is not positive definite, as seen at node {}",
                      graph.nodes[structure.node_of_variable[*failed]].key);
    bound_by_shift(S, matrix, static_cast<double>(structure.pattern.size()), c);
  } else {
    c.smallest_eigenvalue = S.softest_mode(0.0, kLanczosSteps).eigenvalue;
    c.lower_bound =
        c.cost - matrix.slack - (matrix.residual.array() * S.solve(matrix.residual).array()).sum();
  }
  c.lower_bound = std::clamp(c.lower_bound, 0.0, c.cost);
  const double rounding = kRoundingChi2 * static_cast<double>(graph.edges.size());
  c.gap = c.cost <= rounding ? 0.0 : (c.cost - c.lower_bound) / c.cost;
  if (c.gap <= config.max_gap) {
    c.optimality = Optimality::globally_optimal;
    c.reason = format("no poses cost less than {:.6f}", c.lower_bound);
  } else if (c.reason.empty()) {
    c.reason = format("the lower bound, {:.6f}, is further off than {}", c.lower_bound, config.max_gap);
  }
  return c;
}

template <class P>
Certified<P> certified(const BasicPoseGraph<P>& graph, Solution<P> solution,
                       const CertificateConfig& config) {
  const Certificate c = certify(graph, solution.poses, config, solution.edge_weights);
  return {std::move(solution), c, c.optimality, 0};
}

template <class P>
Certified<P> improved(const BasicPoseGraph<P>& graph, Certified<P> out, const OptimizerConfig& optimizer,
                      const CertificateConfig& config) {
  OptimizerConfig from_given = optimizer;
  from_given.initialization = SolveStart::given;
  for (int i = 0; i < config.max_descents; ++i) {
    if (out.certificate.optimality == Optimality::globally_optimal) break;
    auto poses = lifted_descent(graph, out.solution.poses, out.solution.edge_weights);
    if (!poses) break;
    BasicPoseGraph<P> start = graph;
    for (std::size_t n = 0; n < poses->size(); ++n) start.nodes[n].pose = (*poses)[n];
    Solution<P> next = optimize(start, from_given, out.solution.edge_weights);
    if (!next.ok() || !(next.cost_final < (1.0 - kLowerBy) * out.solution.cost_final)) break;
    out.solution.poses = std::move(next.poses);
    out.solution.cost_final = next.cost_final;
    out.solution.iterations += next.iterations;
    out.solution.status = next.status;
    out.certificate = certify(graph, out.solution.poses, config, out.solution.edge_weights);
    out.given = Optimality::not_optimal;
    ++out.descents;
  }
  return out;
}

template Certified<Pose> certified(const PoseGraph&, Solution<Pose>, const CertificateConfig&);
template Certified<Pose2> certified(const PoseGraph2&, Solution<Pose2>, const CertificateConfig&);
template Certified<Pose> improved(const PoseGraph&, Certified<Pose>, const OptimizerConfig&,
                                  const CertificateConfig&);
template Certified<Pose2> improved(const PoseGraph2&, Certified<Pose2>, const OptimizerConfig&,
                                   const CertificateConfig&);
template Certificate certify(const PoseGraph&, const std::vector<Pose>&, const CertificateConfig&,
                             const std::vector<double>&);
template Certificate certify(const PoseGraph2&, const std::vector<Pose2>&, const CertificateConfig&,
                             const std::vector<double>&);

}  // namespace adit
