// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The configuration of everything between recordings and a session.
#pragma once

#include <array>

#include "adit/fleet/agent.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/transport/loopback_bus.hpp"

namespace adit {

/// All policies.
inline constexpr std::array kKeyframeSelections{KeyframeSelection::adaptive, KeyframeSelection::all,
                                                KeyframeSelection::tunnel_filter,
                                                KeyframeSelection::tunnel_filter_keep};

/// Defaults: the safe policy `adaptive`, which merges by tested evidence or refuses with a reason. The other
/// policies are the paper's pipeline: KISS-Matcher's global registration accepted by its number of inliers,
/// PCM, GNC. Its thresholds (`loops.place.max_distance`, `loops.registration.min_inliers`) are unstated in
/// the paper and, as it says, tuned to the site; the defaults here are tuned to the preset zab, and
/// `adaptive` does not read them.
struct SlamConfig {
  KeyframeSelection keyframes = KeyframeSelection::adaptive;  ///< The policy.
  bool check_sensors = true;                                  ///< See robot/sensor_checks.hpp.
  RobotSlamConfig robot;                                      ///< Mapping of one robot.
  AgentConfig loops;                                          ///< Search and test of loops where robots meet.
  BackEndConfig back_end;                                     ///< The joint solution.
  LoopbackConfig bus;                                         ///< What messages between robots suffer.

  SlamConfig();  ///< The defaults.
  /// `loops` under the keyframe policy: adaptive robots test merges, the paper's do not.
  [[nodiscard]] AgentConfig agent() const;
};
/// The keys have no prefix of their own.
Fields fields_of(SlamConfig& config);

}  // namespace adit
