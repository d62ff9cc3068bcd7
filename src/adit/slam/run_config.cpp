// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/run_config.hpp"

namespace adit {

Fields fields_of(RunConfig& c) {
  Fields fields = fields_of(c.slam);
  fields.push_back(
      enum_field("paper_odometry", &c.paper_odometry, kOdometryMethods,
                 "odometry under the paper's keyframe policies in studies and in the profile `paper`"));
  append(fields, "recording", fields_of(c.recording));
  append(fields, "simulation", fields_of(c.simulation));
  append(fields, "world", fields_of(c.world));
  append(fields, "maps", fields_of(c.maps));
  append(fields, "routes", fields_of(c.routes));
  append(fields, "sight", fields_of(c.sight));
  return fields;
}

std::string_view to_string(Profile profile) {
  switch (profile) {
    case Profile::standard:
      return "default";
    case Profile::paper:
      return "paper";
    case Profile::lidar_only:
      return "lidar-only";
  }
  return "";
}

RunConfig config_of(Profile profile) {
  RunConfig config;
  if (profile == Profile::paper) config = with_policy(KeyframeSelection::tunnel_filter, config);
  if (profile == Profile::lidar_only) config.slam.robot.odometry.method = OdometryMethod::kiss_icp;
  return config;
}

RunConfig with_policy(KeyframeSelection policy, RunConfig config) {
  config.slam.keyframes = policy;
  if (policy != KeyframeSelection::adaptive) config.slam.robot.odometry.method = config.paper_odometry;
  return config;
}

}  // namespace adit
