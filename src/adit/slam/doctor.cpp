// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/doctor.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/point_times.hpp"
#include "adit/io/topic_info.hpp"
#include "adit/robot/mount_by_motion.hpp"
#include "adit/robot/scan_checks.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "adit/slam/doctor_mapping.hpp"

namespace adit {
namespace {

/// As --mount takes it, to millimetres and hundredths of a degree.
std::string mount_option(const Pose& T_base_lidar) {
  const Vector3& t = T_base_lidar.translation();
  const Matrix3 R = T_base_lidar.rotation_matrix();
  const double roll = std::atan2(R(2, 1), R(2, 2));
  const double pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps + 0.0; };
  std::string text = format("{},{},{}", rounded(t.x(), 1e3), rounded(t.y(), 1e3), rounded(t.z(), 1e3));
  return text + format(",{},{},{}", rounded(roll / kDegree, 100.0), rounded(pitch / kDegree, 100.0),
                       rounded(yaw / kDegree, 100.0));
}

constexpr double kLong = 1.0;  // seconds without scans: a robot drives a metre or two in the dark

/// Of scans that come seldom without one of them missing.
Health seldom(double interval_s) { return interval_s > 3.0 * kLong ? Health::spoils : Health::noted; }

std::string remedy_of_seldom(const Recording& recording) {
  const bool is_by_names = std::ranges::any_of(recording.assumptions, [](const std::string& assumption) {
    return assumption.starts_with("stamps: ");
  });
  return is_by_names ? "the numbers in the names of the clouds count as seconds: where they are not, put a "
                       "stamps.txt beside the clouds, with the time of each scan in seconds, one a line"
                     : "let the driver publish, and the recorder take, every sweep: scans this far apart "
                       "overlap little";
}

Diagnosis scans_missing(const Recording& recording) {
  const ScanTiming timing = timing_of(recording.scan_stamps);
  const std::string check = "scans: missing";
  if (timing.interval_s == 0.0) return {check, Health::unknown, "there is one scan"};
  // A scan that was left out alone leaves a gap, too; a stretch before a clock was set back leaves none.
  const std::size_t num_lost = std::max(timing.num_missing, recording.num_scans_left_out);
  const double share = static_cast<double>(num_lost) / static_cast<double>(num_lost + recording.num_scans());
  std::string sentence =
      format("{} scans, one every {:.3f} s; {} missing ({:.1f} %), the longest gap {:.2f} s",
             recording.num_scans(), timing.interval_s, num_lost, 100.0 * share, timing.longest_gap_s);
  if (timing.num_missing > 0) sentence += format(" at {:.1f} s", timing.longest_gap_at_s);
  if (recording.num_scans_left_out > 0)
    sentence += format("; {} were recorded and left out, as said of the file", recording.num_scans_left_out);
  if (timing.interval_s >= kLong)
    return {check, seldom(timing.interval_s), sentence, remedy_of_seldom(recording)};
  constexpr double kNotable = 0.005;
  constexpr double kTooMany = 0.1;
  Health health = Health::good;
  if (share > kNotable || timing.longest_gap_s > kLong) health = Health::noted;
  if (share > kTooMany || timing.longest_gap_s > 3.0 * kLong) health = Health::spoils;
  if (health == Health::good) return {check, health, sentence};
  if (2 * recording.num_scans_left_out > num_lost)
    return {
        check, health, sentence,
        "what is said of the file has the cause; where a clock jumped, let the driver stamp by one that is "
        "not set while it records, and cut this recording in two at the jump"};
  return {check, health, sentence,
          "record to a faster disk, with a larger cache of the recorder, or fewer topics"};
}

Diagnosis point_times(const Recording& recording, const ScansSeen& seen) {
  const std::string check = "scans: times of points";
  const double interval = timing_of(recording.scan_stamps).interval_s;
  const bool are_one = std::ranges::any_of(recording.assumptions, says_times_are_one);
  if (are_one || (seen.has_times && seen.sweep_s == 0.0))
    return {
        check, Health::spoils, "all points of a sweep have the same time",
        "let the driver write when each point was measured; that of the whole sweep is no time of a point"};
  if (!seen.has_times)
    return {
        check, Health::noted,
        "points have no times, so that the robot's motion within a sweep bends the scans",
        "let the driver write a time for each point (Ouster t, Velodyne time, Hesai timestamp), or name the "
        "field that has them with --point-time-field"};
  const std::string sentence =
      format("from {:.3f} s of a sweep, of which one comes every {:.3f} s", seen.sweep_s, interval);
  constexpr double kLeast = 0.2;  // of the interval; some drivers send a part of a turn
  constexpr double kMost = 1.2;
  if (interval > 0.0 && (seen.sweep_s < kLeast * interval || seen.sweep_s > kMost * interval))
    return {check, Health::spoils, sentence, "--point-times with the unit in which the driver writes them"};
  return {check, Health::good, sentence};
}

Diagnosis ranges(const ScansSeen& seen) {
  constexpr double kCut = 0.003;   // share of the returns in the last 3 % of the range
  constexpr double kShort = 60.0;  // metres
  constexpr double kFar = 500.0;   // metres: beyond the reach of most LiDARs, let alone in a mine
  const std::string sentence = format("{:.0f} points a scan, from {:.1f} m (1 % are nearer) to {:.1f} m",
                                      seen.points, seen.nearest_m, seen.farthest_m);
  if (seen.median_m > kFar)
    return {"scans: range", Health::spoils,
            format("{}, half of them beyond {:.0f} m: no LiDAR sees that far", sentence, seen.median_m),
            "points are in metres: these are probably in millimetres, so divide x, y and z by 1000 where the "
            "clouds are made"};
  if (seen.share_at_the_end > kCut && seen.farthest_m < kShort)
    return {"scans: range", Health::noted, sentence + ", where they end as if cut off",
            "raise the largest range of the driver or of a filter: far walls tell one tunnel from another"};
  return {"scans: range", Health::good, sentence};
}

Diagnosis view(const ScansSeen& seen) {
  std::string blind;
  double widest = 0.0;
  for (const auto& [from, to] : seen.blind_deg) {
    const double width = to > from ? to - from : to + 360.0 - from;
    widest = std::max(widest, width);
    blind += format("{}{:.0f} to {:.0f}", blind.empty() ? "" : ", ", from, to);
  }
  const std::string sentence =
      format("{:.0f} degrees around", seen.field_of_view_deg) +
      (blind.empty() ? "" : "; blind: " + blind + " degrees (0 is ahead of the robot, 90 to its left)");
  constexpr double kNarrow = 60.0;  // half the opening
  constexpr double kNotable = 20.0;
  if (seen.cone_deg < kNarrow)
    return {"scans: view", Health::noted,
            format("a cone of {:.0f} degrees, like that of a depth camera", 2.0 * seen.cone_deg),
            "two robots that meet head on see nothing alike: drive past places, and back"};
  if (widest > kNotable)
    return {"scans: view", Health::noted, sentence, "something stands in the view; mount the LiDAR higher"};
  return {"scans: view", Health::good, sentence};
}

Diagnosis self_hits(const Recording& recording, const ScansSeen& seen) {
  const std::string check = "scans: the robot itself";
  if (!seen.has_moved)
    return {check, Health::unknown,
            recording.wheel.empty()
                ? "without wheels, which say that the robot moves, it cannot be told from walls"
                : "by the wheels the robot moves less than 5 m, too little to tell it from walls"};
  if (!seen.self_hits) return {check, Health::good, "no return stays where it is while the robot moves"};
  const SelfHits& hits = *seen.self_hits;
  constexpr double kFew = 0.001;
  return {
      check, hits.share < kFew ? Health::good : Health::noted,
      format(
          "{:.2f} % of the returns come from {:.1f} to {:.1f} m about {:.0f} degrees (90 is to the robot's "
          "left) in every scan while the robot moves",
          100.0 * hits.share, hits.nearest_m, hits.farthest_m, hits.azimuth_deg),
      hits.share < kFew ? ""
                        : format("--set robot.odometry.plane_icp.min_range={:.1f} leaves out what is nearer",
                                 hits.farthest_m)};
}

Diagnosis mount_source(const Recording& recording) {
  const std::string sentence =
      format("{} ({})", mount_option(recording.T_base_lidar), recording.mount_source);
  if (recording.mount_source.starts_with("assumed"))
    return {"mount: source", Health::noted, sentence, std::string(kMountRemedy)};
  return {"mount: source", Health::good, sentence};
}

/// The mount with which the floor lies level at z = 0.
Pose levelled(const Pose& T_base_lidar, const FloorSeen& floor) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(floor.up, Vector3::UnitZ());
  const Pose about_sensor(turn, Vector3::Zero());
  const Vector3& at = T_base_lidar.translation();
  const double above = floor.up.dot(at) - floor.height_m * floor.up.z();
  return {(about_sensor * Pose(T_base_lidar.rotation(), Vector3::Zero())).rotation(),
          Vector3(at.x(), at.y(), above)};
}

