// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string_view>

#include "adit/core/config.hpp"

namespace adit {

/// How two walls are compared to the millimetre (relief.hpp; decisions 0013 and 0015), lengths in metres.
struct ReliefConfig {
  double patch_m = 1.0;
  double max_range_m = 15.0;
  double pairing_distance_m = 0.2;
  double max_offset_m = 0.15;
  double min_offset_m = 0.002;
  double min_normal_cosine = 0.95;
  int min_points = 6;
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(ReliefConfig& config);

/// How often walls that are the same, and others, are found on the same side (EqualSignShares).
struct ReliefModel {
  double same_share = 0.52;
  double same_sigma = 0.015;
  double prior_other_share = 0.62;
  double prior_sigma = 0.5;
  double stretch_sigma = 0.8;
  double prior_stretches = 4.0;
  double prior_moulded = 0.02;
  double moulded = 0.002;
  double changed = 0.01;
  double lined_anew = 0.1;
  double lined_share = 0.3;
  int few_patches = 100;
  int min_patches = 30;
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(ReliefModel& model);

/// What is left of the consistency graph: its innermost k-core, or its maximum clique.
enum class Pruning { k_core, clique };
/// Both ways.
inline constexpr std::array kPrunings{Pruning::k_core, Pruning::clique};
/// k_core, clique.
[[nodiscard]] std::string_view to_string(Pruning pruning);

/// Parameters of KISS-Matcher (Lim et al., arXiv 2409.15615) with its published defaults, then those of the
/// refinement and of the verdict. Lengths named `_voxels` are multiples of `voxel_size`, so one number scales
/// the whole method.
///
/// The paper's plain pipeline is `refine = false`, `min_overlap = 0`: the global result, accepted by
/// `min_inliers`.
struct RegistrationConfig {
  double voxel_size = 0.3;

  double normal_radius_voxels = 3.0;
  double feature_radius_voxels = 5.0;
  double max_linearity = 1.0;

  bool ratio_test = true;
  double max_ratio = 0.9;
  double max_descriptor_distance = 30.0;
  int max_correspondences = 5000;

  Pruning pruning = Pruning::k_core;
  double graph_noise_voxels = 1.0;
  int clique_max_search_nodes = 20000;

  double solver_noise_voxels = 0.75;
  double max_noise_bound = 1.0;
  int gnc_max_iterations = 100;
  double gnc_factor = 1.4;
  double gnc_tolerance = 1e-6;

  bool refine = true;
  double refine_distance_voxels = 2.0;
  double refine_kernel_voxels = 0.5;
  int refine_max_iterations = 30;

  int min_inliers = 20;
  double overlap_distance_voxels = 1.5;
  double min_overlap = 0.3;

  ReliefConfig relief;
};

/// The keys are the names of the fields; those of `relief` begin with its name.
[[nodiscard]] Fields fields_of(RegistrationConfig& c);

}  // namespace adit
