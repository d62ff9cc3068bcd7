// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/place_index.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <span>
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

using Candidate = ContextSpectra::Candidate;

constexpr std::size_t kStretch = 256;  ///< Candidates that send one scout.
constexpr std::size_t kScouts = 8;     ///< Scouts that are compared in full.

std::vector<Candidate> most_promising(const std::vector<Candidate>& candidates) {
  std::vector<Candidate> out;
  for (std::size_t begin = 0; begin < candidates.size(); begin += kStretch) {
    const std::span stretch =
        std::span(candidates).subspan(begin, std::min(kStretch, candidates.size() - begin));
    out.push_back(*std::ranges::min_element(stretch, {}, &Candidate::bound));
  }
  return out;
}

bool nearer(const LoopCandidate& a, const LoopCandidate& b) {
  return std::tuple(a.distance, a.match) < std::tuple(b.distance, b.match);
}

/// The least distance over all shifts, where it is no farther than `max_distance`. As `compare_all_shifts`,
/// but only at shifts that the spectra leave.
std::optional<ContextMatch> best_shift(const ScanContext& query, const ScanContext& match,
                                       const std::vector<float>& most_by_shift, double max_distance) {
  const auto num_seen = [](const ScanContext& context) {
    return std::ranges::count_if(context.norms, [](float norm) { return norm > 0.0F; });
  };
  // sectors that both saw, at least
  const auto shared =
      static_cast<double>(std::max(num_seen(query) + num_seen(match) - query.num_sectors, std::ptrdiff_t{1}));
  std::optional<ContextMatch> best;
  for (int shift = 0; shift < query.num_sectors; ++shift) {
    const double least = 1.0 - static_cast<double>(most_by_shift[static_cast<std::size_t>(shift)]) / shared;
    if (least > (best ? best->distance : max_distance)) continue;
    const double distance = distance_at(query, match, shift);
    if (distance <= max_distance && (!best || distance < best->distance))
      best = ContextMatch{distance, shift, yaw_of_shift(shift, query.num_sectors)};
  }
  return best;
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
  if (config_.search != "ring_key") {
    if (!places.spectra) places.spectra.emplace(context.num_rings, context.num_sectors);
    places.spectra->insert(static_cast<std::size_t>(position), context);
  }
  places.contexts.insert(places.contexts.begin() + position, std::move(context));
}

std::size_t PlaceIndex::size() const {
  std::size_t total = 0;
  for (const auto& [robot, places] : places_) total += places.indices.size();
  return total;
}

/// One query under way.
struct PlaceIndex::Search {
  KeyframeId query;
  const ScanContext& context;
  RobotId of;
  std::size_t num_matches;
  double max_distance;                 ///< What is farther takes no place among the matches.
  std::vector<LoopCandidate> matches;  ///< The nearest so far, nearest first.

  [[nodiscard]] bool has(std::uint32_t index) const {
    return std::ranges::any_of(matches, [&](const LoopCandidate& c) { return c.match.index == index; });
  }
  void add(std::uint32_t index, const ContextMatch& match) {
    if (match.distance > max_distance) return;
    const LoopCandidate found{query, {of, index}, match.yaw, match.distance};
    matches.insert(std::ranges::upper_bound(matches, found, nearer), found);
    if (matches.size() > num_matches) matches.pop_back();
    if (matches.size() == num_matches) max_distance = matches.back().distance;
  }
};

/// Keyframes of the query's own robot that are too near in index.
bool PlaceIndex::is_left_out(std::uint32_t index, KeyframeId query, RobotId of) const {
  const std::int64_t gap = std::int64_t{index} - query.index;
  return of == query.robot && std::abs(gap) <= config_.exclude_recent;
}