/// `mount` turned as the motion says and levelled by the floor that is then seen; none where it is not seen.
std::optional<Pose> levelled_by_motion(const Recording& recording, const TiltByMotion& tilt) {
  constexpr double kLeft = 15.0;   // degrees of tilt that the motion may leave
  constexpr double kSpread = 6.0;  // degrees: of a floor, not of what is taken for one
  const Pose& stated = recording.T_base_lidar;
  Recording turned = recording;
  turned.T_base_lidar = Pose((Pose(Eigen::Quaterniond(tilt.R_level_base), Vector3::Zero()) *
                              Pose(stated.rotation(), Vector3::Zero()))
                                 .rotation(),
                             stated.translation());
  const Result<ScansSeen> seen = look_at_scans(turned);
  if (!seen || !seen->floor || seen->floor->spread_deg > kSpread ||
      seen->floor->up.z() < std::cos(kLeft * kDegree))
    return {};
  return levelled(turned.T_base_lidar, *seen->floor);
}

/// Levels `mount` where it is not.
Diagnosis mount_tilt(const Recording& recording, const ScansSeen& seen,
                     const std::optional<TiltByMotion>& by_motion, Pose& mount) {
  const std::string check = "mount: tilt and height";
  if (by_motion) {
    const std::string sentence = format(
        "by the motion between {} pairs of scans the robot drives, or turns, out of the plane that the mount "
        "takes for level: the LiDAR is tilted by some {:.0f} degrees against it",
        by_motion->num_steps, by_motion->tilt_deg);
    if (const std::optional<Pose> level = levelled_by_motion(recording, *by_motion)) {
      mount = *level;
      return {check, Health::spoils, sentence,
              "--mount " + mount_option(mount) + " levels it by the floor that is seen then"};
    }
    if (!seen.floor)
      return {check, Health::spoils, sentence + ", by which the floor is not seen",
              std::string(kMountRemedy)};
  }
  if (!seen.floor) return {check, Health::unknown, "too few scans show the floor"};
  const FloorSeen& floor = *seen.floor;
  const double tilt = std::acos(std::clamp(floor.up.z(), -1.0, 1.0)) / kDegree;
  const std::string sentence = format(
      "by the mount the floor is tilted by {:.1f} degrees (half of the scans within {:.1f}) and lies at z = "
      "{:.2f} m",
      tilt, floor.spread_deg, floor.height_m);
  constexpr double kTilt = 2.0;     // degrees
  constexpr double kHeight = 0.15;  // metres
  if (tilt < std::max(kTilt, floor.spread_deg) && std::abs(floor.height_m) < kHeight)
    return {check, Health::good, sentence};
  constexpr double kMuch = 10.0;  // degrees
  mount = levelled(mount, floor);
  return {check, tilt > kMuch ? Health::spoils : Health::noted, sentence,
          "--mount " + mount_option(mount) + " levels it"};
}

