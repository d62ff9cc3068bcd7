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
  SlamConfig slam;
  RecordingConfig recording;
  ScenarioConfig simulation;
  WorldConfig world;
  OdometryMethod paper_odometry = OdometryMethod::kinematic_icp;
  MapsConfig maps;
  SightConfig sight;
  RouteConfig routes;
};
/// The keys of `slam` have no prefix of their own: robot.odometry.method, loops.place.max_distance, ...
Fields fields_of(RunConfig& config);

/// A named set of values to start from; files and single settings change them afterwards.
enum class Profile {
  standard,    ///< The defaults of the types.
  paper,       ///< The paper's pipeline: tunnel filter, PCM and GNC behind `paper_odometry`.
  lidar_only,  ///< KISS-ICP: robots without wheel odometry.
};
inline constexpr std::array kProfiles{Profile::standard, Profile::paper, Profile::lidar_only};
[[nodiscard]] std::string_view to_string(Profile profile);
[[nodiscard]] RunConfig config_of(Profile profile);

/// `config` under that keyframe policy as studies run it: the paper's policies on the paper's odometry.
[[nodiscard]] RunConfig with_policy(KeyframeSelection policy, RunConfig config);

}  // namespace adit
