// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The configuration of everything between recordings and a session.
#pragma once

#include <array>

#include "adit/fleet/agent.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/transport/loopback_bus.hpp"

namespace adit {

inline constexpr std::array kKeyframeSelections{KeyframeSelection::adaptive, KeyframeSelection::all,
                                                KeyframeSelection::tunnel_filter,
                                                KeyframeSelection::tunnel_filter_keep};

/// Defaults: the safe policy `adaptive`, which merges by tested evidence or refuses with a reason. The other
/// policies are the paper's pipeline: KISS-Matcher's global registration accepted by its number of inliers,
/// PCM, GNC. Its thresholds (`loops.place.max_distance`, `loops.registration.min_inliers`) are unstated in
/// the paper and, as it says, tuned to the site; the defaults here are tuned to the preset zab, and
/// `adaptive` does not read them.
struct SlamConfig {
  KeyframeSelection keyframes = KeyframeSelection::adaptive;
  bool check_sensors = true;  ///< See robot/sensor_checks.hpp.
  RobotSlamConfig robot;
  AgentConfig loops;
  BackEndConfig back_end;
  LoopbackConfig bus;

  SlamConfig();
  /// `loops` under the keyframe policy: adaptive robots test merges, the paper's do not.
  [[nodiscard]] AgentConfig agent() const;
};
Fields fields_of(SlamConfig& config);

}  // namespace adit
