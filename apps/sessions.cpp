// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "sessions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/io/crs.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"
#include "adit/slam/georeference.hpp"
#include "adit/slam/kept_control.hpp"
#include "adit/slam/session_pages.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

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

/// The points that earlier sessions kept.
Control kept_of(const SlamRun& run, const std::string& command) {
  KeptControl kept = kept_control(run.georeferences);
  print_notes(command, kept.notes);
  return {std::move(kept.points), std::move(kept.crs)};
}

Result<> georeference_written(const std::string& path, const Control& control, bool json,
                              const std::string& command) {
  if (control.points.empty()) return {};
  const Result<std::vector<Georeference>> maps = georeference_session(path, control, command);
  if (!maps)
    return fail(
        format("{} was written, without a georeference: {}; adit georeference {} --control FILE sets one",
               path, maps.error().message, shell_quoted(path)));
  if (!json) print_georeferences(*maps);
  return {};
}

Result<> without_failures(const SlamRun& run, const std::string& out) {
  if (run.failed.empty()) return {};
  return fail(format("{} of {} recordings could not be mapped and are missing in {}; {}", run.failed.size(),
                     run.failed.size() + run.num_mapped, out, reasons_of(run.failed)));
}

/// "husky:12": a robot and, where it is stated, the index of its keyframe.
std::pair<std::string, std::optional<std::uint32_t>> end_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text, std::nullopt};
  const std::optional<std::size_t> index = parse_size(text.substr(colon + 1));
  if (!index || *index > std::numeric_limits<std::uint32_t>::max())
    usage_error(format("'{}': after the colon stands the number of a keyframe", text));
  return {text.substr(0, colon), static_cast<std::uint32_t>(*index)};
}

Ruling ruling_of(const std::string& pair, Ruling::Kind kind) {
  const std::size_t comma = pair.find(',');
  if (comma == std::string::npos || comma == 0 || comma + 1 == pair.size())
    usage_error(format("'{}' names no two robots; write A,B, or A:12,B:40 for a loop", pair));
  const auto [a, of_a] = end_of(pair.substr(0, comma));
  const auto [b, of_b] = end_of(pair.substr(comma + 1));
  if (of_a.has_value() != of_b.has_value())
    usage_error(format("'{}': a loop has a keyframe of both robots, A:12,B:40", pair));
  Ruling ruling{kind, a, b};
  if (of_a) ruling.loop = {*of_a, *of_b};
  return ruling;
}

}  // namespace

void refuse_configuration(const Common& common) {
  if (!common.sets.empty() || !common.config_file.empty() || common.profile != Profile::standard)
    usage_error("a session goes on with the configuration that it began with; give none");
}

RecordingConfig reading_of_new(const Common& common, const RecordingConfig& options) {
  const bool are_all_of_reading = std::ranges::all_of(
      common.sets, [](const std::string& entry) { return entry.starts_with("recording."); });
  if (!are_all_of_reading || !common.config_file.empty() || common.profile != Profile::standard)
    usage_error(
        "a session goes on with the configuration that it began with; --set takes recording.* alone, "
        "how the new recording is read");
  RunConfig config;
  set_fields(common.sets, fields_of(config));
  return recording_config(config.recording, options);
}

void add_ruling_options(const Command& command, RulingOptions& options, const std::string& needs) {
  const std::string repeatable = format("(repeatable{}{})", needs.empty() ? "" : "; needs ", needs);
  command.add_option(
      "--veto", options.vetoes,
      "Robots A,B whose loops join nothing, or the loop A:12,B:40 of two keyframes, whatever the test says " +
          repeatable);
  command.add_option(
      "--confirm", options.confirmed,
      "Robots A,B whose maps are joined by the best alignment that was found, or by that of the loop "
      "A:12,B:40, whatever the test says " +
          repeatable);
  command.add_option(
      "--withdraw", options.withdrawn,
      "Robots A,B over whom no ruling counts any more: what the test said last does " + repeatable);
}

