// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well methods separate the false loops of labelled graphs from the true ones, and the tables of it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/evaluation/tables.hpp"

namespace adit {

/// Loops counted by label and by decision.
struct LoopScore {
  /// Loops by their label, then by the decision.
  ///@{
  int true_kept = 0, true_lost = 0;
  int false_kept = 0, false_rejected = 0;
  ///@}

  /// Counts one loop.
  void add(bool is_true, bool is_kept);
  /// By label, whatever was decided.
  ///@{
  [[nodiscard]] int num_true() const { return true_kept + true_lost; }
  [[nodiscard]] int num_false() const { return false_kept + false_rejected; }
  ///@}
  /// Share of true loops among those kept, in [0, 1]; nothing where none was kept.
  [[nodiscard]] std::optional<double> precision() const;
  /// Share of kept loops among the true ones, in [0, 1]; nothing where none is true.
  [[nodiscard]] std::optional<double> recall() const;
  /// Counts the loops of the other too.
  LoopScore& operator+=(const LoopScore& other);
  bool operator==(const LoopScore&) const = default;
};

/// The methods compared, in the order of the tables.
enum class LoopMethod { gnc, pcm, adit };
/// All of them; results of each method stand at its index here.
inline constexpr std::array kLoopMethods = {LoopMethod::gnc, LoopMethod::pcm, LoopMethod::adit};
/// "plain GNC", "PCM" or "adit".
[[nodiscard]] std::string_view to_string(LoopMethod method);

/// The result of one method on one graph.
struct LoopDecision {
  LoopScore score;         ///< Kept: with a final weight of one half or more.
  int parts = 1;           ///< Pieces that the kept loops leave of the graph.
  int possible_parts = 1;  ///< Pieces that the true loops leave.
  double off_m = 0.0;      ///< Largest distance of a position from the optimum of the true loops, metres.
  double time_s = 0.0;     ///< Processor time of all threads.
  bool is_optimal = true;  ///< False where a search stopped at its budget.
  int refused = 0;         ///< Loops that fit, left out because nothing confirms them; not kept, above.
};

/// One graph with one set of false loops.
struct FalseLoopRun {
  std::string graph;      ///< As in the list of graphs.
  std::string injection;  ///< "random", "clustered", or "as found" for a graph that came with its own.
  int num_nodes = 0;      ///< Poses.
  int num_true = 0;       ///< Loops.
  int num_false = 0;      ///< Loops.
  int share_pct = 0;      ///< Of false loops: as requested, or, as found, what the graph holds.
  std::array<std::optional<LoopDecision>, kLoopMethods.size()>
      decisions;                                         ///< Empty where a method has no answer.
  std::array<std::string, kLoopMethods.size()> reasons;  ///< Why, in one sentence, where it has none.
};

/// A summary of each injection and share over the graphs that every method has an answer for; each graph; and
/// the methods that had no answer with their reasons, if there are any.
[[nodiscard]] std::vector<Table> false_loop_tables(const std::vector<FalseLoopRun>& runs);

}  // namespace adit
