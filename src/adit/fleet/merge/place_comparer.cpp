// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/place_comparer.hpp"

#include <map>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

std::vector<std::uint32_t> own_keyframes(const std::vector<PlannedComparison>& asked) {
  std::vector<std::uint32_t> own;
  for (const PlannedComparison& place : asked) own.push_back(place.own);
  return own;
}

}  // namespace

ComparedPlace PlaceComparer::compared(const PlannedComparison& place, const SeenSurface& theirs,
                                      const DisplacementSigns& signs) const {
  const double limit = discernment_.limit();
  const SeenSurface& own = discernment_.surfaces().at(place.own);
  const LocalFit fit = fit_near(own, theirs, place.T_own_theirs, limit, registration_);
  const Pose& T_odom_own = map_.keyframes[place.own].T_odom_base;
  ComparedPlace out{fit.agreement.largest_difference / limit, !signs.empty()};
  out.signs = signs;
  const auto above_limit = [&](const std::vector<DifferingPatch>& patches) {
    std::vector<Vector3> places;
    for (const DifferingPatch& patch : patches)
      if (patch.num_points > limit) places.push_back(T_odom_own * patch.position);
    return places;
  };
  out.structures = above_limit(fit.agreement.structures);
  out.things = above_limit(fit.agreement.things);
  if (!out.differs()) out.offsets = patch_offsets(own, theirs, fit.T_a_b, T_odom_own, registration_);
  return out;
}

std::vector<ComparedPlace> PlaceComparer::with_clouds(const std::vector<PlannedComparison>& asked,
                                                      const Clouds& clouds) {
  std::map<std::uint32_t, const Clouds::Cloud*> came;
  for (const Clouds::Cloud& cloud : clouds.clouds) came[cloud.index] = &cloud;
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  discernment_.surfaces().prepare(own_keyframes(asked));
  std::vector<ComparedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    const Clouds::Cloud& received = *came.at(asked[i].theirs);
    PointCloud cloud;
    cloud.points = received.points;
    const SeenSurface theirs(compute_surface(cloud, registration_), received.viewpoint.cast<double>(),
                             registration_.voxel_size);
    places[i] = compared(asked[i], theirs, signs[i]);
  });
  return places;
}

std::vector<ComparedPlace> PlaceComparer::within_own_map(const std::vector<PlannedComparison>& asked) {
  std::vector<std::uint32_t> both;
  for (const PlannedComparison& place : asked) both.insert(both.end(), {place.own, place.theirs});
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  SurfaceStore& surfaces = discernment_.surfaces();
  surfaces.prepare(both);
  std::vector<ComparedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    places[i] = compared(asked[i], surfaces.at(asked[i].theirs), signs[i]);
  });
  return places;
}

}  // namespace adit
