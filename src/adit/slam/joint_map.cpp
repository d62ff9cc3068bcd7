// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/joint_map.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "adit/core/format.hpp"
#include "adit/geometry/normals.hpp"
#include "adit/geometry/surface_mesh.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/crs.hpp"
#include "adit/io/map_cloud.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/occupancy_map.hpp"
#include "adit/io/text.hpp"
#include "adit/slam/saved_fleet.hpp"

namespace adit {
namespace {

/// Of surfaces about a point, from which its normal is estimated: wide enough for the noise of ranges, where
/// that is not too many points.
double normal_radius(double voxel_m) { return std::max(3.0 * voxel_m, std::min(0.3, 6.0 * voxel_m)); }

/// From where each voxel of a map was seen the nearest: at a grazing angle the sides of a surface are not
/// told apart.
class NearestViews {
 public:
  NearestViews(const RobotMap& map, const std::vector<Pose>& T_world_keyframe, double voxel_m)
      : grid_(voxel_m) {
    for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
      const Eigen::Vector3f viewpoint = (T_world_keyframe[k] * map.viewpoint).cast<float>();
      const PointCloud cloud = transformed(T_world_keyframe[k], *map.keyframes[k].cloud);
      for (const Eigen::Vector3f& point : cloud.points) add(point, viewpoint);
    }
  }
  /// Of a point of the map.
  [[nodiscard]] const Eigen::Vector3f& viewpoint_of(const Eigen::Vector3f& point) const {
    return views_[numbers_.find(grid_.key_of(point).value()).value()].viewpoint;
  }

 private:
  struct View {
    Eigen::Vector3f viewpoint;
    float range = 0.0F;
  };
  void add(const Eigen::Vector3f& point, const Eigen::Vector3f& viewpoint) {
    const auto voxel = grid_.key_of(point);
    if (!voxel) return;
    const View view{viewpoint, (viewpoint - point).norm()};
    const auto number = numbers_.find_or_insert(*voxel, static_cast<std::uint32_t>(views_.size()));
    if (!number)
      views_.push_back(view);
    else if (view.range < views_[*number].range)
      views_[*number] = view;
  }

