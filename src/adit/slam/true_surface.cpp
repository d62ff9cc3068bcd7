// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/true_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/session_dir.hpp"

namespace adit {
namespace {

constexpr double kSampleSpacing = 0.2;      ///< Metres between samples of the true surface.
constexpr double kMapSpacing = 0.05;        ///< Of the maps that are compared: half of what counts as mapped.
constexpr double kEyeSpacing = 1.0;         ///< Metres of the true path.
constexpr float kSurfaceThickness = 0.01F;  ///< What a ray meets so near to a sample is the sample's surface.
constexpr std::size_t kGrain = 4096;

/// True positions of the sensor, by cells as large as its reach.
class Eyes {
 public:
  Eyes(std::span<const Eigen::Vector3f> eyes, const SightConfig& config)
      : reach_(static_cast<float>(config.reach_m)),
        least_cosine_(static_cast<float>(std::cos(config.incidence_deg * kDegree))) {
    for (const Eigen::Vector3f& eye : eyes) cells_[cell_of(eye)].push_back(eye);
  }

  [[nodiscard]] bool see(const MeshPoint& sample, const Raycaster& raycaster) const {
    const Eigen::Vector3f target = sample.point.cast<float>();
    const Eigen::Vector3f normal = sample.normal.cast<float>();
    const auto sees = [&](const Eigen::Vector3f& eye) {
      const Eigen::Vector3f way = target - eye;
      const float distance = way.norm();
      if (distance > reach_ || std::abs(way.dot(normal)) < least_cosine_ * distance) return false;
      if (distance <= kSurfaceThickness) return true;
      return !raycaster.cast({eye, way / distance}, distance - kSurfaceThickness).hit();
    };
    const auto [x, y] = cell_of(target);
    // The cell of the sample first: most rays that meet it come from there.
    for (const int dx : {0, -1, 1})
      for (const int dy : {0, -1, 1})
        if (const auto cell = cells_.find({x + dx, y + dy});
            cell != cells_.end() && std::ranges::any_of(cell->second, sees))
          return true;
    return false;
  }

 private:
  using Cell = std::pair<int, int>;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& p) const {
    return {static_cast<int>(std::floor(p.x() / reach_)), static_cast<int>(std::floor(p.y() / reach_))};
  }
  float reach_;
  float least_cosine_;
  std::map<Cell, std::vector<Eigen::Vector3f>> cells_;
};

/// How many samples could have been seen, and how many of these are mapped.
struct Seen {
  std::size_t total = 0;
  std::size_t mapped = 0;
  Seen& operator+=(const Seen& other) {
    total += other.total;
    mapped += other.mapped;
    return *this;
  }
};

}  // namespace

Result<TrueSurface> TrueSurface::build(const TriangleMesh& mesh) {
  return Raycaster::build(mesh).map(
      [&](const Raycaster& raycaster) { return TrueSurface(raycaster, mesh_points(mesh, kSampleSpacing)); });
}

std::vector<double> TrueSurface::distances(const std::vector<Eigen::Vector3f>& map) const {
  std::vector<double> distances(map.size());
  parallel_for_each(
      map.size(), [&](std::size_t i) { distances[i] = static_cast<double>(raycaster_.distance(map[i])); },
      kGrain);
  return distances;
}

Result<> TrueSurface::add_completeness(const PointGrid& map, std::span<const Eigen::Vector3f> positions,
                                       const SightConfig& config, MapAccuracy& accuracy) const {
  const Eyes eyes(positions, config);
  const Seen seen = parallel_sum(samples_.size(), kGrain, Seen{}, [&](std::size_t begin, std::size_t end) {
    Seen part;
    for (std::size_t i = begin; i < end; ++i) {
      if (!eyes.see(samples_[i], raycaster_)) continue;
      ++part.total;
      part.mapped += map.nearest(samples_[i].point.cast<float>(), static_cast<float>(kMappedWithin)) ? 1 : 0;
    }
    return part;
  });
  if (seen.total == 0) {
    const Eigen::Vector3f& first = positions.front();
    return fail(
        format("nothing of the mesh is within {} m of the true path, which begins at ({:.1f}, {:.1f}, "
               "{:.1f}); do mesh and truth share a frame?",
               config.reach_m, first.x(), first.y(), first.z()));
  }
  accuracy.completeness = static_cast<double>(seen.mapped) / static_cast<double>(seen.total);
  accuracy.seen_m2 = static_cast<double>(seen.total) * kSampleSpacing * kSampleSpacing;
  return {};
}

Result<MapAccuracy> TrueSurface::compare(const std::vector<Eigen::Vector3f>& map,
                                         std::span<const Eigen::Vector3f> eyes,
                                         const SightConfig& config) const {
  const Phase phase("map against mesh");
  std::vector<Eigen::Vector3f> points;
  std::ranges::copy_if(map, std::back_inserter(points),
                       [](const Eigen::Vector3f& point) { return point.allFinite(); });
  if (points.empty()) return fail("the map has no point");
  MapAccuracy accuracy;
  accuracy.num_points = points.size();
  const std::vector<double> errors = distances(points);
  accuracy.median_m = median(errors);
  accuracy.p95_m = percentile(errors, 95.0);
  if (eyes.empty()) return accuracy;
  return add_completeness(PointGrid(points, kCellVoxels * kMapSpacing), eyes, config, accuracy).map([&] {
    return accuracy;
  });
}

std::vector<Eigen::Vector3f> eyes_of(const Trajectory& truth, Stamp begin, Stamp end,
                                     const Vector3& viewpoint) {
  std::vector<Eigen::Vector3f> eyes;
  for (const StampedPose& pose : truth) {
    if (pose.stamp < begin || pose.stamp > end) continue;
    const Eigen::Vector3f eye = (pose.T_world_body * viewpoint).cast<float>();
    if (eyes.empty() || (eye - eyes.back()).norm() >= static_cast<float>(kEyeSpacing)) eyes.push_back(eye);
  }
  return eyes;
}

Result<MapAccuracy> accuracy_of(std::span<const TruedRobot> robots, const Pose& T_world_map,
                                const TrueSurface& surface, const SightConfig& config) {
  PointCloud all;
  std::vector<Eigen::Vector3f> eyes;
  for (const TruedRobot& robot : robots) {
    const std::vector<Keyframe>& keyframes = robot.map->keyframes;
    if (keyframes.empty()) continue;
    std::vector<Pose> T_world_keyframe;
    for (const Pose& pose : robot.T_map_keyframe) T_world_keyframe.push_back(T_world_map * pose);
    const PointCloud cloud = merged_cloud(*robot.map, T_world_keyframe, kMapSpacing);
    all.points.insert(all.points.end(), cloud.points.begin(), cloud.points.end());
    const std::vector<Eigen::Vector3f> own =
        eyes_of(*robot.truth, keyframes.front().stamp, keyframes.back().stamp, robot.map->viewpoint);
    eyes.insert(eyes.end(), own.begin(), own.end());
  }
  if (all.empty()) return fail("the map has no point");
  return surface.compare(voxel_downsample(all, kMapSpacing).points, eyes, config);
}

}  // namespace adit