std::vector<std::size_t> PlaceIndex::nearest_ring_keys(const Places& places, const Search& search) const {
  std::vector<std::pair<float, std::size_t>> ranked;  // Of equal ring keys the earlier keyframe goes first.
  ranked.reserve(places.indices.size());
  const auto num_rings = static_cast<std::size_t>(search.context.num_rings);
  const Eigen::Map<const Eigen::ArrayXf> key(search.context.ring_key.data(), search.context.num_rings);
  for (std::size_t i = 0; i < places.indices.size(); ++i) {
    if (is_left_out(places.indices[i], search.query, search.of)) continue;
    const Eigen::Map<const Eigen::ArrayXf> other(places.ring_keys.data() + i * num_rings, key.size());
    ranked.emplace_back((other - key).square().sum(), i);
  }
  const auto wanted = static_cast<std::size_t>(config_.num_candidates);
  if (ranked.size() > wanted) {
    std::ranges::nth_element(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(wanted));
    ranked.resize(wanted);
  }
  std::vector<std::size_t> positions;
  positions.reserve(ranked.size());
  for (const auto& [distance, i] : ranked) positions.push_back(i);
  return positions;
}

void PlaceIndex::compare_with(const Places& places, const ContextSpectra::Query& query, std::size_t position,
                              Search& search) const {
  const std::uint32_t index = places.indices[position];
  if (search.has(index)) return;
  const ScanContext& match = places.contexts[position];
  if (config_.search == "brute_force") {
    search.add(index, compare(search.context, match));
    return;
  }
  const std::vector<float> most = places.spectra->most_by_shift(query, position);
  if (const auto best = best_shift(search.context, match, most, search.max_distance))
    search.add(index, *best);
}

/// Frequency by frequency, fewer keyframes may still be as near as the nearest known. Scouts, the most
/// promising of each stretch, run ahead, so that early on one is known that is about as near as the nearest
/// of all.
void PlaceIndex::search_all(const Places& places, Search& search) const {
  const ContextSpectra& spectra = *places.spectra;
  const ContextSpectra::Query query = spectra.query_of(search.context);
  const std::size_t num_steps = query.frequencies.size();
  const auto max_distance = [&] { return static_cast<float>(search.max_distance); };
  const auto compare_with_nearest = [&](std::vector<Candidate> candidates, std::size_t at_most) {
    std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
      return std::tuple(a.bound, a.position) < std::tuple(b.bound, b.position);
    });
    candidates.resize(std::min(candidates.size(), at_most));
    for (std::size_t k = 0; k < candidates.size() && candidates[k].bound <= max_distance(); ++k) {
      if (k + 1 < candidates.size()) spectra.prefetch(candidates[k + 1].position);
      compare_with(places, query, candidates[k].position, search);
    }
  };

  std::vector<Candidate> candidates = spectra.candidates(query, max_distance());
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return is_left_out(places.indices[candidate.position], search.query, search.of);
  });
  std::vector<Candidate> scouts = most_promising(candidates);
  for (std::size_t step = 0; step < num_steps; ++step) spectra.narrow(query, step, max_distance(), scouts);
  compare_with_nearest(std::move(scouts), kScouts);
  std::erase_if(candidates, [&](const Candidate& candidate) { return candidate.bound > max_distance(); });
  for (std::size_t step = 0; step < num_steps; ++step)
    spectra.narrow(query, step, max_distance(), candidates);
  const std::size_t all = candidates.size();
  compare_with_nearest(std::move(candidates), all);
}

std::vector<LoopCandidate> PlaceIndex::best_matches(KeyframeId query, const ScanContext& context, RobotId of,
                                                    std::size_t num_matches) const {
  const auto found = places_.find(of);
  if (found == places_.end() || context.empty() || num_matches == 0) return {};
  const Places& places = found->second;
  Search search{query, context, of, num_matches, config_.max_distance, {}};
  if (config_.search == "ring_key") {
    for (const std::size_t i : nearest_ring_keys(places, search)) {
      if (!places.contexts[i].empty()) search.add(places.indices[i], compare(context, places.contexts[i]));
    }
  } else {
    search_all(places, search);
  }
  return std::move(search.matches);
}

std::optional<LoopCandidate> PlaceIndex::best_match(KeyframeId query, const ScanContext& context,
                                                    RobotId of) const {
  const std::vector<LoopCandidate> best = best_matches(query, context, of, 1);
  return best.empty() ? std::nullopt : std::optional(best.front());
}

}  // namespace adit
