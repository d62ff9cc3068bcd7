// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/file_info.hpp"
#include "adit/core/json_text.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/text.hpp"
#include "adit/io/topic_info.hpp"
#include "adit/io/trajectory_files.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/sensor_checks.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

template <class Box>
Json box_json(const Box& box) {
  return {{"min", {box.min().x(), box.min().y(), box.min().z()}},
          {"max", {box.max().x(), box.max().y(), box.max().z()}}};
}

Json trajectory_json(const Trajectory& poses) {
  return {{"poses", poses.size()},
          {"first_stamp_s", stamp_text(poses.front().stamp)},
          {"last_stamp_s", stamp_text(poses.back().stamp)},
          {"path_length_m", path_length(poses)}};
}

Result<Json> cloud_info(const fs::path& path, const RecordingConfig& config) {
  const auto read = [&](const CloudReading& stated) { return read_cloud_file(path, stated); };
  return stated_reading(config).and_then(read).map([](const CloudFile& file) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& point : file.cloud.points) box.extend(point);
    Json info{{"kind", "cloud"},
              {"points", file.cloud.size()},
              {"skipped_nan", file.num_skipped_nan},
              {"intensities", !file.cloud.intensities.empty()},
              {"times", file.cloud.has_times()},
              {"viewpoint", file.viewpoint ? mount_text(*file.viewpoint) : ""},
              {"bounding_box_m", box_json(box)}};
    if (const std::string from = point_times_text(file.times); !from.empty()) info["point_times_from"] = from;
    if (file.bin_columns) info["bin_columns"] = *file.bin_columns;
    return info;
  });
}

Result<Json> mesh_info(const fs::path& path) {
  return read_mesh(path).map([](const TriangleMesh& mesh) {
    return Json{{"kind", "mesh"},
                {"vertices", mesh.vertices.size()},
                {"triangles", mesh.triangles.size()},
                {"bounding_box_m", box_json(bounding_box(mesh))}};
  });
}

/// A PLY with faces is a mesh, one without a cloud.
Result<Json> ply_info(const fs::path& path, const RecordingConfig& config) {
  return is_ply_mesh(path) ? mesh_info(path) : cloud_info(path, config);
}

Result<Json> trajectory_info(const fs::path& path) {
  return read_trajectory(path).map([](const Trajectory& poses) {
    Json info{{"kind", "trajectory"}};
    info.update(trajectory_json(poses));
    return info;
  });
}

Result<Json> graph_info(const fs::path& path) {
  return read_g2o(path).map([](const G2oFile& file) {
    return std::visit(
        [&](const auto& graph) {
          return Json{{"kind", "graph"},
                      {"dimension", std::is_same_v<std::decay_t<decltype(graph)>, PoseGraph> ? 3 : 2},
                      {"nodes", graph.nodes.size()},
                      {"edges", graph.edges.size()},
                      {"notes", file.notes}};
        },
        file.graph);
  });
}

Result<Json> jrl_info(const fs::path& path) {
  return read_jrl(path).map([](const JrlFile& file) {
    return std::visit(
        [&](const auto& jrl) {
          return Json{{"kind", "graph"},
                      {"dimension", std::is_same_v<std::decay_t<decltype(jrl)>, JrlGraph<Pose>> ? 3 : 2},
                      {"name", file.name},
                      {"robots", file.robots},
                      {"nodes", jrl.graph.nodes.size()},
                      {"edges", jrl.graph.edges.size()},
                      {"priors", jrl.priors.size()},
                      {"notes", file.notes}};
        },
        file.content);
  });
}

Result<Json> robot_map_info(const fs::path& path) {
  return read_robot_map(path).map([](const RobotMap& map) {
    std::size_t num_points = 0;
    for (const Keyframe& keyframe : map.keyframes) num_points += keyframe.cloud->size();
    Json info{{"kind", "robot map"},
              {"name", map.name},
              {"keyframes", map.keyframes.size()},
              {"searchable", std::ranges::count(map.searchable, true)},
              {"points", num_points},
              {"slips", map.slips.size()}};
    if (!map.odometry.empty()) info["odometry"] = trajectory_json(map.odometry);
    return info;
  });
}

Result<Json> routes_info(const fs::path& path) {
  return check_not_metadata(path).and_then([&] { return read_routes(path); }).map([](const RoutesFile& file) {
    Json robots = Json::array();
    for (const Route& route : file.routes) {
      robots.push_back({{"name", route.name},
                        {"speed_mps", route.speed_mps},
                        {"waypoints", route.waypoints.size()},
                        {"length_m", length_of(route)}});
    }
    return Json{{"kind", "routes"}, {"world", file.world.string()}, {"robots", robots}};
  });
}

