// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/place_comparer.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/registration/features.hpp"
#include "adit/registration/registration.hpp"

namespace adit {
namespace {

/// What the peer saw at a keyframe, and beside it.
SeenSurface view_of(const Clouds::Cloud& received, const RegistrationConfig& config) {
  PointCloud all;
  all.points = received.points;
  all.points.insert(all.points.end(), received.beside.begin(), received.beside.end());
  return view_of(all, received.viewpoint.cast<double>(), config);
}

SearchableSurface scan_of(const Clouds::Cloud& received, const RegistrationConfig& config) {
  PointCloud scan;
  scan.points = received.points;
  scan.intensities = received.intensities;
  return scan_of(scan, received.viewpoint.cast<double>(), config);
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
  discernment_.views().prepare(keyframes);
}

bool PlaceComparer::agrees_displaced(std::uint32_t own, const SeenSurface& theirs,
                                     const Pose& T_own_theirs) const {
  return std::ranges::any_of(discernment_.displaced_from(own), [&](std::uint32_t displaced) {
    const SeenSurface& there = discernment_.views().at(displaced);
    return agreeing_fit(there, theirs, T_own_theirs, discernment_.limit(), registration_).has_value();
  });
}

FoundAgain PlaceComparer::found_again(const SeenSurface& own, const SeenSurface& theirs,
                                      const Pose& T_own_theirs) const {
  constexpr double kSamePlace = 0.5;  // metres
  constexpr double kSameWay = 0.2;    // radians
  const auto features = [&](const SeenSurface& view) {
    PointCloud cloud;
    cloud.points = view.points().points;
    return compute_features(cloud, registration_);
  };
  const Registration found = register_features(features(own), features(theirs), registration_);
  if (found.verdict != LoopVerdict::accepted) return FoundAgain::elsewhere;
  if (found.weak_axis < kWeakAxis) return FoundAgain::slides;
  const Vector6 off = (T_own_theirs.inverse() * *found.T_a_b).log();
  const bool is_there = off.head<3>().norm() < kSamePlace && off.tail<3>().norm() < kSameWay;
  return is_there ? FoundAgain::there : FoundAgain::elsewhere;
}

PlaceComparer::Fitted PlaceComparer::fitted(const PlannedComparison& place, const SeenSurface& theirs,
                                            const DisplacementSigns& signs) const {
  const double limit = discernment_.limit();
  const SeenSurface& own = discernment_.views().at(place.own);
  const LocalFit fit = fit_near(own, theirs, place.T_own_theirs, limit, registration_);
  const Pose& T_odom_own = map_.keyframes[place.own].T_odom_base;
  Fitted out{{fit.agreement.largest_difference / limit}, fit.T_a_b};
  ComparedPlace& found = out.place;
  if (place.without_guess) {  // all else was compared before
    found.found_again = found.differs() ? FoundAgain::elsewhere : found_again(own, theirs, fit.T_a_b);
    return out;
  }
  if (!signs.empty() && !agrees_displaced(place.own, theirs, fit.T_a_b)) {
    found.is_distinctive = true;
    found.signs = signs;
  }
  const auto above_limit = [&](const std::vector<DifferingPatch>& patches) {
    std::vector<Vector3> places;
    for (const DifferingPatch& patch : patches)
      if (patch.num_points > limit) places.push_back(T_odom_own * patch.position);
    return places;
  };
  found.structures = above_limit(fit.agreement.structures);
  found.things = above_limit(fit.agreement.things);
  return out;
}

void PlaceComparer::add_walls(const PlannedComparison& place, const SearchableSurface& theirs,
                              Fitted& fitted) const {
  fitted.place.offsets = patch_offsets(discernment_.scans().at(place.own), theirs, fitted.T_own_theirs,
                                       map_.keyframes[place.own].T_odom_base, registration_);
}

std::vector<std::size_t> PlaceComparer::those_that_agree(const std::vector<PlannedComparison>& asked,
                                                         const std::vector<Fitted>& found) {
  std::vector<std::size_t> agreeing;
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (!asked[i].without_guess && !found[i].place.differs()) agreeing.push_back(i);
  return agreeing;
}

std::vector<ComparedPlace> PlaceComparer::places_of(std::vector<Fitted> found) {
  std::vector<ComparedPlace> places;
  for (Fitted& fitted : found) places.push_back(std::move(fitted.place));
  return places;
}

std::vector<ComparedPlace> PlaceComparer::with_views(const std::vector<PlannedComparison>& asked,
                                                     const PeerSession::Views& views) {
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  prepare({}, asked, signs);
  std::vector<Fitted> found(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    found[i] = fitted(asked[i], view_of(views.at(asked[i].theirs), registration_), signs[i]);
  });
  const std::vector<std::size_t> agreeing = those_that_agree(asked, found);
  std::vector<std::uint32_t> own;
  for (const std::size_t i : agreeing) own.push_back(asked[i].own);
  discernment_.scans().prepare(own);
  parallel_for_each(agreeing.size(), [&](std::size_t k) {
    const PlannedComparison& place = asked[agreeing[k]];
    add_walls(place, scan_of(views.at(place.theirs), registration_), found[agreeing[k]]);
  });
  return places_of(std::move(found));
}

std::vector<ComparedPlace> PlaceComparer::within_own_map(const std::vector<PlannedComparison>& asked) {
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own_keyframes(asked));
  prepare(their_keyframes(asked), asked, signs);
  const ViewStore& views = discernment_.views();
  std::vector<Fitted> found(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    found[i] = fitted(asked[i], views.at(asked[i].theirs), signs[i]);
  });
  const std::vector<std::size_t> agreeing = those_that_agree(asked, found);
  std::vector<std::uint32_t> both;
  for (const std::size_t i : agreeing) both.insert(both.end(), {asked[i].own, asked[i].theirs});
  ScanStore& scans = discernment_.scans();
  scans.prepare(both);
  parallel_for_each(agreeing.size(), [&](std::size_t k) {
    const PlannedComparison& place = asked[agreeing[k]];
    add_walls(place, scans.at(place.theirs), found[agreeing[k]]);
  });
  return places_of(std::move(found));
}

}  // namespace adit
