// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_mcap.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"
#include "adit/report/palette.hpp"
#include "adit/robot/full_rate.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Bytes of messages in a chunk, before compression.
constexpr std::size_t kChunkBytes = 4'000'000;
// Metres. Two keyframes that a loop joins lie at one place, often, where a line between them cannot be seen.
constexpr double kLoopWidth = 0.1;
constexpr double kLoopEnd = 1.5;

std::string map_frame(const PlacedRobot& robot) {
  return robot.shared_map == 0 ? "map" : format("map_{}", robot.shared_map + 1);
}

/// One robot with what is written of it.
struct ShownRobot {
  const PlacedRobot* placed = nullptr;
  std::string name;            ///< As ROS takes it.
  Trajectory at_scans;         ///< In the shared map, own stamps, like the odometry.
  Duration later{};            ///< Added to its stamps.
  std::uint16_t odometry = 0;  ///< Channels.
  std::uint16_t points = 0;
  std::uint16_t path = 0;
  std::uint16_t map = 0;

  [[nodiscard]] std::string odom_frame() const { return name + "/odom"; }
  [[nodiscard]] std::string base_frame() const { return name + "/base_link"; }
};

/// A message to come: a scan's pose or a keyframe's cloud.
struct Due {
  Stamp stamp;
  std::size_t robot = 0;
  bool is_keyframe = false;
  std::size_t index = 0;
};

/// Gathers messages in chunks.
class Messages {
 public:
  explicit Messages(std::ostream& out) : file_(out, {"ros2", "adit " + std::string(version())}) {}

  std::uint16_t add_channel(const std::string& topic, std::string_view type) {
    const auto [schema, is_new] = schemas_.try_emplace(std::string(type), std::uint16_t{0});
    if (is_new) schema->second = file_.add_schema(schema->first, "ros2msg", ros::definition_of(type));
    return file_.add_channel(topic, "cdr", schema->second);
  }
  void add(std::uint16_t channel, Stamp stamp, std::string data) {
    bytes_ += data.size();
    pending_.push_back({channel, sequence_[channel]++, stamp, stamp, std::move(data)});
    if (bytes_ >= kChunkBytes) flush();
  }
  void finish(const mcap::Metadata& metadata) {
    flush();
    file_.write_metadata(metadata);
    file_.finish();
  }

 private:
  void flush() {
    if (!pending_.empty()) file_.write_chunk(pending_);
    pending_.clear();
    bytes_ = 0;
  }

  mcap::Writer file_;
  std::map<std::string, std::uint16_t> schemas_;
  std::map<std::uint16_t, std::uint32_t> sequence_;
  std::vector<mcap::Message> pending_;
  std::size_t bytes_ = 0;
};

std::vector<ShownRobot> shown_robots(const PlacedSession& session) {
  const std::vector<std::string> names = ros_names(session);
  std::vector<ShownRobot> robots;
  for (std::size_t i = 0; i < session.robots.size(); ++i) {
    const PlacedRobot& placed = session.robots[i];
    Trajectory at_scans = at_every_scan(*placed.map, placed.T_world_keyframe);
    if (!at_scans.empty()) robots.push_back({&placed, names[i], std::move(at_scans)});
  }
  return robots;
}

Result<> check_stamps(const std::vector<ShownRobot>& robots) {
  for (const ShownRobot& robot : robots) {
    const std::vector<Keyframe>& keyframes = robot.placed->map->keyframes;
    for (const Stamp stamp : {robot.at_scans.front().stamp, robot.at_scans.back().stamp,
                              keyframes.front().stamp, keyframes.back().stamp}) {
      if (!ros::fits_ros(stamp)) {
        return fail(format("{}: the stamp {} is outside what ROS messages hold (0 to 2^31 s)",
                           robot.placed->map->name, stamp_text(stamp)));
      }
    }
  }
  return {};
}

void start_together(std::vector<ShownRobot>& robots) {
  const auto start = [](const ShownRobot& robot) { return robot.at_scans.front().stamp; };
  const Stamp first = start(std::ranges::min(robots, {}, start));
  for (ShownRobot& robot : robots) robot.later = first - start(robot);
}

