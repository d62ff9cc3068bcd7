// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/keyframes/tunnel_filter.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

/// A stretch of time on which the wheels were not believed.
struct SlipStretch {
  Stamp begin;             ///< Of the scan before the first such step.
  Stamp end;               ///< Of the scan after the last one.
  double counted_m = 0.0;  ///< By the wheels, more (or, negative, less) than the robot drove.
};

/// One robot's own map: its keyframes in the order driven and the odometry that joins them. All vectors but
/// `odometry`, `slips` and `innovations` are as long as `keyframes`, and keyframes[k].id.index == k.
struct RobotMap {
  RobotId id;                           ///< That of its keyframes, too.
  std::string name;                     ///< As the recording's.
  Vector3 viewpoint = Vector3::Zero();  ///< Position of the LiDAR in the base frame, metres.
  std::vector<Keyframe> keyframes;      ///< Stamps ascend.
  /// Of the drift in T_{k-1}_{k}, right perturbation; entry 0 is zero. They add up along the path.
  std::vector<Matrix6> step_covariances;
  /// Of the noise of T_odom_base itself, right perturbation, which no neighbour shares. The keyframe's cloud
  /// shares it, so that loops between clouds do not see it.
  std::vector<Matrix6> pose_noise;
  ScanContextConfig scan_context;  ///< What `places` were described with.
  /// Of the keyframes' clouds before they were thinned, with z upwards where gravity was felt.
  std::vector<ScanContext> places;
  std::vector<bool> searchable;  ///< Takes part in loop search.
  /// Share of the scan's returns that nothing confirmed (dust, drops, what moves); they are not in the cloud.
  /// None where the scan was too thin to be judged (ScanView::is_dense).
  std::vector<std::optional<float>> unconfirmed;
  Trajectory odometry;             ///< T_odom_base of every scan.
  std::vector<SlipStretch> slips;  ///< In the order of time, none touching the next.
  /// Of every scan that was registered and whose motion had been predicted with a covariance: the innovation
  /// squared, normalised, over its dimension; 1 on average where that covariance is true.
  std::vector<float> innovations;
  int num_degenerate = 0;  ///< Odometry steps with a direction that the scan did not fix.
  int num_refused = 0;     ///< Scans with too few points, or that diverged.
};

/// The mean share of the scans that were judged (RobotMap::unconfirmed); none where none was.
[[nodiscard]] std::optional<double> mean_of_judged(std::span<const std::optional<float>> shares);

/// Which keyframes take part in the graph and in the loop search.
enum class KeyframeSelection {
  all,                 ///< The paper's first policy: every keyframe takes part in both.
  tunnel_filter,       ///< The paper's second policy: tunnel-like keyframes leave both.
  adaptive,            ///< All in the graph; candidates and merges by evidence (MergePolicy::adaptive).
  tunnel_filter_keep,  ///< Tunnel-like keyframes stay in the graph and are barred from the search only.
};
/// all, tunnel_filter, adaptive, tunnel_filter_keep.
[[nodiscard]] std::string_view to_string(KeyframeSelection selection);
/// The policy of that name; fails, listing all names, where there is none.
[[nodiscard]] Result<KeyframeSelection> keyframe_selection(std::string_view name);

/// The map under that policy. Where keyframes leave, the others are numbered anew and covariances are
/// composed over the gaps. A map whose keyframes all leave is returned empty. A keyframe is tunnel-like by
/// `filter`, and where its cloud has no point near enough to tell. Throws ContractViolation when `filter` is
/// out of its ranges.
[[nodiscard]] RobotMap select_keyframes(const RobotMap& map, KeyframeSelection selection,
                                        TunnelFilterConfig filter);

}  // namespace adit
