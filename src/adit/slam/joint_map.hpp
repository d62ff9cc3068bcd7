// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The joint map of a session in the formats that others read.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/geometry/occupancy_grid.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/las.hpp"
#include "adit/io/octomap_file.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// How a session's map is written in other formats.
struct MapsConfig {
  double voxel_m = 0.1;         ///< Of clouds: one point a cube of this edge, metres.
  bool normals = false;         ///< Of .pcd and .ply: with the surface's normal at each point.
  double mesh_cell_m = 0.2;     ///< Of meshes: about how long edges of triangles are, metres.
  bool start_together = false;  ///< Of .mcap: all robots start when the first one does.
  OccupancyConfig grid;
  OctomapConfig octomap;
};
/// Keys of `grid` and `octomap` begin with these names.
[[nodiscard]] Fields fields_of(MapsConfig& config);

/// A robot of a session, with its keyframes in the frame of its shared map.
struct PlacedRobot {
  std::shared_ptr<const RobotMap> map;  ///< As it was saved, by its own odometry.
  std::vector<Pose> T_world_keyframe;   ///< One for each keyframe.
  std::size_t shared_map = 0;           ///< Number of the shared map; 0 is that of the most robots.
};
/// A saved session with the maps of its robots.
struct PlacedSession {
  SavedSession saved;               ///< All but the maps.
  std::vector<PlacedRobot> robots;  ///< By id; `saved` may name more, which have no keyframes.
};
/// Fails as read_fleet does, and where a robot's trajectory and map do not belong together.
[[nodiscard]] Result<PlacedSession> read_placed_session(const std::filesystem::path& session);

/// The frame that clouds and poses are written in.
struct OutputFrame {
  Pose T_frame_map;                 ///< The identity for the map's own frame.
  std::string name;                 ///< For people; "" for the map's own.
  std::string crs_wkt = kLocalCrs;  ///< Its coordinate system as well-known text, for .las.
};
/// The target frame of a map: "EPSG:25833", or "the target frame" where no system was named. Fails as crs_wkt
/// does.
[[nodiscard]] Result<OutputFrame> target_frame(const Georeference& map);

/// Robots that share a frame, with their keyframes in it.
struct JointMap {
  std::vector<std::shared_ptr<const RobotMap>> maps;  ///< By robot id.
  std::vector<std::vector<Pose>> T_world_keyframe;    ///< One for each keyframe of each map.
  std::vector<std::string> left_out;                  ///< Robots of the session that are in other maps.
};
/// The map with that number (PlacedRobot::shared_map): 0 is that of the most robots, the first of several.
[[nodiscard]] JointMap joint_map_of(const PlacedSession& session, std::size_t shared_map = 0);

/// What is subtracted from coordinates in that frame before they are stored as float32: thousands of metres
/// where the map is further than 4 km from zero along an axis, so that millimetres stay.
[[nodiscard]] Vector3 float_offset(const OutputFrame& frame);

/// Of the robot in .las, .pcd and .ply, from 1 on.
[[nodiscard]] std::uint16_t number_in_files(const RobotMap& map);

/// Whether maps of that ending are for robots, which know the map by its own frame: .pgm and .bt.
[[nodiscard]] bool is_for_robots(const std::filesystem::path& path);

/// Writes .las (the source ID is the number of the robot; intensities of each robot are scaled to 16 bits, so
/// that all but the strongest hundredth fit), .pcd or .ply (write_map_cloud; less
/// `float_offset`, which their header states, as it does whom each number means), .bt (write_octomap) or .pgm
/// with its .yaml (occupancy_of). The last two are always in the map's own frame. Fails on other endings.
Result<> write_joint_map(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config,
                         const OutputFrame& frame = {});

/// Writes the surface of the map (surface_mesh of its points) as a .ply with faces that look to where they
/// were seen from, less `float_offset`, which the header states. Fails on other endings, and where too little
/// was seen for a surface.
Result<> write_joint_mesh(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config,
                          const OutputFrame& frame = {});

}  // namespace adit
