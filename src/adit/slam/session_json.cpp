// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// metrics.json of a session, what an evaluation adds to it, and the layout in which Foxglove shows it.
#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/loops_csv.hpp"
#include "adit/report/palette.hpp"
#include "adit/slam/session_evaluation.hpp"
#include "adit/slam/session_mcap.hpp"
#include "adit/slam/session_pages.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

Json slips_json(const std::vector<SlipStretch>& slips) {
  Json json = Json::array();
  for (const SlipStretch& slip : slips)
    json.push_back({{"begin_ns", slip.begin.ns}, {"end_ns", slip.end.ns}, {"counted_m", slip.counted_m}});
  return json;
}

Json robots_json(const SlamRun& run) {
  Json robots = Json::array();
  for (std::size_t i = 0; i < run.session.maps.size(); ++i) {
    const RobotMap& map = *run.session.maps[i];
    const std::vector<RobotProvenance>& mapped = run.session.provenance.robots;
    const auto own =
        std::ranges::find_if(mapped, [&](const RobotProvenance& robot) { return robot.is_of_map(map.name); });
    robots.push_back({{"name", map.name},
                      {"odometry", own == mapped.end() ? "" : own->odometry},
                      {"scans", map.odometry.size()},
                      {"keyframes", map.keyframes.size()},
                      {"path_length_m", path_length(map.odometry)},
                      {"slips", slips_json(map.slips)},
                      {"bytes_sent", run.bytes_sent.at(i)}});
  }
  return robots;
}

Json accuracy_json(const std::optional<MergeAccuracy>& accuracy) {
  if (!accuracy) return nullptr;
  return {{"along_m", accuracy->along_m},
          {"across_m", accuracy->across_m},
          {"up_m", accuracy->up_m},
          {"turn_deg", accuracy->turn_deg},
          {"loops_in_use", accuracy->num_loops}};
}

Json pairs_json(const Session& session) {
  Json pairs = Json::array();
  for (const PairOutcome& pair : session.solution.pairs)
    pairs.push_back({{"robots", {session.name_of(pair.a), session.name_of(pair.b)}},
                     {"loops", pair.num_loops},
                     {"clique", pair.num_selected},
                     {"second_clique", pair.second_clique},
                     {"merged", pair.merged},
                     {"sigma", accuracy_json(pair.accuracy)},
                     {"refused_kind", pair.merged ? "" : to_string(pair.refused_kind)},
                     {"refused_reason", pair.refused_reason}});
  return pairs;
}

/// What each robot's odometry, and the loops of each pair, turned out to be worth.
Json variances_json(const Session& session) {
  Json variances = Json::array();
  for (const auto& [source, found] : session.solution.variances)
    variances.push_back(
        {{"source", source.kind == EdgeKind::loop ? "loops" : "odometry"},
         {"robots", {session.name_of(source.robots.first), session.name_of(source.robots.second)}},
         {"variance", found.variance},
         {"redundancy", found.redundancy},
         {"edges", found.num_edges}});
  return variances;
}

Json components_json(const Session& session) {
  Json components = Json::array();
  for (const Component& component : session.solution.components) {
    Json& names = components.emplace_back(Json::array());
    for (const RobotId id : component.robots) names.push_back(session.name_of(id));
  }
  return components;
}

template <class Errors>
Json number(const std::optional<Errors>& errors, double Errors::*field) {
  return errors ? Json((*errors).*field) : Json(nullptr);
}

Json counts_json(const LoopCounts& counts) {
  return {{"total", counts.total},
          {"correct", counts.correct()},
          {"wrong_place", counts.wrong_place},
          {"wrong_registration", counts.wrong_registration}};
}

Json map_json(const std::optional<MapAccuracy>& map) {
  if (!map) return nullptr;
  return {{"points", map->num_points},
          {"surface_median_m", map->median_m},
          {"surface_p95_m", map->p95_m},
          {"completeness_10cm_pct", map->completeness ? Json(100.0 * *map->completeness) : Json(nullptr)},
          {"could_be_seen_m2", map->completeness ? Json(map->seen_m2) : Json(nullptr)}};
}

Json evaluation_json(const SessionEvaluation& evaluation) {
  Json robots = Json::array();
  for (const RobotErrors& robot : evaluation.robots)
    robots.push_back({{"name", robot.name},
                      {"ate_max_m", number(robot.joint, &AteResult::max_m)},
                      {"ate_rmse_m", number(robot.joint, &AteResult::rmse_m)},
                      {"ate_median_m", number(robot.joint, &AteResult::median_m)},
                      {"odometry_ate_max_m", number(robot.odometry, &AteResult::max_m)},
                      {"odometry_ate_rmse_m", number(robot.odometry, &AteResult::rmse_m)},
                      {"rpe_segment_m", number(robot.relative, &RpeResult::segment_m)},
                      {"rpe_translation_rmse_m", number(robot.relative, &RpeResult::translation_rmse_m)},
                      {"rpe_translation_median_m", number(robot.relative, &RpeResult::translation_median_m)},
                      {"rpe_rotation_rmse_rad", number(robot.relative, &RpeResult::rotation_rmse_rad)},
                      {"rpe_rotation_median_rad", number(robot.relative, &RpeResult::rotation_median_rad)}});
  Json maps = Json::array();
  for (const std::optional<MapAccuracy>& map : evaluation.maps) maps.push_back(map_json(map));
  return {{"components", evaluation.components},
          {"robots", robots},
          {"maps", maps},
          {"loops",
           {{"registered", counts_json(evaluation.registered)},
            {"after_pcm", counts_json(evaluation.consistent)},
            {"in_use", counts_json(evaluation.in_use)},
            {"unjudged", evaluation.num_unjudged}}}};
}

