// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/slam.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/session_toml.hpp"
#include "adit/slam/session_pages.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

struct SlamOptions {
  RecordingConfig recording;
  std::vector<std::string> inputs;
  std::string out;
  SimulationOptions simulation;
  std::string keyframes;
  std::string rerun;
};

/// What is to run, and the provenance that the session will state.
struct Job {
  RunConfig config;
  Provenance provenance;
};

Result<Job> job_of(const SlamOptions& options, const Common& common) {
  if (options.inputs.empty()) usage_error("give recordings, folders of scans, one routes.yaml, or --rerun");
  Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  if (!options.keyframes.empty()) {
    const Result<KeyframeSelection> keyframes = keyframe_selection(options.keyframes);
    if (!keyframes) usage_error(keyframes.error().message);
    config->slam.keyframes = *keyframes;
  }
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

/// The job of an earlier session, from the provenance in its session.toml.
Result<Job> job_again(const SlamOptions& options, const Common& common) {
  if (!options.inputs.empty() || !options.simulation.lidar.empty() ||
      !options.simulation.conditions.empty() || !options.keyframes.empty() ||
      !is_default(options.recording) || !common.sets.empty() || !common.config_file.empty() ||
      common.profile != Profile::standard)
    usage_error("--rerun repeats a session as it was; give no inputs and no configuration with it");
  const Result<std::string> text = read_bytes(options.rerun);
  if (!text) return tl::unexpected(text.error());
  Result<SessionHeader> header = parse_session_toml(*text);
  if (!header) return fail(options.rerun, header.error());
  Job job;
  job.provenance = std::move(header->provenance);
  if (job.provenance.inputs.empty()) return fail(options.rerun + ": names no inputs; is it a session.toml?");
  const Result<> set = parse_config(fields_of(job.config), job.provenance.configuration);
  if (!set) return fail(options.rerun + ": configuration", set.error());
  if (header->version != version())
    print_notes("slam", {format("{} was made by adit {}, and this is {}: results may differ", options.rerun,
                                header->version, version())});
  return job;
}

std::string slips_of(const RobotMap& map) {
  double metres = 0.0;
  for (const SlipStretch& slip : map.slips) metres += std::abs(slip.counted_m);
  return map.slips.empty() ? "" : format(", wheels slipped {} times by {:.1f} m", map.slips.size(), metres);
}

void print_robots(const SlamRun& run) {
  const Session& session = run.session;
  for (std::size_t i = 0; i < session.maps.size(); ++i) {
    const RobotMap& map = *session.maps[i];
    const auto own_loops = std::ranges::count_if(session.solution.loops, [&](const LoopOutcome& loop) {
      return loop.in_use() && loop.loop.from.robot == map.id && loop.loop.to.robot == map.id;
    });
    std::printf(
        "%s: %zu scans, %zu keyframes, %td loops of its own, %d degenerate and %d refused steps%s, %.2f MB "
        "sent\n",
        map.name.c_str(), map.odometry.size(), map.keyframes.size(), own_loops, map.num_degenerate,
        map.num_refused, slips_of(map).c_str(), static_cast<double>(run.bytes_sent[i]) * 1e-6);
  }
}

void print_pairs(const Session& session) {
  const auto name = [&](RobotId id) { return session.fleet.robots.at(id).name; };
  for (const PairOutcome& pair : session.solution.pairs) {
    int in_use = 0;
    for (const LoopOutcome& loop : session.solution.loops)
      in_use += loop.in_use() && loop.loop.from.robot == pair.a && loop.loop.to.robot == pair.b ? 1 : 0;
    std::printf("%s and %s: %s\n", name(pair.a).c_str(), name(pair.b).c_str(),
                pair.merged ? format("merged by {} of {} loops{}", in_use, pair.num_loops,
                                     pair.accuracy ? ", " + to_string(*pair.accuracy) : "")
                                  .c_str()
                            : ("not merged: " + pair.refused_reason).c_str());
  }
}

/// The session is written all the same, so this error is printed last.
Result<> without_failures(const SlamRun& run, const std::string& out) {
  if (run.failed.empty()) return {};
  std::string reasons;
  for (const FailedRobot& robot : run.failed) reasons += "; " + robot.reason;
  return fail(format("{} of {} recordings could not be mapped and are missing in {}{}", run.failed.size(),
                     run.failed.size() + run.session.maps.size(), out, reasons));
}

Result<> slam_command(const SlamOptions& options, const Common& common) {
  Result<Job> job = options.rerun.empty() ? job_of(options, common) : job_again(options, common);
  if (!job) return tl::unexpected(job.error());
  Result<Inputs> inputs = open_inputs(job->provenance.inputs, job->config);
  if (!inputs) return tl::unexpected(inputs.error());
  Result<OutputDir> out = OutputDir::create(options.out, "session");
  if (!out) return tl::unexpected(out.error());
  Result<SlamRun> run = slam(std::move(inputs->recordings), job->config.slam);
  if (!run) return tl::unexpected(run.error());
  print_notes("slam", run->notes);
  job->provenance.world = inputs->world;
  job->provenance.seed = job->config.simulation.seed;
  job->provenance.configuration = to_toml(fields_of(job->config));
  job->provenance.robots = run->session.provenance.robots;
  run->session.provenance = job->provenance;
  Result<> done = write_slam(out->path(), *run);
  if (done) done = out->commit();
  if (!done) return done;
  if (common.json) {
    std::printf("%s", session_metrics(*run).c_str());
  } else {
    print_robots(*run);
    print_pairs(run->session);
  }
  return without_failures(*run, options.out);
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
  command.add_option("--out", options->out, "Session directory to write").required();
  add_simulation_options(command, options->simulation);
  command.add_option("--keyframes", options->keyframes,
                     "Keyframe policy: adaptive (default), all, tunnel_filter or tunnel_filter_keep");
  command.add_option("--rerun", options->rerun,
                     "session.toml of a session to reproduce byte for byte from the same inputs");
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
  command.add_flag(
      "--namespaces", options->recording.namespaces,
      "A bag has several robots: one in every namespace with clouds (/husky1/points, /husky2/points)");
  command.footer(
      "A recording that cannot be mapped is reported with the reason; the others go on, and the exit code is "
      "1.");
}

}  // namespace adit::app
