// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/gnc.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/log_gamma.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/robust_kernel.hpp"
#include "adit/posegraph/loop_clusters.hpp"

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
  return sum * std::exp(a * std::log(x) - x - log_gamma(a));
}

// The control parameter mu of Yang et al.; no unit.
constexpr double kSmallestMu =
    1e-6;                           // below, loops weigh too little to constrain anything in double precision
constexpr double kLargestMu = 1e3;  // above, the surrogate is the truncated cost itself
constexpr double kFirstMu = 0.01;   // of a graduation from a good solution: reaches loops within 100 bounds

constexpr int kMaxRounds = 20;   // of settling; most graphs need a few
constexpr int kMaxRestarts = 2;  // of the search from the best poses so far

// Groups of rejected loops that are reconsidered: loops of one cluster whose ends are near one another.
constexpr std::size_t kSmallestGroup = 3;  // loops
constexpr std::size_t kGroupReach = 12;    // nodes between their ends, at most
constexpr std::size_t kMaxGroups = 8;

// An odometry edge whose chi2 is this many bounds, twice as many standard deviations, is bent.
constexpr double kBentBounds = 4.0;
// A cluster with this share of the loops of the largest one counts as evidence of its own; a solution that
// rejects no cluster this large is accepted.
constexpr double kRivalShare = 0.2;

// Where loops fit better than their information says, the bound shrinks.
constexpr double kVarianceHeadroom = 4.0;  // times the variance of the loops kept still passes
constexpr double kFitQuantile =
    0.9;  // of the kept loops' chi2, compared with that of the chi-square distribution
constexpr double kBoundRelease = 30.0;   // times the fitted bound, when it is widened once
constexpr double kSmallestBound = 1e-6;  // share of the given bound; less is rounding

template <class P>
std::size_t num_rejected(const Solution<P>& s) {
  return static_cast<std::size_t>(std::ranges::count_if(s.edge_weights, [](double w) { return w < 0.5; }));
}

// Loops' weights by their chi2; odometry edges are known inliers.
template <class P, class WeightOfChi2>
std::vector<double> weights_of(const BasicPoseGraph<P>& graph, const std::vector<double>& costs,
                               const WeightOfChi2& weight) {
  std::vector<double> weights(costs.size(), 1.0);
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) weights[e] = weight(costs[e]);
  }
  return weights;
}

template <class P>
double largest_loop_cost(const BasicPoseGraph<P>& graph, const std::vector<double>& costs) {
  double largest = 0.0;
  for (std::size_t e = 0; e < costs.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::loop) largest = std::max(largest, costs[e]);
  }
  return largest;
}

// Remark 5: the smallest mu at which the surrogate is still convex for the largest residual.
double first_mu(double largest_chi2, double bound) {
  return largest_chi2 > bound ? std::max(kSmallestMu, bound / (2.0 * largest_chi2 - bound)) : kLargestMu;
}

// Exactly: outside the band of mu, where a larger mu changes nothing. At a small mu true loops weigh little.
bool all_binary(const std::vector<double>& weights) {
  return std::ranges::all_of(weights, [](double w) { return w == 0.0 || w == 1.0; });
}

template <class P>
BasicPoseGraph<P> moved(BasicPoseGraph<P> graph, const std::vector<P>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) graph.nodes[i].pose = poses[i];
  return graph;
}

// The search: graph and settings stay, solutions go through.
template <class P>
class Search {
 public:
  Search(const BasicPoseGraph<P>& graph, const GncConfig& config)
      : graph_(graph), config_(config), bound_(chi2_quantile(config.inlier_probability, P::kDof)) {}

  // Graduated non-convexity from the poses of `s`, from the convex surrogate on or from `mu` if that is
  // larger.
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

  [[nodiscard]] Solution<P> run(Solution<P> start) const { return settle(graduate(std::move(start)), true); }

  // The paper's search and nothing else.
  [[nodiscard]] Solution<P> run_plain(Solution<P> start) const {
    if (!start.ok()) return start;
    const Solution<P> s = graduate(std::move(start));
    return s.ok() ? continued(s, s.poses, warm(), loops_within_bound(s.poses)) : s;
  }

