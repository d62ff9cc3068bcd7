// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/merge_result.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::array<std::pair<MergeOutcome, std::string_view>, 4> kOutcomes = {
    {{MergeOutcome::success, "success"},
     {MergeOutcome::bent, "bent"},
     {MergeOutcome::refused, "refused"},
     {MergeOutcome::wrong, "wrong"}}};

constexpr double kPrecise = 0.01;  ///< Of the path: the paper's rule.

bool is_precise(const MergeEvidence& evidence) {
  return std::ranges::all_of(evidence.robots, [](const MergeEvidence::Robot& robot) {
    return robot.ate_max_m < kPrecise * robot.path_length_m;
  });
}

/// Drift alone bends a merged map by what the odometries lose between the meeting and the end; the error of a
/// wrong place is far larger.
bool is_worse_than_drift(const MergeEvidence& evidence) {
  constexpr double kFactor = 1.5;
  constexpr double kSlack = 1.0;  // Metres: odometries may be better than registrations.
  double drift = 0.0;
  double error = 0.0;
  for (const MergeEvidence::Robot& robot : evidence.robots) {
    drift = std::max(drift, robot.drift_m);
    error = std::max(error, robot.ate_max_m);
  }
  return error > kFactor * drift + kSlack;
}

std::string share_text(int part, int total) {
  return total == 0 ? "-" : format("{} of {} ({:.0f} %)", part, total, 100.0 * part / total);
}

/// "0+1 2 3": robots that share a map are joined by a plus.
std::string maps_text(const std::vector<std::vector<std::string>>& maps) {
  const std::string prefix = "robot_";
  std::string text;
  for (const std::vector<std::string>& map : maps) {
    if (!text.empty()) text += ' ';
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (i > 0) text += '+';
      text += map[i].starts_with(prefix) ? map[i].substr(prefix.size()) : map[i];
    }
  }
  return text;
}

using GroupAndPolicy = std::pair<std::string, std::string>;

/// Groups and policies in the order in which they first appear.
std::vector<GroupAndPolicy> groups_of(const std::vector<MergeRun>& runs) {
  std::vector<GroupAndPolicy> groups;
  for (const MergeRun& run : runs) {
    const GroupAndPolicy key{run.group, run.keyframes};
    if (std::ranges::find(groups, key) == groups.end()) groups.push_back(key);
  }
  return groups;
}

Table summary_table(const std::vector<MergeRun>& runs) {
  Table table{
      "Merging, in short",
      "Mergeable pairs share at least 25 m of path, and on it a stretch of 20 m whose surface differs from "
      "that of every other stretch that a robot passed by more than sensors may err. "
      "Bent: merged in the correct place, but with an ATE of 1 % of the path or more. Indistinct: "
      "merged correctly, of the pairs that share 25 m but no such stretch. Kept apart: of the pairs "
      "that share less. Joint: all robots of a world at once; merged: mergeable pairs that end in "
      "one correct map; whole: worlds where all robots that mergeable pairs connect share a map. "
      "CPU: time of all threads for merging alone, from the robots' "
      "maps to the joint solution.",
      {},
      {"Worlds", "Keyframes", "Number", "Merged well", "Bent", "Refused", "Indistinct", "Kept apart",
       "Wrong merges", "Wrong loops", "Joint: merged", "Joint: whole", "Joint: wrong", "Joint: wrong loops",
       "Registrations", "CPU (s)"},
      {}};
  for (const GroupAndPolicy& key : groups_of(runs)) {
    MergeCounts counts;
    for (const MergeRun& run : runs)
      if (key == GroupAndPolicy{run.group, run.keyframes}) counts.add(run);
    table.rows.push_back({key.first, key.second, format("{}", counts.worlds),
                          share_text(counts.success, counts.mergeable), format("{}", counts.bent),
                          format("{}", counts.refused),
                          share_text(counts.indistinct_merged, counts.indistinct),
                          share_text(counts.kept_apart, counts.others), format("{}", counts.wrong),
                          format("{}", counts.wrong_loops), share_text(counts.joint_merged, counts.mergeable),
                          share_text(counts.joint_whole, counts.worlds), format("{}", counts.joint_wrong),
                          format("{}", counts.joint_wrong_loops), format("{}", counts.registrations),
                          format("{:.1f}", counts.time_s)});
  }
  return table;
}

/// Ablations name what they leave out after the policy; their worlds and refusals would fill pages.
bool is_variant(const MergeRun& run) { return run.keyframes.find(' ') != std::string::npos; }

/// The worst robot of the pairs that were merged.
double worst_ate_pct(const MergeRun& run) {
  double worst = 0.0;
  for (const MergePair& pair : run.pairs)
    if (pair.outcome != MergeOutcome::refused)
      worst = std::max({worst, pair.ate_max_over_path_pct[0], pair.ate_max_over_path_pct[1]});
  return worst;
}

