// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/mapping.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/robot_ids.hpp"
#include "adit/fleet/merge/scan_quality.hpp"
#include "adit/odometry/steady_motion.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/robot/sensor_checks.hpp"

namespace adit {
namespace {

/// What was found of one recording's sensors; what goes wrong meanwhile stops no other robot.
std::vector<std::string> sensor_notes(Recording& recording) {
  try {
    std::vector<std::string> notes;
    Recording sound = recording;
    for (const SensorFinding& finding : use_sound_sensors(sound)) notes.push_back(finding.sentence);
    recording = std::move(sound);
    return notes;
  } catch (const std::exception& error) {
    return {format("wheels and IMU could not be checked, and are used as they are: {}", error.what())};
  }
}

/// The recordings with what can be used of their wheels and IMUs, and a note per finding.
std::vector<Recording> with_sound_sensors(std::vector<Recording> recordings,
                                          std::vector<std::string>& notes) {
  const Phase phase("checking sensors", recordings.size());
  for (Recording& recording : recordings) {
    for (const std::string& note : sensor_notes(recording))
      notes.push_back(format("{}: {}", recording.name, note));
    phase.advance();
  }
  return recordings;
}

/// A note where a robot's scans are not as good as they should be.
void note_quality(const RobotMap& map, std::vector<std::string>& notes) {
  const double mean = mean_of_judged(map.unconfirmed).value_or(0.0);
  if (mean < kNotableUnconfirmed) return;
  notes.push_back(
      format("{}: {:.0f} % of the LiDAR's returns were confirmed by no other and are left out of the map, as "
             "dust, rain and moving things are",
             map.name, 100.0 * mean));
}

/// A note where wheels and scans are at odds over most of the way: wheels slip for stretches, and a mount
/// that is wrong lets them look so all along.
void note_slips(const RobotMap& map, const Recording& recording, std::vector<std::string>& notes) {
  constexpr double kMost = 0.5;   // of the way by the wheels
  constexpr double kLeast = 5.0;  // metres
  double slipped = 0.0;
  for (const SlipStretch& slip : map.slips) slipped += std::abs(slip.counted_m);
  const double way = path_length(recording.wheel);
  if (slipped < kLeast || slipped < kMost * way) return;
  notes.push_back(format(
      "{}: by the scans the wheels slipped for {:.0f} m of the {:.0f} m that they counted, so that the "
      "mount of the LiDAR or the scale of the wheels is probably wrong; adit doctor measures both",
      map.name, slipped, way));
}

/// A note where scans are missing for so long that the velocity before says no more where the robot went, and
/// nothing else measured.
void note_gaps(const Recording& recording, std::vector<std::string>& notes) {
  Duration longest{};
  Duration before{};
  Stamp begin;
  for (std::size_t i = 1; i < recording.num_scans(); ++i) {
    const Duration gap = recording.scan_stamps[i] - recording.scan_stamps[i - 1];
    const Duration kept = std::max({kVelocityHorizon, std::exchange(before, gap), longest});
    if (gap <= kept) continue;
    const SensedMotion motion = sensed_before(recording, i);
    if (motion.wheel || !motion.imu.empty()) continue;
    longest = gap;
    begin = recording.scan_stamps[i - 1];
  }
  if (longest > Duration{})
    notes.push_back(
        format("{}: no scans for {:.1f} s from {:.3f} s on, and nothing else says where the robot went; "
               "cut the recording there if the map is torn",
               recording.name, to_seconds(longest), begin.seconds()));
}

std::optional<Pose> fixed_mount(const Recording& recording) {
  return recording.clouds_in_mount_frame ? std::optional(recording.T_base_lidar) : std::nullopt;
}

/// Under that policy. Turns whatever goes wrong into an error of this robot, so that the others go on.
Result<RobotMap> map_one(const Recording& recording, RobotId id, const RobotSlamConfig& config,
                         KeyframeSelection policy, const Phase& phase, LeftOut& left_out) {
  try {
    Result<RobotMap> map =
        map_recording(with_damaged_scans_empty(recording, left_out), id, config, [&](std::size_t) {
          phase.advance();
          return true;
        });
    if (const Result<> any = left_out.unless_all(); !any) return fail(recording.name, any.error());
    return map.map(
        [&](const RobotMap& whole) { return select_keyframes(whole, policy, config.tunnel_filter); });
  } catch (const std::exception& error) {
    return fail(recording.name + ": " + error.what());
  }
}

}  // namespace

std::string reasons_of(const std::vector<FailedRobot>& failed) {
  std::vector<std::string> reasons;
  for (const FailedRobot& robot : failed) reasons.push_back(robot.reason);
  return format("{}", fmt::join(reasons, "; "));
}

std::size_t num_scans(const std::vector<Recording>& recordings) {
  std::size_t sum = 0;
  for (const Recording& recording : recordings) sum += recording.num_scans();
  return sum;
}

Result<Mapping> map_robots(const std::vector<Recording>& given, const SlamConfig& config,
                           std::size_t num_before) {
  const Result<std::vector<RobotId>> ids = robot_ids(num_before + given.size());
  if (!ids) return tl::unexpected(ids.error());
  Mapping mapping;
  const std::vector<Recording> recordings =
      config.check_sensors ? with_sound_sensors(given, mapping.notes) : given;
  std::vector<RobotSlamConfig> configs;
  for (const Recording& recording : recordings) {
    configs.push_back(config.robot);
    if (const auto note = use_kiss_icp_without_sensors(recording, configs.back().odometry))
      mapping.notes.push_back(*note);
    note_gaps(recording, mapping.notes);
  }
  std::vector<Result<RobotMap>> maps(recordings.size(), fail("not run"));
  std::vector<LeftOut> left_out(recordings.size(), LeftOut("scans"));
  {
    const Phase phase("mapping", num_scans(recordings));
    parallel_for_each(recordings.size(), [&](std::size_t i) {
      maps[i] =
          map_one(recordings[i], (*ids)[num_before + i], configs[i], config.keyframes, phase, left_out[i]);
    });
  }
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!maps[i]) {
      mapping.failed.push_back({recordings[i].name, maps[i].error().message});
      continue;
    }
    if (const auto sentence = left_out[i].sentence())
      mapping.notes.push_back(format("{}: {}", recordings[i].name, *sentence));
    note_quality(*maps[i], mapping.notes);
    note_slips(*maps[i], recordings[i], mapping.notes);
    mapping.robots.push_back({std::make_shared<const RobotMap>(std::move(*maps[i])),
                              std::string(to_string(configs[i].odometry.method)), recordings[i].lidar,
                              fixed_mount(recordings[i])});
  }
  if (!mapping.robots.empty()) return mapping;
  if (mapping.failed.empty()) return fail("no recording was given");
  return fail(reasons_of(mapping.failed));
}

}  // namespace adit
