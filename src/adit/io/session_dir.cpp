// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/session_dir.hpp"

#include <sstream>
#include <system_error>

#include "adit/core/progress.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/folders.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/loops_csv.hpp"
#include "adit/io/session_toml.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/keyframe_trajectory.hpp"

namespace adit {
namespace {

constexpr double kMapVoxel = 0.2;
Result<> write_robot(const std::filesystem::path& dir, const RobotMap& map, const FleetSolution& solution,
                     MapFiles map_files) {
  if (map.keyframes.empty()) return {};  // all of them left under the policy: nothing to write
  const std::filesystem::path folder = dir / map.name;
  Result<> done = make_folder(folder);
  const std::vector<Pose>& T_world_keyframe = solution.T_world_keyframe.at(map.id);
  if (done) done = write_tum(folder / "trajectory.tum", keyframe_trajectory(map, T_world_keyframe));
  if (done) done = write_tum(folder / "odometry.tum", map.odometry);
  if (done && map_files == MapFiles::write) {
    done = write_cloud(folder / "map.ply", merged_cloud(map, T_world_keyframe, kMapVoxel));
  }
  return done;
}

Result<> write_graph(const std::filesystem::path& path, const PoseGraph& graph) {
  std::ostringstream text;
  write_g2o(text, graph);
  return write_bytes(path, text.str());
}

Result<> write_graphs(const std::filesystem::path& dir, const FleetSolution& solution) {
  Result<> done = write_graph(dir / "graph_initial.g2o", solution.initial);
  if (done) done = write_graph(dir / "graph_pcm.g2o", solution.after_pcm);
  if (done) done = write_graph(dir / "graph_optimized.g2o", solution.optimized);
  return done;
}

Result<> write_merged_map(const std::filesystem::path& dir, const Session& session) {
  std::vector<std::vector<Pose>> T_world_keyframe;
  for (const auto& map : session.maps)
    T_world_keyframe.push_back(session.solution.T_world_keyframe.at(map->id));
  const PointCloud all = merged_cloud(session.maps, T_world_keyframe, kMapVoxel);
  return all.empty() ? Result<>{} : write_cloud(dir / "map.ply", all);
}

/// The folder of a robot whose keyframes all left under the policy is not written; another of that name may
/// be the user's.
bool has_robot(const std::filesystem::path& folder) {
  std::error_code error;  // reading the file then says what is wrong
  std::error_code ignored;
  return std::filesystem::exists(folder / "trajectory.tum", error) || error ||
         std::filesystem::exists(folder / "odometry.tum", ignored);
}

}  // namespace

PointCloud merged_cloud(const RobotMap& map, const std::vector<Pose>& T_world_keyframe, double voxel) {
  // Thinned every so many keyframes: neighbours see the same walls, and the sum of all clouds need not fit
  // memory.
  constexpr std::size_t kKeyframesAtOnce = 32;
  PointCloud merged;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    append(merged, transformed(T_world_keyframe.at(k), *map.keyframes[k].cloud));
    if (k % kKeyframesAtOnce == kKeyframesAtOnce - 1) merged = voxel_downsample(merged, voxel);
  }
  return voxel_downsample(merged, voxel);
}

PointCloud merged_cloud(const std::vector<std::shared_ptr<const RobotMap>>& maps,
                        const std::vector<std::vector<Pose>>& T_world_keyframe, double voxel) {
  PointCloud all;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    append(all, merged_cloud(*maps[i], T_world_keyframe.at(i), voxel));
  }
  return all.empty() ? all : voxel_downsample(all, voxel);
}

Result<> write_session(const std::filesystem::path& dir, const Session& session, MapFiles map_files) {
  const Phase phase("writing", session.maps.size() + 1);
  Result<> done = write_bytes(dir / "session.toml", session_toml(session));
  for (const auto& map : session.maps) {
    if (done) done = write_robot(dir, *map, session.solution, map_files);
    phase.advance();
  }
  if (done) done = write_graphs(dir, session.solution);
  if (done) done = write_bytes(dir / "loops.csv", loops_csv(session));
  if (done && map_files == MapFiles::write) done = write_merged_map(dir, session);
  return done;
}

Result<SavedSession> read_session(const std::filesystem::path& dir) {
  const Result<std::string> toml = read_bytes(dir / "session.toml");
  if (!toml) return fail(dir.string() + ": not a session directory", toml.error());
  Result<SessionHeader> header = parse_session_toml(*toml);
  if (!header) return fail((dir / "session.toml").string(), header.error());
  SavedSession session;
  session.version = std::move(header->version);
  session.provenance = std::move(header->provenance);
  session.robots = std::move(header->robots);
  session.components = std::move(header->components);
  for (const std::string& robot : session.robots) {
    if (!has_robot(dir / robot)) {
      session.optimized.emplace_back();
      session.odometry.emplace_back();
      continue;
    }
    Result<Trajectory> optimized = read_tum(dir / robot / "trajectory.tum");
    if (!optimized) return tl::unexpected(optimized.error());
    Result<Trajectory> odometry = read_tum(dir / robot / "odometry.tum");
    if (!odometry) return tl::unexpected(odometry.error());
    session.optimized.push_back(std::move(*optimized));
    session.odometry.push_back(std::move(*odometry));
  }
  const Result<std::string> csv = read_bytes(dir / "loops.csv");
  if (!csv) return tl::unexpected(csv.error());
  Result<std::vector<SavedLoop>> loops = parse_loops_csv(*csv);
  if (!loops) return fail((dir / "loops.csv").string(), loops.error());
  session.loops = std::move(*loops);
  Result<std::vector<Georeference>> georeferences = read_georeferences(dir);
  if (!georeferences) return tl::unexpected(georeferences.error());
  session.georeferences = std::move(*georeferences);
  return session;
}

}  // namespace adit
