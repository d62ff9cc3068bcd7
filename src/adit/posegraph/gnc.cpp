// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/gnc.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

// Regularized lower incomplete gamma function P(a, x) by its power series; a chi-square of k degrees of
// freedom has the distribution P(k/2, x/2).
double lower_gamma(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

// Prop. 4 of the paper: closed-form weight of a residual's chi2 at this mu.
double truncated_weight(double chi2, double bound, double mu) {
  if (chi2 <= mu / (mu + 1.0) * bound) return 1.0;
  if (chi2 >= (mu + 1.0) / mu * bound) return 0.0;
  return std::clamp(std::sqrt(bound * mu * (mu + 1.0) / chi2) - mu, 0.0, 1.0);
}

template <class P>
double largest_loop_cost(const BasicPoseGraph<P>& graph, const std::vector<double>& costs) {
  double largest = 0.0;
  for (std::size_t e = 0; e < costs.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) largest = std::max(largest, costs[e]);
  }
  return largest;
}

template <class P>
std::vector<double> weights_at(const BasicPoseGraph<P>& graph, const std::vector<double>& costs, double bound,
                               double mu) {
  std::vector<double> weights(costs.size(), 1.0);
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) weights[e] = truncated_weight(costs[e], bound, mu);
  }
  return weights;
}

bool all_binary(const std::vector<double>& weights) {
  return std::ranges::all_of(weights, [](double w) { return w < 1e-4 || w > 1.0 - 1e-4; });
}

template <class P>
void put_poses(BasicPoseGraph<P>& graph, const std::vector<P>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) graph.nodes[i].pose = poses[i];
}

std::size_t num_rejected(const std::vector<double>& weights) {
  return static_cast<std::size_t>(std::ranges::count_if(weights, [](double w) { return w < 0.5; }));
}

// Known inliers have weight 1 whatever the caller said.
template <class P>
std::vector<double> start_weights(const BasicPoseGraph<P>& graph, std::vector<double> weights) {
  if (weights.empty()) weights.assign(graph.edges.size(), 1.0);
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::odometry) weights[e] = 1.0;
  }
  return weights;
}

}  // namespace

double chi2_quantile(double probability, int dof) {
  ADIT_CHECK(probability > 0.0 && probability < 1.0 && dof > 0,
             "a probability inside (0, 1) and positive dof");
  double low = 0.0;
  double high = static_cast<double>(dof);
  while (lower_gamma(0.5 * dof, 0.5 * high) < probability) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (lower_gamma(0.5 * dof, 0.5 * middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <class P>
Solution<P> optimize_gnc(const BasicPoseGraph<P>& graph, const GncConfig& config,
                         const std::vector<double>& initial_weights) {
  ADIT_CHECK(initial_weights.empty() || initial_weights.size() == graph.edges.size(),
             "one weight an edge, or none");
  const double bound = chi2_quantile(config.inlier_probability, P::kDof);
  BasicPoseGraph<P> moving = graph;  // carries the poses from one outer iteration to the next
  std::vector<double> weights = start_weights(graph, initial_weights);
  Solution<P> first = optimize(moving, config.optimizer, weights);
  if (!first.ok()) return first;
  const double cost_initial = first.cost_initial;
  int iterations = first.iterations;
  put_poses(moving, first.poses);
  std::vector<double> costs = edge_costs(moving, first.poses);
  const double largest = largest_loop_cost(graph, costs);

  // Remark 5: the smallest mu at which the surrogate is still convex for the largest residual.
  double mu = largest > bound ? std::max(1e-6, bound / (2.0 * largest - bound)) : 1e6;
  OptimizerConfig inner = config.optimizer;
  inner.initialization = "none";
  inner.relative_tolerance = std::max(inner.relative_tolerance, 1e-3);
  inner.max_iterations = std::min(inner.max_iterations, 5);
  for (int outer = 0; outer < config.max_outer_iterations; ++outer, mu *= config.mu_step) {
    weights = weights_at(graph, costs, bound, mu);
    if (mu > 1e3 || (outer > 0 && all_binary(weights))) break;
    const Solution<P> step = optimize(moving, inner, weights);
    iterations += step.iterations;
    if (!step.ok()) return step;
    put_poses(moving, step.poses);
    costs = edge_costs(moving, step.poses);
  }
  for (double& weight : weights) weight = weight < 0.5 ? 0.0 : 1.0;
  inner = config.optimizer;
  inner.initialization = "none";
  Solution<P> last = optimize(moving, inner, weights);
  last.iterations += iterations;
  last.cost_initial = cost_initial;
  last.notes.insert(last.notes.begin(), first.notes.begin(), first.notes.end());
  const std::size_t rejected = num_rejected(weights);
  if (rejected > 0) last.notes.push_back(format("{} loops rejected", rejected));
  return last;
}

template Solution<Pose> optimize_gnc(const PoseGraph&, const GncConfig&, const std::vector<double>&);
template Solution<Pose2> optimize_gnc(const PoseGraph2&, const GncConfig&, const std::vector<double>&);

}  // namespace adit
