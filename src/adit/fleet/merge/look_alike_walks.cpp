// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/look_alike_walks.hpp"

#include <cmath>

#include "adit/core/parallel.hpp"
#include "adit/fleet/merge/segments.hpp"
#include "adit/fleet/search/path.hpp"
#include "adit/fleet/search/revisits.hpp"
#include "adit/registration/registration.hpp"

namespace adit {

LookAlikeWalks::LookAlikeWalks(Discernment& discernment, const OdometryChain& chain, FeatureStore& features,
                               const AdaptiveConfig& config)
    : discernment_(discernment),
      chain_(chain),
      features_(features),
      config_(config),
      path_m_(chain.path_m()) {}

void LookAlikeWalks::start(const std::vector<LoopCandidate>& similar) {
  const DiscernmentConfig& config = config_.merge_check.discernment;
  const std::vector<Segment> stretches = agreeing_segments(
      chain_, chain_, similar, {static_cast<std::size_t>(config.look_alikes), config.segment});
  std::vector<std::optional<Walk>> found(stretches.size());
  for (std::size_t attempt = 0; attempt < static_cast<std::size_t>(config.starts_per_look_alike); ++attempt) {
    std::vector<std::size_t> open;
    std::vector<std::uint32_t> used;
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      if (found[s] || attempt >= stretches[s].candidates.size()) continue;
      const LoopCandidate& candidate = stretches[s].candidates[attempt];
      used.insert(used.end(), {candidate.query.index, candidate.match.index});
      open.push_back(s);
    }
    features_.prepare(used);
    parallel_for_each(open.size(), [&](std::size_t i) {
      found[open[i]] = start_at(stretches[open[i]].candidates[attempt]);
    });
  }
  std::size_t look_alike = 0;
  for (const std::optional<Walk>& walk : found) {
    if (!walk) continue;
    for (const double direction : {1.0, -1.0}) {
      walks_.push_back(*walk);
      walks_.back().direction = direction;
      walks_.back().look_alike = look_alike;
    }
    ++look_alike;
  }
}

/// None where registration finds no alignment, and where odometry does not exclude that it is one place:
/// scans from afar that see the same walls.
std::optional<LookAlikeWalks::Walk> LookAlikeWalks::start_at(const LoopCandidate& candidate) const {
  const std::uint32_t a = candidate.query.index;
  const std::uint32_t b = candidate.match.index;
  const Registration found = register_features(features_.at(a), features_.at(b), config_.registration);
  if (found.verdict != LoopVerdict::accepted || found.weak_axis < kWeakAxis ||
      fits_odometry(chain_, {a, b, *found.T_a_b, found.information}, config_.search.revisit))
    return {};
  return Walk{a, b, *found.T_a_b};
}

std::vector<OwnComparison> LookAlikeWalks::next_places() {
  const double followed_m = config_.merge_check.discernment.followed_m;
  std::vector<OwnComparison> places;
  for (Walk& walk : walks_) {
    walk.path_m += walk.direction * config_.merge_check.spacing_m;
    const auto place = place_at(walk, walk.path_m, kComparedApart[places.size() % kComparedApart.size()]);
    walk.is_over = std::abs(walk.path_m) > followed_m || !place;
    if (!walk.is_over) places.push_back(*place);
  }
  std::erase_if(walks_, [](const Walk& walk) { return walk.is_over; });
  return places;
}

void LookAlikeWalks::follow(Measured& measured) {
  std::vector<WallOffsets> offsets(walks_.size(),
                                   WallOffsets(config_.registration.relief));  // of each look-alike
  while (!walks_.empty()) {
    Step step;
    step.asked = next_places();
    std::vector<std::uint32_t> places;
    for (const OwnComparison& place : step.asked) places.push_back(place.a);
    const std::vector<bool> is_distinctive = discernment_.distinctive(places);
    step.found = discernment_.compare(step.asked, FitFrom::along_the_path);
    if (config_.merge_check.discernment.second_looks) look_again(step);
    const std::vector<std::vector<PatchOffset>> walls = discernment_.walls_of(step.asked, step.found);
    for (std::size_t w = 0; w < walks_.size(); ++w) {
      Walk& walk = walks_[w];
      walk.is_over = discernment_.differ(step.found[w].agreement);
      if (walk.is_over) {
        measured.look_alikes.add_differed(walk.num_passed);
        continue;
      }
      offsets[walk.look_alike].add(walls[w]);
      if (is_distinctive[w]) measured.look_alikes.add_agreed(walk.num_passed++);
    }
    std::erase_if(walks_, [](const Walk& walk) { return walk.is_over; });
  }
  for (const WallOffsets& of_one : offsets) measured.walls.add_other(of_one.counted());
}

std::optional<OwnComparison> LookAlikeWalks::place_at(const Walk& walk, double path_m, double apart_m) const {
  // The two drives run the same way along the look-alike, or one against the other; keyframe b stands T_a_b.x
  // ahead of a already.
  const double sense = (walk.T_a_b.rotation_matrix() * Vector3::UnitX()).x() > 0.0 ? 1.0 : -1.0;
  const auto a = keyframe_at(path_m_, path_m_[walk.a] + path_m);
  const auto b =
      keyframe_at(path_m_, path_m_[walk.b] + sense * (path_m + apart_m - walk.T_a_b.translation().x()));
  if (!a || !b) return {};
  return OwnComparison{*a, *b, chain_.between(*a, walk.a) * walk.T_a_b * chain_.between(walk.b, *b)};
}

void LookAlikeWalks::look_again(Step& step) {
  const double second_look_m = config_.merge_check.discernment.second_look_m;
  std::vector<std::size_t> which;
  std::vector<OwnComparison> asked;
  for (std::size_t w = 0; w < walks_.size(); ++w) {
    if (!discernment_.differ(step.found[w].agreement)) continue;
    for (const double metres : {second_look_m, -second_look_m}) {
      const auto place = place_at(walks_[w], walks_[w].path_m + metres, kComparedApart.front());
      if (!place) continue;
      which.push_back(w);
      asked.push_back(*place);
      break;
    }
  }
  const std::vector<LocalFit> again = discernment_.compare(asked, FitFrom::along_the_path);
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (discernment_.differ(again[i].agreement)) continue;
    step.asked[which[i]] = asked[i];
    step.found[which[i]] = again[i];
  }
}

}  // namespace adit
