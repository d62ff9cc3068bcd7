// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>

#include "adit/io/tum.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/slam/session_evaluation.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

struct EvaluateOptions {
  std::string session;
  std::vector<std::string> truths;
};

Result<std::vector<GivenTruth>> read_truths(const std::vector<std::string>& files) {
  std::vector<GivenTruth> given;
  for (const std::string& file : files) {
    const auto [robot, path] = name_and_path(file);
    Result<Trajectory> truth = read_tum(path);
    if (!truth) return tl::unexpected(truth.error());
    given.push_back({path, robot, std::move(*truth)});
  }
  return given;
}

Result<> evaluate_command(const EvaluateOptions& options, const Common& common) {
  const Result<SavedSession> session = read_session(options.session);
  if (!session) return tl::unexpected(session.error());
  const Result<std::vector<GivenTruth>> given = read_truths(options.truths);
  if (!given) return tl::unexpected(given.error());
  const auto truths = match_truths(*session, *given);
  if (!truths) return tl::unexpected(truths.error());
  for (std::size_t i = 0; i < truths->size(); ++i)
    if (!(*truths)[i]) print_notes("evaluate", {session->robots[i] + " has no truth and is left out"});
  const Result<SessionEvaluation> evaluation = evaluate(*session, *truths);
  if (!evaluation) return tl::unexpected(evaluation.error());
  if (common.json) {
    std::printf("%s\n", json_of(*evaluation).c_str());
  } else {
    for (const Table& table : tables_of(*evaluation)) std::printf("%s\n", text_of(table).c_str());
  }
  const Result<> saved = save_evaluation(options.session, *evaluation);
  if (!saved) print_notes("evaluate", {"the session itself is unchanged: " + saved.error().message});
  return {};
}

}  // namespace

void add_evaluate(Program& program) {
  const auto options = std::make_shared<EvaluateOptions>();
  const Command command = program.add_command(
      "evaluate", "Compute ATE, RPE and loop precision of a session from the true trajectories",
      [options](const Common& common) { return evaluate_command(*options, common); });
  command.add_option("session", options->session, "Session directory of adit slam").required();
  command
      .add_option("--truth", options->truths,
                  "True trajectories (TUM) in any order, each named after its robot (robot_0.tum, "
                  "robot_0_truth.tum, robot_0/truth.tum) or given as NAME=FILE")
      .required();
  command.footer(
      "Writes the class of each loop into loops.csv of the session, and the errors into its metrics.json.");
}

}  // namespace adit::app
