// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The parts of which `optimize_gnc` is made; for gnc.cpp and loop_trials.hpp only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "adit/core/progress.hpp"
#include "adit/core/robust_kernel.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/loop_evidence.hpp"

namespace adit {

// The control parameter mu of Yang et al.; no unit.
/// Of the control parameter mu of Yang et al., which has no unit: below, loops weigh too little to constrain
/// anything in double precision.
inline constexpr double kSmallestMu = 1e-6;
inline constexpr double kLargestMu = 1e3;  ///< Above, the surrogate is the truncated cost itself.
/// Of a graduation from a good solution: reaches loops within 100 bounds.
inline constexpr double kFirstMu = 0.01;

inline constexpr int kMaxRounds = 20;   ///< Of settling; most graphs need a few.
inline constexpr int kMaxRestarts = 2;  ///< Of the search from the best poses so far.

// Groups of rejected loops that are reconsidered: loops of one cluster whose ends are near one another.
inline constexpr std::size_t kSmallestGroup = 3;  ///< Loops; smaller ones are not reconsidered.
inline constexpr std::size_t kGroupReach = 12;    ///< Ends are near if their indices differ by no more.
inline constexpr std::size_t kMaxParts = 8;       ///< Groups, where only parts of clusters are reconsidered.
inline constexpr std::size_t kMaxGroups = 24;     ///< Groups, where all clusters are; the largest ones.

/// An odometry edge whose chi2 is this many bounds, twice as many standard deviations, is bent.
inline constexpr double kBentBounds = 4.0;
/// A cluster with this share of the loops of the largest one counts as evidence of its own; a solution that
/// rejects no cluster this large is accepted.
inline constexpr double kRivalShare = 0.2;
inline constexpr std::size_t kDecisiveCluster = 12;  ///< Loops; in a smaller cluster all may be one mistake.

// Where loops fit better than their information says, the bound shrinks.
inline constexpr double kVarianceHeadroom = 4.0;  ///< So many times the variance of kept loops still passes.
/// Of the kept loops' chi2, compared with that of the chi-square distribution.
inline constexpr double kFitQuantile = 0.9;
inline constexpr double kBoundRelease = 30.0;  ///< Times the fitted bound, when it is widened once.

/// Parts of clusters that are kept for the most part, or whole clusters too.
enum class Reconsidered { parts, all };

/// Edges with a weight below one half.
template <class P>
[[nodiscard]] std::size_t num_rejected(const Solution<P>& s) {
  return static_cast<std::size_t>(std::ranges::count_if(s.edge_weights, [](double w) { return w < 0.5; }));
}

/// Loops' weights by their chi2; odometry edges are known inliers, of weight 1. `costs`: chi2 of each edge.
template <class P, class WeightOfChi2>
std::vector<double> weights_of(const BasicPoseGraph<P>& graph, const std::vector<double>& costs,
                               const WeightOfChi2& weight) {
  std::vector<double> weights(costs.size(), 1.0);
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) weights[e] = weight(costs[e]);
  }
  return weights;
}

/// 0 without loops. `costs`: chi2 of each edge.
template <class P>
double largest_loop_cost(const BasicPoseGraph<P>& graph, const std::vector<double>& costs) {
  double largest = 0.0;
  for (std::size_t e = 0; e < costs.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) largest = std::max(largest, costs[e]);
  }
  return largest;
}

/// Remark 5: the smallest mu at which the surrogate is still convex for the largest residual.
inline double first_mu(double largest_chi2, double bound) {
  return largest_chi2 > bound ? std::max(kSmallestMu, bound / (2.0 * largest_chi2 - bound)) : kLargestMu;
}

/// Whether all are exactly 0 or 1: a larger mu then changes nothing. At a small mu true loops weigh little.
inline bool all_binary(const std::vector<double>& weights) {
  return std::ranges::all_of(weights, [](double w) { return w == 0.0 || w == 1.0; });
}

/// The graph with its nodes at `poses`, one per node.
template <class P>
BasicPoseGraph<P> moved(BasicPoseGraph<P> graph, const std::vector<P>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) graph.nodes[i].pose = poses[i];
  return graph;
}

/// The search: graph and settings stay, solutions go through.
template <class P>
class GncSearch {
 public:
  /// Loops with a chi2 above `bound` count as false. Graph and settings must outlive the search.
  GncSearch(const BasicPoseGraph<P>& graph, const GncConfig& config, double bound)
      : graph_(graph), config_(config), bound_(bound) {}

  /// Takes this bound instead of the one fitted.
  void restore_bound(double bound) { bound_ = bound; }

