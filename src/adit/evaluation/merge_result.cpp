// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/merge_result.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/statistics.hpp"

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

/// With the limits between which the share lies, at a confidence of 95 %.
std::string limits_text(int part, int total) {
  if (total == 0) return "-";
  const ShareLimits limits = share_limits(static_cast<std::size_t>(part), static_cast<std::size_t>(total));
  return format("{} of {} ({:.0f} %; {:.0f} to {:.0f})", part, total, 100.0 * part / total,
                100.0 * limits.lower, 100.0 * limits.upper);
}

/// Of what should not happen: with the upper limit of its share.
std::string at_most_text(int part, int total) {
  if (total == 0) return format("{}", part);
  return format("{} of {} (< {:.1f} %)", part, total,
                100.0 * share_upper_limit(static_cast<std::size_t>(part), static_cast<std::size_t>(total)));
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

/// What runs have in common that one row sums up: group, keyframe policy, sensors and conditions.
using Setting = std::array<std::string, 4>;

Setting setting_of(const MergeRun& run) { return {run.group, run.keyframes, run.sensors, run.conditions}; }

/// In the order in which they first appear, with their sums.
std::vector<std::pair<Setting, MergeCounts>> sums_of(const std::vector<MergeRun>& runs) {
  std::vector<std::pair<Setting, MergeCounts>> sums;
  for (const MergeRun& run : runs) {
    auto sum = std::ranges::find(sums, setting_of(run), &std::pair<Setting, MergeCounts>::first);
    if (sum == sums.end()) sum = sums.insert(sums.end(), {setting_of(run), {}});
    sum->second.add(run);
  }
  return sums;
}

std::vector<std::string> row_of(const Setting& setting, std::vector<std::string> cells) {
  cells.insert(cells.begin(), setting.begin(), setting.end());
  return cells;
}

Table summary_table(const std::vector<MergeRun>& runs) {
  Table table{
      "Merging, in short",
      "Mergeable pairs share at least 25 m of path, and on it a stretch of 20 m whose surface differs from "
      "that of every other stretch that a robot passed by more than sensors may err. Bent: merged in the "
      "correct place, but with an ATE of 1 % of the path or more. Indistinct: merged correctly, of the "
      "pairs that share 25 m but no such stretch. Kept apart: of the pairs that share less. Wrong merges: "
      "of all pairs. Joint: all robots of a world at once; merged: mergeable pairs that end in one correct "
      "map; pairs in one map: of any kind; whole: worlds where all robots that mergeable pairs connect "
      "share a map; wrong: of all worlds. In brackets: the share, the limits between which it lies, and "
      "after < the upper limit alone, all with a confidence of 95 %, as if pairs were independent. CPU: "
      "time of all threads for merging alone, from the robots' maps to the joint solution.",
      {},
      {"Worlds", "Keyframes", "Sensors", "Conditions", "Number", "Merged well", "Bent", "Refused",
       "Indistinct", "Kept apart", "Wrong merges", "Wrong loops", "Joint: merged", "Joint: pairs in one map",
       "Joint: whole", "Joint: wrong", "Joint: wrong loops", "Registrations", "CPU (s)"},
      {}};
  for (const auto& [setting, counts] : sums_of(runs))
    table.rows.push_back(row_of(
        setting, {format("{}", counts.worlds), limits_text(counts.success, counts.mergeable),
                  format("{}", counts.bent), format("{}", counts.refused),
                  share_text(counts.indistinct_merged, counts.indistinct),
                  share_text(counts.kept_apart, counts.others), at_most_text(counts.wrong, counts.pairs),
                  format("{}", counts.wrong_loops), limits_text(counts.joint_merged, counts.mergeable),
                  format("{}", counts.joint_pairs), share_text(counts.joint_whole, counts.worlds),
                  at_most_text(counts.joint_wrong, counts.worlds), format("{}", counts.joint_wrong_loops),
                  format("{}", counts.registrations), format("{:.1f}", counts.time_s)}));
  return table;
}

/// Ablations name what they leave out after the policy; their worlds and refusals would fill pages.
bool is_variant(const MergeRun& run) { return run.keyframes.find(' ') != std::string::npos; }

std::vector<std::string> words_of(const std::string& list) {
  constexpr std::string_view kBetween = ", ";
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(kBetween, begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + kBetween.size();
  }
  return words;
}

/// "os1-64 and os2-32": by name, whichever robot has which.
std::string sensors_of(const MergePair& pair, const MergeRun& run) {
  const std::vector<std::string> in_turn = words_of(run.sensors);
  std::vector<std::string> robots;  // in their order: pairs run from the first with each of the others on
  for (const MergePair& one : run.pairs)
    for (const std::string& robot : one.robots)
      if (std::ranges::find(robots, robot) == robots.end()) robots.push_back(robot);
  std::array<std::string, 2> names;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto at = std::ranges::find(robots, pair.robots[i]) - robots.begin();
    names[i] = in_turn[static_cast<std::size_t>(at) % in_turn.size()];
  }
  std::ranges::sort(names);
  return names[0] == names[1] ? names[0] + " both" : names[0] + " and " + names[1];
}