/// `rate_hz`, where there is one, and `longest_gap_s`.
void add_rhythm(Json& info, const Rhythm& rhythm) {
  if (rhythm.rate_hz) info["rate_hz"] = *rhythm.rate_hz;
  info["longest_gap_s"] = rhythm.longest_gap_s;
}

Json imu_json(const Recording& recording) {
  const std::vector<ImuSample>& imu = recording.imu;
  std::vector<Stamp> stamps;
  for (const ImuSample& sample : imu) stamps.push_back(sample.stamp);
  Json info{{"name", recording.imu_name},
            {"mount", mount_text(recording.T_base_imu)},
            {"mount_from", recording.imu_mount_source},
            {"samples", imu.size()}};
  add_rhythm(info, rhythm_of(stamps));
  info["first_stamp_s"] = stamp_text(imu.front().stamp);
  info["last_stamp_s"] = stamp_text(imu.back().stamp);
  return info;
}

/// What is wrong with wheels and IMU, a sentence each.
Json findings_json(Recording recording) {
  Json sentences = Json::array();
  for (const SensorFinding& finding : use_sound_sensors(recording)) sentences.push_back(finding.sentence);
  return sentences;
}

/// `point_times_s`: from where to where the times of its points lie, about the stamp.
void add_first_scan(Json& info, const Scan& scan) {
  info["points_first_scan"] = scan.cloud.size();
  if (!scan.cloud.has_times()) return;
  const auto [earliest, latest] = std::ranges::minmax(scan.cloud.time_offsets_ns);
  info["point_times_s"] = {seconds_between({0}, {earliest}), seconds_between({0}, {latest})};
}

Json recording_json(const Recording& recording) {
  Json info{{"kind", "recording"},
            {"name", recording.name},
            {"lidar", recording.lidar},
            {"mount", mount_text(recording.T_base_lidar)},
            {"mount_from", recording.mount_source},
            {"assumed", recording.assumptions},
            {"warnings", recording.warnings},
            {"scans", recording.num_scans()},
            {"first_stamp_s", stamp_text(recording.scan_stamps.front())},
            {"last_stamp_s", stamp_text(recording.scan_stamps.back())}};
  if (const Result<Scan> scan = recording.read_scan(0)) add_first_scan(info, *scan);
  if (!recording.wheel.empty()) info["wheel_odometry"] = trajectory_json(recording.wheel);
  if (!recording.imu.empty()) info["imu"] = imu_json(recording);
  info["findings"] = findings_json(recording);
  if (!recording.truth.empty()) info["ground_truth"] = trajectory_json(recording.truth);
  return info;
}

Json topic_json(const BagTopic& topic, const TopicInfo& info) {
  Json json{{"topic", topic.name},
            {"type", topic.type},
            {"encoding", topic.encoding},
            {"messages", info.num_messages}};
  if (info.num_messages > 1) add_rhythm(json, info.rhythm);
  if (!info.used_as.empty()) json["used_as"] = info.used_as;
  if (!info.joints.empty()) json["joints"] = info.joints;
  if (info.frame.empty()) return json;
  json["frame"] = info.frame;
  if (info.rate_by_stamps_hz) json["rate_by_stamps_hz"] = *info.rate_by_stamps_hz;
  json["recorded_after_stamp_s"] = {info.recorded_after_stamp_s.first, info.recorded_after_stamp_s.second};
  if (!info.fields.empty()) json["fields"] = info.fields;
  if (!info.point_times_from.empty()) json["point_times_from"] = info.point_times_from;
  return json;
}

/// What a bag holds, whether or not adit can map it.
Json bag_json(const Bag& bag, const std::vector<TopicInfo>& topics) {
  Json info{{"kind", "recording"}, {"storage", bag.storage}};
  if (bag.storage == "mcap") {
    info["profile"] = bag.profile;
    info["chunks"] = bag.num_chunks;
  }
  info["files"] = bag.num_files;
  info["messages"] = bag.messages.size();
  if (!bag.messages.empty()) {
    const Stamp start = bag.messages.front().log_time;
    const Stamp end = bag.messages.back().log_time;
    info["start_s"] = stamp_text(start);
    info["end_s"] = stamp_text(end);
    info["duration_s"] = seconds_between(start, end);
  }
  info["topics"] = Json::array();
  for (std::size_t i = 0; i < topics.size(); ++i)
    info["topics"].push_back(topic_json(bag.topics[i], topics[i]));
  return info;
}

