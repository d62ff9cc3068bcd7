// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/slam.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/session_toml.hpp"
#include "command_line.hpp"
#include "inputs.hpp"
#include "outputs.hpp"
#include "policies.hpp"
#include "sessions.hpp"

namespace adit::app {
namespace {

struct SlamOptions {
  RecordingConfig recording;
  std::vector<std::string> inputs;
  std::string out;
  SimulationOptions simulation;
  std::string keyframes;
  std::string rerun;
  std::string session;
  RulingOptions rulings;
  ControlOptions control;
};

Result<Job> job_of(const SlamOptions& options, const Common& common) {
  if (options.inputs.empty())
    usage_error("give recordings, folders of scans, one routes.yaml, --session or --rerun");
  Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  if (!options.keyframes.empty()) config->slam.keyframes = *keyframe_selection(options.keyframes);
  config->recording = recording_config(config->recording, options.recording);
  Provenance provenance;
  provenance.command = common.command;
  provenance.inputs = options.inputs;
  provenance.profile = to_string(common.profile);
  provenance.settings = common.sets;
  return Job{*config, provenance};
}

bool is_default(RecordingConfig options) {
  RecordingConfig defaults;
  return to_toml(fields_of(options)) == to_toml(fields_of(defaults));
}

/// In what cannot change from step to step of a session.
bool is_changed(const SlamOptions& options) {
  return !options.simulation.lidar.empty() || !options.simulation.conditions.empty() ||
         !options.keyframes.empty();
}

/// The steps in which a session was made, as they can be typed. Where each wrote to is not recorded: one that
/// goes on writes to its session.
std::string steps_of(const Provenance& provenance) {
  std::vector<std::string> steps = provenance.earlier_commands;
  steps.push_back(provenance.command);
  for (std::string& step : steps)
    if (step.find(" --session ") == std::string::npos) step += " --out DIR";
  return format("{}", fmt::join(steps, "; "));
}

/// The job of an earlier session, from the provenance in its session.toml.
Result<Job> job_again(const SlamOptions& options, const Common& common) {
  if (!options.inputs.empty() || is_changed(options) || !is_default(options.recording) ||
      !common.sets.empty() || !common.config_file.empty() || common.profile != Profile::standard)
    usage_error("--rerun repeats a session as it was; give no inputs and no configuration with it");
  const Result<std::string> text = read_bytes(options.rerun);
  if (!text) return tl::unexpected(text.error());
  Result<SessionHeader> header = parse_session_toml(*text);
  if (!header) return fail(options.rerun, header.error());
  Job job;
  job.provenance = std::move(header->provenance);
  if (job.provenance.inputs.empty()) return fail(options.rerun + ": names no inputs; is it a session.toml?");
  const bool is_georeferenced =
      std::filesystem::exists(std::filesystem::path(options.rerun).parent_path() / "georeference.toml");
  if (!job.provenance.earlier_commands.empty())
    return fail(
        format("{}: this session was made in several steps; repeat them one by one, each DIR being the "
               "session that a later step names: {}{}",
               options.rerun, steps_of(job.provenance),
               is_georeferenced ? "; its georeference is not among them: adit georeference does it" : ""));
  const Result<std::vector<std::string>> not_taken =
      parse_saved_config(fields_of(job.config), job.provenance.configuration);
  if (!not_taken) return fail(options.rerun + ": configuration", not_taken.error());
  for (const std::string& setting : *not_taken)
    print_notes("slam", {format("{}: configuration, {}; this version does without", options.rerun, setting)});
  if (is_georeferenced)
    print_notes("slam", {format("{} is georeferenced; that is not repeated: adit georeference does it",
                                options.rerun)});
  if (header->version != version())
    print_notes("slam", {format("{} was made by adit {}, and this is {}: results may differ", options.rerun,
                                header->version, version())});
  return job;
}

/// Fails where `path` holds robots that are neither in the sessions to go on from nor to be mapped. One that
/// cannot be opened counts as meant, too.
Result<> check_loses_no_robot(const std::string& path, const std::vector<SavedFleet>& saved,
                              const Inputs& inputs) {
  std::vector<std::string> names;
  for (const SavedFleet& fleet : saved)
    for (const auto& map : fleet.maps) names.push_back(map->name);
  for (const Recording& recording : inputs.recordings) names.push_back(recording.name);
  for (const FailedRobot& robot : inputs.failed)
    names.push_back(robot.name.substr(robot.name.rfind('/') + 1));  // a namespace
  return check_keeps_robots(path, names);
}

/// Maps recordings, opened as `reading` says; the robots of earlier sessions, if any, come first.
Result<> run_job(Job job, const RunConfig& reading, const std::vector<std::string>& paths,
                 std::vector<SavedFleet> saved, const SlamOptions& options, bool json) {
  const std::string& to = options.out.empty() ? options.session : options.out;
  const Result<Control> control = read_control(options.control);
  if (!control) return tl::unexpected(control.error());
  Result<Inputs> inputs = open_inputs(paths, reading);
  if (!inputs) return tl::unexpected(inputs.error());
  if (const Result<> kept = check_loses_no_robot(to, saved, *inputs); !kept) return kept;
  Result<OutputDir> out = OutputDir::create(to, "session");
  if (!out) return tl::unexpected(out.error());
  if (!inputs->world.empty()) job.provenance.world = inputs->world;
  Result<SlamRun> run =
      slam_on(std::move(saved), std::move(inputs->recordings), job.config.slam, rulings_of(options.rulings));
  if (!run && !inputs->failed.empty())
    return fail(format("{}; {}", run.error().message, reasons_of(inputs->failed)));
  if (!run) return tl::unexpected(run.error());
  std::ranges::move(inputs->failed, std::back_inserter(run->failed));
  print_notes("slam", run->notes);
  return finish_session(std::move(*run), std::move(job), *out, to, json, *control, "slam");
}

Result<> go_on(const SlamOptions& options, const Common& common) {
  // How the new recordings are read is their own matter.
  const RecordingConfig recording = reading_of_new(common, options.recording);
  if (is_changed(options) || !options.rerun.empty())
    usage_error("a session goes on as it began; give recordings and how to read them, nothing else");
  if (options.inputs.empty() && options.rulings.empty())
    usage_error("give recordings to add to the session, or --veto, --confirm or --withdraw");
  Result<SavedSessions> saved = open_sessions({options.session});
  if (!saved) return tl::unexpected(saved.error());
  Job& job = saved->job;
  job.provenance.command = common.command;
  job.provenance.inputs.insert(job.provenance.inputs.end(), options.inputs.begin(), options.inputs.end());
  RunConfig reading = job.config;
  reading.recording = recording;
  return run_job(std::move(job), reading, options.inputs, std::move(saved->fleets), options, common.json);
}

Result<> slam_command(const SlamOptions& options, const Common& common) {
  if (!options.session.empty()) return go_on(options, common);
  if (options.out.empty()) usage_error("--out is required: the session directory to write");
  if (!options.rulings.empty())
    usage_error(
        "--veto, --confirm and --withdraw rule over what a session has found; give it with --session");
  Result<Job> job = options.rerun.empty() ? job_of(options, common) : job_again(options, common);
  if (!job) return tl::unexpected(job.error());
  job->provenance.seed = job->config.simulation.seed;
  const std::vector<std::string> inputs = job->provenance.inputs;
  return run_job(*job, job->config, inputs, {}, options, common.json);
}

}  // namespace

void add_slam(Program& program) {
  const auto options = std::make_shared<SlamOptions>();
  const Command command =
      program.add_command("slam", "Map each robot, merge the maps decentrally, write one session",
                          [options](const Common& common) { return slam_command(*options, common); });
  command.add_option("inputs", options->inputs,
                     "Recordings or folders of scans, NAME=FILE to name the robot; or one routes.yaml, "
                     "simulated on the fly");
  command.add_option("--out", options->out,
                     "Session directory to write; with --session that one, where none is given");
  command.add_option(
      "--session", options->session,
      "Session to go on from: its robots stay, the inputs are added as further robots or visits, "
      "and nothing is computed again that is known");
  add_simulation_options(command, options->simulation);
  command.add_option("--keyframes", options->keyframes, "Keyframe policy (default: adaptive)")
      .one_of(policy_names());
  command.add_option("--rerun", options->rerun,
                     "session.toml of a session to reproduce byte for byte from the same inputs");
  add_ruling_options(command, options->rulings, "--session");
  add_control_options(command, options->control);
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
  command.add_flag(
      "--namespaces", options->recording.namespaces,
      "A bag has several robots: one in every namespace with clouds (/husky1/points, /husky2/points)");
  command.footer(
      "A recording that cannot be mapped is reported with the reason; the others go on, and the exit code is "
      "1. One that is there twice, or in the session already, counts once, with a note.");
}

}  // namespace adit::app