/// `found`: with the mount levelled, which is `mount`.
Diagnosis mount_turn(const Result<MountByMotion>& found, const Pose& mount) {
  const std::string check = "mount: turn and lever arm";
  if (!found) return {check, Health::unknown, found.error().message};
  std::string sentence = format(
      "by the motion between {} pairs of scans the mount is off by {:+.2f} degrees of yaw "
      "(+-{:.2f})",
      found->num_steps, found->yaw_deg, found->yaw_sigma_deg);
  constexpr double kSigmas = 3.0;
  constexpr double kYaw = 1.0;           // degrees
  constexpr double kLever = 0.15;        // metres
  constexpr double kLeverUnknown = 0.1;  // metres, one standard deviation
  const bool is_turned = std::abs(found->yaw_deg) > std::max(kYaw, kSigmas * found->yaw_sigma_deg);
  const Pose by_yaw = Pose::planar(0.0, 0.0, is_turned ? found->yaw_deg * kDegree : 0.0);
  const bool knows_ahead = found->ahead_sigma_m < kLeverUnknown;
  const bool knows_left = found->left_sigma_m < kLeverUnknown;
  // What was found goes on from where the yaw about the robot's origin takes the LiDAR.
  const Vector3 found_shift =
      by_yaw * mount.translation() - mount.translation() + Vector3(found->ahead_m, found->left_m, 0.0);
  Vector3 shift = Vector3::Zero();
  const auto add_lever = [&](const char* way, double sigma, Eigen::Index axis) {
    sentence += format(" and {:+.2f} m {} (+-{:.2f})", found_shift[axis], way, sigma);
    if (std::abs(found_shift[axis]) > std::max(kLever, kSigmas * sigma)) shift[axis] = found_shift[axis];
  };
  if (knows_ahead) add_lever("ahead", found->ahead_sigma_m, 0);
  if (knows_left) add_lever("to the left", found->left_sigma_m, 1);
  if (!knows_ahead && !knows_left)
    sentence += "; lever arm: too few turns to tell";
  else if (!knows_left)
    sentence += "; to the left: too few turns to both sides to tell";
  else if (!knows_ahead)
    sentence += "; ahead: too few turns to tell";
  if (!is_turned && shift.isZero()) return {check, Health::good, sentence};
  const Vector3 at = mount.translation() + shift;
  const Pose better((by_yaw * Pose(mount.rotation(), Vector3::Zero())).rotation(), at);
  constexpr double kMuch = 5.0;  // degrees
  return {check, std::abs(found->yaw_deg) > kMuch ? Health::spoils : Health::noted, sentence,
          "--mount " + mount_option(better) + ", if the wheels are right"};
}

