// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From control points to the transform of a session's maps into the frame of surveyors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/io/georeference.hpp"
#include "adit/slam/joint_map.hpp"
#include "adit/slam/map_covariance.hpp"

namespace adit {

/// What control points say of a session, not written to it yet.
struct Georeferencing {
  std::vector<Georeference> maps;  ///< Those with control points.
  std::vector<std::string> notes;  ///< One line each.
};

/// Finds T_target_map of each map that `points` are marked in, by fit_control. A mark's error is that of
/// picking it and that of the place in the map, whose covariance is the pose graph's (graph_optimized.g2o),
/// the first keyframe of the map being its origin: far marks of a map that drifts count less. The maps
/// themselves stay as they are: a rigid transform takes no bend out of them. The session is read, not written
/// (write_georeferences). Fails, naming the point, where a mark is nowhere in the session, or in the frame of
/// a LiDAR whose mount the session does not say, and as fit_control and crs_wkt do.
[[nodiscard]] Result<Georeferencing> georeference(const std::filesystem::path& session,
                                                  const std::vector<ControlPoint>& points,
                                                  const std::string& crs);

/// The covariances of T_target_base at `places` of the map that was georeferenced: of the place in the map,
/// of T_target_map, and of what they share, as the marks lie in that map. Right perturbation, [translation;
/// rotation], metres and radians. Fails as `georeference` does, and where the map has moved since.
[[nodiscard]] Result<std::vector<Matrix6>> target_covariances(const PlacedSession& session,
                                                              const MapCovariance& covariance,
                                                              const Georeference& map,
                                                              const std::vector<Place>& places);

}  // namespace adit
