// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/incremental_study.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/geometry/umeyama.hpp"
#include "adit/posegraph/false_loops.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/study/processor_time.hpp"

namespace adit {
namespace {

Vector3 position_of(const Pose& T) { return T.translation(); }
Vector3 position_of(const Pose2& T) { return {T.translation().x(), T.translation().y(), 0.0}; }

enum class Better { high, low };
/// Collects a figure step by step.
class StepFigure {
 public:
  explicit StepFigure(Better better) : better_(better) {}
  void add(double value) {
    sum_ += value;
    ++number_;
    out_.last = value;
    const bool is_worse = better_ == Better::high ? value < out_.worst : value > out_.worst;
    if (number_ == 1 || is_worse) out_.worst = value;
    out_.mean = sum_ / static_cast<double>(number_);
  }
  [[nodiscard]] const OverSteps& result() const { return out_; }

 private:
  Better better_;
  OverSteps out_;
  double sum_ = 0.0;
  std::size_t number_ = 0;
};

/// Feeds a labelled graph to the solver and judges each step.
template <class P>
class Feeding {
 public:
  Feeding(const LabelledGraph<P>& labelled, const std::vector<P>& reference)
      : labelled_(labelled), edges_at_(labelled.graph.nodes.size()) {
    for (std::size_t e = 0; e < labelled.graph.edges.size(); ++e) {
      const auto& edge = labelled.graph.edges[e];
      edges_at_[std::max(edge.from, edge.to)].push_back(e);
    }
    for (const P& pose : reference) truth_.push_back(position_of(pose));
  }

  Result<IncrementalRun> run(const RobustIncrementalConfig& config, const std::string& name) {
    RobustIncremental<P> solver(config);
    const auto& nodes = labelled_.graph.nodes;
    solver.add_node(nodes.front().key, nodes.front().pose);
    const Phase phase(name, nodes.size());
    for (std::size_t i = 1; i < nodes.size(); ++i, phase.advance()) {
      throw_if_cancelled();
      const double start_s = processor_s();
      add(solver, i);
      const auto step = solver.update();
      times_ms_.push_back(1e3 * (processor_s() - start_s));
      if (step.status != SolveStatus::converged && step.status != SolveStatus::max_iterations)
        return fail(format("step {}: {}: {}", i, to_string(step.status), step.reason));
      count(step);
      ate_m_.add(error_m(solver.poses()));
    }
    return result();
  }

 private:
  void add(RobustIncremental<P>& solver, std::size_t node) {
    const auto& graph = labelled_.graph;
    P start = solver.poses().back();
    for (const std::size_t e : edges_at_[node]) {
      const auto& edge = graph.edges[e];
      if (edge.kind == EdgeKind::odometry && edge.to == node)
        start = solver.poses()[edge.from] * edge.T_from_to;
    }
    solver.add_node(graph.nodes[node].key, start);
    for (const std::size_t e : edges_at_[node]) {
      const bool is_true = e < labelled_.num_true;
      is_true_.push_back(is_true);
      solver.add_edge(graph.edges[e]);
      if (graph.edges[e].kind == EdgeKind::loop) ++(is_true ? run_.num_true : run_.num_false);
    }
  }

  void count(const typename RobustIncremental<P>::Step& step) {
    for (const std::size_t e : step.accepted) ++(is_true_[e] ? true_in_use_ : false_in_use_);
    for (const std::size_t e : step.dropped) --(is_true_[e] ? true_in_use_ : false_in_use_);
    const auto share = [](std::size_t part, std::size_t whole) {
      return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
    };
    precision_.add(share(true_in_use_, true_in_use_ + false_in_use_));
    recall_.add(share(true_in_use_, run_.num_true));
    run_.most_false_in_use = std::max(run_.most_false_in_use, false_in_use_);
  }

