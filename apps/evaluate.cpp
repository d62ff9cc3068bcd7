// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/loop_stats.hpp"
#include "adit/evaluation/rpe.hpp"
#include "adit/evaluation/tables.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/tum.hpp"
#include "adit/report/text_tables.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct Options {
  std::string session;
  std::vector<std::string> truths;
};

struct RobotErrors {
  AteResult joint;     ///< After one alignment of the robot's whole component.
  AteResult odometry;  ///< Of the odometry alone, after its own alignment.
  std::optional<RpeResult> relative;
};

std::size_t index_of(const SavedSession& session, const std::string& robot) {
  return static_cast<std::size_t>(std::ranges::find(session.robots, robot) - session.robots.begin());
}

Result<std::vector<RobotErrors>> errors_of(const SavedSession& session,
                                           const std::vector<Trajectory>& truths) {
  std::vector<RobotErrors> errors(session.robots.size());
  for (const std::vector<std::string>& component : session.components) {
    std::vector<Trajectory> estimates;
    std::vector<Trajectory> component_truths;
    for (const std::string& robot : component) {
      estimates.push_back(session.optimized.at(index_of(session, robot)));
      component_truths.push_back(truths.at(index_of(session, robot)));
    }
    const Result<std::vector<AteResult>> joint = joint_ate(estimates, component_truths);
    if (!joint) return tl::unexpected(joint.error());
    for (std::size_t i = 0; i < component.size(); ++i)
      errors[index_of(session, component[i])].joint = (*joint)[i];
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Result<AteResult> odometry = ate(session.odometry[i], truths[i]);
    if (!odometry) return fail(session.robots[i], odometry.error());
    errors[i].odometry = *odometry;
    if (const Result<RpeResult> relative = rpe(session.optimized[i], truths[i]))
      errors[i].relative = *relative;
  }
  return errors;
}

struct LoopSummary {
  LoopCounts accepted;
  LoopCounts consistent;
  LoopCounts in_use;
};

Result<LoopSummary> loops_of(const SavedSession& session, const std::vector<Trajectory>& truths) {
  LoopSummary summary;
  for (const SavedLoop& saved : session.loops) {
    if (saved.loop.verdict != LoopVerdict::accepted) continue;
    const Result<Pose> from = pose_at(truths.at(index_of(session, saved.from_robot)), saved.from_stamp);
    const Result<Pose> to = pose_at(truths.at(index_of(session, saved.to_robot)), saved.to_stamp);
    if (!from) return fail(saved.from_robot, from.error());
    if (!to) return fail(saved.to_robot, to.error());
    const LoopClass loop_class = classify(saved.loop, *from, *to);
    summary.accepted.add(loop_class);
    if (saved.in_clique) summary.consistent.add(loop_class);
    if (saved.weight >= 0.5) summary.in_use.add(loop_class);
  }
  return summary;
}

Table robot_table(const SavedSession& session, const std::vector<RobotErrors>& errors) {
  Table table;
  table.title = "Trajectory errors";
  table.caption = "ATE after one alignment of all robots that share a map; RPE over 10 m.";
  table.header = {"Robot", "ATE max (m)", "ATE rmse (m)", "Odometry ATE max (m)", "RPE median (m)"};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    table.rows.push_back(
        {session.robots[i], format("{:.3f}", errors[i].joint.max_m), format("{:.3f}", errors[i].joint.rmse_m),
         format("{:.3f}", errors[i].odometry.max_m),
         errors[i].relative ? format("{:.3f}", errors[i].relative->translation_median_m) : "-"});
  }
  return table;
}

Table loop_table(const LoopSummary& summary) {
  Table table;
  table.title = "Loops";
  table.caption = "Classes after the paper: more than 10 m apart; more than 1 m or 15 degrees off.";
  table.header = {"Stage", "Loops", "Correct", "Wrong place", "Wrong registration", "Precision (%)"};
  const auto row = [&](const std::string& stage, const LoopCounts& counts) {
    table.rows.push_back(
        {stage, format("{}", counts.total), format("{}", counts.correct()), format("{}", counts.wrong_place),
         format("{}", counts.wrong_registration),
         counts.total == 0 ? "-" : format("{:.1f}", 100.0 * counts.correct() / counts.total)});
  };
  row("registered", summary.accepted);
  row("after PCM", summary.consistent);
  row("in use", summary.in_use);
  return table;
}

nlohmann::ordered_json counts_json(const LoopCounts& counts) {
  return {{"total", counts.total},
          {"correct", counts.correct()},
          {"wrong_place", counts.wrong_place},
          {"wrong_registration", counts.wrong_registration}};
}

nlohmann::ordered_json json_of(const SavedSession& session, const std::vector<RobotErrors>& errors,
                               const LoopSummary& loops) {
  nlohmann::ordered_json json;
  json["components"] = session.components;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    json["robots"].push_back({{"name", session.robots[i]},
                              {"ate_max_m", errors[i].joint.max_m},
                              {"ate_rmse_m", errors[i].joint.rmse_m},
                              {"odometry_ate_max_m", errors[i].odometry.max_m},
                              {"odometry_ate_rmse_m", errors[i].odometry.rmse_m}});
  }
  json["loops"] = {{"registered", counts_json(loops.accepted)},
                   {"after_pcm", counts_json(loops.consistent)},
                   {"in_use", counts_json(loops.in_use)}};
  return json;
}

Result<> evaluate(const Options& options, const Common& common) {
  const Result<SavedSession> session = read_session(options.session);
  if (!session) return tl::unexpected(session.error());
  if (options.truths.size() != session->robots.size()) {
    usage_error(format("{} has {} robots: give {} truth files, in this order: {}", options.session,
                       session->robots.size(), session->robots.size(), fmt::join(session->robots, ", ")));
  }
  std::vector<Trajectory> truths;
  for (const std::string& file : options.truths) {
    Result<Trajectory> truth = read_tum(file);
    if (!truth) return tl::unexpected(truth.error());
    truths.push_back(std::move(*truth));
  }
  const Result<std::vector<RobotErrors>> errors = errors_of(*session, truths);
  if (!errors) return tl::unexpected(errors.error());
  const Result<LoopSummary> loops = loops_of(*session, truths);
  if (!loops) return tl::unexpected(loops.error());
  if (common.json) {
    std::printf("%s\n", json_of(*session, *errors, *loops).dump().c_str());
  } else {
    std::printf("%s\n%s\n", text_of(robot_table(*session, *errors)).c_str(),
                text_of(loop_table(*loops)).c_str());
  }
  return {};
}

}  // namespace

void add_evaluate(Program& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_command("evaluate", "ATE, RPE and loop precision of a session",
                          [options](const Common& common) { return evaluate(*options, common); });
  command->add_option("session", options->session, "Session directory of adit slam")->required();
  command->add_option("--truth", options->truths, "True trajectory (TUM), one a robot in the session's order")
      ->required();
}

}  // namespace adit::app
