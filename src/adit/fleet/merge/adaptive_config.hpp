// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// All settings of MergePolicy::adaptive: how candidates are found, registered and turned into merges.
#pragma once

#include "adit/core/config.hpp"
#include "adit/fleet/merge/evidence_model.hpp"
#include "adit/fleet/merge/loop_noise.hpp"
#include "adit/fleet/merge/segments.hpp"
#include "adit/fleet/search/candidate_search.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/robot/submap.hpp"

namespace adit {

/// What a robot measures on its own map (Discernment).
struct DiscernmentConfig {
  int samples = 32;
  int look_alikes = 16;
  double displacement_m = 5.0;
  bool second_looks = true;
  double second_look_m = 1.0;
  double followed_m = 60.0;
  int starts_per_look_alike = 4;
  double shortest_reach_m = 50.0;
  double longest_reach_m = 150.0;
  double reach_off_m = 0.5;
  SegmentConfig segment;
};
/// Keys of `segment` begin with its name.
Fields fields_of(DiscernmentConfig& config);

/// When loops between two robots may join their maps (MergeChecker, decision 0010).
struct MergeCheckConfig {
  double spacing_m = 3.0;
  int max_checks = 200;
  double wall_spacing_m = 1.0;
  int max_wall_checks = 96;
  int first_checks = 8;
  int max_hypotheses = 12;
  double loops_agree = 0.99;
  double same_alignment_m = 3.0;
  double misplaced_m = 0.75;
  int misplaced_keyframes = 60;
  int misplaced_neighbours = 5;
  int misplaced_quorum = 3;
  bool relief = true;
  EvidenceModel evidence;
  DiscernmentConfig discernment;
};
/// Keys of `evidence` and `discernment` begin with these names.
Fields fields_of(MergeCheckConfig& config);

/// Used where AgentConfig::policy is MergePolicy::adaptive.
struct AdaptiveConfig {
  SearchConfig search;
  RegistrationConfig registration;
  SubmapConfig submap;  ///< What is registered.
  /// What is compared: one scan alone shows too little of what another sensor sees (decision 0051).
  SubmapConfig view{.reach_m = 3.0, .step_m = 1.0, .radius_m = 20.0};
  double one_place_m = 10.0;
  /// Noise of every loop beside what its registration states: errors of two LiDARs (decision 0086).
  LoopNoise loop_noise{.translation = 0.02, .rotation_deg = 0.1};
  MergeCheckConfig merge_check;
};
/// The keys of `search` carry no prefix of their own.
Fields fields_of(AdaptiveConfig& config);

}  // namespace adit
