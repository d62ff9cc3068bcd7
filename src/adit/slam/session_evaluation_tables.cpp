// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The tables of an evaluation.
#include "adit/core/format.hpp"
#include "adit/slam/session_evaluation.hpp"

namespace adit {
namespace {

using Row = std::vector<std::string>;

template <class Errors>
std::string metres(const std::optional<Errors>& errors, double Errors::*field) {
  return errors ? format("{:.3f}", (*errors).*field) : "-";
}

Table robot_table(const SessionEvaluation& evaluation) {
  Table table;
  table.title = "Trajectory errors";
  table.caption = "ATE after one alignment of all robots that share a map; RPE over 10 m.";
  table.header = {"Robot", "ATE max (m)", "ATE rmse (m)", "Odometry ATE max (m)", "RPE median (m)"};
  for (const RobotErrors& robot : evaluation.robots)
    table.rows.push_back({robot.name, metres(robot.joint, &AteResult::max_m),
                          metres(robot.joint, &AteResult::rmse_m), metres(robot.odometry, &AteResult::max_m),
                          metres(robot.relative, &RpeResult::translation_median_m)});
  return table;
}

Table loop_table(const SessionEvaluation& evaluation) {
  Table table;
  table.title = "Loops";
  table.caption =
      "Classes as in the paper. Wrong place: the keyframes are more than 10 m apart. Wrong registration: the "
      "transform errs by more than 1 m or 15 degrees.";
  table.header = {"Stage", "Loops", "Correct", "Wrong place", "Wrong registration", "Precision (%)"};
  const auto row = [&](const std::string& stage, const LoopCounts& counts) {
    table.rows.push_back(
        {stage, format("{}", counts.total), format("{}", counts.correct()), format("{}", counts.wrong_place),
         format("{}", counts.wrong_registration),
         counts.total == 0 ? "-" : format("{:.1f}", 100.0 * counts.correct() / counts.total)});
  };
  row("registered", evaluation.registered);
  row("after PCM", evaluation.consistent);
  row("in use", evaluation.in_use);
  return table;
}

Row map_row(const std::string& robots, const std::optional<MapAccuracy>& map) {
  if (!map) return {robots, "-", "-", "-", "-", "-"};
  return {robots,
          format("{}", map->num_points),
          format("{:.3f}", map->median_m),
          format("{:.3f}", map->p95_m),
          map->completeness ? format("{:.1f}", 100.0 * *map->completeness) : "-",
          map->completeness ? format("{:.0f}", map->seen_m2) : "-"};
}

Table empty_map_table() {
  Table table;
  table.title = "Map against the true surface";
  table.caption =
      "Distance of the map's points from the surface, and how much of the surface that could have been seen "
      "from "
      "the true path lies within 10 cm of them.";
  table.header = {"Map", "Points", "Median (m)", "95 % (m)", "Complete (%)", "Could be seen (m²)"};
  return table;
}

}  // namespace

std::vector<Table> tables_of(const SessionEvaluation& evaluation) {
  std::vector<Table> tables = {robot_table(evaluation), loop_table(evaluation)};
  if (evaluation.maps.empty()) return tables;
  Table& maps = tables.emplace_back(empty_map_table());
  for (std::size_t i = 0; i < evaluation.maps.size(); ++i)
    maps.rows.push_back(
        map_row(format("{}", fmt::join(evaluation.components.at(i), ", ")), evaluation.maps[i]));
  return tables;
}

Table table_of(const MapAccuracy& map, const std::string& name) {
  Table table = empty_map_table();
  table.rows.push_back(map_row(name, map));
  return table;
}

}  // namespace adit
