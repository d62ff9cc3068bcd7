// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/place_index.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {
namespace {

PlaceIndexConfig checked(PlaceIndexConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
  return config;
}

}  // namespace

PlaceIndex::PlaceIndex(const PlaceIndexConfig& config) : config_(checked(config)) {}

void PlaceIndex::add(KeyframeId id, ScanContext context) {
  for (const auto& [robot, places] : places_) {
    ADIT_CHECK(places.contexts.empty() || (places.contexts.front().num_rings == context.num_rings &&
                                           places.contexts.front().num_sectors == context.num_sectors),
               "all contexts of an index have one grid size");
  }
  ADIT_CHECK(context.num_sectors > 0, "a context is made by describe, from_heights or decode");
  Places& places = places_[id.robot];
  const auto at = std::ranges::lower_bound(places.indices, id.index);
  ADIT_CHECK(at == places.indices.end() || *at != id.index, "a keyframe is added once");
  const auto position = at - places.indices.begin();
  places.indices.insert(at, id.index);
  places.ring_keys.insert(places.ring_keys.begin() + position * context.num_rings, context.ring_key.begin(),
                          context.ring_key.end());
  places.contexts.insert(places.contexts.begin() + position, std::move(context));
}

std::size_t PlaceIndex::size() const {
  std::size_t total = 0;
  for (const auto& [robot, places] : places_) total += places.indices.size();
  return total;
}

std::vector<std::size_t> PlaceIndex::candidates(const Places& places, KeyframeId query,
                                                const ScanContext& context, RobotId of) const {
  std::vector<std::pair<float, std::size_t>> ranked;  // Of equal ring keys the earlier keyframe goes first.
  ranked.reserve(places.indices.size());
  const Eigen::Map<const Eigen::ArrayXf> key(context.ring_key.data(), context.num_rings);
  const auto too_near = [&](std::uint32_t index) {
    const std::int64_t gap = std::int64_t{index} - query.index;
    return of == query.robot && std::abs(gap) <= config_.exclude_recent;
  };
  for (std::size_t i = 0; i < places.indices.size(); ++i) {
    if (too_near(places.indices[i])) continue;
    const float* other = places.ring_keys.data() + i * static_cast<std::size_t>(context.num_rings);
    ranked.emplace_back((Eigen::Map<const Eigen::ArrayXf>(other, context.num_rings) - key).square().sum(), i);
  }
  const bool all = config_.search == "brute_force";
  const std::size_t wanted = all ? ranked.size() : static_cast<std::size_t>(config_.num_candidates);
  if (ranked.size() > wanted) {
    std::ranges::nth_element(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(wanted));
    ranked.resize(wanted);
  }
  std::vector<std::size_t> positions;
  positions.reserve(ranked.size());
  for (const auto& [distance, i] : ranked) positions.push_back(i);
  return positions;
}

std::vector<LoopCandidate> PlaceIndex::best_matches(KeyframeId query, const ScanContext& context, RobotId of,
                                                    std::size_t num_matches) const {
  const auto found = places_.find(of);
  if (found == places_.end() || context.empty()) return {};
  const Places& places = found->second;
  std::vector<LoopCandidate> matches;
  for (const std::size_t i : candidates(places, query, context, of)) {
    if (places.contexts[i].empty()) continue;
    const ContextMatch match = compare(context, places.contexts[i]);
    if (match.distance <= config_.max_distance) {
      matches.push_back({query, {of, places.indices[i]}, match.yaw, match.distance});
    }
  }
  std::ranges::sort(matches, {}, [](const LoopCandidate& c) { return std::tuple(c.distance, c.match); });
  matches.resize(std::min(matches.size(), num_matches));
  return matches;
}

std::optional<LoopCandidate> PlaceIndex::best_match(KeyframeId query, const ScanContext& context,
                                                    RobotId of) const {
  const std::vector<LoopCandidate> best = best_matches(query, context, of, 1);
  return best.empty() ? std::nullopt : std::optional(best.front());
}

}  // namespace adit
