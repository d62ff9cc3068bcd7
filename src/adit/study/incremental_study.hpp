// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Measures how false loops are found while a graph grows keyframe by keyframe, as riSAM's paper does: at
/// every step (McGann, Rogers, Kaess, ICRA 2023).
#pragma once

#include <string>
#include <vector>

#include "adit/posegraph/robust_incremental.hpp"
#include "adit/study/loop_graphs.hpp"

namespace adit {

/// A figure over all steps.
struct OverSteps {
  double mean = 0.0;   ///< All steps count alike.
  double worst = 0.0;  ///< The least of a share, the largest of an error.
  double last = 0.0;   ///< Of the whole graph.
};

/// One graph with one share of false loops, fed node by node.
struct IncrementalRun {
  std::string graph;          ///< As in the list of graphs.
  int share_pct = 0;          ///< Of false loops, among all.
  std::uint64_t seed = 0;     ///< Of the false loops.
  std::size_t num_nodes = 0;  ///< One more than there are steps.
  std::size_t num_true = 0;   ///< Loops.
  std::size_t num_false = 0;  ///< Loops.
  OverSteps precision;        ///< Share of true loops among those in use; 1 while none is.
  OverSteps recall;  ///< Share of the true loops so far that are in use; 1 before the first one comes.
  OverSteps ate_m;   ///< RMSE of the positions so far against the optimum of the whole graph's true edges.
  std::size_t most_false_in_use = 0;  ///< At any step.
  double median_ms = 0.0;             ///< Processor time per step, of all threads.
  double p99_ms = 0.0;                ///< 99th percentile of that.
  double max_ms = 0.0;                ///< Of the slowest step.
};

/// Adds random false loops (false_loops.hpp) of each share, without those that are true by chance, and feeds
/// the graph in the order of its nodes: each with its odometry and all loops to nodes before it. Fails where
/// the graph cannot be read or has fewer than two nodes, its true edges cannot be solved, or a step cannot.
[[nodiscard]] Result<std::vector<IncrementalRun>> run_incremental(const ListedGraph& listed,
                                                                  const RobustIncrementalConfig& config,
                                                                  const std::vector<int>& shares);

/// One run in one line of text.
[[nodiscard]] std::string summary_line(const IncrementalRun& run);
/// incremental.json.
[[nodiscard]] std::string json_of(const std::vector<IncrementalRun>& runs);

}  // namespace adit