// Without a field of its own choice Foxglove colours a cloud by one that it finds, whatever the mode.
Json cloud_settings(const std::string& color, double point_size) {
  return {{"visible", true},
          {"colorMode", "flat"},
          {"colorField", "x"},
          {"flatColor", color},
          {"pointSize", point_size}};
}

}  // namespace

std::string session_metrics(const SlamRun& run) {
  Json failed = Json::array();
  for (const FailedRobot& robot : run.failed)
    failed.push_back({{"name", robot.name}, {"reason", robot.reason}});
  const Json metrics = {{"version", 1},
                        {"adit_version", version()},
                        {"robots", robots_json(run)},
                        {"pairs", pairs_json(run.session)},
                        {"components", components_json(run.session)},
                        {"variances", variances_json(run.session)},
                        {"online",
                         {{"largest_difference_m", run.online.largest_m},
                          {"loops_judged_otherwise", run.online.num_judged_otherwise}}},
                        {"failed", failed}};
  return json_text(metrics, 2) + "\n";
}

std::string json_of(const SessionEvaluation& evaluation) { return json_text(evaluation_json(evaluation)); }

std::string json_of(const MapAccuracy& map) { return json_text(map_json(map)); }

Result<> save_evaluation(const std::filesystem::path& session, const SessionEvaluation& evaluation) {
  const std::filesystem::path loops = session / "loops.csv";
  const Result<std::string> old = read_bytes(loops);
  if (!old) return tl::unexpected(old.error());
  const Result<std::string> judged = with_classes(*old, evaluation.loop_classes);
  if (!judged) return fail(loops.string(), judged.error());
  if (const Result<> written = write_bytes(loops, *judged); !written) return written;

  // Sessions of earlier versions have no metrics.json; what is there stays.
  const std::filesystem::path file = session / "metrics.json";
  const Result<std::string> text = read_bytes(file);
  Json metrics = text ? Json::parse(*text, nullptr, false) : Json{{"version", 1}};
  if (!metrics.is_object()) return fail(file.string() + ": not JSON; remove the file and evaluate again");
  metrics["evaluation"] = evaluation_json(evaluation);
  return write_bytes(file, json_text(metrics, 2) + "\n");
}

std::string foxglove_layout(const PlacedSession& session) {
  Json topics = {{"/graph", {{"visible", true}}}};
  const std::vector<std::string> names = ros_names(session);
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < session.robots.size(); ++i) {
    const PlacedRobot& robot = session.robots[i];
    if (robot.map->keyframes.empty() || robot.map->odometry.empty()) continue;
    const std::string name = "/" + names[i];
    const std::string color = hex(robot_color(i));
    // Thin walls, so that the path and the loops within them are seen.
    topics[name + "/map"] = cloud_settings(color + "1a", 1.5);
    topics[name + "/path"] = {
        {"visible", true}, {"type", "line"}, {"gradient", {color, color}}, {"lineWidth", 0.6}};
    topics[name + "/points"] = cloud_settings(hex(kInk), 2.0);
    topics[name + "/odometry"] = {{"visible", false}};
    if (robot.shared_map != 0) continue;
    for (const Pose& T : robot.T_world_keyframe) box.extend(T.translation());
  }
  if (box.isEmpty()) box.extend(Vector3::Zero().eval());
  const Vector3 centre = box.center();
  // From so far away the whole map fits into the view.
  const double distance = std::max(20.0, 1.1 * box.diagonal().norm());
  const Json camera = {{"distance", distance},
                       {"perspective", true},
                       {"phi", 30},
                       {"thetaOffset", 0},
                       {"target", {0, 0, 0}},
                       {"targetOffset", {centre.x(), centre.y(), centre.z()}},
                       {"targetOrientation", {0, 0, 0, 1}},
                       {"fovy", 45},
                       {"near", 0.5},
                       {"far", 20.0 * distance}};
  const Json panel = {{"cameraState", camera},
                      {"followMode", "follow-none"},
                      {"followTf", "map"},
                      {"scene",
                       {{"backgroundColor", hex(kWhite)},
                        {"transforms", {{"axisScale", 2}, {"showLabel", false}, {"lineWidth", 0}}}}},
                      {"topics", topics},
                      {"transforms", Json::object()},
                      {"layers", Json::object()}};
  const Json layout = {{"configById", {{"3D!adit", panel}}},
                       {"globalVariables", Json::object()},
                       {"userNodes", Json::object()},
                       {"playbackConfig", {{"speed", 5}}},
                       {"layout", "3D!adit"}};
  return json_text(layout, 2) + "\n";
}

}  // namespace adit
