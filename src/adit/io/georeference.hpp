// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the maps of a session lie in the frame of surveyors, and the control points that say so.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"
#include "adit/core/time.hpp"

namespace adit {

/// Where a control point was seen.
struct ControlMark {
  std::string robot;  ///< "": in the map of the most robots.
  std::optional<Stamp>
      stamp;  ///< With one `position` is in the base frame of the robot then, else in its map.
  Vector3 position = Vector3::Zero();  ///< Metres.
  double sigma = 0.05;                 ///< Of picking it, along each axis, metres.
  bool is_in_lidar_frame = false;      ///< With a stamp: `position` is in the LiDAR's frame, not the base's.
};

/// A point with surveyed coordinates that was found in a map or a scan.
struct ControlPoint {
  std::string name;                  ///< No other point of one file of control points has it.
  Vector3 target = Vector3::Zero();  ///< Surveyed: metres in the target frame, z up.
  double sigma_xy = 0.0;             ///< Standard deviations, metres: along x and along y,
  double sigma_z = 0.0;              ///< and along z.
  bool is_check = false;             ///< Judged, without a say in the transform.
  ControlMark mark;                  ///< Where it was found.
};

/// Control points as comma-separated values (docs/commands.md, "Control points"). Fails with line and remedy
/// on a column that is missing or unknown, a cell that is no number, a standard deviation that is not
/// positive, a mark that nothing says the place of, a frame of a mark that is in no scan, and a name that
/// occurs twice.
[[nodiscard]] Result<std::vector<ControlPoint>> parse_control_points(std::string_view csv);
/// The same of a file, which errors name.
[[nodiscard]] Result<std::vector<ControlPoint>> read_control_points(const std::filesystem::path& path);

/// What became of a control point.
enum class ControlUse {
  used,          ///< Has a say in the transform.
  rejected,      ///< Contradicts the others.
  check,         ///< A check point that agrees, or that nothing can be said of.
  failed_check,  ///< A check point that contradicts those in use.
};
/// "used", "rejected", "check" or "failed check", as in georeference.toml.
[[nodiscard]] std::string_view to_string(ControlUse use);

/// A control point after the fit.
struct JudgedControl {
  ControlPoint point;  ///< Its mark is in the base frame of a keyframe, so that it moves with the map.
  ControlUse use = ControlUse::used;   ///< Decided by `misfit`.
  Vector3 residual = Vector3::Zero();  ///< Surveyed less mapped, along the axes of the target frame, metres.
  std::optional<double> misfit = {};   ///< ControlFit::misfits.
};

/// How well the place is known where it is known worst, one standard deviation each, metres.
struct FarEnd {
  std::string robot;      ///< Whose keyframe it is.
  Stamp stamp;            ///< Of the keyframe.
  double sigma_xy = 0.0;  ///< In the horizontal direction that is known worst.
  double sigma_z = 0.0;   ///< Upwards.
};

/// Of one map.
struct Georeference {
  std::vector<std::string> robots;       ///< Whose map it is.
  std::string crs;                       ///< As given: "EPSG:25833", the name of a mine's own grid, ""...
  Pose T_target_map;                     ///< From the map to the frame of `crs`, metres.
  Matrix6 covariance = Matrix6::Zero();  ///< Of T_target_map, right perturbation, [translation; rotation].
  std::vector<JudgedControl> points;     ///< All that were found in this map, check points included.
  double chi2 = 0.0;                     ///< Of the points in use.
  int redundancy = 0;                    ///< Numbers measured minus unknowns: what `chi2` is on average.
  double scale_ppm = 0.0;        ///< By how much the target frame is larger than the map; not applied.
  double scale_sigma_ppm = 0.0;  ///< Standard deviation of `scale_ppm`.
  FarEnd far_end;                ///< Among keyframes of all its robots.
};

/// georeference.toml in a session directory. Reading one that is not there gives none; a damaged one fails.
///@{
Result<> write_georeferences(const std::filesystem::path& session, const std::vector<Georeference>& maps);
[[nodiscard]] Result<std::vector<Georeference>> read_georeferences(const std::filesystem::path& session);
///@}

/// Of the map of that robot; null where it is in the odometry frame of a robot still.
[[nodiscard]] const Georeference* georeference_of(const std::vector<Georeference>& maps,
                                                  const std::string& robot);

}  // namespace adit