  /// As the configuration states it.
  [[nodiscard]] double given_bound() const { return chi2_quantile(config_.inlier_probability, P::kDof); }

  /// Graduated non-convexity from the poses of `s`, from the convex surrogate on or from `mu` if that is
  /// larger.
  [[nodiscard]] Solution<P> graduate(Solution<P> s, double mu = 0.0) const {
    OptimizerConfig inner = warm();
    inner.relative_tolerance = std::max(inner.relative_tolerance, 1e-3);
    inner.max_iterations = std::min(inner.max_iterations, 5);
    std::vector<double> costs = edge_costs(graph_, s.poses);
    mu = std::max(mu, first_mu(largest_loop_cost(graph_, costs), bound_));
    const Phase phase("graduated search", steps_from(mu));
    for (int outer = 0; s.ok() && outer < config_.max_outer_iterations; ++outer, mu *= config_.mu_step) {
      const auto weights =
          weights_of(graph_, costs, [&](double chi2) { return tls_weight(chi2, bound_, mu); });
      if (mu >= kLargestMu || all_binary(weights)) break;
      s = continued(s, s.poses, inner, weights);
      costs = edge_costs(graph_, s.poses);
      phase.advance();
    }
    return s;
  }

  /// A graduated search from the poses of `start`, with the loops chosen anew at its end.
  [[nodiscard]] Solution<P> run(Solution<P> start) const {
    if (!start.ok()) return start;
    return settle(unbend(graduate(std::move(start))));
  }

  /// The paper's search and nothing else.
  [[nodiscard]] Solution<P> run_plain(Solution<P> start) const {
    if (!start.ok()) return start;
    const Solution<P> s = graduate(std::move(start));
    return s.ok() ? continued(s, s.poses, warm(), loops_within_bound(s.poses)) : s;
  }

  /// Least squares over the loops that confirm one another, those of the largest clusters. It never meets
  /// most false loops, which is also what keeps the matrix sparse.
  [[nodiscard]] Solution<P> from(const LoopClusters& clusters) const {
    const double rival = kRivalShare * static_cast<double>(largest_of(clusters));
    std::vector<double> weights(graph_.edges.size(), 1.0);
    for (std::size_t e = 0; e < weights.size(); ++e) {
      const std::size_t cluster = clusters.of_edge[e];
      if (cluster != LoopClusters::kNone && static_cast<double>(clusters.sizes[cluster]) < rival)
        weights[e] = 0.0;
    }
    return optimize(graph_, config_.optimizer, weights);
  }

  /// Lowers the bound to what the loops in use call for: a high quantile of their chi2 against that of true
  /// noise, but not below what all that is in use says together. False when it stays as it is.
  bool fit_bound(const Solution<P>& s) {
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    std::vector<double> kept;
    for (std::size_t e = 0; e < costs.size(); ++e) {
      if (graph_.edges[e].kind == EdgeKind::loop && s.edge_weights[e] > 0.5) kept.push_back(costs[e]);
    }
    if (kept.empty()) return false;
    const auto middle =
        kept.begin() + static_cast<std::ptrdiff_t>(kFitQuantile * static_cast<double>(kept.size()));
    std::nth_element(kept.begin(), middle, kept.end());
    const double fit = *middle / chi2_quantile(kFitQuantile, P::kDof);
    const double share = std::max(kVarianceHeadroom * fit, largest_variance(graph_, s, costs));
    bound_ *= std::min(share, 1.0);
    return share < 1.0;
  }

  /// From a solution that holds few loops, but true ones, to all true ones. The bound follows their fit, is
  /// let out once for loops that drift has kept away, and drawn in again; where it is right as given,
  /// gradually.
  [[nodiscard]] Solution<P> grow(Solution<P> s) {
    const double given = bound_;
    if (!s.ok()) return s;
    if (!fit_bound(s)) return settle(graduate(settle(std::move(s)), kFirstMu));
    s = settle(std::move(s));
    bound_ = std::min(given, kBoundRelease * bound_);
    s = settle(std::move(s));
    bound_ = given;
    if (s.ok()) fit_bound(s);
    return settle(std::move(s));
  }

