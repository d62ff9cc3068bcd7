// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/place_index.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
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

bool nearer(const LoopCandidate& a, const LoopCandidate& b) {
  return std::tuple(a.distance, a.match) < std::tuple(b.distance, b.match);
}

}  // namespace

std::string_view to_string(PlaceSearch search) {
  return search == PlaceSearch::ring_key ? "ring_key" : "brute_force";
}

Fields fields_of(PlaceIndexConfig& c) {
  return {{"max_distance", &c.max_distance, "", 0.0, 1.0, "largest descriptor distance of a loop candidate"},
          {"num_candidates", &c.num_candidates, "", 1, 100000,
           "number of nearest ring keys whose columns are compared"},
          {"exclude_recent", &c.exclude_recent, "", 0, 100000,
           "keyframes of the query's own robot this near in index are not loop candidates"},
          enum_field("search", &c.search, kPlaceSearches,
                     "compare with the keyframes of the nearest ring keys, or with all")};
}

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

/// All keyframes but those of the query's own robot that are too near in index; of these, by ring key, the
/// nearest few.
std::vector<std::size_t> PlaceIndex::positions_to_compare(const Places& places, KeyframeId query,
                                                          const ScanContext& context, RobotId of) const {
  std::vector<std::pair<float, std::size_t>> ranked;  // Of equal ring keys the earlier keyframe goes first.
  ranked.reserve(places.indices.size());
  const auto num_rings = static_cast<std::size_t>(context.num_rings);
  const Eigen::Map<const Eigen::ArrayXf> key(context.ring_key.data(), context.num_rings);
  for (std::size_t i = 0; i < places.indices.size(); ++i) {
    const std::int64_t gap = std::int64_t{places.indices[i]} - query.index;
    if (of == query.robot && std::abs(gap) <= config_.exclude_recent) continue;
    const Eigen::Map<const Eigen::ArrayXf> other(places.ring_keys.data() + i * num_rings, key.size());
    ranked.emplace_back((other - key).square().sum(), i);
  }
  const auto wanted = static_cast<std::size_t>(config_.num_candidates);
  if (config_.search == PlaceSearch::ring_key && ranked.size() > wanted) {
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
  for (const std::size_t i : positions_to_compare(places, query, context, of)) {
    if (places.contexts[i].empty()) continue;
    const ContextMatch match = compare(context, places.contexts[i]);
    if (match.distance <= config_.max_distance)
      matches.push_back({query, {of, places.indices[i]}, match.yaw, match.distance});
  }
  std::ranges::sort(matches, nearer);
  matches.resize(std::min(matches.size(), num_matches));
  return matches;
}

std::optional<LoopCandidate> PlaceIndex::best_match(KeyframeId query, const ScanContext& context,
                                                    RobotId of) const {
  const std::vector<LoopCandidate> best = best_matches(query, context, of, 1);
  return best.empty() ? std::nullopt : std::optional(best.front());
}

}  // namespace adit
