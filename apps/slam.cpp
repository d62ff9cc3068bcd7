// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/report/html_report.hpp"
#include "inputs.hpp"
#include "joint_pictures.hpp"
#include "progress.hpp"
#include "study_run.hpp"

namespace adit::app {
namespace {

struct Options {
  RecordingConfig recording;
  std::vector<std::string> inputs;
  std::string out;
  std::string lidar = "os2-128";
  std::string keyframes = "adaptive";
};

Result<std::vector<std::shared_ptr<const RobotMap>>> map_robots(const std::vector<Recording>& recordings,
                                                                const RobotSlamConfig& config,
                                                                KeyframeSelection selection) {
  std::size_t num_scans = 0;
  for (const Recording& recording : recordings) num_scans += recording.num_scans();
  Progress progress("scans", num_scans);
  std::vector<Result<RobotMap>> maps(recordings.size(), fail("not run"));
  parallel_for_each(recordings.size(), [&](std::size_t i) {
    RobotSlamConfig own = config;
    if (recordings[i].wheel.empty()) own.odometry.method = OdometryMethod::kiss_icp;  // nothing else to go by
    maps[i] = map_recording(recordings[i], {static_cast<std::uint8_t>(i)}, own, [&](std::size_t) {
      progress.advance();
      return !interrupted();
    });
  });
  std::vector<std::shared_ptr<const RobotMap>> selected;
  for (Result<RobotMap>& map : maps) {
    if (!map) return tl::unexpected(map.error());
    selected.push_back(std::make_shared<const RobotMap>(select_keyframes(*map, selection)));
  }
  return selected;
}

void print_summary(const Session& session, const std::vector<std::uint64_t>& bytes_sent) {
  for (std::size_t i = 0; i < session.maps.size(); ++i) {
    const RobotMap& map = *session.maps[i];
    const auto own_loops = std::ranges::count_if(session.solution.loops, [&](const LoopOutcome& loop) {
      return loop.in_use() && loop.loop.from.robot == map.id && loop.loop.to.robot == map.id;
    });
    std::printf(
        "%s: %zu scans, %zu keyframes, %td loops of its own, %d degenerate and %d refused steps, %.2f MB "
        "sent\n",
        map.name.c_str(), map.odometry.size(), map.keyframes.size(), own_loops, map.num_degenerate,
        map.num_refused, static_cast<double>(bytes_sent[i]) * 1e-6);
  }
  const auto name = [&](RobotId id) { return session.fleet.robots.at(id).name; };
  for (const PairOutcome& pair : session.solution.pairs) {
    int in_use = 0;
    for (const LoopOutcome& loop : session.solution.loops) {
      in_use += loop.in_use() && loop.loop.from.robot == pair.a && loop.loop.to.robot == pair.b ? 1 : 0;
    }
    std::printf("%s and %s: %s\n", name(pair.a).c_str(), name(pair.b).c_str(),
                pair.merged ? format("merged by {} of {} loops", in_use, pair.num_loops).c_str()
                            : ("not merged: " + pair.refused_reason).c_str());
  }
}

nlohmann::ordered_json summary_json(const Session& session, const std::vector<std::uint64_t>& bytes_sent) {
  nlohmann::ordered_json json;
  const auto name = [&](RobotId id) { return session.fleet.robots.at(id).name; };
  for (std::size_t i = 0; i < session.maps.size(); ++i) {
    json["robots"].push_back({{"name", session.maps[i]->name},
                              {"scans", session.maps[i]->odometry.size()},
                              {"keyframes", session.maps[i]->keyframes.size()},
                              {"bytes_sent", bytes_sent[i]}});
  }
  for (const PairOutcome& pair : session.solution.pairs) {
    json["pairs"].push_back({{"robots", {name(pair.a), name(pair.b)}},
                             {"loops", pair.num_loops},
                             {"clique", pair.clique},
                             {"second_clique", pair.second_clique},
                             {"merged", pair.merged},
                             {"refused_reason", pair.refused_reason}});
  }
  return json;
}

/// A page without ground truth: what was merged, by which loops, and why or why not.
Result<> write_report(const std::filesystem::path& dir, const Session& session) {
  StudyResult page;
  page.version = version();
  page.seed = session.provenance.seed;
  page.configuration = session.provenance.configuration;
  page.command = session.provenance.command + format(" {}", fmt::join(session.provenance.inputs, " "));
  for (const auto& map : session.maps) page.robots.push_back(robot_facts(*map, {}));
  JointResult& joint = page.joint.emplace();
  const auto name = [&](RobotId id) { return session.fleet.robots.at(id).name; };
  for (const PairOutcome& pair : session.solution.pairs) {
    if (!pair.merged)
      joint.refusals.push_back(format("{} and {}: {}", name(pair.a), name(pair.b), pair.refused_reason));
  }
  joint.loop_map = loop_map(session.fleet, session.solution);
  joint.merges = merge_pictures(session.fleet, session.solution);
  return write_bytes(dir / "report.html", html_report(page, {}, study_figures(page)));
}

Result<> slam(const Options& options, const Common& common) {
  RunConfig config;
  if (const Result<> chosen = choose_lidar(options.lidar, config.simulation); !chosen)
    usage_error(chosen.error().message);
  const Result<KeyframeSelection> selection = keyframe_selection(options.keyframes);
  if (!selection) usage_error(selection.error().message);
  if (const Result<> configured = configure(fields_of(config), common); !configured) return configured;
  config = under(*selection, config);
  const Result<std::vector<Recording>> recordings =
      open_inputs(options.inputs, config.simulation, options.recording);
  if (!recordings) return tl::unexpected(recordings.error());
  Result<OutputDir> out = OutputDir::create(options.out, "session");
  if (!out) return tl::unexpected(out.error());
  catch_interrupts();
  const auto maps = map_robots(*recordings, config.robot, *selection);
  if (!maps) return tl::unexpected(maps.error());
  const Result<Meeting> meeting = hold_meeting(*maps, config);
  if (!meeting) return tl::unexpected(meeting.error());

  Session session;
  session.provenance = {"adit slam", options.inputs, config.simulation.seed, to_toml(fields_of(config))};
  session.maps = *maps;
  session.fleet = meeting->agents.front().known();
  session.solution = meeting->agents.front().solve(config.back_end);
  if (const Result<> written = write_session(out->path(), session, MapFiles::write); !written) return written;
  if (const Result<> written = write_report(out->path(), session); !written) return written;
  if (interrupted()) return fail("interrupted");
  if (const Result<> done = out->commit(); !done) return done;
  if (common.json) {
    std::printf("%s\n", summary_json(session, meeting->bytes_sent).dump().c_str());
  } else {
    print_summary(session, meeting->bytes_sent);
  }
  return {};
}

}  // namespace

void add_slam(Program& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = program.add_command("slam", "All robots given, merged decentrally, into one session",
                                          [options](const Common& common) { return slam(*options, common); });
  command->add_option("inputs", options->inputs, "Recordings, folders of scans, or one routes.yaml")
      ->required();
  command->add_option("--out", options->out, "Session directory to write")->required();
  command->add_option("--lidar", options->lidar, "Simulated LiDAR (routes.yaml only)")->capture_default_str();
  command->add_option("--keyframes", options->keyframes, "adaptive, all, tunnel_filter or tunnel_filter_keep")
      ->capture_default_str();
  add_recording_options(*command, options->recording);
}

}  // namespace adit::app
