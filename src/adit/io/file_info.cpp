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
#include "adit/io/joint_odometry.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/text.hpp"
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

Result<Json> cloud_info(const fs::path& path) {
  return read_cloud_file(path).map([](const CloudFile& file) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& point : file.cloud.points) box.extend(point);
    return Json{{"kind", "cloud"},
                {"points", file.cloud.size()},
                {"skipped_nan", file.num_skipped_nan},
                {"intensities", !file.cloud.intensities.empty()},
                {"times", file.cloud.has_times()},
                {"viewpoint", file.viewpoint ? mount_text(*file.viewpoint) : ""},
                {"bounding_box_m", box_json(box)}};
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
Result<Json> ply_info(const fs::path& path) { return is_ply_mesh(path) ? mesh_info(path) : cloud_info(path); }

Result<Json> trajectory_info(const fs::path& path) {
  return read_tum(path).map([](const Trajectory& poses) {
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
  return read_routes(path).map([](const RoutesFile& file) {
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

// Any two stamps, whose difference may not fit 64 bits.
double seconds_between(Stamp earlier, Stamp later) {
  return static_cast<double>((static_cast<long double>(later.ns) - static_cast<long double>(earlier.ns)) /
                             1e9L);
}

/// The rate is that of the median interval, which gaps do not change.
struct Rhythm {
  double rate_hz = 0.0;
  double longest_gap_s = 0.0;
};
Rhythm rhythm_of(std::vector<double> intervals) {
  if (intervals.empty()) return {};
  const auto middle = intervals.begin() + std::ssize(intervals) / 2;
  std::ranges::nth_element(intervals, middle);
  return {*middle > 0.0 ? 1.0 / *middle : 0.0, *std::ranges::max_element(intervals)};
}

Json imu_json(const Recording& recording) {
  const std::vector<ImuSample>& imu = recording.imu;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < imu.size(); ++i)
    intervals.push_back(seconds_between(imu[i - 1].stamp, imu[i].stamp));
  const Rhythm rhythm = rhythm_of(std::move(intervals));
  return {{"name", recording.imu_name},
          {"mount", mount_text(recording.T_base_imu)},
          {"mount_from", recording.imu_mount_source},
          {"samples", imu.size()},
          {"rate_hz", rhythm.rate_hz},
          {"longest_gap_s", rhythm.longest_gap_s},
          {"first_stamp_s", stamp_text(imu.front().stamp)},
          {"last_stamp_s", stamp_text(imu.back().stamp)}};
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

/// When the messages of one topic were recorded.
struct TopicTimes {
  std::size_t count = 0;
  Stamp last;
  std::vector<double> intervals;  ///< Seconds.
};

std::vector<TopicTimes> times_of(const Bag& bag) {
  std::vector<TopicTimes> times(bag.topics.size());
  for (const BagMessage& message : bag.messages) {
    TopicTimes& topic = times[message.topic];
    if (topic.count++ > 0) topic.intervals.push_back(seconds_between(topic.last, message.log_time));
    topic.last = message.log_time;
  }
  return times;
}

/// What the messages say of themselves, by the first and the last one. A stamp that is far from the time of
/// recording, or another distance from it at the end, tells of clocks that differ or were set.
void add_contents(Json& topic, const Bag& bag, std::size_t index) {
  const std::string& type = bag.topics[index].type;
  if (type == ros::kJointState) topic["joints"] = first_joints(bag, index);
  if (!ros::is_cloud(type) && type != ros::kOdometry && type != ros::kImu) return;
  const auto is_of_topic = [index](const BagMessage& message) { return message.topic == index; };
  const auto first = std::ranges::find_if(bag.messages, is_of_topic);
  const auto last = std::find_if(bag.messages.rbegin(), bag.messages.rend(), is_of_topic);
  if (first == bag.messages.end()) return;
  const auto header = decoded(bag, *first, ros::decode_header);
  const auto end = decoded(bag, *last, ros::decode_header);
  if (!header || !end) return;
  topic["frame"] = header->frame;
  topic["recorded_after_stamp_s"] = {seconds_between(header->stamp, first->log_time),
                                     seconds_between(end->stamp, last->log_time)};
  if (type != ros::kPointCloud2) return;
  if (const auto fields = decoded(bag, *first, ros::describe_cloud)) topic["fields"] = *fields;
}

/// What adit would take each topic for; empty where it cannot choose.
std::vector<std::string> uses_of(const Bag& bag, const RecordingConfig& config) {
  std::vector<std::string> uses(bag.topics.size());
  const Result<BagTopics> chosen = choose_topics(bag, config);
  if (!chosen) return uses;
  const auto mark = [&](const TopicIndices& topics, const char* use) {
    for (const std::size_t i : topics) uses[i] = use;
  };
  mark(chosen->points, "points");
  if (config.wheel != kNoWheel) mark(chosen->wheel, "wheel");
  mark(chosen->truth, "truth");
  mark(chosen->imu, "imu");
  mark(chosen->transforms, "mounts");
  mark(chosen->static_transforms, "mounts");
  return uses;
}

Json topics_json(const Bag& bag, const RecordingConfig& config) {
  std::vector<TopicTimes> times = times_of(bag);
  const std::vector<std::string> uses = uses_of(bag, config);
  Json topics = Json::array();
  for (std::size_t i = 0; i < bag.topics.size(); ++i) {
    Json topic{
        {"topic", bag.topics[i].name}, {"type", bag.topics[i].type}, {"encoding", bag.topics[i].encoding}};
    topic["messages"] = times[i].count;
    if (times[i].count > 1) {
      const Rhythm rhythm = rhythm_of(std::move(times[i].intervals));
      topic["rate_hz"] = rhythm.rate_hz;
      topic["longest_gap_s"] = rhythm.longest_gap_s;
    }
    if (!uses[i].empty()) topic["used_as"] = uses[i];
    add_contents(topic, bag, i);
    topics.push_back(std::move(topic));
  }
  return topics;
}

/// What a bag holds, whether or not it is a recording that adit can use.
Json bag_json(const Bag& bag, bool is_mcap_file, const RecordingConfig& config) {
  Json info;
  if (is_mcap_file) {
    info = {{"kind", "mcap"}, {"profile", bag.profile}, {"chunks", bag.num_chunks}};
  } else {
    info = {{"kind", "bag"}, {"storage", bag.storage}, {"files", bag.num_files}};
  }
  info["messages"] = bag.messages.size();
  info["topics"] = topics_json(bag, config);
  return info;
}

/// What to type next, with the options that were given.
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

/// The options with which a bag that is no recording yet becomes one, the likeliest; none where none is
/// known.
std::optional<RecordingConfig> what_to_try(const Bag& bag, const RecordingConfig& config) {
  RecordingConfig likeliest = with_likeliest_topics(bag, config);
  if (read_recording(bag, likeliest)) return likeliest;
  if (!likeliest.mount.empty()) return std::nullopt;
  likeliest.mount = "0,0,0";
  if (!read_recording(bag, likeliest)) return std::nullopt;
  likeliest.mount = "X,Y,Z,ROLL,PITCH,YAW";  // to be filled in
  return likeliest;
}

/// A bag, with what adit makes of it, or why it cannot use it.
Result<Json> bag_info(const fs::path& path, const RecordingConfig& config) {
  Result<Bag> bag = open_bag(path);
  if (!bag) return tl::unexpected(bag.error());
  Json info = bag_json(*bag, lower_case(path.extension().string()) == ".mcap", config);
  const Bag looked_at = quickly_read(std::move(*bag), info);
  const Result<Recording> recording = read_recording(looked_at, config);
  if (recording) {
    info.update(recording_json(*recording));
    info["next"] = next_command(path, config);
    return info;
  }
  info["not_a_recording"] = format("{}: {}", path.string(), recording.error().message);
  if (const auto options = what_to_try(looked_at, config)) info["next"] = next_command(path, *options);
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

Result<Json> folder_info(const fs::path& path, const RecordingConfig& config) {
  if (fs::exists(path / "session.toml")) return session_info(path);
  if (is_bag_folder(path)) return bag_info(path, config);
  return open_recording(path.string(), config).map(recording_json);
}

Result<Json> info_of(const fs::path& path, const RecordingConfig& config) {
  if (fs::is_directory(path)) return folder_info(path, config);
  const std::string extension = lower_case(path.extension().string());
  if (is_bag_file(path)) return bag_info(path, config);
  if (extension == ".pcd" || extension == ".bin") return cloud_info(path);
  if (extension == ".ply") return ply_info(path);
  if (extension == ".obj" || extension == ".stl" || extension == ".dae" || extension == ".glb")
    return mesh_info(path);
  if (extension == ".tum" || extension == ".txt") return trajectory_info(path);
  if (extension == ".g2o") return graph_info(path);
  if (extension == ".adit") return robot_map_info(path);
  if (extension == ".jrl" || extension == ".cbor") return jrl_info(path);
  if (extension == ".yaml" || extension == ".yml") return routes_info(path);
  if (fs::is_regular_file(path)) {
    return fail(
        path.string() +
        ": not a kind of file that adit knows; it knows bags (.mcap .db3 .bag), clouds and meshes (.pcd .ply "
        ".bin .obj .stl .dae .glb), .tum, .g2o, .jrl, maps of robots (.adit), routes (.yaml) and folders of "
        "scans, of a bag or of a session");
  }
  return open_recording(path.string(), config).map(recording_json);
}

}  // namespace

Result<std::string> file_info(const std::string& path, const RecordingConfig& config) {
  return info_of(path, config).map([](const Json& info) { return json_text(info, 2); });
}

}  // namespace adit
