// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/false_loop_result.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

std::optional<double> ratio(int part, int total) {
  if (total == 0) return std::nullopt;
  return static_cast<double>(part) / total;
}

/// Never rounded up to a full 100.
std::string percent_text(const std::optional<double>& share) {
  if (!share) return "-";
  return *share < 1.0 ? format("{:.1f}", std::min(100.0 * *share, 99.9)) : "100";
}

std::string off_text(const LoopDecision& decision) {
  return decision.parts > decision.possible_parts ? format("{} parts", decision.parts)
                                                  : format("{:.3f}", decision.off_m);
}

void append_score(std::vector<std::string>& row, const LoopScore& score) {
  row.push_back(percent_text(score.precision()));
  row.push_back(percent_text(score.recall()));
}

void append_decision(std::vector<std::string>& row, const std::optional<LoopDecision>& decision) {
  if (!decision) {
    row.insert(row.end(), 5, "-");
    return;
  }
  append_score(row, decision->score);
  if (!decision->is_optimal) row.back() += " †";
  row.push_back(format("{}", decision->refused));
  row.push_back(off_text(*decision));
  row.push_back(format("{:.2f}", decision->time_s));
}

struct Sum {
  int graphs = 0;
  int num_true = 0;
  int num_false = 0;
  std::array<LoopScore, kLoopMethods.size()> scores;
  std::array<int, kLoopMethods.size()> flawless{};  ///< Graphs of which no false loop was kept.
};

/// By injection and share; "as found" has no requested share, and is left to the table of graphs.
std::map<std::pair<std::string, int>, Sum> sums_of(const std::vector<FalseLoopRun>& runs) {
  std::map<std::pair<std::string, int>, Sum> sums;
  for (const FalseLoopRun& run : runs) {
    const bool is_complete = std::ranges::all_of(run.decisions, [](const auto& d) { return d.has_value(); });
    if (run.injection == "as found" || !is_complete) continue;
    Sum& sum = sums[{run.injection, run.share_pct}];
    ++sum.graphs;
    sum.num_true += run.num_true;
    sum.num_false += run.num_false;
    for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
      sum.scores[m] += run.decisions[m]->score;
      sum.flawless[m] += run.decisions[m]->score.false_kept == 0 ? 1 : 0;
    }
  }
  return sums;
}

/// No rows yet; they begin with the columns `first` and go on with those `of_each` method.
Table side_by_side(std::string title, std::string note, std::vector<std::string> first,
                   const std::vector<std::string>& of_each) {
  Table table{std::move(title), std::move(note), {{"", first.size()}}, std::move(first), {}};
  for (const LoopMethod method : kLoopMethods) {
    table.groups.push_back({std::string(to_string(method)), of_each.size()});
    table.header.insert(table.header.end(), of_each.begin(), of_each.end());
  }
  return table;
}

Table summary_table(const std::vector<FalseLoopRun>& runs) {
  Table table =
      side_by_side("False loops, in short",
                   "Loops of all graphs for which every method has an answer. P: precision, the share of "
                   "true loops among those kept; R: recall, the share of true loops that are kept; both in "
                   "per cent. Clean: graphs of which no false loop was kept.",
                   {"Injection", "False (%)", "Graphs", "True loops", "False loops"}, {"P", "R", "Clean"});
  for (const auto& [key, sum] : sums_of(runs)) {
    std::vector<std::string> row = {key.first, format("{}", key.second), format("{}", sum.graphs),
                                    format("{}", sum.num_true), format("{}", sum.num_false)};
    for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
      append_score(row, sum.scores[m]);
      row.push_back(format("{}", sum.flawless[m]));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table graph_table(const std::vector<FalseLoopRun>& runs) {
  Table table = side_by_side(
      "False loops, each graph",
      "P and R as above; refused: loops that fit, left out because nothing else confirms them; off: the "
      "largest distance in metres of a position from the optimum of the true "
      "loops, or the number of parts into which the kept loops divide the graph, where that is more than "
      "with the true loops; CPU: time in seconds. † The clique search stopped at its budget.",
      {"Graph", "Injection", "False (%)", "True loops", "False loops"}, {"P", "R", "refused", "off", "CPU"});
  for (const FalseLoopRun& run : runs) {
    std::vector<std::string> row = {run.graph, run.injection, format("{}", run.share_pct),
                                    format("{}", run.num_true), format("{}", run.num_false)};
    for (const auto& decision : run.decisions) append_decision(row, decision);
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// One line per graph, method and reason.
Table reason_table(const std::vector<FalseLoopRun>& runs) {
  Table table{"Methods without an answer",
              "Shown as \"-\" in the table of graphs.",
              {},
              {"Graph", "Method", "Reason"},
              {}};
  for (const FalseLoopRun& run : runs)
    for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
      if (run.decisions[m]) continue;
      std::vector<std::string> row = {run.graph, std::string(to_string(kLoopMethods[m])), run.reasons[m]};
      if (std::ranges::find(table.rows, row) == table.rows.end()) table.rows.push_back(std::move(row));
    }
  return table;
}

}  // namespace

void LoopScore::add(bool is_true, bool is_kept) {
  ++(is_true ? (is_kept ? true_kept : true_lost) : (is_kept ? false_kept : false_rejected));
}

std::optional<double> LoopScore::precision() const { return ratio(true_kept, true_kept + false_kept); }

std::optional<double> LoopScore::recall() const { return ratio(true_kept, num_true()); }

LoopScore& LoopScore::operator+=(const LoopScore& other) {
  true_kept += other.true_kept;
  true_lost += other.true_lost;
  false_kept += other.false_kept;
  false_rejected += other.false_rejected;
  return *this;
}

std::string_view to_string(LoopMethod method) {
  switch (method) {
    case LoopMethod::gnc:
      return "plain GNC";
    case LoopMethod::pcm:
      return "PCM";
    case LoopMethod::adit:
      return "adit";
  }
  ADIT_CHECK(false, "a method has a name");
  return "";
}

std::vector<Table> false_loop_tables(const std::vector<FalseLoopRun>& runs) {
  std::vector<Table> tables = {summary_table(runs), graph_table(runs)};
  if (Table reasons = reason_table(runs); !reasons.rows.empty()) tables.push_back(std::move(reasons));
  return tables;
}

}  // namespace adit
