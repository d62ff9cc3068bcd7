// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Measures which false loops plain GNC, PCM and adit's own search find in pose graphs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adit/evaluation/false_loop_result.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/graph_pcm.hpp"
#include "adit/study/loop_graphs.hpp"

namespace adit {

/// How the methods are set, and on what they are run.
struct LoopStudy {
  GncConfig gnc;  ///< Of adit's own search and of plain GNC, whatever its `plain` says.
  PcmConfig pcm;  ///< What PCM keeps is solved by the optimizer of `gnc`.
  std::vector<int> shares = {10, 30, 50, 70};  ///< Per cent of all loops that are false.
  std::function<void(FalseLoopRun)> on_run;    ///< Takes each result.
};

/// Runs all methods on one listed graph: with each share of false loops, or on those that the file itself
/// has. Fails where the graph cannot be read or its true edges cannot be solved.
Result<> run_graph(const ListedGraph& listed, const LoopStudy& study);

/// The graphs of a list that are run, and which are left out.
struct ChosenGraphs {
  std::vector<ListedGraph> graphs;  ///< In the order of the list.
  std::vector<std::string> notes;   ///< One line per graph that is left out because its file is absent.
};
/// The graphs named in `only`, or all where it is empty. Fails on a name that the list does not have.
[[nodiscard]] Result<ChosenGraphs> chosen_graphs(const std::filesystem::path& list,
                                                 const std::vector<ListedGraph>& graphs,
                                                 const std::vector<std::string>& only);

/// One run in one line of text.
[[nodiscard]] std::string summary_line(const FalseLoopRun& run);
/// false_loops.json.
[[nodiscard]] std::string json_of(const std::vector<FalseLoopRun>& runs);

}  // namespace adit
