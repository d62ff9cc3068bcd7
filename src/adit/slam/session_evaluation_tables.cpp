// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The tables of an evaluation.
#include "adit/core/format.hpp"
#include "adit/slam/session_evaluation.hpp"

namespace adit {
namespace {

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

}  // namespace

std::vector<Table> tables_of(const SessionEvaluation& evaluation) {
  return {robot_table(evaluation), loop_table(evaluation)};
}

}  // namespace adit
