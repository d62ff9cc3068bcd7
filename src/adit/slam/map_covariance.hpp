// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well the places of a session's maps are known.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"
#include "adit/posegraph/marginals.hpp"
#include "adit/slam/joint_map.hpp"

namespace adit {

/// A keyframe of a session.
struct Place {
  std::size_t robot = 0;     ///< Index into PlacedSession::robots.
  std::size_t keyframe = 0;  ///< Of that robot.

  /// Its pose in its shared map.
  [[nodiscard]] const Pose& T_map_keyframe(const PlacedSession& session) const {
    return session.robots[robot].T_world_keyframe[keyframe];
  }
  bool operator==(const Place&) const = default;  ///< Whether it is the same keyframe.
};

/// How the places of a map vary together: the covariance of the session's optimized graph, with the first
/// keyframe of each map held fixed, and each keyframe's own noise (which that one has, too). Right
/// perturbation, [translation; rotation], metres and radians.
class MapCovariance {
 public:
  /// Of the session in that folder, whose graph_optimized.g2o is read. `session` must outlive the result.
  /// Fails where the graph is missing, is singular or is not that of the session.
  static Result<MapCovariance> of(const PlacedSession& session, const std::filesystem::path& folder);

  static Result<MapCovariance> of(const PlacedSession&& session, const std::filesystem::path&) = delete;

  /// Six rows for each of `rows`, six columns for each of `columns`.
  [[nodiscard]] Eigen::MatrixXd cross(const std::vector<Place>& rows,
                                      const std::vector<Place>& columns) const;
  /// Of one place.
  [[nodiscard]] Matrix6 at(const Place& place) const;

 private:
  MapCovariance(const PlacedSession& session, Marginals<Pose> marginals)
      : session_(session), marginals_(std::move(marginals)) {}

  [[nodiscard]] std::vector<std::size_t> nodes_of(const std::vector<Place>& places) const;

  const PlacedSession& session_;
  Marginals<Pose> marginals_;
  std::map<std::uint64_t, std::size_t> nodes_;
};

}  // namespace adit