/// Whether a folder of clouds, or FOLDER@PART, has .bin, which may lie in KITTI's `velodyne`.
bool has_bin(const fs::path& path) {
  std::error_code ignored;
  const std::string name = path.string();
  const fs::path folder = fs::is_directory(path, ignored) ? path : fs::path(name.substr(0, name.rfind('@')));
  for (const fs::path& place : {folder, folder / "velodyne"})
    for (const fs::directory_entry& entry : fs::directory_iterator(place, ignored))
      if (lower_case(entry.path().extension().string()) == ".bin") return true;
  return false;
}

/// What to type next, with the options that were given and are of use.
std::string next_command(const fs::path& path, const RecordingConfig& config) {
  std::string command = "adit doctor " + shell_quoted(path.string());
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) command += option + shell_quoted(value);
  };
  add(" --mount ", config.mount);
  add(" --points ", config.points);
  add(" --wheel ", config.wheel);
  add(" --imu ", config.imu);
  add(" --imu-mount ", config.imu_mount);
  add(" --point-times ", config.point_times);
  add(" --point-time-field ", config.point_time_field);
  if (config.bin_columns != 0 && has_bin(path)) add(" --bin-columns ", format("{}", config.bin_columns));
  add(" --tf ", config.tf);
  JointDriveConfig drive = config.drive;
  JointDriveConfig none;
  const Fields defaults = fields_of(none);
  for (std::size_t i = 0; const Field& field : fields_of(drive))
    if (value_text(field) != value_text(defaults[i++]))
      add(" --set recording.drive." + field.key + "=", value_text(field));
  add(" --set recording.truth=", config.truth);
  add(" --set recording.topics_under=", config.topics_under);
  if (config.stamp_at != RecordingConfig().stamp_at) add(" --set recording.stamp_at=", config.stamp_at);
  return command;
}

/// Seconds from the first message to the last.
double span_of(const Bag& bag) {
  if (bag.messages.empty()) return 0.0;
  return seconds_between(bag.messages.front().log_time, bag.messages.back().log_time);
}

/// Of a large bag the beginning, since wheels and scans lie among all the rest of it; `looked_at` then says
/// so.
Bag quickly_read(Bag bag, Json& info) {
  constexpr double kQuick = 100e6;  // bytes
  const double span = span_of(bag);
  const double share = kQuick / static_cast<double>(std::max<std::uint64_t>(bag.num_bytes, 1));
  if (share >= 1.0 || bag.own) return bag;
  info["looked_at"] = format("the first {:.1f} s of {:.1f} s; adit doctor looks at all", share * span, span);
  return beginning_of(std::move(bag), share * span);
}

/// The options with which a bag can be mapped that cannot be yet, the likeliest; none where none is known.
std::optional<RecordingConfig> what_to_try(const Bag& bag, const RecordingConfig& config) {
  RecordingConfig likeliest = with_likeliest_topics(bag, config);
  if (read_recording(bag, likeliest)) return likeliest;
  if (!likeliest.mount.empty()) return std::nullopt;
  likeliest.mount = "0,0,0";
  if (!read_recording(bag, likeliest)) return std::nullopt;
  likeliest.mount = "X,Y,Z,ROLL,PITCH,YAW";  // to be filled in
  return likeliest;
}

/// A bag, with what adit makes of it, or why it cannot be mapped.
Result<Json> bag_info(const fs::path& path, const RecordingConfig& config) {
  Result<Bag> bag = open_bag(path);
  if (!bag) return tl::unexpected(bag.error());
  if (const Result<> named = check_named_topics(*bag, config); !named)
    return fail(path.string(), named.error());
  const std::vector<TopicInfo> topics = topics_of(*bag, config);
  Json info = bag_json(*bag, topics);
  const Bag looked_at = quickly_read(std::move(*bag), info);
  const Result<Recording> recording = read_recording(looked_at, config);
  if (recording) {
    info.update(recording_json(*recording));
    info["next"] = next_command(path, config);
  } else {
    info["cannot_be_mapped"] = format("{}: {}", path.string(), recording.error().message);
    info["warnings"] = looked_at.warnings;
    info["findings"] = Json::array();
    if (const auto options = what_to_try(looked_at, config)) info["next"] = next_command(path, *options);
  }
  for (const TopicInfo& topic : topics)
    if (!topic.clock_finding.empty()) info["findings"].push_back(topic.clock_finding);
  return info;
}

