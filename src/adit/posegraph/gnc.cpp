// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/gnc.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/log_gamma.hpp"
#include "adit/core/progress.hpp"
#include "adit/posegraph/gnc_search.hpp"
#include "adit/posegraph/loop_trials.hpp"

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

template <class P>
std::size_t num_loops(const BasicPoseGraph<P>& graph) {
  return static_cast<std::size_t>(
      std::ranges::count(graph.edges, EdgeKind::loop, &BasicPoseGraph<P>::Edge::kind));
}

// From the clusters, and from other poses as long as the answer is not clearly fine; `given`: the graph's
// own.
template <class P>
Solution<P> best_of_all(const BasicPoseGraph<P>& graph, const GncConfig& config, const Solution<P>& given) {
  // The starts, most of which a clear answer makes needless, the loops that are reconsidered, and the trials.
  const Phase phase("searching for false loops", 4 + kMaxRestarts + 2);
  const double given_bound = chi2_quantile(config.inlier_probability, P::kDof);
  const LoopEvidence<P> evidence(graph, loop_clusters(graph), given_bound);
  GncSearch<P> search(graph, config, given_bound);
  Solution<P> best = search.grow(search.from(evidence.clusters()));
  phase.advance();
  const auto take_better = [&](Solution<P> other) {
    other.iterations += best.iterations;
    const bool better = other.ok() && (!best.ok() || evidence.cost(other) < evidence.cost(best));
    best.iterations = other.iterations;
    if (better) best = std::move(other);
    return better;
  };
  // The bound that was fitted to one answer is not that of others.
  const auto is_fine = [&] {
    return search.is_clearly_fine(best, evidence.clusters()) && evidence.has_right_scale(best);
  };
  bool done = is_fine();
  const Tried tried = done ? Tried::parts_of_large : Tried::all;
  if (!done) search.restore_bound(evidence.bound());
  const auto improve_with = [&](Solution<P> other) {
    if (take_better(std::move(other))) done = is_fine();
  };
  if (!done) {
    const BasicPoseGraph<P> pieces = evidence.one_loop_per_piece();
    const GncSearch<P> by_piece(pieces, config, evidence.bound());
    improve_with(search.settle(by_piece.run(given)));
  }
  phase.advance();
  if (!done) improve_with(search.run(given));
  phase.advance();
  if (!done) improve_with(search.run(optimize(graph, config.optimizer)));
  phase.advance();
  // Loops that hold only together are found from where the others have brought the poses.
  for (int i = 0; i < kMaxRestarts && best.ok() && !done; ++i) {
    Solution<P> again = best;
    again.iterations = 0;
    if (!take_better(search.run(std::move(again)))) break;
    done = is_fine();
    phase.advance();
  }
  // Where all loops fit by their stated noise and the trials leave none, nothing is decided: loops to both
  // sides of a slip of the odometry strain one another.
  std::optional<Solution<P>> all_fit;
  if (best.ok() && num_rejected(best) == 0) all_fit = best;
  if (best.ok())
    best = search.reconsider(std::move(best), evidence, done ? Reconsidered::parts : Reconsidered::all);
  phase.advance();
  if (best.ok()) best = try_loops(graph, search, evidence, tried, std::move(best));
  return all_fit && num_rejected(best) == num_loops(graph) ? *all_fit : best;
}

// The paper's search from the graph's own poses and from least squares with all loops.
template <class P>
Solution<P> best_of_plain(const BasicPoseGraph<P>& graph, const GncConfig& config, const Solution<P>& given) {
  const GncSearch<P> search(graph, config, chi2_quantile(config.inlier_probability, P::kDof));
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
  OptimizerConfig none = config.optimizer;
  none.initialization = SolveStart::given;
  none.max_iterations = 0;
  const Solution<P> given = optimize(graph, none);
  if (!given.ok()) return given;
  Solution<P> best = config.plain ? best_of_plain(graph, config, given) : best_of_all(graph, config, given);
  best.cost_initial = given.cost_initial;
  if (const std::size_t rejected = num_rejected(best); rejected > 0)
    best.notes.push_back(format("{} loops rejected", rejected));
  return best;
}

template Solution<Pose> optimize_gnc(const PoseGraph&, const GncConfig&);
template Solution<Pose2> optimize_gnc(const PoseGraph2&, const GncConfig&);

}  // namespace adit
