// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/full_rate.hpp"
#include "adit/robot/keyframe_trajectory.hpp"
#include "command_line.hpp"
#include "inputs.hpp"
#include "outputs.hpp"
#include "sessions.hpp"

namespace adit::app {
namespace {

struct LocalizeOptions {
  std::string session;
  std::string input;
  std::string out;
  RecordingConfig recording;
};

/// Why the robot was not merged with each of the session's.
std::vector<std::string> refusals(const Session& session, RobotId robot) {
  std::vector<std::string> out;
  for (const PairOutcome& pair : session.solution.pairs)
    if (!pair.merged && (pair.a == robot || pair.b == robot))
      out.push_back(
          format("{}: {}", session.name_of(pair.a == robot ? pair.b : pair.a), pair.refused_reason));
  return out;
}

std::string trajectory_in(const std::string& session, const std::string& robot) {
  return (std::filesystem::path(session) / robot / "trajectory.tum").string();
}

/// Where the robot was at its keyframes, in `out`, and at every scan, beside it. Returns the paths.
Result<std::vector<std::string>> write_followed(const std::string& out, const RobotMap& robot,
                                                const std::vector<Pose>& T_world_keyframe) {
  const std::string of_scans = path_beside(out, "_scans").string();
  return write_tum(out, keyframe_trajectory(robot, T_world_keyframe))
      .and_then([&] { return write_tum(of_scans, at_every_scan(robot, T_world_keyframe)); })
      .map([&] {
        return std::vector<std::string>{out, of_scans};
      });
}

Result<> localize_command(const LocalizeOptions& options, const Common& common) {
  const RecordingConfig reading = reading_of_new(common, options.recording);
  Result<SavedSessions> saved = open_sessions({options.session});
  if (!saved) return tl::unexpected(saved.error());
  const auto [name, path] = name_and_path(options.input);
  Result<Recording> recording = open_input(path, reading);
  if (!recording) return tl::unexpected(recording.error());
  if (!name.empty()) recording->name = name;
  const Result<SlamRun> run =
      slam_on(std::move(saved->fleets), {std::move(*recording)}, saved->job.config.slam);
  if (!run) return tl::unexpected(run.error());
  const auto known = std::ranges::find(run->repeated, false, &RepeatedRobot::was_saved);
  if (known != run->repeated.end())
    return fail(format("{} is the recording of {} in {}; where that robot was says {}", path, known->same_as,
                       options.session, trajectory_in(options.session, known->same_as)));
  print_notes("localize", run->notes);
  const Session& session = run->session;
  const RobotMap& robot = *session.maps.back();  // new robots come last
  const auto component = std::ranges::find_if(session.solution.components, [&](const Component& c) {
    return std::ranges::find(c.robots, robot.id) != c.robots.end();
  });
  if (component == session.solution.components.end() || component->robots.size() < 2) {
    std::string reasons;
    for (const std::string& refusal : refusals(session, robot.id)) reasons += "; " + refusal;
    return fail(format("{} was not found in {}{}", robot.name, options.session, reasons));
  }
  Result<std::vector<std::string>> written;
  if (!options.out.empty())
    written = write_followed(options.out, robot, session.solution.T_world_keyframe.at(robot.id));
  if (!written) return tl::unexpected(written.error());
  const std::string& frame = session.name_of(component->anchor);
  nlohmann::ordered_json json{{"robot", robot.name},
                              {"frame_of", frame},
                              {"keyframes", robot.keyframes.size()},
                              {"scans", robot.odometry.size()}};
  json["found_by"] = nlohmann::ordered_json::array();
  if (!common.json)
    std::printf("%s was found in %s: %zu keyframes in the frame of %s's odometry\n", robot.name.c_str(),
                options.session.c_str(), robot.keyframes.size(), frame.c_str());
  for (const PairOutcome& pair : session.solution.pairs) {
    if (!pair.merged || (pair.a != robot.id && pair.b != robot.id)) continue;
    const std::string& other = session.name_of(pair.a == robot.id ? pair.b : pair.a);
    json["found_by"].push_back(other);
    if (!common.json)
      std::printf("  by the map of %s%s\n", other.c_str(),
                  pair.accuracy ? (": " + to_string(*pair.accuracy)).c_str() : "");
  }
  if (!written->empty()) json["written"] = *written;
  if (common.json)
    std::printf("%s\n", json_text(json, 2).c_str());
  else if (!written->empty())
    std::printf("written: %s\n", format("{}", fmt::join(*written, ", ")).c_str());
  return {};
}

}  // namespace

void add_localize(Program& program) {
  const auto options = std::make_shared<LocalizeOptions>();
  const Command command =
      program.add_command("localize", "Find a robot in the map of a session and follow it, or say why not",
                          [options](const Common& common) { return localize_command(*options, common); });
  command.add_option("session", options->session, "Session directory").required();
  command.add_option("input", options->input, "Recording or folder of scans, NAME=FILE to name the robot")
      .required();
  command
      .add_option("--out", options->out,
                  "TUM file for where the robot was at its keyframes, in the frame of the map; beside it, "
                  "with _scans at the end of its name, one for every scan")
      .check(trajectory_name_fault);
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
  command.footer("The session stays as it is; adit slam --session adds the robot to it.");
}

}  // namespace adit::app
