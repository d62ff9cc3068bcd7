// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/joint_map.hpp"

#include <algorithm>

#include "adit/io/cloud_files.hpp"
#include "adit/io/las.hpp"
#include "adit/io/occupancy_map.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/text.hpp"
#include "adit/slam/saved_fleet.hpp"

namespace adit {
namespace {

std::vector<LasPoint> las_points(const JointMap& map, double voxel_m) {
  std::vector<LasPoint> points;
  for (std::size_t i = 0; i < map.maps.size(); ++i) {
    const PointCloud cloud = merged_cloud(*map.maps[i], map.T_world_keyframe[i], voxel_m);
    for (const Eigen::Vector3f& point : cloud.points)
      points.push_back({point.cast<double>(), 0, static_cast<std::uint16_t>(map.maps[i]->id.value + 1)});
  }
  return points;
}

std::vector<PlacedScan> scans_of(const JointMap& map) {
  std::vector<PlacedScan> scans;
  for (std::size_t i = 0; i < map.maps.size(); ++i)
    for (std::size_t k = 0; k < map.maps[i]->keyframes.size(); ++k)
      scans.push_back({map.maps[i]->keyframes[k].cloud, map.maps[i]->viewpoint, map.T_world_keyframe[i][k]});
  return scans;
}

}  // namespace

Fields fields_of(MapsConfig& c) {
  Fields fields = {
      {"voxel_m", &c.voxel_m, "m", 0.01, 10.0, "one point a voxel of this edge in .las, .pcd and .ply"}};
  append(fields, "grid", fields_of(c.grid));
  return fields;
}

Result<JointMap> read_joint_map(const std::filesystem::path& session) {
  const Result<SavedSession> saved = read_session(session);
  if (!saved) return tl::unexpected(saved.error());
  const Result<SavedFleet> fleet = read_fleet(session);
  if (!fleet) return tl::unexpected(fleet.error());
  const auto largest = std::ranges::max_element(saved->components, {}, &std::vector<std::string>::size);
  JointMap map;
  for (const auto& robot : fleet->maps) {
    const bool is_in =
        largest != saved->components.end() && std::ranges::find(*largest, robot->name) != largest->end();
    if (!is_in) {
      map.left_out.push_back(robot->name);
      continue;
    }
    const auto index = std::ranges::find(saved->robots, robot->name) - saved->robots.begin();
    const Trajectory& trajectory = saved->optimized[static_cast<std::size_t>(index)];
    if (trajectory.size() != robot->keyframes.size())
      return fail(
          (session / robot->name).string() +
          ": trajectory.tum and map.adit have different numbers of keyframes; one of them was changed");
    map.maps.push_back(robot);
    map.T_world_keyframe.emplace_back();
    for (const StampedPose& pose : trajectory) map.T_world_keyframe.back().push_back(pose.T_world_body);
  }
  return map;
}

Result<> write_joint_map(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".las") return write_las(path, las_points(map, config.voxel_m));
  if (extension == ".pgm")
    return occupancy_of(scans_of(map), config.grid).and_then([&](const OccupancyGrid& grid) {
      return write_occupancy_map(path, grid);
    });
  if (extension == ".pcd" || extension == ".ply")
    return write_cloud(path, merged_cloud(map.maps, map.T_world_keyframe, config.voxel_m));
  return fail(path.string() + ": a session becomes .las, .pcd, .ply or .pgm (with .yaml)");
}

}  // namespace adit
