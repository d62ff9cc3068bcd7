// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/self_similarity.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/parallel.hpp"

namespace adit {
namespace {

/// Ranks all keyframes, however similar and near; by ring key it compares several times as many as are asked
/// for.
PlaceIndexConfig ranking_all(PlaceIndexConfig place, int matches) {
  constexpr int kComparedPerMatch = 4;
  place.max_distance = 1.0;
  place.exclude_recent = 0;
  place.num_candidates = std::max(place.num_candidates, kComparedPerMatch * matches);
  return place;
}

}  // namespace

SelfSimilarity::SelfSimilarity(std::shared_ptr<const RobotMap> map, const OdometryChain& chain,
                               PlaceIndexConfig place, const SelfSimilarityConfig& config)
    : map_(std::move(map)), chain_(chain), index_(ranking_all(place, config.matches)), config_(config) {
  for (std::uint32_t k = 0; k < map_->places.size(); ++k) index_.add({map_->id, k}, map_->places[k]);
}

std::optional<LoopCandidate> SelfSimilarity::most_similar(std::uint32_t k, const ScanContext& context) const {
  const auto num = static_cast<std::size_t>(config_.matches);
  for (const LoopCandidate& match : index_.best_matches({map_->id, k}, context, map_->id, num))
    if (is_elsewhere(k, match.match.index)) return match;
  return {};
}

std::vector<LoopCandidate> SelfSimilarity::look_alikes(const Lanes& lanes) const {
  const auto stride = static_cast<std::size_t>(config_.stride);
  std::vector<std::vector<LoopCandidate>> similar((map_->keyframes.size() + stride - 1) / stride);
  parallel_for_each(similar.size(), [&](std::size_t i) {
    const auto k = static_cast<std::uint32_t>(stride * i);
    similar[i] = most_similar_from(lanes, *map_, k,
                                   [&](const ScanContext& context) { return most_similar(k, context); });
  });
  std::vector<LoopCandidate> found;
  for (const std::vector<LoopCandidate>& of_one : similar)
    for (const LoopCandidate& candidate : of_one)
      if (candidate.query < candidate.match) found.push_back(candidate);
  return found;
}

std::vector<double> SelfSimilarity::distances() const {
  std::vector<double> distances(map_->keyframes.size(), 1.0);
  parallel_for_each(
      distances.size(),
      [&](std::size_t k) {
        if (const auto match = most_similar(static_cast<std::uint32_t>(k))) distances[k] = match->distance;
      },
      16);
  return distances;
}

bool SelfSimilarity::is_elsewhere(std::uint32_t k, std::uint32_t other) const {
  if (std::abs(chain_.path_m()[k] - chain_.path_m()[other]) < config_.other_place_m) return false;
  const double drift = std::sqrt(chain_.covariance(k, other).topLeftCorner<3, 3>().trace());
  return chain_.between(k, other).translation().norm() > config_.other_place_m + config_.sigmas * drift;
}

}  // namespace adit
