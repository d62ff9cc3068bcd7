// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_registration.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/registration/registration.hpp"

namespace adit {

std::vector<LoopClosure> LoopRegistration::with_clouds(const std::vector<PeerSession::Arrived>& arrived,
                                                       const Clouds& clouds) {
  std::vector<std::uint32_t> own;
  for (const PeerSession::Arrived& one : arrived) own.push_back(one.candidate.query.index);
  features_->prepare(own);
  std::vector<Features> theirs(clouds.clouds.size());
  parallel_for_each(theirs.size(), [&](std::size_t c) {
    PointCloud cloud;
    cloud.points = clouds.clouds[c].points;
    theirs[c] = compute_features(cloud, config_.registration);
  });
  std::vector<LoopClosure> loops(arrived.size());
  parallel_for_each(loops.size(), [&](std::size_t i) {
    loops[i] = registered(arrived[i].candidate, theirs[arrived[i].cloud]);
  });
  return loops;
}

std::vector<LoopClosure> LoopRegistration::within_own_map(const std::vector<LoopCandidate>& candidates) {
  std::vector<std::uint32_t> used;
  for (const LoopCandidate& candidate : candidates)
    used.insert(used.end(), {candidate.query.index, candidate.match.index});
  features_->prepare(used);
  std::vector<LoopClosure> loops(candidates.size());
  parallel_for_each(loops.size(), [&](std::size_t i) {
    loops[i] = registered(candidates[i], features_->at(candidates[i].match.index));
  });
  return loops;
}

LoopClosure LoopRegistration::registered(const LoopCandidate& candidate, const Features& match) const {
  const Registration registration =
      register_features(features_->at(candidate.query.index), match, config_.registration);
  LoopClosure loop;
  loop.from = candidate.query;
  loop.to = candidate.match;
  loop.T_from_to = registration.T_a_b.value_or(Pose());
  loop.information = config_.noise ? information_of(*config_.noise) : registration.information;
  if (config_.added_noise) loop.information = with_noise(*config_.added_noise, loop.information);
  loop.place_distance = candidate.distance;
  loop.num_inliers = registration.num_inliers;
  loop.overlap = registration.overlap;
  loop.weak_axis = registration.weak_axis;
  loop.verdict = registration.verdict;
  loop.reason = registration.reason;
  const double apart_m = loop.T_from_to.translation().norm();
  if (loop.verdict == LoopVerdict::accepted && apart_m > config_.one_place_m) {
    loop.verdict = LoopVerdict::rejected;
    loop.reason = format("its ends would be {:.1f} m apart: not one place", apart_m);
  }
  // Floor and roof of a tunnel look alike, and a tunnel's mirror image is that tunnel upside down.
  constexpr double kSteepest = 60.0;  // degrees between two robots on ramps
  const double upright = loop.T_from_to.rotation_matrix()(2, 2);
  if (loop.verdict == LoopVerdict::accepted && config_.upright && upright < std::cos(kSteepest * kDegree)) {
    loop.verdict = LoopVerdict::rejected;
    loop.reason =
        format("one robot would be tilted by {:.0f} degrees against the other: both stand on the floor",
               std::acos(std::max(upright, -1.0)) / kDegree);
  }
  // With no overlap asked for, poses may be accepted at which nothing can say how well they are known.
  if (loop.verdict == LoopVerdict::accepted && !is_usable(loop.information)) {
    loop.verdict = LoopVerdict::rejected;
    loop.reason += ", but no pair of surfaces agrees";
  }
  return loop;
}

}  // namespace adit
