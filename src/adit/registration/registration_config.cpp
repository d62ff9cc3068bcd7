// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/registration_config.hpp"

namespace adit {
namespace {

Fields feature_fields(RegistrationConfig& c) {
  return {{"voxel_size", &c.voxel_size, "m", 0.005, 10.0, "edge of the voxels that clouds are thinned to"},
          {"normal_radius_voxels", &c.normal_radius_voxels, "voxels", 1.0, 10.0, "neighbourhood of a normal"},
          {"feature_radius_voxels", &c.feature_radius_voxels, "voxels", 1.0, 20.0,
           "neighbourhood of a descriptor; at least that of a normal"},
          {"max_linearity", &c.max_linearity, "", 0.0, 1.0,
           "points more linear than this, (l1 - l2) / l1, get no descriptor; 1: all get one"}};
}

Fields matching_fields(RegistrationConfig& c) {
  return {{"ratio_test", &c.ratio_test, "", 0, 1, "a match must be clearly nearer than the second nearest"},
          {"max_ratio", &c.max_ratio, "", 0.0, 1.0,
           "of the squared descriptor distances, nearest to second nearest"},
          {"max_descriptor_distance", &c.max_descriptor_distance, "", 0.0, 300.0,
           "between the descriptors of a match (histograms sum to 100)"},
          {"max_correspondences", &c.max_correspondences, "", 3, 20000,
           "kept at most, those with the best ratios"},
          enum_field("pruning", &c.pruning, kPrunings, "how the consistency graph is pruned"),
          {"graph_noise_voxels", &c.graph_noise_voxels, "voxels", 0.01, 10.0,
           "two correspondences are consistent when their distances differ by at most this"},
          {"clique_max_search_nodes", &c.clique_max_search_nodes, "", 1, 100000000,
           "branches of the clique search, at most; then the best clique so far is taken"}};
}

Fields solver_fields(RegistrationConfig& c) {
  return {{"solver_noise_voxels", &c.solver_noise_voxels, "voxels", 0.01, 10.0,
           "noise bound of an inlier in the rotation and translation solvers"},
          {"max_noise_bound", &c.max_noise_bound, "m", 0.01, 10.0, "both noise bounds are clamped to this"},
          {"gnc_max_iterations", &c.gnc_max_iterations, "", 1, 10000, "of the rotation solver, at most"},
          {"gnc_factor", &c.gnc_factor, "", 1.01, 10.0, "growth of the control parameter in each iteration"},
          {"gnc_tolerance", &c.gnc_tolerance, "", 0.0, 1.0, "change of the cost that ends the iterations"}};
}

Fields verdict_fields(RegistrationConfig& c) {
  return {{"refine", &c.refine, "", 0, 1, "point-to-plane ICP after the global solution"},
          {"refine_distance_voxels", &c.refine_distance_voxels, "voxels", 0.1, 20.0,
           "farthest correspondence of the refinement"},
          {"refine_kernel_voxels", &c.refine_kernel_voxels, "voxels", 0.01, 20.0,
           "scale of the robust kernel, and largest residual that counts as evidence"},
          {"refine_max_iterations", &c.refine_max_iterations, "", 1, 1000, "of the refinement, at most"},
          {"min_inliers", &c.min_inliers, "", 3, 20000, "fewer inliers of the global solution: rejected"},
          {"overlap_distance_voxels", &c.overlap_distance_voxels, "voxels", 0.1, 20.0,
           "a point with a neighbour of the other cloud this near lies in the overlap"},
          {"min_overlap", &c.min_overlap, "", 0.0, 1.0, "less overlap in either direction: rejected"}};
}

}  // namespace

std::string_view to_string(Pruning pruning) { return pruning == Pruning::k_core ? "k_core" : "clique"; }

Fields fields_of(RegistrationConfig& c) {
  Fields all;
  for (Fields (*const stage)(RegistrationConfig&) :
       {feature_fields, matching_fields, solver_fields, verdict_fields}) {
    for (Field& field : stage(c)) all.push_back(std::move(field));
  }
  return all;
}

}  // namespace adit
