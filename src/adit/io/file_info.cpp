// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/file_info.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <variant>

#include "adit/io/bag.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/robot_map_file.hpp"
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

/// The rate is that of the median interval, which gaps do not change.
Json imu_json(const Recording& recording) {
  const std::vector<ImuSample>& imu = recording.imu;
  std::vector<Duration> intervals;
  for (std::size_t i = 1; i < imu.size(); ++i) intervals.push_back(imu[i].stamp - imu[i - 1].stamp);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  if (!intervals.empty()) std::ranges::nth_element(intervals, middle);
  return {{"name", recording.imu_name},
          {"mount", mount_text(recording.T_base_imu)},
          {"mount_from", recording.imu_mount_source},
          {"samples", imu.size()},
          {"rate_hz", intervals.empty() ? 0.0 : 1.0 / to_seconds(*middle)},
          {"longest_gap_s", intervals.empty() ? 0.0 : to_seconds(*std::ranges::max_element(intervals))},
          {"first_stamp_s", stamp_text(imu.front().stamp)},
          {"last_stamp_s", stamp_text(imu.back().stamp)}};
}

/// What is wrong with wheels and IMU, a sentence each.
Json findings_json(Recording recording) {
  Json sentences = Json::array();
  for (const SensorFinding& finding : use_sound_sensors(recording)) sentences.push_back(finding.sentence);
  return sentences;
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
  if (const Result<Scan> scan = recording.read_scan(0)) info["points_first_scan"] = scan->cloud.size();
  if (!recording.wheel.empty()) info["wheel_odometry"] = trajectory_json(recording.wheel);
  if (!recording.imu.empty()) info["imu"] = imu_json(recording);
  info["findings"] = findings_json(recording);
  if (!recording.truth.empty()) info["ground_truth"] = trajectory_json(recording.truth);
  return info;
}

/// What any MCAP file holds, whether or not it is a recording that adit can use.
Result<Json> mcap_topics_info(const fs::path& path) {
  const Result<ByteSource> source = open_source(path);
  if (!source) return tl::unexpected(source.error());
  const Result<mcap::Reader> reader = mcap::Reader::open(*source);
  if (!reader) return fail(path.string(), reader.error());
  const mcap::Contents& contents = reader->contents();
  std::map<std::uint16_t, std::size_t> counts;
  for (const mcap::MessageRef& message : contents.messages) ++counts[message.channel_id];
  Json topics = Json::array();
  for (const auto& [id, channel] : contents.channels) {
    const auto schema = contents.schemas.find(channel.schema_id);
    topics.push_back({{"topic", channel.topic},
                      {"type", schema == contents.schemas.end() ? "" : schema->second.name},
                      {"encoding", channel.message_encoding},
                      {"messages", counts[id]}});
  }
  return Json{{"kind", "mcap"},
              {"profile", contents.header.profile},
              {"chunks", contents.chunks.size()},
              {"messages", contents.messages.size()},
              {"topics", topics}};
}

/// The same of a bag of any storage.
Result<Json> bag_topics_info(const fs::path& path) {
  return open_bag(path).map([](const Bag& bag) {
    std::vector<std::size_t> counts(bag.topics.size(), 0);
    for (const BagMessage& message : bag.messages) ++counts[message.topic];
    Json topics = Json::array();
    for (std::size_t i = 0; i < bag.topics.size(); ++i)
      topics.push_back({{"topic", bag.topics[i].name},
                        {"type", bag.topics[i].type},
                        {"encoding", bag.topics[i].encoding},
                        {"messages", counts[i]}});
    return Json{{"kind", "bag"},
                {"storage", bag.storage},
                {"files", bag.num_files},
                {"messages", bag.messages.size()},
                {"topics", topics}};
  });
}

/// With what adit makes of it, or why it cannot use it.
Result<Json> with_recording(Result<Json> topics, const fs::path& path, const RecordingConfig& config) {
  return std::move(topics).map([&](Json info) {
    const Result<Recording> recording = open_recording(path.string(), config);
    if (recording) {
      info.update(recording_json(*recording));
    } else {
      info["not_a_recording"] = recording.error().message;
    }
    return info;
  });
}

Result<Json> session_info(const fs::path& path) {
  return read_session(path).map([](const SavedSession& session) {
    Json robots = Json::array();
    for (std::size_t i = 0; i < session.robots.size(); ++i) {
      Json robot{{"name", session.robots[i]}};
      if (!session.optimized[i].empty()) robot.update(trajectory_json(session.optimized[i]));
      robots.push_back(robot);
    }
    return Json{{"kind", "session"}, {"version", session.version},       {"seed", session.provenance.seed},
                {"robots", robots},  {"components", session.components}, {"loops", session.loops.size()}};
  });
}

Result<Json> folder_info(const fs::path& path, const RecordingConfig& config) {
  if (fs::exists(path / "session.toml")) return session_info(path);
  if (is_bag_folder(path)) return with_recording(bag_topics_info(path), path, config);
  return open_recording(path.string(), config).map(recording_json);
}

Result<Json> info_of(const fs::path& path, const RecordingConfig& config) {
  if (fs::is_directory(path)) return folder_info(path, config);
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".mcap") return with_recording(mcap_topics_info(path), path, config);
  if (is_bag_file(path)) return with_recording(bag_topics_info(path), path, config);
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
  return info_of(path, config).map([](const Json& info) { return info.dump(2); });
}

}  // namespace adit
