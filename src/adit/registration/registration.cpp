// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/registration.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/geometry/max_clique.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/registration/correspondence_graph.hpp"
#include "adit/registration/gnc_registration.hpp"
#include "adit/registration/icp_refine.hpp"
#include "adit/registration/matching.hpp"
#include "adit/registration/verification.hpp"

namespace adit {
namespace {

/// The matched points, side by side.
struct MatchedPoints {
  std::vector<Eigen::Vector3f> a;
  std::vector<Eigen::Vector3f> b;
};

Registration rejected(Registration registration, std::string reason) {
  registration.verdict = LoopVerdict::rejected;
  registration.reason = std::move(reason);
  return registration;
}

MatchedPoints matched_points(const Features& a, const Features& b,
                             const std::vector<Correspondence>& matches) {
  MatchedPoints out;
  for (const Correspondence& match : matches) {
    out.a.push_back(a.points[match.a]);
    out.b.push_back(b.points[match.b]);
  }
  return out;
}

MatchedPoints pruned(const MatchedPoints& points, const RegistrationConfig& config) {
  const double bound = std::min(config.graph_noise_voxels * config.voxel_size, config.max_noise_bound);
  const BitGraph graph = consistency_graph(points.a, points.b, static_cast<float>(bound));
  MatchedPoints out;
  const bool exact = config.pruning == Pruning::clique;
  const auto max_nodes = static_cast<std::uint64_t>(config.clique_max_search_nodes);
  for (const std::uint32_t k : exact ? max_clique(graph, max_nodes).vertices : max_core(graph)) {
    out.a.push_back(points.a[k]);
    out.b.push_back(points.b[k]);
  }
  return out;
}

Registration with_evidence(Registration registration, const Features& a, const Features& b,
                           const RegistrationConfig& config) {
  const PointGrid grid_a(a.points, kCellVoxels * config.voxel_size);
  const PointGrid grid_b(b.points, kCellVoxels * config.voxel_size);
  if (config.refine) {
    registration.T_a_b = refine_point_to_plane(a, grid_a, b, *registration.T_a_b, config);
  }
  const Evidence evidence = gather_evidence(a, grid_a, b, grid_b, *registration.T_a_b, config);
  registration.overlap = evidence.overlap;
  registration.information = evidence.information;
  registration.weak_axis = evidence.weak_axis;
  registration.weak_direction = evidence.weak_direction;
  return registration;
}

}  // namespace

Registration register_features(const Features& a, const Features& b, const RegistrationConfig& config) {
  Registration out;
  if (a.empty() || b.empty()) {
    return rejected(out, format("cloud {} has no point with a surface around it", a.empty() ? 'a' : 'b'));
  }
  const std::vector<Correspondence> matches = match_descriptors(a.descriptors, b.descriptors, config);
  out.num_correspondences = static_cast<int>(matches.size());
  if (matches.size() < 3)
    return rejected(out, format("only {} points look alike in both clouds", matches.size()));

  const MatchedPoints consistent = pruned(matched_points(a, b, matches), config);
  out.num_pruned = static_cast<int>(consistent.a.size());
  const double bound = std::min(config.solver_noise_voxels * config.voxel_size, config.max_noise_bound);
  const auto solution = align_robustly(consistent.a, consistent.b, bound, config);
  if (!solution) {
    return rejected(out, format("the {} consistent points agree on no rotation", consistent.a.size()));
  }
  out.T_a_b = solution->T_a_b;
  out.num_inliers = static_cast<int>(solution->inliers.size());
  // most candidates of a loop search end here, before the costly refinement
  if (out.num_inliers < config.min_inliers) return judged(out, config);
  return judged(with_evidence(std::move(out), a, b, config), config);
}

Registration register_clouds(const PointCloud& a, const PointCloud& b, const RegistrationConfig& config) {
  const std::array<const PointCloud*, 2> clouds = {&a, &b};
  std::array<Features, 2> features;
  parallel_for_each(2, [&](std::size_t k) { features[k] = compute_features(*clouds[k], config); });
  return register_features(features[0], features[1], config);
}

Pose align_clouds(const PointCloud& a, const PointCloud& b, const Pose& T_a_b,
                  const RegistrationConfig& config) {
  const std::array<const PointCloud*, 2> clouds = {&a, &b};
  std::array<OrientedPoints, 2> surfaces;
  parallel_for_each(2, [&](std::size_t k) { surfaces[k] = compute_surface(*clouds[k], config); });
  return align_to_planes(surfaces[0], PointGrid(surfaces[0].points, kCellVoxels * config.voxel_size),
                         surfaces[1], T_a_b, config);
}

}  // namespace adit
