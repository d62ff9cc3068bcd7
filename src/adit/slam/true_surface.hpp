// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Compares maps with the true surface of a world, a mesh.
#pragma once

#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/evaluation/map_accuracy.hpp"
#include "adit/geometry/mesh_points.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/robot/robot_map.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// What of a surface a robot could have seen: that on which a ray from a true position of its sensor falls,
/// no longer than `reach_m` and no flatter than `incidence_deg`, with nothing in between. It does not depend
/// on the sensor, so that a narrow view or a dropped scan shows as a hole in the map. It is not the range of
/// the sensor either: far down a tunnel, walls are met under flat angles, with metres between returns.
struct SightConfig {
  double reach_m = 20.0;
  double incidence_deg = 75.0;
  double sensor_height_m = 0.9;  ///< Above the true trajectory, for clouds that do not say.
};
/// The keys are the names of the fields.
inline Fields fields_of(SightConfig& c) {
  return {{"reach_m", &c.reach_m, "m", 0.5, 1000,
           "a surface could have been seen from a true position of the sensor so near ..."},
          {"incidence_deg", &c.incidence_deg, "deg", 1, 90,
           "... under an angle of at most this (0: head-on), with nothing in between"},
          {"sensor_height_m", &c.sensor_height_m, "m", 0, 10,
           "sensor above the positions of the true trajectory, where a cloud is compared"}};
}

/// A mesh made ready for distances and lines of sight.
class TrueSurface {
 public:
  /// Fails as `check_mesh` does.
  [[nodiscard]] static Result<TrueSurface> build(const TriangleMesh& mesh);

  /// `map`, points in the frame of the mesh, against the surface; `eyes` are the true positions of the
  /// sensor, a metre apart or less; without any there is no completeness. Points that are not finite do not
  /// count. Fails on a map without points, and where nothing of the surface can be seen from the eyes: they
  /// are then not inside of this mesh.
  [[nodiscard]] Result<MapAccuracy> compare(const std::vector<Eigen::Vector3f>& map,
                                            std::span<const Eigen::Vector3f> eyes,
                                            const SightConfig& config) const;

 private:
  TrueSurface(Raycaster raycaster, std::vector<MeshPoint> samples)
      : raycaster_(std::move(raycaster)), samples_(std::move(samples)) {}
  [[nodiscard]] std::vector<double> distances(const std::vector<Eigen::Vector3f>& map) const;
  [[nodiscard]] Result<> add_completeness(const PointGrid& map, std::span<const Eigen::Vector3f> eyes,
                                          const SightConfig& config, MapAccuracy& accuracy) const;
  Raycaster raycaster_;
  std::vector<MeshPoint> samples_;
};

/// Positions on the true drive T_world_base between two stamps, about one a metre, `viewpoint` (base frame)
/// being that of the sensor.
[[nodiscard]] std::vector<Eigen::Vector3f> eyes_of(const Trajectory& truth, Stamp begin, Stamp end,
                                                   const Vector3& viewpoint);

/// A robot of a shared map.
struct TruedRobot {
  const RobotMap* map = nullptr;         ///< With its keyframes' clouds; not owned, as all here.
  std::span<const Pose> T_map_keyframe;  ///< One a keyframe.
  const Trajectory* truth = nullptr;     ///< T_world_base.
};
/// The map of these robots, one point in 5 cm, after the alignment T_world_map, against the surface that they
/// could have seen between their first and last keyframes.
[[nodiscard]] Result<MapAccuracy> accuracy_of(std::span<const TruedRobot> robots, const Pose& T_world_map,
                                              const TrueSurface& surface, const SightConfig& config);

}  // namespace adit
