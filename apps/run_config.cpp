// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "run_config.hpp"

namespace adit::app {

RunConfig::RunConfig() {
  loops.registration.refine = false;
  loops.registration.min_overlap = 0.0;
  loops.registration.min_inliers = 30;
}

RunConfig under(KeyframeSelection selection, RunConfig config) {
  config.loops.policy = selection == KeyframeSelection::adaptive ? MergePolicy::adaptive : MergePolicy::paper;
  return config;
}

RunConfig studied_under(KeyframeSelection selection, RunConfig config) {
  if (selection != KeyframeSelection::adaptive) config.robot.odometry.method = config.paper_odometry;
  return under(selection, std::move(config));
}

Fields fields_of(RunConfig& c) {
  Fields fields = {enum_field("paper_odometry", &c.paper_odometry, kOdometryMethods,
                              "odometry of the paper's keyframe policies in `adit study` and `merge-study`")};
  append(fields, "simulation", fields_of(c.simulation));
  append(fields, "robot", fields_of(c.robot));
  append(fields, "loops", fields_of(c.loops));
  append(fields, "back_end", fields_of(c.back_end));
  append(fields, "bus", fields_of(c.bus));
  return fields;
}

RunConfig study_config() {
  RunConfig config;
  config.loops.place.max_distance = 0.05;
  config.loops.registration.min_inliers = 50;
  return config;
}

}  // namespace adit::app