/// Runs of each group, policy and conditions by the sensors of a pair, and all together. Empty where no run
/// has more than one sensor.
Table pairs_of_sensors_table(const std::vector<MergeRun>& runs) {
  Table table{"Merging, by the sensors of a pair",
              "As above, pair by pair and where all robots met.",
              {},
              {"Worlds", "Keyframes", "Conditions", "Sensors of the pair", "Pairs", "Merged well",
               "Joint: merged", "Kept apart", "Wrong merges"},
              {}};
  using Key = std::array<std::string, 4>;
  std::vector<std::pair<Key, MergeCounts>> sums;  // in the order in which they first appear
  const auto add = [&](const Key& key, const MergeRun& run) {
    auto sum = std::ranges::find(sums, key, &std::pair<Key, MergeCounts>::first);
    if (sum == sums.end()) sum = sums.insert(sums.end(), {key, {}});
    sum->second.add(run);
  };
  const auto is_mixed = [](const MergeRun& run) { return words_of(run.sensors).size() > 1; };
  if (std::ranges::none_of(runs, is_mixed)) return table;
  for (const MergeRun& run : runs) {
    if (is_variant(run)) continue;
    for (const MergePair& pair : run.pairs) {
      MergeRun alone = run;
      alone.pairs = {pair};
      add({run.group, run.keyframes, run.conditions, sensors_of(pair, run)}, alone);
    }
  }
  for (const MergeRun& run : runs)
    if (!is_variant(run)) add({run.group, run.keyframes, run.conditions, "all"}, run);
  for (const auto& [key, counts] : sums)
    table.rows.push_back(
        {key[0], key[1], key[2], key[3], format("{}", counts.pairs),
         limits_text(counts.success, counts.mergeable), limits_text(counts.joint_merged, counts.mergeable),
         share_text(counts.kept_apart, counts.others), at_most_text(counts.wrong, counts.pairs)});
  std::ranges::stable_sort(
      table.rows, {}, [](const std::vector<std::string>& row) { return std::tuple(row[0], row[1], row[2]); });
  return table;
}

Table kinds_table(const std::vector<MergeRun>& runs) {
  Table table{"What kept mergeable pairs apart",
              "Pairs that were tried by themselves, by the reason that the decision gave.",
              {},
              {"Worlds", "Keyframes", "Sensors", "Conditions", "Refused"},
              {}};
  for (const RefusalKind kind : kRefusalKinds) table.header.emplace_back(to_string(kind));
  for (const auto& [setting, counts] : sums_of(runs)) {
    if (counts.refused == 0) continue;
    std::vector<std::string> cells = {format("{}", counts.refused)};
    for (const int number : counts.refusals) cells.push_back(format("{}", number));
    table.rows.push_back(row_of(setting, std::move(cells)));
  }
  return table;
}

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
      {"World", "Keyframes", "Sensors", "Conditions", "Mergeable", "Well", "Bent", "Refused", "Indistinct",
       "Wrong", "Wrong loops", "Max ATE (%)", "Maps of all robots", "Joint max ATE (%)", "Registrations",
       "CPU (s)"},
      {}};
  for (const MergeRun& run : runs) {
    if (is_variant(run)) continue;
    MergeCounts counts;
    counts.add(run);
    std::string maps = maps_text(run.joint.maps);
    if (!are_within(run.joint.possible_maps, run.joint.maps))
      maps += format(" ({})", maps_text(run.joint.possible_maps));
    table.rows.push_back({run.world, run.keyframes, run.sensors, run.conditions,
                          format("{}", counts.mergeable), format("{}", counts.success),
                          format("{}", counts.bent), format("{}", counts.refused),
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
      {"World", "Keyframes", "Sensors", "Conditions", "Robots", "Shared (m)", "Distinctive (m)", "Reason"},
      {}};
  for (const MergeRun& run : runs)
    for (const MergePair& pair : run.pairs)
      if (!is_variant(run) && pair.shares_enough() && pair.outcome == MergeOutcome::refused)
        table.rows.push_back({run.world, run.keyframes, run.sensors, run.conditions,
                              maps_text({{pair.robots[0], pair.robots[1]}}), format("{:.0f}", pair.shared_m),
                              format("{:.0f}", pair.distinctive_m), pair.refused_reason});
  return table;
}

Table wrong_table(const std::vector<MergeRun>& runs) {
  Table table{"Wrong merges",
              "Each pair with the stretch that it shares and the largest ATE after the merge.",
              {},
              {"World", "Keyframes", "Sensors", "Conditions", "Pairs merged in a wrong place"},
              {}};
  for (const MergeRun& run : runs) {
    std::string pairs;
    for (const MergePair& pair : run.pairs)
      if (pair.outcome == MergeOutcome::wrong)
        pairs += format("{}{} ({:.0f} m shared, {:.0f} m off)", pairs.empty() ? "" : ", ",
                        maps_text({{pair.robots[0], pair.robots[1]}}), pair.shared_m,
                        std::max(pair.ate_max_m[0], pair.ate_max_m[1]));
    if (!pairs.empty()) table.rows.push_back({run.world, run.keyframes, run.sensors, run.conditions, pairs});
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
    const bool in_one_map = are_within({{pair.robots[0], pair.robots[1]}}, run.joint.maps);
    ++pairs;
    merged += 1 - is(MergeOutcome::refused);
    joint_pairs += in_one_map ? 1 : 0;
    wrong += is(MergeOutcome::wrong);
    wrong_loops += pair.wrong_loops_in_use;
    if (pair.mergeable()) {
      ++mergeable;
      joint_merged += !run.joint.wrong && in_one_map ? 1 : 0;
      success += is(MergeOutcome::success);
      bent += is(MergeOutcome::bent);
      refused += is(MergeOutcome::refused);
      if (pair.outcome == MergeOutcome::refused) ++refusals[static_cast<std::size_t>(pair.refused_kind)];
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
  for (Table table :
       {pairs_of_sensors_table(runs), wrong_table(runs), kinds_table(runs), refusals_table(runs)})
    if (!table.rows.empty()) tables.push_back(std::move(table));
  return tables;
}

}  // namespace adit
