// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/keyframes/tunnel_filter.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

/// Noise of the odometry between two keyframes, a random walk: variances grow with the distance driven, so
/// they add up along the path whatever the spacing of the keyframes.
struct OdometryNoise {
  double translation = 0.05;   ///< Sigma of each axis after one metre, metres.
  double rotation_deg = 0.15;  ///< Sigma about each axis after one metre.
  double guessed = 5.0;        ///< Factor on both where odometry had no prediction to rely on.
};
inline Fields fields_of(OdometryNoise& c) {
  return {
      {"translation", &c.translation, "m/sqrt(m)", 1e-4, 1.0, "odometry noise, translation after one metre"},
      {"rotation_deg", &c.rotation_deg, "deg/sqrt(m)", 1e-4, 10.0,
       "odometry noise, rotation after one metre"},
      {"guessed", &c.guessed, "", 1.0, 100.0,
       "factor on that noise where scans come at irregular intervals and there are no wheels"}};
}

/// Covariance of the relative pose over `distance_m` metres of odometry (right perturbation, [translation;
/// rotation], metres and radians). Distances below 1 cm count as 1 cm.
[[nodiscard]] Matrix6 odometry_covariance(const OdometryNoise& noise, double distance_m);

/// One robot's own map: its keyframes in the order driven and the odometry that joins them. All vectors but
/// `odometry` are as long as `keyframes`, and keyframes[k].id.index == k.
struct RobotMap {
  RobotId id;
  std::string name;
  Vector3 viewpoint = Vector3::Zero();  ///< Position of the LiDAR in the base frame, metres.
  std::vector<Keyframe> keyframes;
  std::vector<Matrix6> step_covariances;  ///< Of T_{k-1}_{k} (right perturbation); entry 0 is zero.
  ScanContextConfig scan_context;         ///< What `places` were described with.
  std::vector<ScanContext> places;
  std::vector<TunnelVerdict> tunnel;
  std::vector<bool> searchable;  ///< Takes part in loop search.
  Trajectory odometry;           ///< T_odom_base of every scan.
  int num_degenerate = 0;        ///< Odometry steps with a direction that the scan did not fix.
  int num_refused = 0;           ///< Scans with too few points, or that diverged.
};

/// Which keyframes take part in the graph and in the loop search.
enum class KeyframeSelection {
  all,                 ///< The paper's first policy: every keyframe takes part in both.
  tunnel_filter,       ///< The paper's second policy: tunnel-like keyframes leave both.
  adaptive,            ///< All in the graph; candidates and merges by evidence (MergePolicy::adaptive).
  tunnel_filter_keep,  ///< Tunnel-like keyframes stay in the graph and are barred from the search only.
};
[[nodiscard]] std::string_view to_string(KeyframeSelection selection);
[[nodiscard]] Result<KeyframeSelection> keyframe_selection(std::string_view name);

/// The map under that policy. Where keyframes leave, the others are numbered anew and covariances are
/// composed over the gaps. A map whose keyframes all leave is returned empty.
[[nodiscard]] RobotMap select_keyframes(const RobotMap& map, KeyframeSelection selection);

}  // namespace adit