  /// Whether the loops that `s` turns down are many times fewer, cluster by cluster, than a cluster that it
  /// keeps.
  [[nodiscard]] bool rejects_only_small(const Solution<P>& s, const LoopClusters& clusters) const {
    std::vector<std::size_t> rejected(clusters.sizes.size(), 0);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      if (clusters.of_edge[e] != LoopClusters::kNone && s.edge_weights[e] < 0.5)
        ++rejected[clusters.of_edge[e]];
    }
    std::size_t largest_rejected = 0;
    std::size_t largest_kept = 0;
    for (std::size_t c = 0; c < rejected.size(); ++c) {
      largest_rejected = std::max(largest_rejected, rejected[c]);
      largest_kept = std::max(largest_kept, clusters.sizes[c] - rejected[c]);
    }
    return largest_kept >= kDecisiveCluster &&
           static_cast<double>(largest_rejected) < kRivalShare * static_cast<double>(largest_kept);
  }

  /// Loops that hold only together are lost together: where a stretch has bent, each of them alone seems
  /// false. With a whole group back in use the stretch straightens, if the group is true; the evidence
  /// decides. Where whole clusters are in doubt, those in use are taken out in the same way.
  [[nodiscard]] Solution<P> reconsider(Solution<P> s, const LoopEvidence<P>& evidence,
                                       Reconsidered which) const {
    const auto rejected = rejected_groups(s, evidence.clusters(), which);
    s = improved_by(std::move(s), rejected, 1.0, evidence);
    if (which == Reconsidered::parts || !s.ok()) return s;
    const auto kept = kept_clusters(s, evidence.clusters());
    s = improved_by(std::move(s), kept, 0.0, evidence);
    return s;
  }

  /// Alternates between the poses for these loops and the loops for these poses; both lower the objective, so
  /// that it ends. True loops that were lost on the way come back. The loops `barred` stay out.
  [[nodiscard]] Solution<P> settle(Solution<P> s, const std::vector<std::size_t>& barred = {}) const {
    for (int round = 0; s.ok() && round < kMaxRounds; ++round) {
      auto weights = loops_within_bound(s.poses);
      for (const std::size_t e : barred) weights[e] = 0.0;
      if (round > 0 && weights == s.edge_weights) break;
      s = continued(s, s.poses, warm(), weights);
    }
    return s;
  }

  /// A chain that false loops have bent beyond what the solver straightens is found anew.
  [[nodiscard]] Solution<P> unbend(const Solution<P>& s) const {
    if (!s.ok()) return s;
    const auto weights = loops_within_bound(s.poses);
    Solution<P> next = continued(s, s.poses, warm(), weights);
    Solution<P> anew = continued(next, poses_of(graph_), config_.optimizer, weights);
    next.iterations = anew.iterations;
    return anew.ok() && anew.cost_final < next.cost_final ? anew : next;
  }

  /// Least squares with these weights, from the poses of `s`.
  [[nodiscard]] Solution<P> with_weights(const Solution<P>& s, const std::vector<double>& weights) const {
    return continued(s, s.poses, warm(), weights);
  }

  /// The truncated least-squares objective: chi2 of all edges, of a loop at most the bound.
  [[nodiscard]] double objective(const Solution<P>& s) const {
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    double sum = 0.0;
    for (std::size_t e = 0; e < costs.size(); ++e) {
      sum += graph_.edges[e].kind == EdgeKind::loop ? std::min(costs[e], bound_) : costs[e];
    }
    return sum;
  }

  /// No odometry edge is off by more than twice the bound's standard deviations, and no part of the graph
  /// came loose.
  [[nodiscard]] bool is_whole_and_unbent(const Solution<P>& s) const {
    if (s.status != SolveStatus::converged) return false;
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    for (std::size_t e = 0; e < costs.size(); ++e)
      if (graph_.edges[e].kind == EdgeKind::odometry && costs[e] > kBentBounds * bound_) return false;
    return connected_components(graph_, s.edge_weights).anchors.size() ==
           connected_components(graph_).anchors.size();
  }

  /// Nothing hints at a better explanation: at most one loop in ten was rejected or only small clusters were,
  /// and neither is odometry bent nor the graph in parts.
  [[nodiscard]] bool is_clearly_fine(const Solution<P>& s, const LoopClusters& clusters) const {
    if (!is_whole_and_unbent(s)) return false;
    const auto num_loops = static_cast<std::size_t>(
        std::ranges::count_if(graph_.edges, [](const auto& edge) { return edge.kind == EdgeKind::loop; }));
    return 10 * num_rejected(s) <= num_loops || rejects_only_small(s, clusters);
  }

 private:
  // Settings of a solve that starts from poses already found.
  [[nodiscard]] OptimizerConfig warm() const {
    OptimizerConfig config = config_.optimizer;
    config.initialization = SolveStart::given;
    return config;
  }

  [[nodiscard]] std::vector<double> loops_within_bound(const std::vector<P>& poses) const {
    return weights_of(graph_, edge_costs(graph_, poses),
                      [&](double chi2) { return chi2 <= bound_ ? 1.0 : 0.0; });
  }

  // The largest number of steps of a graduation from `mu` on.
  [[nodiscard]] std::size_t steps_from(double mu) const {
    const double steps = std::ceil(std::log(kLargestMu / mu) / std::log(config_.mu_step));
    return static_cast<std::size_t>(
        std::clamp(steps, 1.0, static_cast<double>(config_.max_outer_iterations)));
  }

  [[nodiscard]] static std::size_t largest_of(const LoopClusters& clusters) {
    return clusters.sizes.empty() ? 0 : *std::ranges::max_element(clusters.sizes);
  }

  // Gives each of the groups this weight in turn, and keeps what the evidence prefers.
  [[nodiscard]] Solution<P> improved_by(Solution<P> s, const std::vector<std::vector<std::size_t>>& groups,
                                        double weight, const LoopEvidence<P>& evidence) const {
    if (groups.empty()) return s;
    const Phase phase("reconsidering loops", groups.size());
    for (const std::vector<std::size_t>& group : groups) {
      std::vector<double> weights = s.edge_weights;
      for (const std::size_t e : group) weights[e] = weight;
      Solution<P> other = continued(s, s.poses, warm(), weights);
      if (other.ok()) other = settle(graduate(std::move(other), kFirstMu));
      const int iterations = other.iterations;
      if (other.ok() && evidence.cost(other) < evidence.cost(s)) s = std::move(other);
      s.iterations = iterations;
      phase.advance();
    }
    return s;
  }

  // What of each cluster is in use; the largest first.
  [[nodiscard]] std::vector<std::vector<std::size_t>> kept_clusters(const Solution<P>& s,
                                                                    const LoopClusters& clusters) const {
    std::vector<std::vector<std::size_t>> kept(clusters.sizes.size());
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (clusters.of_edge[e] != LoopClusters::kNone && s.edge_weights[e] > 0.5)
        kept[clusters.of_edge[e]].push_back(e);
    return largest(std::move(kept), kMaxGroups);
  }

  [[nodiscard]] static std::vector<std::vector<std::size_t>> largest(
      std::vector<std::vector<std::size_t>> groups, std::size_t number) {
    std::erase_if(groups, [](const auto& group) { return group.size() < kSmallestGroup; });
    std::ranges::stable_sort(groups, std::ranges::greater(), &std::vector<std::size_t>::size);
    groups.resize(std::min(groups.size(), number));
    return groups;
  }

  // The largest group first.
  [[nodiscard]] std::vector<std::vector<std::size_t>> rejected_groups(const Solution<P>& s,
                                                                      const LoopClusters& clusters,
                                                                      Reconsidered which) const {
    std::vector<std::size_t> kept(clusters.sizes.size(), 0);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (clusters.of_edge[e] != LoopClusters::kNone && s.edge_weights[e] > 0.5) ++kept[clusters.of_edge[e]];
    std::vector<std::size_t> rest;
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const std::size_t cluster = clusters.of_edge[e];
      if (cluster == LoopClusters::kNone || s.edge_weights[e] > 0.5) continue;
      if (which == Reconsidered::all || 2 * kept[cluster] > clusters.sizes[cluster]) rest.push_back(e);
    }
    const auto near = [](std::size_t a, std::size_t b) { return (a < b ? b - a : a - b) <= kGroupReach; };
    const auto together = [&](std::size_t e, std::size_t f) {
      const auto& a = graph_.edges[e];
      const auto& b = graph_.edges[f];
      return clusters.of_edge[e] == clusters.of_edge[f] &&
             ((near(a.from, b.from) && near(a.to, b.to)) || (near(a.from, b.to) && near(a.to, b.from)));
    };
    std::vector<std::vector<std::size_t>> groups;
    while (!rest.empty()) {
      std::vector<std::size_t> group = {rest.front()};
      rest.erase(rest.begin());
      for (std::size_t k = 0; k < group.size(); ++k) {
        const auto joins = std::stable_partition(rest.begin(), rest.end(),
                                                 [&](std::size_t e) { return !together(group[k], e); });
        group.insert(group.end(), joins, rest.end());
        rest.erase(joins, rest.end());
      }
      groups.push_back(std::move(group));
    }
    return largest(std::move(groups), which == Reconsidered::all ? kMaxGroups : kMaxParts);
  }

  // One more solve, counted on top of those before.
  [[nodiscard]] Solution<P> continued(const Solution<P>& before, const std::vector<P>& start,
                                      const OptimizerConfig& config,
                                      const std::vector<double>& weights) const {
    Solution<P> s = optimize(moved(graph_, start), config, weights);
    s.iterations += before.iterations;
    return s;
  }

  const BasicPoseGraph<P>& graph_;
  const GncConfig& config_;
  double bound_;
};

}  // namespace adit
