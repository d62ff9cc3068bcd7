// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/place_comparer.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/core/picked.hpp"

namespace adit {
namespace {

/// What the peer saw at a keyframe, and beside it.
SeenSurface received_view(const Clouds::Cloud& received, const RegistrationConfig& config) {
  PointCloud all;
  all.points = received.points;
  all.points.insert(all.points.end(), received.beside.begin(), received.beside.end());
  return view_of(all, received.viewpoint.cast<double>(), config);
}

SearchableSurface received_scan(const Clouds::Cloud& received, const RegistrationConfig& config) {
  PointCloud scan;
  scan.points = received.points;
  scan.intensities = received.intensities;
  return scan_of(scan, received.viewpoint.cast<double>(), config);
}

}  // namespace

bool PlaceComparer::agrees_displaced(std::uint32_t own, const SeenSurface& theirs,
                                     const Pose& T_own_theirs) const {
  return std::ranges::any_of(discernment_.displaced_from(own), [&](std::uint32_t displaced) {
    const SeenSurface& there = discernment_.views().at(displaced);
    return agreeing_fit(there, theirs, T_own_theirs, discernment_.limit(), registration_).has_value();
  });
}

PlaceComparer::Fitted PlaceComparer::fit(const PlannedComparison& place, const SeenSurface& theirs) const {
  const double limit = discernment_.limit();
  const SeenSurface& own = discernment_.views().at(place.own);
  const LocalFit near = fit_near(own, theirs, place.T_own_theirs, limit, registration_);
  Fitted out{{near.agreement.largest_difference / limit}, near.T_a_b};
  ComparedPlace& found = out.place;
  const auto above_limit = [&](const std::vector<DifferingPatch>& patches) {
    std::vector<Vector3> places;
    for (const DifferingPatch& patch : patches)
      if (patch.num_points > limit) places.push_back(map_.keyframes[place.own].T_odom_base * patch.position);
    return places;
  };
  found.structures = above_limit(near.agreement.structures);
  found.things = above_limit(near.agreement.things);
  return out;
}

std::vector<PlaceComparer::Fitted> PlaceComparer::compare_views(const std::vector<PlannedComparison>& asked,
                                                                const ViewOfTheirs& theirs,
                                                                const std::vector<std::uint32_t>& kept) {
  const auto prepare = [&](const std::vector<std::uint32_t>& more) {
    std::vector<std::uint32_t> all = kept;
    all.insert(all.end(), more.begin(), more.end());
    discernment_.views().prepare(all);
  };
  prepare(own_keyframes(asked));
  std::vector<Fitted> found(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) { found[i] = fit(asked[i], theirs(i)); });

  // What a displacement would show is asked of few places that differ, and most do.
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (asks_for_signs(asked[i].question, found[i].place.differs())) which.push_back(i);
  const std::vector<std::uint32_t> own = own_keyframes(picked(asked, which));
  const std::vector<DisplacementSigns> signs = discernment_.displacement_signs(own);
  std::vector<std::uint32_t> displaced;
  for (std::size_t k = 0; k < which.size(); ++k) {
    if (signs[k].empty()) continue;
    const std::vector<std::uint32_t> both_ways = discernment_.displaced_from(own[k]);
    displaced.insert(displaced.end(), both_ways.begin(), both_ways.end());
  }
  prepare(displaced);
  parallel_for_each(which.size(), [&](std::size_t k) {
    auto& [place, T_own_theirs] = found[which[k]];
    place.signs.emplace();
    if (signs[k].empty() || agrees_displaced(own[k], theirs(which[k]), T_own_theirs)) return;
    place.is_distinctive = true;
    place.signs = signs[k];
  });
  return found;
}

void PlaceComparer::add_walls(const PlannedComparison& place, const SearchableSurface& theirs,
                              Fitted& fitted) const {
  fitted.place.offsets = patch_offsets(discernment_.scans().at(place.own), theirs, fitted.T_own_theirs,
                                       map_.keyframes[place.own].T_odom_base, registration_);
}

std::vector<std::size_t> PlaceComparer::those_with_walls(const std::vector<PlannedComparison>& asked,
                                                         const std::vector<Fitted>& found) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (asks_for_walls(asked[i].question, found[i].place.differs())) out.push_back(i);
  return out;
}

std::vector<ComparedPlace> PlaceComparer::places_of(std::vector<Fitted> found) {
  std::vector<ComparedPlace> places;
  for (Fitted& fitted : found) places.push_back(std::move(fitted.place));
  return places;
}

std::vector<ComparedPlace> PlaceComparer::with_views(const std::vector<PlannedComparison>& asked,
                                                     const PeerSession::Views& views) {
  std::vector<std::optional<SeenSurface>> theirs(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    theirs[i].emplace(received_view(views.at(asked[i].theirs), registration_));
  });
  std::vector<Fitted> found =
      compare_views(asked, [&](std::size_t i) -> const SeenSurface& { return *theirs[i]; }, {});
  for (std::size_t i = 0; i < asked.size(); ++i) {
    found[i].place.unconfirmed_own = map_.unconfirmed[asked[i].own];
    found[i].place.unconfirmed_theirs = views.at(asked[i].theirs).unconfirmed;
  }
  const std::vector<std::size_t> with_walls = those_with_walls(asked, found);
  discernment_.scans().prepare(own_keyframes(picked(asked, with_walls)));
  parallel_for_each(with_walls.size(), [&](std::size_t k) {
    const std::size_t i = with_walls[k];
    add_walls(asked[i], received_scan(views.at(asked[i].theirs), registration_), found[i]);
  });
  return places_of(std::move(found));
}

std::vector<ComparedPlace> PlaceComparer::within_own_map(const std::vector<PlannedComparison>& asked) {
  const std::vector<std::uint32_t> later = their_keyframes(asked);
  std::vector<Fitted> found = compare_views(
      asked, [&](std::size_t i) -> const SeenSurface& { return discernment_.views().at(later[i]); }, later);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    found[i].place.unconfirmed_own = map_.unconfirmed[asked[i].own];
    found[i].place.unconfirmed_theirs = map_.unconfirmed[later[i]];
  }
  const std::vector<std::size_t> with_walls = those_with_walls(asked, found);
  std::vector<std::uint32_t> both = own_keyframes(picked(asked, with_walls));
  for (const std::size_t i : with_walls) both.push_back(later[i]);
  ScanStore& scans = discernment_.scans();
  scans.prepare(both);
  parallel_for_each(with_walls.size(), [&](std::size_t k) {
    const std::size_t i = with_walls[k];
    add_walls(asked[i], scans.at(later[i]), found[i]);
  });
  return places_of(std::move(found));
}

}  // namespace adit