Table worlds_table(const std::vector<MergeRun>& runs) {
  Table table{
      "Each world",
      "Maps: robots that share one are joined by a plus; in brackets the maps that mergeable pairs would "
      "allow, where that is more. ATE: of the worst robot, in per cent of its path.",
      {},
      {"World", "Keyframes", "Mergeable", "Well", "Bent", "Refused", "Indistinct", "Wrong", "Wrong loops",
       "Max ATE (%)", "Maps of all robots", "Joint max ATE (%)", "Registrations", "CPU (s)"},
      {}};
  for (const MergeRun& run : runs) {
    if (is_variant(run)) continue;
    MergeCounts counts;
    counts.add(run);
    std::string maps = maps_text(run.joint.maps);
    if (!are_within(run.joint.possible_maps, run.joint.maps))
      maps += format(" ({})", maps_text(run.joint.possible_maps));
    table.rows.push_back({run.world, run.keyframes, format("{}", counts.mergeable),
                          format("{}", counts.success), format("{}", counts.bent),
                          format("{}", counts.refused),
                          share_text(counts.indistinct_merged, counts.indistinct), format("{}", counts.wrong),
                          format("{}", counts.wrong_loops), format("{:.2f}", worst_ate_pct(run)), maps,
                          format("{:.2f}", run.joint.ate_max_over_path_pct), format("{}", run.registrations),
                          format("{:.1f}", run.time_s)});
  }
  return table;
}

Table refusals_table(const std::vector<MergeRun>& runs) {
  Table table{
      "Pairs that share 25 m and were refused",
      "With the metres of the shared stretch that are distinctive, and the reason given by the decision.",
      {},
      {"World", "Keyframes", "Robots", "Shared (m)", "Distinctive (m)", "Reason"},
      {}};
  for (const MergeRun& run : runs)
    for (const MergePair& pair : run.pairs)
      if (!is_variant(run) && pair.shares_enough() && pair.outcome == MergeOutcome::refused)
        table.rows.push_back({run.world, run.keyframes, maps_text({{pair.robots[0], pair.robots[1]}}),
                              format("{:.0f}", pair.shared_m), format("{:.0f}", pair.distinctive_m),
                              pair.refused_reason});
  return table;
}

Table wrong_table(const std::vector<MergeRun>& runs) {
  Table table{"Wrong merges",
              "Each pair with the stretch that it shares and the largest ATE after the merge.",
              {},
              {"World", "Keyframes", "Pairs merged in a wrong place"},
              {}};
  for (const MergeRun& run : runs) {
    std::string pairs;
    for (const MergePair& pair : run.pairs)
      if (pair.outcome == MergeOutcome::wrong)
        pairs += format("{}{} ({:.0f} m shared, {:.0f} m off)", pairs.empty() ? "" : ", ",
                        maps_text({{pair.robots[0], pair.robots[1]}}), pair.shared_m,
                        std::max(pair.ate_max_m[0], pair.ate_max_m[1]));
    if (!pairs.empty()) table.rows.push_back({run.world, run.keyframes, pairs});
  }
  return table;
}

}  // namespace

std::string_view to_string(MergeOutcome outcome) {
  return std::ranges::find(kOutcomes, outcome, &decltype(kOutcomes)::value_type::first)->second;
}

MergeOutcome merge_outcome(std::string_view name) {
  const auto found = std::ranges::find(kOutcomes, name, &decltype(kOutcomes)::value_type::second);
  ADIT_CHECK(found != kOutcomes.end(), "an outcome has one of four names");
  return found->first;
}

MergeOutcome judge_merge(const MergeEvidence& evidence) {
  if (!evidence.merged) return MergeOutcome::refused;
  if (is_precise(evidence)) return MergeOutcome::success;
  const bool held_by_wrong_loops = 2 * evidence.wrong_loops_in_use >= evidence.loops_in_use;
  return held_by_wrong_loops || is_worse_than_drift(evidence) ? MergeOutcome::wrong : MergeOutcome::bent;
}

bool are_within(const std::vector<std::vector<std::string>>& maps,
                const std::vector<std::vector<std::string>>& groups) {
  return std::ranges::all_of(maps, [&](const std::vector<std::string>& map) {
    return std::ranges::any_of(groups, [&](const std::vector<std::string>& group) {
      return std::ranges::all_of(
          map, [&](const std::string& robot) { return std::ranges::count(group, robot) > 0; });
    });
  });
}

void MergeCounts::add(const MergeRun& run) {
  ++worlds;
  for (const MergePair& pair : run.pairs) {
    const auto is = [&](MergeOutcome outcome) { return pair.outcome == outcome ? 1 : 0; };
    wrong += is(MergeOutcome::wrong);
    wrong_loops += pair.wrong_loops_in_use;
    if (pair.mergeable()) {
      ++mergeable;
      joint_merged +=
          !run.joint.wrong && are_within({{pair.robots[0], pair.robots[1]}}, run.joint.maps) ? 1 : 0;
      success += is(MergeOutcome::success);
      bent += is(MergeOutcome::bent);
      refused += is(MergeOutcome::refused);
    } else if (pair.shares_enough()) {
      ++indistinct;
      indistinct_merged += is(MergeOutcome::success) + is(MergeOutcome::bent);
    } else {
      ++others;
      kept_apart += is(MergeOutcome::refused);
    }
  }
  joint_wrong += run.joint.wrong ? 1 : 0;
  joint_whole += are_within(run.joint.possible_maps, run.joint.maps) && !run.joint.wrong ? 1 : 0;
  joint_wrong_loops += run.joint.wrong_loops_in_use;
  registrations += run.registrations;
  time_s += run.time_s;
}

std::vector<Table> merge_tables(const std::vector<MergeRun>& runs) {
  std::vector<Table> tables{summary_table(runs), worlds_table(runs)};
  for (Table table : {wrong_table(runs), refusals_table(runs)})
    if (!table.rows.empty()) tables.push_back(std::move(table));
  return tables;
}

}  // namespace adit
