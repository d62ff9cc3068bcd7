// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <memory>
#include <utility>

#include "command_line.hpp"
#include "outputs.hpp"
#include "sessions.hpp"

namespace adit::app {
namespace {

struct MergeOptions {
  std::vector<std::string> sessions;
  std::string out;
  RulingOptions rulings;
  ControlOptions control;
};

Result<> merge_command(const MergeOptions& options, const Common& common) {
  refuse_configuration(common);
  if (options.sessions.size() < 2) usage_error("give two sessions or more");
  const Result<Control> control = read_control(options.control);
  if (!control) return tl::unexpected(control.error());
  Result<SavedSessions> saved = open_sessions(options.sessions);
  if (!saved) return tl::unexpected(saved.error());
  std::vector<std::string> names;
  for (const SavedFleet& fleet : saved->fleets)
    for (const auto& map : fleet.maps) names.push_back(map->name);
  if (const Result<> kept = check_keeps_robots(options.out, names); !kept) return kept;
  Result<OutputDir> out = OutputDir::create(options.out, "session");
  if (!out) return tl::unexpected(out.error());
  saved->job.provenance.command = common.command;
  Result<SlamRun> run =
      slam_on(std::move(saved->fleets), {}, saved->job.config.slam, rulings_of(options.rulings));
  if (!run) return tl::unexpected(run.error());
  print_notes("merge", run->notes);
  return finish_session(std::move(*run), std::move(saved->job), *out, options.out, common.json, *control,
                        "merge");
}

}  // namespace

void add_merge(Program& program) {
  const auto options = std::make_shared<MergeOptions>();
  const Command command =
      program.add_command("merge", "Join sessions that others mapped: their robots meet, by the same test",
                          [options](const Common& common) { return merge_command(*options, common); });
  command.add_option("sessions", options->sessions, "Session directories").required();
  command.add_option("--out", options->out, "Session directory to write").required();
  add_ruling_options(command, options->rulings);
  add_control_options(command, options->control);
  command.footer(
      "Robots of one session do not meet again. Of robots that are called alike the later ones get a "
      "number. A robot that both sessions hold, with the same map, counts once, with a note.");
}

}  // namespace adit::app