Json georeference_json(const Georeference& map) {
  const Pose& T = map.T_target_map;
  std::map<ControlUse, std::size_t> num;
  for (const JudgedControl& point : map.points) ++num[point.use];
  const Eigen::Vector4d& q = T.rotation().coeffs();
  return {{"robots", map.robots},
          {"crs", map.crs},
          {"translation", {T.translation().x(), T.translation().y(), T.translation().z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"used", num[ControlUse::used]},
          {"rejected", num[ControlUse::rejected]},
          {"checks", num[ControlUse::check]},
          {"failed_checks", num[ControlUse::failed_check]},
          {"sigma_xy_m", map.far_end.sigma_xy},
          {"sigma_z_m", map.far_end.sigma_z}};
}

Result<Json> session_info(const fs::path& path) {
  return read_session(path).map([](const SavedSession& session) {
    Json robots = Json::array();
    for (std::size_t i = 0; i < session.robots.size(); ++i) {
      Json robot{{"name", session.robots[i]}};
      if (!session.optimized[i].empty()) robot.update(trajectory_json(session.optimized[i]));
      robots.push_back(robot);
    }
    Json info{{"kind", "session"}, {"version", session.version},       {"seed", session.provenance.seed},
              {"robots", robots},  {"components", session.components}, {"loops", session.loops.size()}};
    for (const Georeference& map : session.georeferences)
      info["georeferences"].push_back(georeference_json(map));
    return info;
  });
}

/// A folder of clouds, or FOLDER@PART.
Result<Json> scans_info(const fs::path& path, const RecordingConfig& config) {
  return open_recording(path.string(), config).map([&](const Recording& recording) {
    Json info = recording_json(recording);
    info["next"] = next_command(path, config);
    return info;
  });
}

Result<Json> folder_info(const fs::path& path, const RecordingConfig& config) {
  std::error_code ignored;
  if (fs::exists(path / "session.toml", ignored)) return session_info(path);
  return is_bag_folder(path) ? bag_info(path, config) : scans_info(path, config);
}

/// What robots of a session found is no map; the session says what it holds.
Result<Json> adit_info(const fs::path& path) {
  if (path.filename() != "fleet.adit") return robot_map_info(path);
  const fs::path session = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return Json{{"kind", "loops and merge checks of a session"},
              {"next", "adit info " + shell_quoted(session.string())}};
}

/// A setting that no recording can be read with is wrong usage of any of them.
Result<> check_reading(const RecordingConfig& config) {
  return mount_of(config)
      .and_then([&](const auto&) { return imu_mount_of(config); })
      .and_then([&](const auto&) { return stated_reading(config); })
      .and_then([&](const auto&) { return check_stamp_at(config); });
}

Result<Json> info_of(const fs::path& path, const RecordingConfig& config) {
  if (const Result<> usable = check_reading(config); !usable) return tl::unexpected(usable.error());
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return folder_info(path, config);
  const std::string extension = lower_case(path.extension().string());
  if (is_bag_file(path)) return bag_info(path, config);
  if (extension == ".pcd" || extension == ".bin") return cloud_info(path, config);
  if (extension == ".ply") return ply_info(path, config);
  if (extension == ".obj" || extension == ".stl" || extension == ".dae" || extension == ".glb")
    return mesh_info(path);
  if (extension == ".tum" || extension == ".txt" || extension == ".csv" || extension == ".kitti")
    return trajectory_info(path);
  if (extension == ".g2o") return graph_info(path);
  if (extension == ".adit") return adit_info(path);
  if (extension == ".jrl" || extension == ".cbor") return jrl_info(path);
  if (extension == ".yaml" || extension == ".yml") return routes_info(path);
  if (fs::is_regular_file(path, ignored)) {
    if (const Result<> plain = check_not_packed(path); !plain) return tl::unexpected(plain.error());
    return fail(
        path.string() +
        ": not a kind of file that adit knows; it knows bags (.mcap .db3 .bag), clouds and meshes (.pcd .ply "
        ".bin .obj .stl .dae .glb), trajectories (.tum .txt .csv), graphs (.g2o .jrl .cbor), maps of robots "
        "(.adit), routes (.yaml) and folders of scans, of a bag or of a session");
  }
  return scans_info(path, config);
}

}  // namespace

Result<std::string> file_info(const std::string& path, const RecordingConfig& config) {
  return info_of(path, config).map([](const Json& info) { return json_text(info, 2); });
}

}  // namespace adit
