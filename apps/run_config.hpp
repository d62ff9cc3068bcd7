// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The whole configuration of a run, in one tree of keys.
#pragma once

#include "adit/fleet/agent.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/transport/loopback_bus.hpp"
#include "command_line.hpp"

namespace adit::app {

struct RunConfig {
  ScenarioConfig simulation;
  RobotSlamConfig robot;
  AgentConfig loops;
  BackEndConfig back_end;
  LoopbackConfig bus;
  OdometryMethod paper_odometry = OdometryMethod::kinematic_icp;

  /// The paper's pipeline behind the odometry: KISS-Matcher's global result accepted by its inliers, PCM,
  /// GNC.
  RunConfig();
};
Fields fields_of(RunConfig& config);

/// The configuration under a keyframe policy: `adaptive` chooses candidates and tests merges by evidence.
[[nodiscard]] RunConfig under(KeyframeSelection selection, RunConfig config);

/// The same in a study, where the paper's policies run on the paper's odometry.
[[nodiscard]] RunConfig studied_under(KeyframeSelection selection, RunConfig config);

/// That pipeline with the thresholds of the studies. The paper's are unstated and, as it says, tuned to the
/// site; these are tuned to zab.
[[nodiscard]] RunConfig study_config();

}  // namespace adit::app