  VoxelGrid grid_;
  VoxelTable numbers_;
  std::vector<View> views_;
};

/// Normals in the frame of the map, turned to where the robot saw the point from: the nearest place of the
/// robot may be on the other side of a thin wall.
std::vector<Eigen::Vector3f> normals_of(const std::vector<Eigen::Vector3f>& points, const NearestViews& views,
                                        double radius) {
  std::vector<Eigen::Vector3f> normals = estimate_normals(points, static_cast<float>(radius));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (normals[i].dot(views.viewpoint_of(points[i]) - points[i]) < 0.0F) normals[i] = -normals[i];
  return normals;
}

/// One point of each robot in a voxel.
MapCloud map_cloud(const JointMap& map, double voxel_m, bool with_normals) {
  MapCloud out;
  for (std::size_t i = 0; i < map.maps.size(); ++i) {
    const PointCloud cloud = merged_cloud(*map.maps[i], map.T_world_keyframe[i], voxel_m);
    append(out.cloud, cloud);
    out.robots.resize(out.cloud.size(), number_in_files(*map.maps[i]));
    if (!with_normals) continue;
    const NearestViews views(*map.maps[i], map.T_world_keyframe[i], voxel_m);
    const std::vector<Eigen::Vector3f> normals = normals_of(cloud.points, views, normal_radius(voxel_m));
    out.normals.insert(out.normals.end(), normals.begin(), normals.end());
  }
  return out;
}

/// In 16 bits, so that nearly all of a robot's points keep what tells them apart: sensors have other scales.
std::vector<std::uint16_t> in_16_bits(const std::vector<float>& intensities) {
  constexpr double kNearlyAll = 0.99;
  constexpr float kLargest = 65535.0F;
  std::vector<float> sorted;
  for (const float intensity : intensities)
    if (std::isfinite(intensity)) sorted.push_back(intensity);
  std::ranges::sort(sorted);
  const float strong =
      sorted.empty() ? 0.0F
                     : sorted[static_cast<std::size_t>(kNearlyAll * static_cast<double>(sorted.size() - 1))];
  std::vector<std::uint16_t> out;
  for (const float intensity : intensities) {
    const float share =
        strong > 0.0F && std::isfinite(intensity) ? std::clamp(intensity / strong, 0.0F, 1.0F) : 0.0F;
    out.push_back(static_cast<std::uint16_t>(std::lround(kLargest * share)));
  }
  return out;
}

std::vector<LasPoint> las_points(const JointMap& map, double voxel_m, const Pose& T_frame_map) {
  std::vector<LasPoint> points;
  for (std::size_t i = 0; i < map.maps.size(); ++i) {
    const PointCloud cloud = merged_cloud(*map.maps[i], map.T_world_keyframe[i], voxel_m);
    const std::vector<std::uint16_t> intensities = in_16_bits(cloud.intensities);
    for (std::size_t k = 0; k < cloud.size(); ++k)
      points.push_back({T_frame_map * cloud.points[k].cast<double>(),
                        intensities.empty() ? std::uint16_t{0} : intensities[k],
                        number_in_files(*map.maps[i])});
  }
  return points;
}

/// From the map to where its coordinates are short.
Pose shifted_from_map(const OutputFrame& frame) {
  const Vector3 offset = float_offset(frame);
  return Pose::translation_of(-offset.x(), -offset.y(), -offset.z()) * frame.T_frame_map;
}

/// For headers of files: the frame, and what its coordinates lack; "" for the map's own frame.
std::string comment_on(const OutputFrame& frame) {
  const Vector3 offset = float_offset(frame);
  return frame.name.empty()
             ? ""
             : format("{}; add the offset {} {} {}", frame.name, offset.x(), offset.y(), offset.z());
}

/// Comments for the header of a cloud: its frame, and which robots the numbers of points mean. Each is a line
/// of its own, as `extension` has them: some readers of .ply take no long ones.
std::string comments_on(const OutputFrame& frame, const JointMap& map, const std::string& extension) {
  std::vector<std::string> lines;
  if (!frame.name.empty()) lines.push_back(comment_on(frame));
  for (const auto& robot : map.maps)
    lines.push_back(format("robot {} {}", number_in_files(*robot), robot->name));
  return format("{}", fmt::join(lines, extension == ".ply" ? "\ncomment " : "\n# "));
}

Result<> write_joint_cloud(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config,
                           const OutputFrame& frame) {
  MapCloud cloud = map_cloud(map, config.voxel_m, config.normals);
  const std::string comments = comments_on(frame, map, lower_case(path.extension().string()));
  if (frame.name.empty()) return write_map_cloud(path, cloud, comments);
  const Pose T_shifted_map = shifted_from_map(frame);
  cloud.cloud = transformed(T_shifted_map, std::move(cloud.cloud));
  const Eigen::Matrix3f R = T_shifted_map.rotation_matrix().cast<float>();
  for (Eigen::Vector3f& normal : cloud.normals) normal = R * normal;
  return write_map_cloud(path, cloud, comments);
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
      {"voxel_m", &c.voxel_m, "m", 0.01, 10.0,
       "one point a voxel of this edge in .las, .pcd and .ply (of each robot), and in .mcap"},
      {"normals", &c.normals, "", 0, 1, "whether .pcd and .ply state the surface's normal at each point"},
      {"mesh_cell_m", &c.mesh_cell_m, "m", 0.05, 10.0, "of meshes: about how long edges of triangles are"},
      {"start_together", &c.start_together, "", 0, 1,
       "in an .mcap, whether each robot starts when the first one does, whatever the stamps of "
       "its recording"}};
  append(fields, "grid", fields_of(c.grid));
  append(fields, "octomap", fields_of(c.octomap));
  return fields;
}