std::vector<Due> all_due(const std::vector<ShownRobot>& robots) {
  std::vector<Due> due;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const ShownRobot& robot = robots[i];
    for (std::size_t k = 0; k < robot.at_scans.size(); ++k)
      due.push_back({robot.at_scans[k].stamp + robot.later, i, false, k});
    const std::vector<Keyframe>& keyframes = robot.placed->map->keyframes;
    for (std::size_t k = 0; k < keyframes.size(); ++k)
      due.push_back({keyframes[k].stamp + robot.later, i, true, k});
  }
  std::ranges::stable_sort(due, {}, &Due::stamp);
  return due;
}

/// Where a robot was at the keyframe of that stamp.
std::optional<Vector3> keyframe_at(const ShownRobot& robot, Stamp stamp) {
  const std::vector<Keyframe>& keyframes = robot.placed->map->keyframes;
  const auto found = std::ranges::lower_bound(keyframes, stamp, {}, &Keyframe::stamp);
  if (found == keyframes.end() || found->stamp != stamp) return {};
  return robot.placed->T_world_keyframe[static_cast<std::size_t>(found - keyframes.begin())].translation();
}

std::array<float, 4> opaque(Rgba color) {
  return {static_cast<float>(color.r) / 255.0F, static_cast<float>(color.g) / 255.0F,
          static_cast<float>(color.b) / 255.0F, 1.0F};
}

/// Of each shared map: loops in use, and those that were not used. Both ends have to lie in it.
std::vector<ros::Marker> loop_markers(const PlacedSession& session, const std::vector<ShownRobot>& robots,
                                      Stamp stamp) {
  std::map<std::string, const ShownRobot*> by_name;
  for (const ShownRobot& robot : robots) by_name[robot.placed->map->name] = &robot;
  std::map<std::pair<std::string, LoopFate>, ros::Marker> markers;
  for (const SavedLoop& loop : session.saved.loops) {
    const auto from = by_name.find(loop.from_robot);
    const auto to = by_name.find(loop.to_robot);
    if (from == by_name.end() || to == by_name.end() || loop.loop.verdict != LoopVerdict::accepted ||
        from->second->placed->shared_map != to->second->placed->shared_map)
      continue;
    const auto begin = keyframe_at(*from->second, loop.from_stamp);
    const auto end = keyframe_at(*to->second, loop.to_stamp);
    if (!begin || !end) continue;
    const LoopFate fate = loop.in_use() ? LoopFate::in_use : LoopFate::refused;
    const std::string frame = map_frame(*from->second->placed);
    ros::Marker& marker = markers[{frame, fate}];
    marker.frame = frame;
    marker.name = loop.in_use() ? "loops in use" : "loops not used";
    marker.stamp = stamp;
    marker.color = opaque(fate_color(fate));
    marker.width = kLoopWidth;
    marker.points.push_back(*begin);
    marker.points.push_back(*end);
  }
  std::vector<ros::Marker> out;
  for (const auto& [key, lines] : markers) {
    ros::Marker ends = lines;
    ends.shape = ros::MarkerShape::spheres;
    ends.width = kLoopEnd;
    out.insert(out.end(), {lines, std::move(ends)});
  }
  return out;
}

void add_channels(Messages& messages, std::vector<ShownRobot>& robots) {
  for (ShownRobot& robot : robots) {
    const std::string name = "/" + robot.name;
    robot.odometry = messages.add_channel(name + "/odometry", ros::kOdometry);
    robot.points = messages.add_channel(name + "/points", ros::kPointCloud2);
    robot.path = messages.add_channel(name + "/path", ros::kPath);
    robot.map = messages.add_channel(name + "/map", ros::kPointCloud2);
  }
}

