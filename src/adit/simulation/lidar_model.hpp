// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A LiDAR: a spinning one with many beams, or one whose pattern does not repeat (scan_pattern.hpp). Frame: x
/// forward, y left, z up, origin in the sensor's centre.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/air.hpp"
#include "adit/simulation/lidar_unit.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/surface_signal.hpp"

namespace adit {

/// In which order a sensor looks in which directions.
enum class LidarPattern {
  spinning,  ///< All beams of a column at once, columns around the upward axis.
  rosette,   ///< Two turning prisms in front of one laser, about the forward axis.
  wave,      ///< Turning about the upward axis while the elevation swings.
};
/// All patterns, for configurations.
inline constexpr std::array kLidarPatterns{LidarPattern::spinning, LidarPattern::rosette, LidarPattern::wave};
/// As configurations name it: "spinning".
[[nodiscard]] std::string_view to_string(LidarPattern pattern);

/// Lengths in metres. Defaults: Ouster OS2-128.
struct LidarConfig {
  std::string name = "os2-128";
  LidarPattern pattern = LidarPattern::spinning;
  int beams = 128;
  int columns = 1024;
  double elevation_min_deg = -11.25;  ///< Lowest beam; beams are spread evenly up to the highest.
  double elevation_max_deg = 11.25;
  double azimuth_min_deg = -180.0;  ///< A spinning sensor fires only between these, 0 forward, left positive.
  double azimuth_max_deg = 180.0;
  double first_rpm = 7294.0;    ///< Of the pattern, see scan_pattern.hpp: of a prism, or of the azimuth.
  double second_rpm = -4664.0;  ///< Of the other prism, or of the elevation.
  double rate_hz = 10.0;
  double range_min = 0.5;
  double range_max = 200.0;
  double noise_near = 0.025;  ///< Standard deviation of a range at range_min; linear in between.
  double noise_far = 0.08;    ///< The same at range_max.
  double reach = 200.0;       ///< Where a surface of 10 % is just seen, head-on; felt as Surfaces say.
  double divergence_deg =
      0.09;  ///< Of the beam, full angle; felt as LidarErrorConfig::divergence_factor says.
  double dropout_start_deg = 75.0;  ///< Incidence angle (0: head-on) from which returns start to get lost ...
  double dropout_end_deg = 88.0;    ///< ... and from which none is left; linear in between.
  double mount_forward = 0.0;       ///< Position on the robot, in the base frame.
  double mount_height = 0.9;
};

/// The keys are the names of the members; in the configuration of a run they begin with "simulation.lidar.".
inline Fields fields_of(LidarConfig& c) {
  return {
      {"name", &c.name, "", 0, 0, "the sensor's name, noted in recordings"},
      enum_field(
          "pattern", &c.pattern, kLidarPatterns,
          "spinning, rosette (two prisms, a cone ahead) or wave (all around); the latter two do not repeat"),
      {"beams", &c.beams, "", 1, 1024,
       "beams, spread evenly over the vertical field of view; else shots one after the other per column"},
      {"columns", &c.columns, "", 4, 8192, "firings of all beams per scan"},
      {"elevation_min_deg", &c.elevation_min_deg, "deg", -90, 90, "elevation of the lowest beam"},
      {"elevation_max_deg", &c.elevation_max_deg, "deg", -90, 90, "elevation of the highest beam"},
      {"azimuth_min_deg", &c.azimuth_min_deg, "deg", -180, 180,
       "a spinning sensor fires to the left of this (0: forward) ..."},
      {"azimuth_max_deg", &c.azimuth_max_deg, "deg", -180, 180, "... and to the right of this"},
      {"first_rpm", &c.first_rpm, "1/min", -1e6, 1e6, "rosette: of the first prism; wave: of the azimuth"},
      {"second_rpm", &c.second_rpm, "1/min", -1e6, 1e6,
       "rosette: of the second prism; wave: of the elevation"},
      {"rate_hz", &c.rate_hz, "Hz", 0.1, 100, "scans per second; of a spinning sensor, turns"},
      {"range_min", &c.range_min, "m", 0, 100, "nearer returns are dropped"},
      {"range_max", &c.range_max, "m", 0.1, 1000, "farther returns are dropped"},
      {"noise_near", &c.noise_near, "m", 0, 1, "standard deviation of a range at range_min"},
      {"noise_far", &c.noise_far, "m", 0, 1, "standard deviation of a range at range_max"},
      {"reach", &c.reach, "m", 0.1, 1000, "range at which a surface of 10 % reflectivity is just seen"},
      {"divergence_deg", &c.divergence_deg, "deg", 0, 5,
       "width of a beam, full angle; times lidar_errors.divergence_factor"},
      {"dropout_start_deg", &c.dropout_start_deg, "deg", 0, 90,
       "incidence angle where returns start to get lost"},
      {"dropout_end_deg", &c.dropout_end_deg, "deg", 0, 90, "incidence angle beyond which no return is left"},
      {"mount_forward", &c.mount_forward, "m", -5, 5, "sensor ahead of the base frame's origin"},
      {"mount_height", &c.mount_height, "m", 0.05, 5, "sensor above the floor"}};
}

/// Ranges of the fields, and: azimuths, elevations, ranges and drop-out angles in ascending order.
Result<> check_lidar(LidarConfig config);

/// os2-128, os2-128-512, os2-128-2048 (the suffix is the number of columns), os2-32 (thinned, for quick
/// runs), os1-64, os1-64-front (90 degrees of it), os1-128, os0-128, vlp-16, livox-mid-40, livox-avia,
/// livox-mid-360 (fields of view, points per second and ranges as their makers state; the Avia's and the
/// Mid-360's curves only resemble theirs, which are not published). An unknown name fails with the list.
[[nodiscard]] Result<LidarConfig> lidar_preset(const std::string& name);
/// The names that lidar_preset() knows.
[[nodiscard]] std::vector<std::string> lidar_presets();

/// The stated mount: level, facing forward. The true one is this times LidarUnit::T_nominal_true.
[[nodiscard]] inline Pose T_base_lidar(const LidarConfig& config) {
  return Pose::translation_of(config.mount_forward, 0.0, config.mount_height);
}
/// Beams that are lasers of their own, each with its own errors; 0 where one laser draws a pattern.
[[nodiscard]] std::size_t num_rings(const LidarConfig& config);

/// Duration of one scan.
[[nodiscard]] inline Duration sweep_time(const LidarConfig& config) {
  return from_seconds(1.0 / config.rate_hz);
}

/// One scan of the sensor, moving steadily (on a geodesic) from its pose at the start to its pose at the end,
/// or through poses in between.
struct Sweep {
  Pose T_world_lidar_start;  ///< One sweep_time() before `end`.
  Pose T_world_lidar_end;    ///< At `end`, when the last column is fired.
  Stamp end;                 ///< Stamp of the scan.
  /// One per scan. A ray's noise depends on it, its beam and its column alone.
  std::uint64_t noise_seed = 0;
  std::vector<Pose> T_world_lidar_between = {};  ///< At equal intervals of time; without start and end.
  double dust = 0.0;  ///< Share of rays that end in dust, within 5 m of the sensor.
  /// What moves, where it is in the middle of equal parts of the sweep; nothing where nothing is.
  std::vector<std::optional<Raycaster>> movers = {};
  Surfaces surfaces = {};  ///< Of the world; all alike by default.
  Air air = {};            ///< Clear by default.
};

/// What the sensor sees during one sweep, as it would report it: each point in the lidar frame of its own
/// column's time, with motion distortion, range noise and drop-out. Columns in the order of time (clockwise
/// from straight back where the sensor spins), beams from the highest down; rays without a return leave no
/// point. Where surfaces are not alike, points have intensities: reflectivity times the cosine of the
/// incidence, in percent. Time offsets run from almost minus one turn to 0 at the last column: the stamp is
/// the END of the sweep. The errors of `unit` are added, those of mount and clocks apart, which the caller
/// knows; its rings are none or num_rings().
[[nodiscard]] Scan cast_scan(const Raycaster& raycaster, const LidarConfig& config, const Sweep& sweep,
                             const LidarUnit& unit = {});

}  // namespace adit
