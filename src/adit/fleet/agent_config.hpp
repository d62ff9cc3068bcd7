// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/loop_noise.hpp"
#include "adit/fleet/merge/loop_registration.hpp"
#include "adit/fleet/sync/merge_policy.hpp"
#include "adit/place/place_index.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/robot/submap.hpp"

namespace adit {

/// How a robot searches for loops with itself and with others, and tests them.
struct AgentConfig {
  /// Not a field of its own: SlamConfig::agent derives it from the keyframe selection.
  MergePolicy policy = MergePolicy::adaptive;
  PlaceIndexConfig place;
  RegistrationConfig registration;  ///< Read under MergePolicy::paper alone, like the next.
  LoopNoise loop_noise;
  int max_candidates = 6000;
  int candidates_per_peer = 8;
  AdaptiveConfig adaptive;  ///< Read under MergePolicy::adaptive alone.

  /// That of the policy: `adaptive.registration`, or `registration`.
  [[nodiscard]] const RegistrationConfig& registration_in_use() const {
    return policy == MergePolicy::adaptive ? adaptive.registration : registration;
  }
  /// The paper registers single scans.
  [[nodiscard]] SubmapConfig submap_in_use() const {
    return policy == MergePolicy::adaptive ? adaptive.submap : SubmapConfig{.reach_m = 0.0};
  }
  /// Which registered candidates are loops, under the policy.
  [[nodiscard]] LoopRegistrationConfig loop_registration() const;
};
/// Keys of `place`, `registration` and `adaptive` begin with these names; those of `loop_noise` are
/// loop_translation and loop_rotation_deg. `policy` has none: it follows the keyframe policy
/// (SlamConfig::agent).
Fields fields_of(AgentConfig& config);

}  // namespace adit
