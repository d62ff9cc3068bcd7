// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The one tree of configuration keys: every command reads it and uses what concerns it.
#pragma once

#include <array>
#include <string_view>

#include "adit/core/recording_config.hpp"
#include "adit/simulation/route_config.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/simulation/world.hpp"
#include "adit/slam/joint_map.hpp"
#include "adit/slam/slam_config.hpp"
#include "adit/slam/true_surface.hpp"

namespace adit {

/// Everything that `adit config` prints.
struct RunConfig {
  SlamConfig slam;                                                ///< Between recordings and session.
  RecordingConfig recording;                                      ///< How recordings are read.
  ScenarioConfig simulation;                                      ///< Of robots and sensors.
  WorldConfig world;                                              ///< The generated one.
  OdometryMethod paper_odometry = OdometryMethod::kinematic_icp;  ///< Under the paper's policies in studies.
  MapsConfig maps;     ///< What `adit convert` writes of a session.
  SightConfig sight;   ///< What of a world's surface robots could have seen, for evaluation.
  RouteConfig routes;  ///< How `adit routes` plans.
};
/// The keys of `slam` have no prefix of their own: robot.odometry.method, loops.place.max_distance, ...
Fields fields_of(RunConfig& config);

/// A named set of values to start from; files and single settings change them afterwards.
enum class Profile {
  standard,    ///< The defaults of the types.
  paper,       ///< The paper's pipeline: tunnel filter, PCM and GNC behind `paper_odometry`.
  lidar_only,  ///< KISS-ICP: robots without wheel odometry.
};
/// All profiles.
inline constexpr std::array kProfiles{Profile::standard, Profile::paper, Profile::lidar_only};
/// default, paper, lidar-only.
[[nodiscard]] std::string_view to_string(Profile profile);
/// The values of a profile.
[[nodiscard]] RunConfig config_of(Profile profile);

/// `config` under that keyframe policy as studies run it: the paper's policies on the paper's odometry.
[[nodiscard]] RunConfig with_policy(KeyframeSelection policy, RunConfig config);

}  // namespace adit