  // From the loops that confirm one another: least squares over the largest clusters, then all loops that
  // this explains. It never meets most false loops, which is also what keeps the matrix sparse.
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

  // Lowers the bound to what the loops in use call for: a high quantile of their chi2 against that of true
  // noise.
  // False when it stays as it is.
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
    const double share = kVarianceHeadroom * *middle / chi2_quantile(kFitQuantile, P::kDof);
    bound_ *= std::clamp(share, kSmallestBound, 1.0);
    return share < 1.0;
  }

  // From a solution that holds few loops, but true ones, to all true ones. The bound follows their fit, is
  // let out once for loops that drift has kept away, and drawn in again; where it is right as given,
  // gradually.
  [[nodiscard]] Solution<P> grow(Solution<P> s) {
    const double given = bound_;
    if (!s.ok()) return s;
    if (!fit_bound(s)) return settle(graduate(settle(std::move(s), false), kFirstMu), false);
    s = settle(std::move(s), false);
    bound_ = std::min(given, kBoundRelease * bound_);
    s = settle(std::move(s), false);
    bound_ = given;
    if (s.ok()) fit_bound(s);
    return settle(std::move(s), false);
  }

  // Whether the loops that `s` turns down are many times fewer, cluster by cluster, than a cluster that it
  // keeps.
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
    return static_cast<double>(largest_rejected) < kRivalShare * static_cast<double>(largest_kept);
  }

  // Loops that hold only together are lost together: where a stretch has bent, each of them alone seems
  // false. With a whole group back in use the stretch straightens, if the group is true; the objective
  // decides.
  [[nodiscard]] Solution<P> reconsider(Solution<P> s, const LoopClusters& clusters) const {
    const auto groups = rejected_groups(s, clusters);
    if (groups.empty()) return s;
    const Phase phase("reconsidering loops", groups.size());
    for (const std::vector<std::size_t>& group : groups) {
      std::vector<double> weights = s.edge_weights;
      for (const std::size_t e : group) weights[e] = 1.0;
      Solution<P> other = continued(s, s.poses, warm(), weights);
      if (other.ok()) other = settle(graduate(std::move(other), kFirstMu), false);
      const int iterations = other.iterations;
      if (other.ok() && objective(other) < objective(s)) s = std::move(other);
      s.iterations = iterations;
      phase.advance();
    }
    return s;
  }

  // Alternates between the poses for these loops and the loops for these poses; both lower the objective, so
  // that it ends. True loops that were lost on the way come back.
  // With `unbend`, a chain that false loops have bent beyond what the solver straightens is found anew.
  [[nodiscard]] Solution<P> settle(Solution<P> s, bool unbend) const {
    for (int round = 0; s.ok() && round < kMaxRounds; ++round) {
      const auto weights = loops_within_bound(s.poses);
      if (round > 0 && weights == s.edge_weights) break;
      Solution<P> next = continued(s, s.poses, warm(), weights);
      if (round == 0 && unbend) {
        Solution<P> anew = continued(next, poses_of(graph_), config_.optimizer, weights);
        next.iterations = anew.iterations;
        if (anew.ok() && anew.cost_final < next.cost_final) next = std::move(anew);
      }
      s = std::move(next);
    }
    return s;
  }

  // The truncated least-squares objective.
  [[nodiscard]] double objective(const Solution<P>& s) const {
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    double sum = 0.0;
    for (std::size_t e = 0; e < costs.size(); ++e) {
      sum += graph_.edges[e].kind == EdgeKind::loop ? std::min(costs[e], bound_) : costs[e];
    }
    return sum;
  }

  // Nothing hints at a better explanation: no odometry edge is off by more than twice the bound's standard
  // deviations, at most one loop in ten was rejected or only small clusters were, and no part of the graph
  // came loose.
  [[nodiscard]] bool is_clearly_fine(const Solution<P>& s, const LoopClusters& clusters) const {
    if (s.status != SolveStatus::converged) return false;
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    std::size_t num_loops = 0;
    for (std::size_t e = 0; e < costs.size(); ++e) {
      if (graph_.edges[e].kind == EdgeKind::loop)
        ++num_loops;
      else if (costs[e] > kBentBounds * bound_)
        return false;
    }
    return (10 * num_rejected(s) <= num_loops || rejects_only_small(s, clusters)) &&
           connected_components(graph_, s.edge_weights).anchors.size() ==
               connected_components(graph_).anchors.size();
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

  // Of clusters that are kept for the most part; the largest group first.
  [[nodiscard]] std::vector<std::vector<std::size_t>> rejected_groups(const Solution<P>& s,
                                                                      const LoopClusters& clusters) const {
    std::vector<std::size_t> kept(clusters.sizes.size(), 0);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (clusters.of_edge[e] != LoopClusters::kNone && s.edge_weights[e] > 0.5) ++kept[clusters.of_edge[e]];
    std::vector<std::size_t> rest;
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const std::size_t cluster = clusters.of_edge[e];
      if (cluster != LoopClusters::kNone && 2 * kept[cluster] > clusters.sizes[cluster] &&
          s.edge_weights[e] < 0.5)
        rest.push_back(e);
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
      if (group.size() >= kSmallestGroup) groups.push_back(std::move(group));
    }
    std::ranges::stable_sort(groups, std::ranges::greater(), &std::vector<std::size_t>::size);
    groups.resize(std::min(groups.size(), kMaxGroups));
    return groups;
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

// From the clusters, and from other poses as long as the answer is not clearly fine; `given`: the graph's
// own.
template <class P>
Solution<P> best_of_all(const BasicPoseGraph<P>& graph, const GncConfig& config, const Solution<P>& given,
                        Search<P>& search) {
  // One step per start, most of which a clear answer makes needless, and one for the loops that are
  // reconsidered.
  const Phase phase("searching for false loops", 3 + kMaxRestarts + 1);
  const LoopClusters clusters = loop_clusters(graph);
  Solution<P> best = search.grow(search.from(clusters));
  phase.advance();
  const auto improve_from = [&](Solution<P> start) {
    Solution<P> other = start.ok() ? search.run(std::move(start)) : std::move(start);
    other.iterations += best.iterations;
    const bool better = other.ok() && (!best.ok() || search.objective(other) < search.objective(best));
    best.iterations = other.iterations;
    if (better) best = std::move(other);
    return better;
  };
  const auto is_fine = [&] { return search.is_clearly_fine(best, clusters); };
  if (!is_fine()) improve_from(given);
  phase.advance();
  if (!is_fine()) improve_from(optimize(graph, config.optimizer));
  phase.advance();
  // Loops that hold only together are found from where the others have brought the poses.
  for (int i = 0; i < kMaxRestarts && best.ok() && !is_fine(); ++i) {
    Solution<P> again = best;
    again.iterations = 0;
    if (!improve_from(std::move(again))) break;
    phase.advance();
  }
  if (best.ok()) best = search.reconsider(std::move(best), clusters);
  return best;
}

// The paper's search from the graph's own poses and from least squares with all loops.
template <class P>
Solution<P> best_of_plain(const BasicPoseGraph<P>& graph, const GncConfig& config, const Solution<P>& given,
                          const Search<P>& search) {
  Solution<P> first = search.run_plain(given);
  Solution<P> second = search.run_plain(optimize(graph, config.optimizer));
  const int iterations = first.iterations + second.iterations;
  const bool second_wins = second.ok() && (!first.ok() || search.objective(second) < search.objective(first));
  Solution<P> best = second_wins ? std::move(second) : std::move(first);
  best.iterations = iterations;
  return best;
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
Solution<P> optimize_gnc(const BasicPoseGraph<P>& graph, const GncConfig& config) {
  Search<P> search(graph, config);
  OptimizerConfig none = config.optimizer;
  none.initialization = SolveStart::given;
  none.max_iterations = 0;
  const Solution<P> given = optimize(graph, none);
  if (!given.ok()) return given;
  Solution<P> best =
      config.plain ? best_of_plain(graph, config, given, search) : best_of_all(graph, config, given, search);
  best.cost_initial = given.cost_initial;
  if (const std::size_t rejected = num_rejected(best); rejected > 0)
    best.notes.push_back(format("{} loops rejected", rejected));
  return best;
}

template Solution<Pose> optimize_gnc(const PoseGraph&, const GncConfig&);
template Solution<Pose2> optimize_gnc(const PoseGraph2&, const GncConfig&);

}  // namespace adit
