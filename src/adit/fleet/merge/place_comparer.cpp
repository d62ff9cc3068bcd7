// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/place_comparer.hpp"

#include <algorithm>
#include <map>

#include "adit/core/parallel.hpp"
#include "adit/registration/features.hpp"
#include "adit/registration/registration.hpp"

namespace adit {
namespace {

std::vector<std::uint32_t> own_keyframes(const std::vector<PlannedComparison>& asked) {
  std::vector<std::uint32_t> own;
  for (const PlannedComparison& place : asked) own.push_back(place.own);
  return own;
}

}  // namespace

void PlaceComparer::prepare(std::vector<std::uint32_t> keyframes, const std::vector<PlannedComparison>& asked,
                            const std::vector<DisplacementSigns>& signs) {
  for (std::size_t i = 0; i < asked.size(); ++i) {
    keyframes.push_back(asked[i].own);
    if (signs[i].empty()) continue;
    const std::vector<std::uint32_t> displaced = discernment_.displaced_from(asked[i].own);
    keyframes.insert(keyframes.end(), displaced.begin(), displaced.end());
  }
  discernment_.surfaces().prepare(keyframes);
}

bool PlaceComparer::agrees_displaced(std::uint32_t own, const SeenPlace& theirs,
                                     const Pose& T_own_theirs) const {
  return std::ranges::any_of(discernment_.displaced_from(own), [&](std::uint32_t displaced) {
    const SeenSurface& there = discernment_.surfaces().at(displaced).view;
    return agreeing_fit(there, theirs.view, T_own_theirs, discernment_.limit(), registration_).has_value();
  });
}

FoundAgain PlaceComparer::found_again(const SeenPlace& own, const SeenPlace& theirs,
                                      const Pose& T_own_theirs) const {
  constexpr double kSamePlace = 0.5;  // metres
  constexpr double kSameWay = 0.2;    // radians
  const auto features = [&](const SeenPlace& place) {
    PointCloud cloud;
    cloud.points = place.view.points().points;
    return compute_features(cloud, registration_);
  };
  const Registration found = register_features(features(own), features(theirs), registration_);
  if (found.verdict != LoopVerdict::accepted) return FoundAgain::elsewhere;
  if (found.weak_axis < kWeakAxis) return FoundAgain::slides;
  const Vector6 off = (T_own_theirs.inverse() * *found.T_a_b).log();
  const bool is_there = off.head<3>().norm() < kSamePlace && off.tail<3>().norm() < kSameWay;
  return is_there ? FoundAgain::there : FoundAgain::elsewhere;
}

ComparedPlace PlaceComparer::compared(const PlannedComparison& place, const SeenPlace& theirs,
                                      const DisplacementSigns& signs) const {
  const double limit = discernment_.limit();
  const SeenPlace& own = discernment_.surfaces().at(place.own);
  const LocalFit fit = fit_near(own.view, theirs.view, place.T_own_theirs, limit, registration_);
  const Pose& T_odom_own = map_.keyframes[place.own].T_odom_base;
  ComparedPlace out{fit.agreement.largest_difference / limit};
  if (place.without_guess) {  // all else was compared before
    out.found_again = out.differs() ? FoundAgain::elsewhere : found_again(own, theirs, fit.T_a_b);
    return out;
  }
  if (!signs.empty() && !agrees_displaced(place.own, theirs, fit.T_a_b)) {
    out.is_distinctive = true;
    out.signs = signs;
  }
  const auto above_limit = [&](const std::vector<DifferingPatch>& patches) {
    std::vector<Vector3> places;
    for (const DifferingPatch& patch : patches)
      if (patch.num_points > limit) places.push_back(T_odom_own * patch.position);
    return places;
  };
  out.structures = above_limit(fit.agreement.structures);
  out.things = above_limit(fit.agreement.things);
  if (!out.differs())
    out.offsets = patch_offsets(own.scan, theirs.scan, fit.T_a_b, T_odom_own, registration_);
  return out;
}

std::vector<ComparedPlace> PlaceComparer::with_clouds(const std::vector<PlannedComparison>& asked,
                                                      const Clouds& clouds) {
  std::map<std::uint32_t, const Clouds::Cloud*> came;
  for (const Clouds::Cloud& cloud : clouds.clouds) came[cloud.index] = &cloud;
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  prepare({}, asked, signs);
  std::vector<ComparedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    const Clouds::Cloud& received = *came.at(asked[i].theirs);
    PointCloud scan;
    scan.points = received.points;
    PointCloud view = scan;
    scan.intensities = received.intensities;
    view.points.insert(view.points.end(), received.beside.begin(), received.beside.end());
    const SeenPlace theirs(view, scan, received.viewpoint.cast<double>(), registration_);
    places[i] = compared(asked[i], theirs, signs[i]);
  });
  return places;
}

std::vector<ComparedPlace> PlaceComparer::within_own_map(const std::vector<PlannedComparison>& asked) {
  std::vector<std::uint32_t> later;
  for (const PlannedComparison& place : asked) later.push_back(place.theirs);
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  prepare(later, asked, signs);
  const SurfaceStore& surfaces = discernment_.surfaces();
  std::vector<ComparedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    places[i] = compared(asked[i], surfaces.at(asked[i].theirs), signs[i]);
  });
  return places;
}

}  // namespace adit
