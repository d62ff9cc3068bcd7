// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/metrics_json.hpp"
#include "adit/core/json_text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json ate_field(const std::optional<AteResult>& ate, double AteResult::*field) {
  return ate ? number((*ate).*field) : Json(nullptr);
}

Json odometry_json(const OdometryResult& odometry) {
  return {{"ate_max_m", ate_field(odometry.ate, &AteResult::max_m)},
          {"ate_rmse_m", ate_field(odometry.ate, &AteResult::rmse_m)},
          {"ate_median_m", ate_field(odometry.ate, &AteResult::median_m)},
          {"ms_per_scan_median", number(odometry.ms_per_scan_median)}};
}

Json robot_json(const RobotResult& robot) {
  Json methods = Json::object();
  for (const OdometryResult& odometry : robot.odometry) methods[odometry.method] = odometry_json(odometry);
  return {{"name", robot.name},
          {"path_length_m", number(robot.path_length_m)},
          {"duration_s", number(robot.duration_s)},
          {"speed_mean_mps", number(robot.speed_mean_mps())},
          {"scans", robot.scans},
          {"keyframes", robot.keyframes},
          {"odometry", methods}};
}

Json ate_list(std::span<const MergedRobot> robots, double AteResult::*field) {
  Json list = Json::array();
  for (const MergedRobot& robot : robots) list.push_back(ate_field(robot.ate, field));
  return list;
}

Json ratio_list(std::span<const MergedRobot> robots) {
  Json list = Json::array();
  for (const MergedRobot& robot : robots) list.push_back(number(robot.ate_max_over_path_pct()));
  return list;
}

Json pair_json(const PairResult& pair) {
  return {{"robots", Json::array({pair.robots[0].name, pair.robots[1].name})},
          {"keyframes", pair.keyframes},
          {"pcm", pair.pcm},
          {"loops_before_pcm", pair.loops_before_pcm.total},
          {"wrong_place_before_pcm", pair.loops_before_pcm.wrong_place},
          {"wrong_registration_before_pcm", pair.loops_before_pcm.wrong_registration},
          {"loops_after_pcm", pair.loops_after_pcm.total},
          {"wrong_place_after_pcm", pair.loops_after_pcm.wrong_place},
          {"wrong_registration_after_pcm", pair.loops_after_pcm.wrong_registration},
          {"wrong_loops_in_solution", pair.wrong_loops_in_solution},
          {"merged", pair.merged},
          {"refused_kind", pair.merged ? "" : to_string(pair.refused_kind)},
          {"refused_reason", pair.refused_reason},
          {"success", pair.success()},
          {"ate_max_m", ate_list(pair.robots, &AteResult::max_m)},
          {"ate_rmse_m", ate_list(pair.robots, &AteResult::rmse_m)},
          {"ate_max_over_path_pct", ratio_list(pair.robots)}};
}

Json map_list(std::span<const std::optional<MapAccuracy>> maps) {
  Json list = Json::array();
  for (const std::optional<MapAccuracy>& map : maps) {
    list.push_back(map ? Json{{"surface_median_m", map->median_m},
                              {"surface_p95_m", map->p95_m},
                              {"completeness_10cm_pct",
                               map->completeness ? number(100.0 * *map->completeness) : Json(nullptr)}}
                       : Json(nullptr));
  }
  return list;
}

Json joint_json(const JointResult& joint) {
  return {{"keyframes", joint.keyframes},
          {"components", joint.components},
          {"ate_max_m", ate_list(joint.robots, &AteResult::max_m)},
          {"ate_rmse_m", ate_list(joint.robots, &AteResult::rmse_m)},
          {"ate_max_over_path_pct", ratio_list(joint.robots)},
          {"maps", map_list(joint.map_accuracy)},
          {"loops", joint.loops.total},
          {"wrong_place", joint.loops.wrong_place},
          {"wrong_registration", joint.loops.wrong_registration},
          {"wrong_loops_in_solution", joint.wrong_loops_in_solution},
          {"refusals", joint.refusals},
          {"bytes_sent_per_robot", joint.bytes_sent_per_robot}};
}

}  // namespace

std::string metrics_json(const StudyResult& study) {
  Json robots = Json::array();
  for (const RobotResult& robot : study.robots) robots.push_back(robot_json(robot));
  Json pairs = Json::array();
  for (const PairResult& pair : study.pairs) pairs.push_back(pair_json(pair));
  const Json metrics = {{"version", 1},
                        {"adit_version", study.version},
                        {"world", study.world},
                        {"lidar", study.lidar},
                        {"seed", study.seed},
                        {"wall_s", number(study.wall_s)},
                        {"peak_rss_mb", number(study.peak_rss_mb)},
                        {"robots", robots},
                        {"pairs", pairs},
                        {"joint", study.joint ? joint_json(*study.joint) : Json(nullptr)}};
  // Names may hold any bytes; those that are not UTF-8 are replaced instead of throwing.
  return json_text(metrics, 2) + "\n";
}

}  // namespace adit