  /// After one alignment, as long as the positions allow one.
  [[nodiscard]] double error_m(const std::vector<P>& poses) const {
    std::vector<Vector3> estimate;
    for (const P& pose : poses) estimate.push_back(position_of(pose));
    const std::vector<Vector3> truth(truth_.begin(),
                                     truth_.begin() + static_cast<std::ptrdiff_t>(poses.size()));
    const Result<Pose> T_truth_estimate = align_rigid(estimate, truth);
    if (!T_truth_estimate) return 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      sum += (*T_truth_estimate * estimate[i] - truth[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  [[nodiscard]] IncrementalRun result() {
    run_.num_nodes = labelled_.graph.nodes.size();
    run_.precision = precision_.result();
    run_.recall = recall_.result();
    run_.ate_m = ate_m_.result();
    std::ranges::sort(times_ms_);
    run_.median_ms = times_ms_[times_ms_.size() / 2];
    run_.p99_ms = times_ms_[times_ms_.size() * 99 / 100];
    run_.max_ms = times_ms_.back();
    return run_;
  }

  const LabelledGraph<P>& labelled_;
  std::vector<std::vector<std::size_t>> edges_at_;  ///< Of the later one of their nodes.
  std::vector<Vector3> truth_;
  std::vector<bool> is_true_;  ///< By the solver's edges.
  std::size_t true_in_use_ = 0;
  std::size_t false_in_use_ = 0;
  std::vector<double> times_ms_;
  StepFigure precision_{Better::high};
  StepFigure recall_{Better::high};
  StepFigure ate_m_{Better::low};
  IncrementalRun run_;
};

template <class P>
Result<std::vector<IncrementalRun>> run_on(const ListedGraph& listed, const BasicPoseGraph<P>& graph,
                                           const RobustIncrementalConfig& config,
                                           const std::vector<int>& shares) {
  if (graph.nodes.size() < 2)
    return fail(
        listed.path +
        ": a graph of fewer than two nodes has no step that could be judged; remove it from the list");
  const BasicPoseGraph<P> clean = with_every_nth_loop(graph, listed.keep_every);
  const Solution<P> reference = optimize(clean);
  if (!reference.ok()) return fail(format("{}: {}", listed.path, reference.reason));
  std::vector<IncrementalRun> runs;
  for (const int share : shares) {
    LabelledGraph<P> labelled = with_false_loops(clean, 0.01 * share, FalseLoops::random, listed.seed);
    drop_true_by_chance(labelled, reference.poses, chi2_quantile(config.inlier_probability, P::kDof));
    Result<IncrementalRun> run = Feeding<P>(labelled, reference.poses).run(config, listed.name);
    if (!run) return fail(listed.path, run.error());
    run->graph = listed.name;
    run->share_pct = share;
    run->seed = listed.seed;
    runs.push_back(std::move(*run));
  }
  return runs;
}

}  // namespace

Result<std::vector<IncrementalRun>> run_incremental(const ListedGraph& listed,
                                                    const RobustIncrementalConfig& config,
                                                    const std::vector<int>& shares) {
  const Result<G2oFile> file = read_listed(listed);
  if (!file) return tl::unexpected(file.error());
  return std::visit([&](const auto& graph) { return run_on(listed, graph, config, shares); }, file->graph);
}

std::string summary_line(const IncrementalRun& run) {
  return format(
      "{:12} {:2} % of {:6} loops false (seed {}): precision {:.5f} (worst {:.4f}, last {:.5f}), recall "
      "{:.4f} "
      "(worst {:.4f}, last {:.4f}), ATE {:.3f} m (worst {:.3f}, last {:.3f}), {} false in use at most; per "
      "step {:.2f} ms median, {:.1f} at 99 %, {:.1f} at most",
      run.graph, run.share_pct, run.num_true + run.num_false, run.seed, run.precision.mean,
      run.precision.worst, run.precision.last, run.recall.mean, run.recall.worst, run.recall.last,
      run.ate_m.mean, run.ate_m.worst, run.ate_m.last, run.most_false_in_use, run.median_ms, run.p99_ms,
      run.max_ms);
}

}  // namespace adit
