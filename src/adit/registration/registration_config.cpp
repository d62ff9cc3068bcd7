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
           "largest ratio of the squared descriptor distances, nearest to second nearest"},
          {"max_descriptor_distance", &c.max_descriptor_distance, "", 0.0, 300.0,
           "largest distance between the descriptors of a match (histograms sum to 100)"},
          {"max_correspondences", &c.max_correspondences, "", 3, 20000,
           "matches kept at most, those with the best ratios"},
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
          {"gnc_max_iterations", &c.gnc_max_iterations, "", 1, 10000,
           "iterations of the rotation solver, at most"},
          {"gnc_factor", &c.gnc_factor, "", 1.01, 10.0, "growth of the control parameter in each iteration"},
          {"gnc_tolerance", &c.gnc_tolerance, "", 0.0, 1.0, "change of the cost that ends the iterations"}};
}

Fields verdict_fields(RegistrationConfig& c) {
  return {{"refine", &c.refine, "", 0, 1, "point-to-plane ICP after the global solution"},
          {"refine_distance_voxels", &c.refine_distance_voxels, "voxels", 0.1, 20.0,
           "farthest correspondence of the refinement"},
          {"refine_kernel_voxels", &c.refine_kernel_voxels, "voxels", 0.01, 20.0,
           "scale of the robust kernel, and largest residual that counts as evidence"},
          {"refine_max_iterations", &c.refine_max_iterations, "", 1, 1000,
           "iterations of the refinement, at most"},
          {"min_inliers", &c.min_inliers, "", 3, 20000, "fewer inliers of the global solution: rejected"},
          {"overlap_distance_voxels", &c.overlap_distance_voxels, "voxels", 0.1, 20.0,
           "a point with a neighbour of the other cloud this near lies in the overlap"},
          {"min_overlap", &c.min_overlap, "", 0.0, 1.0, "less overlap in either direction: rejected"}};
}

}  // namespace

std::string_view to_string(Pruning pruning) { return pruning == Pruning::k_core ? "k_core" : "clique"; }

Fields fields_of(ReliefConfig& c) {
  return {{"patch_m", &c.patch_m, "m", 0.1, 10.0, "edge of the cells that cut walls into patches"},
          {"max_range_m", &c.max_range_m, "m", 1.0, 100.0,
           "points farther from the sensor are left out: beams are too far apart there"},
          {"pairing_distance_m", &c.pairing_distance_m, "m", 0.01, 1.0,
           "largest distance from a point of one scan to the nearest of the other"},
          {"max_offset_m", &c.max_offset_m, "m", 0.01, 1.0,
           "largest offset between the two walls; more is another object, not relief"},
          {"min_offset_m", &c.min_offset_m, "m", 0.0, 0.1,
           "smaller mean offsets of a patch are left out: they depend on where the beams fall"},
          {"min_normal_cosine", &c.min_normal_cosine, "", 0.0, 1.0,
           "smallest cosine between the normals of a pair of points"},
          {"min_points", &c.min_points, "", 1, 1000, "points needed per patch and pair of scans"}};
}

Fields fields_of(ReliefModel& c) {
  return {
      {"same_share", &c.same_share, "", 0.5, 1.0, "share of equal signs on one wall"},
      {"same_sigma", &c.same_sigma, "", 0.0, 0.5, "its standard deviation from one side of 10 m to the next"},
      {"prior_other_share", &c.prior_other_share, "", 0.51, 1.0,
       "share of equal signs on other walls, where the own map has none to measure it on"},
      {"prior_sigma", &c.prior_sigma, "", 0.0, 5.0,
       "prior of the log share's standard deviation over look-alikes"},
      {"stretch_sigma", &c.stretch_sigma, "", 0.0, 5.0,
       "the log share's standard deviation along one of them, from one side of 10 m to the next"},
      {"prior_moulded", &c.prior_moulded, "", 0.0, 1.0,
       "share of the tunnels that agree, but are others, whose walls were cast in one mould,"},
      {"moulded", &c.moulded, "", 0.0, 1.0, "and where other walls of the own map were found to differ"},
      {"prior_stretches", &c.prior_stretches, "", 0.0, 1000.0,
       "number of look-alikes that the prior counts as"},
      {"changed", &c.changed, "", 1e-6, 1.0,
       "share of the pairs of maps of one tunnel whose walls seem to be others as a whole: seen by sensors "
       "that "
       "err in another way than is estimated"},
      {"lined_anew", &c.lined_anew, "", 0.0, 1.0,
       "share of the pairs of visits between which walls were moved: lined anew or widened"},
      {"lined_share", &c.lined_share, "", 0.0, 1.0, "share of the sides of 10 m that this concerned then"},
      {"few_patches", &c.few_patches, "", 1, 1000000,
       "patches of the own map needed before their share is what a map is weighed against"},
      {"min_patches", &c.min_patches, "", 1, 1000000, "patches of two maps needed before they are evidence"}};
}

Fields fields_of(RegistrationConfig& c) {
  Fields all;
  for (Fields (*const stage)(RegistrationConfig&) :
       {feature_fields, matching_fields, solver_fields, verdict_fields}) {
    for (Field& field : stage(c)) all.push_back(std::move(field));
  }
  append(all, "relief", fields_of(c.relief));
  return all;
}

}  // namespace adit
