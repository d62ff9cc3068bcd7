// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/slam_config.hpp"

namespace adit {

SlamConfig::SlamConfig() {
  loops.place.max_distance = 0.05;
  loops.registration.refine = false;
  loops.registration.min_overlap = 0.0;
  loops.registration.min_inliers = 50;
}

AgentConfig SlamConfig::agent() const {
  AgentConfig config = loops;
  config.policy = keyframes == KeyframeSelection::adaptive ? MergePolicy::adaptive : MergePolicy::paper;
  return config;
}

Fields fields_of(SlamConfig& c) {
  Fields fields = {enum_field("keyframes", &c.keyframes, kKeyframeSelections,
                              "which keyframes take part, and how merges are decided: adaptive tests each by "
                              "evidence; the others are the paper's"),
                   {"check_sensors", &c.check_sensors, "", 0, 0,
                    "whether wheels and IMU that would spoil the map are repaired or left out, with a note"}};
  append(fields, "robot", fields_of(c.robot));
  append(fields, "loops", fields_of(c.loops));
  append(fields, "back_end", fields_of(c.back_end));
  append(fields, "bus", fields_of(c.bus));
  return fields;
}

}  // namespace adit