std::vector<Ruling> rulings_of(const RulingOptions& options) {
  std::vector<Ruling> rulings;
  for (const std::string& pair : options.withdrawn) {
    rulings.push_back(ruling_of(pair, Ruling::Kind::withdraw));
    if (rulings.back().loop)
      usage_error(
          format("--withdraw {}: all rulings over two robots are withdrawn at once; write A,B", pair));
  }
  for (const std::string& pair : options.confirmed) rulings.push_back(ruling_of(pair, Ruling::Kind::confirm));
  for (const std::string& pair : options.vetoes) rulings.push_back(ruling_of(pair, Ruling::Kind::veto));
  return rulings;
}

Option add_control_options(const Command& command, ControlOptions& options) {
  command.add_option("--crs", options.crs,
                     "Coordinate system of the control points: a code such as EPSG:25833, or the name of a "
                     "grid of your own");
  return command.add_option("--control", options.file,
                            "Control points (CSV: name, x, y, z, sigma, and where each was seen)");
}

Result<Control> read_control(const ControlOptions& options) {
  if (options.file.empty()) {
    if (!options.crs.empty()) usage_error("--crs is the coordinate system of --control FILE; give both");
    return Control{};
  }
  if (const Result<std::string> known = crs_wkt(options.crs); !known) return tl::unexpected(known.error());
  return read_control_points(options.file).map([&](std::vector<ControlPoint> points) {
    return Control{std::move(points), options.crs};
  });
}

Result<std::vector<Georeference>> georeference_session(const std::string& path, const Control& control,
                                                       const std::string& command) {
  Result<Georeferencing> found = georeference(path, control.points, control.crs);
  if (!found) return tl::unexpected(found.error());
  print_notes(command, found->notes);
  return write_georeferences(path, found->maps).map([&] { return std::move(found->maps); });
}

void print_georeferences(const std::vector<Georeference>& maps) {
  for (const Georeference& map : maps) {
    std::printf(
        "%s: in %s by %td of %zu points; chi2 %.1f, expected %d; scale %+.0f ppm (standard deviation %.0f), "
        "not applied\n",
        format("{}", fmt::join(map.robots, ", ")).c_str(),
        map.crs.empty() ? "the target frame" : map.crs.c_str(),
        std::ranges::count(map.points, ControlUse::used, &JudgedControl::use), map.points.size(), map.chi2,
        map.redundancy, map.scale_ppm, map.scale_sigma_ppm);
    const Vector3& t = map.T_target_map.translation();
    std::printf(
        "  origin of the map %.3f %.3f %.3f m; the place known worst, %s at %s s, to %.3f m horizontally and "
        "%.3f m vertically\n",
        t.x(), t.y(), t.z(), map.far_end.robot.c_str(), stamp_text(map.far_end.stamp).c_str(),
        map.far_end.sigma_xy, map.far_end.sigma_z);
    for (const JudgedControl& point : map.points)
      std::printf("  %-12s %-12s residual %+.3f %+.3f %+.3f m, misfit %s\n", point.point.name.c_str(),
                  std::string(to_string(point.use)).c_str(), point.residual.x(), point.residual.y(),
                  point.residual.z(),
                  point.misfit ? format("{:.1f}", *point.misfit).c_str() : "cannot be judged");
  }
}

Result<> finish_session(SlamRun run, Job job, OutputDir& out, const std::string& path, bool json,
                        const Control& control, const std::string& command) {
  Result<> done = write_slam(out.path(), run, std::move(job));
  if (done) done = out.commit();
  if (!done) return done;
  if (json) {
    std::printf("%s", session_metrics(run).c_str());
  } else {
    print_robots(run);
    print_pairs(run.session);
  }
  const Control given = control.points.empty() ? kept_of(run, command) : control;
  const Result<> georeferenced = georeference_written(path, given, json, command);
  const Result<> complete = without_failures(run, path);
  if (complete || georeferenced) return complete ? georeferenced : complete;
  return fail(complete.error().message + "; " + georeferenced.error().message);
}

}  // namespace adit::app