/// The mount of the LiDAR, levelled where it is not.
Pose add_mount(const Recording& recording, const ScansSeen& seen, std::vector<Diagnosis>& out) {
  Pose mount = recording.T_base_lidar;
  Result<std::vector<MotionStep>> steps = motion_steps(recording);
  out.push_back(mount_tilt(recording, seen, steps ? tilt_by_motion(*steps) : std::nullopt, mount));
  if (mount.matrix() != recording.T_base_lidar.matrix()) {
    Recording level = recording;
    level.T_base_lidar = mount;
    steps = motion_steps(level);
  }
  out.push_back(mount_turn(
      steps.and_then([](const std::vector<MotionStep>& all) { return mount_by_motion(all); }), mount));
  return mount;
}

/// The same scans, by another mount.
Result<ScansSeen> seen_by_mount(const Recording& recording, const ScansSeen& seen, const Pose& mount) {
  if (mount.matrix() == recording.T_base_lidar.matrix()) return seen;
  Recording level = recording;
  level.T_base_lidar = mount;
  return look_at_scans(level);
}

void add_missing_sensors(const Recording& recording, RecordedAs recorded_as, std::vector<Diagnosis>& out) {
  const bool is_folder = recorded_as == RecordedAs::folder_of_clouds;
  if (recording.wheel.empty())
    out.push_back({"wheels", Health::noted,
                   "the recording has no wheel odometry, so that scans alone say how far",
                   is_folder ? "put odometry.tum, the poses by the wheels, beside the clouds"
                             : "--wheel TOPIC if it is there under another type or name"});
  if (recording.imu.empty() && recording.wheel.empty())
    out.push_back({"IMU", Health::noted,
                   "the recording has none either, so that kiss-icp goes by the scans alone",
                   is_folder ? "folders of clouds hold none; record a bag"
                             : "--imu TOPIC if it is there under another name"});
  else if (recording.imu.empty())
    out.push_back({"IMU", Health::good, "the recording has none, and needs none beside its wheels"});
}

/// Where wheels and IMU share a clock that is not the LiDAR's, only the scans tell.
Diagnosis clock_apart(double late_s, bool is_with_imu) {
  return {"wheels and IMU", Health::noted,
          format("the stamps of {} are {:.2f} s too {} by the scans",
                 is_with_imu ? "wheels and IMU, which go together," : "wheels", std::abs(late_s),
                 late_s > 0.0 ? "late" : "early"),
          "make the LiDAR's driver use the clock of the others; where it stamps the other end of a sweep, "
          "--set recording.stamp_at=start or =end"};
}