void add_overviews(Messages& messages, const std::vector<ShownRobot>& robots, Stamp first, double voxel_m) {
  for (const ShownRobot& robot : robots) {
    const RobotMap& map = *robot.placed->map;
    Trajectory path;
    for (std::size_t k = 0; k < map.keyframes.size(); ++k)
      path.push_back({map.keyframes[k].stamp + robot.later, robot.placed->T_world_keyframe[k]});
    messages.add(robot.path, first, ros::encode_path(map_frame(*robot.placed), path));
    const Scan cloud{first, merged_cloud(map, robot.placed->T_world_keyframe, voxel_m)};
    messages.add(robot.map, first, ros::encode_cloud(cloud, map_frame(*robot.placed)));
  }
}

// Of T: ROS states covariances along the axes of the fixed frame, adit along those of the body.
Matrix6 along_fixed_axes(const Matrix6& covariance, const Pose& T) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T.rotation_matrix();
  return turn * covariance * turn.transpose();
}

void add_pose(Messages& messages, std::uint16_t tf, const ShownRobot& robot, const Due& due) {
  const RobotMap& map = *robot.placed->map;
  const Pose& T_odom_base = map.odometry[due.index].T_world_body;
  const Pose T_map_odom = robot.at_scans[due.index].T_world_body * T_odom_base.inverse();
  const ros::TransformMessage odometry{robot.odom_frame(), robot.base_frame(), {due.stamp, T_odom_base}};
  messages.add(tf, due.stamp,
               ros::encode_transforms(
                   {{map_frame(*robot.placed), robot.odom_frame(), {due.stamp, T_map_odom}}, odometry}));
  ros::OdometryMessage message{odometry};
  const Stamp own = map.odometry[due.index].stamp;
  const auto keyframe = std::ranges::lower_bound(map.keyframes, own, {}, &Keyframe::stamp);
  if (keyframe != map.keyframes.end() && keyframe->stamp == own)
    message.covariance.pose = along_fixed_axes(
        map.pose_noise[static_cast<std::size_t>(keyframe - map.keyframes.begin())], T_odom_base);
  messages.add(robot.odometry, due.stamp, ros::encode_odometry(message));
}

}  // namespace

std::vector<std::string> ros_names(const PlacedSession& session) {
  std::vector<std::string> names;
  for (const PlacedRobot& robot : session.robots) {
    std::string name = robot.map->name;
    std::ranges::replace_if(
        name,
        [](char c) {
          const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
          return !is_letter && (c < '0' || c > '9');
        },
        '_');
    if (name.empty() || (name.front() >= '0' && name.front() <= '9')) name.insert(0, "robot_");
    while (std::ranges::find(names, name) != names.end()) name += "_2";
    names.push_back(name);
  }
  return names;
}

Result<> write_session_mcap(const fs::path& path, const PlacedSession& session, double voxel_m,
                            bool together) {
  std::vector<ShownRobot> robots = shown_robots(session);
  if (robots.empty()) return fail(path.string() + ": no robot of the session has a map");
  if (const Result<> checked = check_stamps(robots); !checked) return fail(path.string(), checked.error());
  if (together) start_together(robots);
  const std::vector<Due> due = all_due(robots);
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  Messages messages(file->stream());
  const std::uint16_t tf = messages.add_channel("/tf", ros::kTransforms);
  const std::uint16_t graph = messages.add_channel("/graph", ros::kMarkers);
  add_channels(messages, robots);
  const Stamp first = due.front().stamp;
  add_overviews(messages, robots, first, voxel_m);
  messages.add(graph, first, ros::encode_markers(loop_markers(session, robots, first)));
  const Phase phase("writing messages", due.size());
  for (const Due& next : due) {
    const ShownRobot& robot = robots[next.robot];
    if (next.is_keyframe) {
      const Scan cloud{next.stamp, *robot.placed->map->keyframes[next.index].cloud};
      messages.add(robot.points, next.stamp, ros::encode_cloud(cloud, robot.base_frame()));
    } else {
      add_pose(messages, tf, robot, next);
    }
    phase.advance();
  }
  messages.finish({"adit session", {{"command", session.saved.provenance.command}}});
  if (!file->stream()) return fail(path.string() + ": writing failed; is the disk full?");
  fs::path layout = path;
  layout.replace_extension(".layout.json");
  return file->commit().and_then([&] { return write_bytes(layout, foxglove_layout(session)); });
}

}  // namespace adit