Result<PlacedSession> read_placed_session(const std::filesystem::path& session) {
  Result<SavedSession> saved = read_session(session);
  if (!saved) return tl::unexpected(saved.error());
  const Result<SavedFleet> fleet = read_fleet(session);
  if (!fleet) return tl::unexpected(fleet.error());
  // The map of the most robots comes first; robots without keyframes count for nothing.
  std::vector<std::vector<std::string>> shared_maps = saved->components;
  const auto num_mapped = [&](const std::vector<std::string>& names) {
    return std::ranges::count_if(fleet->maps, [&](const auto& map) {
      return !map->keyframes.empty() && std::ranges::find(names, map->name) != names.end();
    });
  };
  std::ranges::stable_sort(shared_maps, std::greater<>(), num_mapped);
  PlacedSession out;
  for (const auto& map : fleet->maps) {
    const auto index = std::ranges::find(saved->robots, map->name) - saved->robots.begin();
    const auto shared = std::ranges::find_if(shared_maps, [&](const std::vector<std::string>& names) {
      return std::ranges::find(names, map->name) != names.end();
    });
    if (index == std::ssize(saved->robots) ||
        saved->optimized[static_cast<std::size_t>(index)].size() != map->keyframes.size()) {
      return fail((session / map->name).string() +
                  ": trajectory.tum and map.adit do not belong together; one of them was changed");
    }
    const auto number = static_cast<std::size_t>(shared - shared_maps.begin());
    const bool is_listed = shared != shared_maps.end();
    PlacedRobot robot{map, {}, is_listed ? number : number + out.robots.size()};
    for (const StampedPose& pose : saved->optimized[static_cast<std::size_t>(index)])
      robot.T_world_keyframe.push_back(pose.T_world_body);
    out.robots.push_back(std::move(robot));
  }
  out.saved = std::move(*saved);
  return out;
}

JointMap joint_map_of(const PlacedSession& session, std::size_t shared_map) {
  JointMap map;
  for (const PlacedRobot& robot : session.robots) {
    if (robot.shared_map != shared_map) {
      map.left_out.push_back(robot.map->name);
      continue;
    }
    map.maps.push_back(robot.map);
    map.T_world_keyframe.push_back(robot.T_world_keyframe);
  }
  return map;
}

Result<OutputFrame> target_frame(const Georeference& map) {
  return crs_wkt(map.crs).map([&](const std::string& wkt) {
    std::string name = map.crs.empty() ? "the target frame" : map.crs;
    std::ranges::replace_if(
        name, [](unsigned char c) { return c < ' '; }, ' ');  // for lines of headers
    return OutputFrame{map.T_target_map, std::move(name), wkt};
  });
}

Vector3 float_offset(const OutputFrame& frame) {
  constexpr double kFar = 4000.0;  // metres; there float32 has steps of 0.2 to 0.5 mm
  return frame.T_frame_map.translation().unaryExpr([](double coordinate) {
    return std::abs(coordinate) < kFar ? 0.0 : 1000.0 * std::round(coordinate / 1000.0);
  });
}

std::uint16_t number_in_files(const RobotMap& map) { return static_cast<std::uint16_t>(map.id.value + 1); }

bool is_for_robots(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".pgm" || extension == ".bt";
}

Result<> write_joint_map(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config,
                         const OutputFrame& frame) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".las")
    return write_las(path, las_points(map, config.voxel_m, frame.T_frame_map), frame.crs_wkt);
  if (extension == ".pgm")
    return occupancy_of(scans_of(map), config.grid).and_then([&](const OccupancyGrid& grid) {
      return write_occupancy_map(path, grid);
    });
  if (extension == ".bt") return write_octomap(path, scans_of(map), config.octomap);
  if (extension == ".pcd" || extension == ".ply") return write_joint_cloud(path, map, config, frame);
  return fail(path.string() +
              ": a session becomes .las, .pcd, .ply, .pgm (with .yaml), .bt, .mcap (with a layout), .tum, "
              ".kitti, .csv, .jrl or .g2o");
}

Result<> write_joint_mesh(const std::filesystem::path& path, const JointMap& map, const MapsConfig& config,
                          const OutputFrame& frame) {
  constexpr double kPointsPerCell = 2.0;  // along an edge, so that each corner sees several
  if (lower_case(path.extension().string()) != ".ply")
    return fail(path.string() + ": the mesh of a session becomes .ply");
  const MapCloud cloud = map_cloud(map, config.mesh_cell_m / kPointsPerCell, true);
  TriangleMesh mesh = surface_mesh(cloud.cloud.points, cloud.normals, config.mesh_cell_m);
  if (mesh.empty()) return fail(path.string() + ": the map has too few points for a surface");
  const Pose T_shifted_map = shifted_from_map(frame);
  for (Eigen::Vector3f& vertex : mesh.vertices)
    vertex = (T_shifted_map * vertex.cast<double>()).cast<float>();
  return write_mesh(path, mesh, comment_on(frame));
}

}  // namespace adit