/// Where nothing was found: what was looked at. `by_scans`: as of wheels_late_by_scans.
Diagnosis sound_sensors(const Recording& sound, const SensorsChecked& checked,
                        const std::optional<double>& by_scans) {
  const std::string check = "wheels and IMU";
  if (sound.wheel.empty())
    return {check, Health::good,
            "units, gravity, gaps and covariances of the IMU are sound; without wheels its clock is compared "
            "with none"};
  if (!checked.with_imu && !checked.with_scans && !by_scans)
    return {check, Health::unknown,
            format("too little motion to compare the wheels with {}",
                   sound.imu.empty() ? "the scans" : "the IMU or the scans")};
  if (sound.imu.empty())
    return {
        check, Health::good,
        "units, signs, clock and covariances of the wheels agree with the scans, as far as this drive tells"};
  return {
      check, Health::good,
      format(
          "{}, as far as this drive tells",
          !checked.with_imu ? "the clock of the wheels agrees with that of the scans"
          : by_scans
              ? "units, signs and covariances agree with one another, and clocks with that of the scans, too"
              : "units, signs, clocks and covariances agree with one another; too few turns to compare their "
                "clock with that of the scans")};
}

/// `sound`: the recording with the sensors that are sound, by `checked`.
void add_sensors(const Recording& recording, const Recording& sound, const SensorsChecked& checked,
                 std::vector<Diagnosis>& out) {
  for (const SensorFinding& finding : checked.findings)
    out.push_back({"wheels and IMU",
                   finding.consequence == Consequence::left_out ? Health::spoils : Health::noted,
                   finding.sentence});
  // Without an IMU the wheels were compared with the scans already.
  const std::optional<double> late_s = sound.imu.empty() ? std::nullopt : wheels_late_by_scans(sound);
  if (late_s.value_or(0.0) != 0.0)
    out.push_back(clock_apart(*late_s, checked.with_imu));
  else if (checked.findings.empty() && (!recording.wheel.empty() || !recording.imu.empty()))
    out.push_back(sound_sensors(sound, checked, late_s));
}

}  // namespace

std::string_view to_string(Health health) {
  switch (health) {
    case Health::good:
      return "good";
    case Health::noted:
      return "noted";
    case Health::spoils:
      return "spoils";
    case Health::unknown:
      break;
  }
  return "unknown";
}

Result<std::vector<Diagnosis>> diagnose(const Recording& recording, const RobotSlamConfig& config,
                                        RecordedAs recorded_as) {
  const Result<ScansSeen> seen = look_at_scans(recording);
  if (!seen) return tl::unexpected(seen.error());
  std::vector<Diagnosis> of_mount = {mount_source(recording)};
  const Pose level = add_mount(recording, *seen, of_mount);
  const Result<ScansSeen> seen_level = seen_by_mount(recording, *seen, level);
  if (!seen_level) return tl::unexpected(seen_level.error());
  std::vector<Diagnosis> out;
  for (const std::string& warning : recording.warnings) out.push_back({"file", Health::noted, warning});
  for (const std::string& assumption : recording.assumptions)
    out.push_back({"file", Health::noted, "assumed " + assumption});
  if (seen->damaged) out.push_back({"file", Health::noted, *seen->damaged});
  out.push_back(scans_missing(recording));
  out.push_back(point_times(recording, *seen));
  out.push_back(ranges(*seen));
  out.push_back(view(*seen_level));
  out.push_back(self_hits(recording, *seen_level));
  std::ranges::move(of_mount, std::back_inserter(out));
  add_missing_sensors(recording, recorded_as, out);
  Recording sound = recording;
  const SensorsChecked checked = check_sensors(sound);
  add_sensors(recording, sound, checked, out);
  out.push_back(diagnose_mapping(sound, *seen, config));
  return out;
}

std::vector<Diagnosis> diagnose_clocks(const Bag& bag, const RecordingConfig& config) {
  constexpr std::string_view kCheck = "clocks";  // findings begin with it
  std::vector<Diagnosis> out;
  for (const TopicInfo& topic : topics_of(bag, config)) {
    if (topic.used_as.empty() || topic.clock_finding.empty()) continue;
    std::string sentence = topic.clock_finding;
    if (sentence.starts_with(std::string(kCheck) + ": ")) sentence.erase(0, kCheck.size() + 2);
    out.push_back({std::string(kCheck), Health::noted, sentence});
  }
  return out;
}

}  // namespace adit
