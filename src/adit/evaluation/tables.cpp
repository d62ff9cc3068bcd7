// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/tables.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/evaluation/paper_figures.hpp"

namespace adit {
namespace {

using Row = std::vector<std::string>;

std::string short_name(const std::string& robot) {
  const std::string prefix = "robot_";
  return robot.starts_with(prefix) && robot.size() > prefix.size() ? robot.substr(prefix.size()) : robot;
}

std::string pair_name(const std::array<std::string, 2>& robots) {
  return format("({}, {})", short_name(robots[0]), short_name(robots[1]));
}

std::string policy_title(const std::string& keyframes) {
  if (keyframes == "all") return "All KF";
  if (keyframes == "tunnel_filter") return "Tunnel-filtered KF";
  if (keyframes == "tunnel_filter_keep") return "Filtered, kept in graph";
  if (keyframes == "adaptive") return "Adaptive KF";
  return keyframes + " KF";
}

std::vector<std::string> policies_of(const StudyResult& study) {
  std::vector<std::string> policies;
  for (const char* known : {"all", "tunnel_filter"}) {
    const bool used = std::any_of(study.pairs.begin(), study.pairs.end(),
                                  [&](const PairResult& pair) { return pair.keyframes == known; });
    if (used) policies.emplace_back(known);
  }
  for (const PairResult& pair : study.pairs) {
    if (std::find(policies.begin(), policies.end(), pair.keyframes) == policies.end()) {
      policies.push_back(pair.keyframes);
    }
  }
  return policies;
}

std::vector<std::array<std::string, 2>> pairs_of(const StudyResult& study) {
  std::vector<std::array<std::string, 2>> pairs;
  for (const PairResult& pair : study.pairs) {
    const std::array<std::string, 2> names = {pair.robots[0].name, pair.robots[1].name};
    if (std::find(pairs.begin(), pairs.end(), names) == pairs.end()) pairs.push_back(names);
  }
  return pairs;
}

const paper::PairRow* paper_row(const std::string& pair) {
  const auto found = std::find_if(paper::kPairs.begin(), paper::kPairs.end(),
                                  [&](const paper::PairRow& row) { return row.pair == pair; });
  return found == paper::kPairs.end() ? nullptr : &*found;
}

std::string percent_cell(double percent) { return percent == 0.0 ? "-" : format("{:.2f}", percent); }

void add_cells(Row& row, const std::vector<std::string>& cells) {
  row.insert(row.end(), cells.begin(), cells.end());
}

/// Adds one group of columns: its title over them and their headings.
void add_group(Table& table, const std::string& title, const std::vector<std::string>& headings) {
  table.groups.push_back({title, headings.size()});
  add_cells(table.header, headings);
}

Row share_cells(const LoopCounts* counts) {
  if (counts == nullptr) return {"", ""};
  if (counts->total == 0) return {"none", "none"};
  return {percent_cell(counts->wrong_place_pct()), percent_cell(counts->wrong_registration_pct())};
}

Row share_cells(const paper::OutlierShares* shares) {
  if (shares == nullptr) return {"", ""};
  return {percent_cell(shares->wrong_place), percent_cell(shares->wrong_registration)};
}

/// Before PCM both runs of a pair have the same loops; either will do.
const LoopCounts* counts_before(const StudyResult& study, const std::array<std::string, 2>& pair,
                                const std::string& policy) {
  const PairResult* run = find_pair(study, pair, policy, true);
  if (run == nullptr) run = find_pair(study, pair, policy, false);
  return run == nullptr ? nullptr : &run->loops_before_pcm;
}

const LoopCounts* counts_after(const StudyResult& study, const std::array<std::string, 2>& pair,
                               const std::string& policy) {
  const PairResult* run = find_pair(study, pair, policy, true);
  return run == nullptr ? nullptr : &run->loops_after_pcm;
}

struct OutlierColumns {
  decltype(&counts_before) counts;
  paper::OutlierShares paper::PairRow::*paper_all;
  paper::OutlierShares paper::PairRow::*paper_filtered;
};

void fill_outliers(Table& table, const StudyResult& study, const OutlierColumns& columns,
                   PaperFigures paper) {
  add_group(table, "", {"Robot pair"});
  const std::vector<std::string> policies = policies_of(study);
  for (const std::string& policy : policies) add_group(table, policy_title(policy), {"PR %", "PCR %"});
  if (paper == PaperFigures::show) {
    add_group(table, "Paper: All KF", {"PR %", "PCR %"});
    add_group(table, "Paper: Tunnel-filtered KF", {"PR %", "PCR %"});
  }
  for (const auto& pair : pairs_of(study)) {
    Row row = {pair_name(pair)};
    for (const std::string& policy : policies)
      add_cells(row, share_cells(columns.counts(study, pair, policy)));
    if (paper == PaperFigures::show) {
      const paper::PairRow* theirs = paper_row(row.front());
      add_cells(row, share_cells(theirs == nullptr ? nullptr : &(theirs->*columns.paper_all)));
      add_cells(row, share_cells(theirs == nullptr ? nullptr : &(theirs->*columns.paper_filtered)));
    }
    table.rows.push_back(std::move(row));
  }
}

constexpr const char* kSuccess = "✓";
constexpr const char* kFailure = "✗";
constexpr const char* kRefused = "○";

std::string success_cell(const PairResult* run) {
  if (run == nullptr) return "";
  if (!run->merged) return kRefused;
  return run->success() ? kSuccess : kFailure;
}

void add_success_rows(Table& table, const StudyResult& study, PaperFigures paper, const bool pcm) {
  for (const auto& pair : pairs_of(study)) {
    Row row = {pair_name(pair), pcm ? "yes" : "no"};
    for (const std::string& policy : policies_of(study))
      row.push_back(success_cell(find_pair(study, pair, policy, pcm)));
    if (paper == PaperFigures::show) {
      const paper::PairRow* theirs = paper_row(row.front());
      const auto mark = [&](bool without, bool with) -> std::string {
        return theirs == nullptr ? "" : (pcm ? with : without) ? kSuccess : kFailure;
      };
      row.push_back(theirs == nullptr ? "" : mark(theirs->all_succeeds_without_pcm, theirs->all_succeeds));
      row.push_back(
          theirs == nullptr ? "" : mark(theirs->filtered_succeeds_without_pcm, theirs->filtered_succeeds));
    }
    table.rows.push_back(std::move(row));
  }
}

std::string max_ate_cell(const MergedRobot& robot, bool merged) {
  if (!robot.ate) return "";
  return format("{:.3f}{}", robot.ate->max_m, merged ? "" : " ○");
}

Row max_ate_cells(const PairResult* run) {
  if (run == nullptr) return {"", ""};
  return {max_ate_cell(run->robots[0], run->merged), max_ate_cell(run->robots[1], run->merged)};
}

Row odometry_cells(const OdometryResult& odometry, double path_length_m) {
  const std::optional<AteResult>& ate = odometry.ate;
  const auto metres = [&](double AteResult::*value) {
    return ate ? format("{:.3f}", *ate.*value) : std::string();
  };
  return {metres(&AteResult::max_m), metres(&AteResult::rmse_m), metres(&AteResult::median_m),
          ate && path_length_m > 0.0 ? format("{:.2f}", 100.0 * ate->max_m / path_length_m) : "",
          odometry.ms_per_scan_median ? format("{:.1f}", *odometry.ms_per_scan_median) : ""};
}

/// The number of the shared map that a robot is in, counted from 1; "alone" when it shares its map with no
/// other.
std::string map_of(const JointResult& joint, const std::string& robot) {
  for (std::size_t i = 0; i < joint.components.size(); ++i) {
    const std::vector<std::string>& names = joint.components[i];
    if (std::find(names.begin(), names.end(), robot) == names.end()) continue;
    return names.size() == 1 ? "alone" : format("{}", i + 1);
  }
  return "alone";
}

/// Of the shared map that the robot is in: blank where it was not compared with the true surface.
Row map_cells(const JointResult& joint, const std::string& robot) {
  for (std::size_t i = 0; i < joint.components.size() && i < joint.map_accuracy.size(); ++i) {
    const std::optional<MapAccuracy>& map = joint.map_accuracy[i];
    if (!map || std::ranges::find(joint.components[i], robot) == joint.components[i].end()) continue;
    return {format("{:.3f}", map->median_m), format("{:.3f}", map->p95_m),
            map->completeness ? format("{:.1f}", 100.0 * *map->completeness) : ""};
  }
  return {"", "", ""};
}

}  // namespace

Table trajectories_table(const StudyResult& study, PaperFigures paper) {
  Table table;
  table.title = "Trajectories";
  table.caption = "Path length, duration and average speed of each robot (the paper's table 1).";
  add_group(table, "", {"Robot"});
  add_group(table, "Ours", {"Path length (m)", "Time (s)", "Avg speed (m/s)", "Scans", "Keyframes"});
  if (paper == PaperFigures::show)
    add_group(table, "Paper", {"Path length (m)", "Time (s)", "Avg speed (m/s)"});
  for (const RobotResult& robot : study.robots) {
    Row row = {short_name(robot.name),
               format("{:.2f}", robot.path_length_m),
               format("{:.2f}", robot.duration_s),
               format("{:.2f}", robot.speed_mean_mps()),
               format("{}", robot.scans),
               format("{}", robot.keyframes)};
    if (paper == PaperFigures::show) {
      const auto theirs = std::find_if(paper::kRobots.begin(), paper::kRobots.end(),
                                       [&](const paper::RobotRow& r) { return r.robot == row.front(); });
      add_cells(row, theirs == paper::kRobots.end()
                         ? Row{"", "", ""}
                         : Row{format("{:.2f}", theirs->path_length_m), format("{:.2f}", theirs->duration_s),
                               format("{:.2f}", theirs->speed_mps)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table outliers_before_pcm_table(const StudyResult& study, PaperFigures paper) {
  Table table;
  table.title = "Outliers before PCM";
  table.caption =
      "Per cent of wrong loops among all loops found, before PCM: PR, a wrong place; PCR, the right place "
      "but a wrong registration. - stands for 0, none for a pair without a loop (the paper's table 2).";
  fill_outliers(table, study, {&counts_before, &paper::PairRow::all_before, &paper::PairRow::filtered_before},
                paper);
  return table;
}

Table outliers_after_pcm_table(const StudyResult& study, PaperFigures paper) {
  Table table;
  table.title = "Outliers after PCM";
  table.caption =
      "Per cent of wrong loops among the loops that PCM kept: PR, a wrong place; PCR, the right place but a "
      "wrong registration. - stands for 0, none for a pair without a loop (the paper's table 3).";
  fill_outliers(table, study, {&counts_after, &paper::PairRow::all_after, &paper::PairRow::filtered_after},
                paper);
  return table;
}

Table success_table(const StudyResult& study, PaperFigures paper) {
  Table table;
  table.title = "Success of the merge";
  table.caption =
      "✓ both robots end with a largest ATE below 1 % of their path; ✗ merged with a larger error; ○ not "
      "merged, for a stated reason (the paper's table 4).";
  add_group(table, "", {"Robot pair", "PCM"});
  std::vector<std::string> headings;
  for (const std::string& policy : policies_of(study)) headings.push_back(policy_title(policy));
  if (!headings.empty()) add_group(table, "Ours", headings);
  if (paper == PaperFigures::show) add_group(table, "Paper", {"All KF", "Tunnel-filtered KF"});
  add_success_rows(table, study, paper, false);
  add_success_rows(table, study, paper, true);
  std::erase_if(table.rows, [&](const Row& row) {  // a half of the table that was not run
    return std::all_of(row.begin() + 2, row.begin() + 2 + static_cast<std::ptrdiff_t>(headings.size()),
                       [](const std::string& cell) { return cell.empty(); });
  });
  return table;
}

Table max_ate_table(const StudyResult& study, PaperFigures paper) {
  Table table;
  table.title = "Largest ATE";
  table.caption =
      "Largest ATE in metres of both robots of a pair, with PCM, after one alignment of both together; ○ not "
      "merged, each robot after its own alignment (the paper's table 5).";
  add_group(table, "", {"Robot pair"});
  const std::vector<std::string> policies = policies_of(study);
  for (const std::string& policy : policies)
    add_group(table, policy_title(policy), {"1st robot", "2nd robot"});
  if (paper == PaperFigures::show) add_group(table, "Paper: Tunnel-filtered KF", {"1st robot", "2nd robot"});
  for (const auto& pair : pairs_of(study)) {
    Row row = {pair_name(pair)};
    for (const std::string& policy : policies)
      add_cells(row, max_ate_cells(find_pair(study, pair, policy, true)));
    if (paper == PaperFigures::show) {
      const paper::PairRow* theirs = paper_row(row.front());
      add_cells(row, theirs == nullptr ? Row{"", ""}
                                       : Row{format("{:.3f}", theirs->max_ate_m[0]),
                                             format("{:.3f}", theirs->max_ate_m[1])});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table odometry_table(const StudyResult& study) {
  Table table;
  table.title = "Odometry";
  table.caption =
      "ATE of each odometry after the robot's own alignment; the largest also as per cent of the path. Time "
      "is the median per scan.";
  table.header = {"Robot", "Method", "Max (m)", "RMSE (m)", "Median (m)", "Max / path (%)", "ms / scan"};
  for (const RobotResult& robot : study.robots) {
    for (const OdometryResult& odometry : robot.odometry) {
      Row row = {short_name(robot.name), odometry.title()};
      add_cells(row, odometry_cells(odometry, robot.path_length_m));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Table joint_table(const StudyResult& study) {
  Table table;
  table.title = "All robots jointly";
  table.header = {"Robot",          "Shared map",   "Max ATE (m)",      "RMSE (m)", "Max / path (%)",
                  "Map median (m)", "Map 95 % (m)", "Map complete (%)", "Sent (MB)"};
  if (!study.joint) return table;
  const JointResult& joint = *study.joint;
  table.caption = format(
      "All robots merged at once ({}): {} loops, {} of them wrong and in use. ATE after one alignment of "
      "each shared map. Map: distance of the shared map's points from the true surface after that alignment, "
      "and "
      "how much of the surface that could have been seen lies within 10 cm of it.",
      policy_title(joint.keyframes), joint.loops.total, joint.wrong_loops_in_solution);
  for (std::size_t i = 0; i < joint.robots.size(); ++i) {
    const MergedRobot& robot = joint.robots[i];
    const std::optional<double> ratio = robot.ate_max_over_path_pct();
    const bool counted = i < joint.bytes_sent_per_robot.size();
    Row row = {short_name(robot.name), map_of(joint, robot.name),
               robot.ate ? format("{:.3f}", robot.ate->max_m) : "",
               robot.ate ? format("{:.3f}", robot.ate->rmse_m) : "", ratio ? format("{:.2f}", *ratio) : ""};
    add_cells(row, map_cells(joint, robot.name));
    row.push_back(counted ? format("{:.2f}", 1e-6 * static_cast<double>(joint.bytes_sent_per_robot[i])) : "");
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Table> study_tables(const StudyResult& study, PaperFigures paper) {
  std::vector<Table> tables = {trajectories_table(study, paper)};
  if (!study.pairs.empty()) {
    tables.push_back(outliers_before_pcm_table(study, paper));
    tables.push_back(outliers_after_pcm_table(study, paper));
    tables.push_back(success_table(study, paper));
    tables.push_back(max_ate_table(study, paper));
  }
  const bool has_odometry = std::any_of(study.robots.begin(), study.robots.end(),
                                        [](const RobotResult& robot) { return !robot.odometry.empty(); });
  if (has_odometry) tables.push_back(odometry_table(study));
  if (study.joint) tables.push_back(joint_table(study));
  return tables;
}

}  // namespace adit
