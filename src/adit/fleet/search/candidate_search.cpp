// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/candidate_search.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/fleet/sync/own_map_parts.hpp"

namespace adit {

Fields fields_of(SearchConfig& c) {
  Fields fields = {
      {"candidates", &c.candidates, "", 1, 1e6, "candidates that are registered with each peer"},
      {"query_stride", &c.query_stride, "", 1, 1000,
       "every so many-th own keyframe is looked for, in large fleets every fourth at least"},
      {"ring_keys", &c.ring_keys, "", 1, 100000,
       "keyframes of the peer, those with the nearest ring keys, that each is compared with; in place of "
       "loops.place.num_candidates"},
      {"stand_out", &c.stand_out, "", 0, 0,
       "rank candidates by their distance over that to the most similar other place of the own map; "
       "otherwise by their distance"},
      {"of_a_place", &c.of_a_place, "", 1, 1e6, "at most this many candidates of one place"},
      {"place_keyframes", &c.place_keyframes, "", 1, 1e6,
       "keyframes nearer than this in index count as one place"},
      {"lane_m", &c.lane_m, "m", 0.0, 100.0,
       "distance between the lanes from which a keyframe is described for the search"},
      {"lanes", &c.lanes, "", 0, 100, "such lanes on each side of the one that was driven"},
      {"revisits", &c.revisits, "", 0, 0, "look for loops within the robot's own map"},
      {"revisit_candidates", &c.revisit_candidates, "", 1, 1e6,
       "candidates registered within the robot's own map"}};
  append(fields, "self_similarity", fields_of(c.self_similarity));
  append(fields, "revisit", fields_of(c.revisit));
  return fields;
}

std::vector<std::uint32_t> query_keyframes(const RobotMap& map, std::size_t stride) {
  const std::vector<std::uint32_t> keyframes = searchable_keyframes(map);
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < keyframes.size(); i += stride) out.push_back(keyframes[i]);
  return out;
}

std::vector<LoopCandidate> most_similar_places(const RobotMap& map, const std::vector<std::uint32_t>& queries,
                                               const PeerPlaces& peer, const PlaceIndexConfig& place,
                                               const Lanes& lanes) {
  PlaceIndex index(place);
  std::set<std::uint32_t> added;  // a confused peer may name a keyframe twice
  for (const Places::Place& theirs : peer.places)
    if (added.insert(theirs.index).second) index.add({peer.peer, theirs.index}, theirs.context);
  std::vector<std::vector<LoopCandidate>> best(queries.size());
  parallel_for_each(
      queries.size(),
      [&](std::size_t i) {
        best[i] = most_similar_from(lanes, map, queries[i], [&](const ScanContext& context) {
          return index.best_match({map.id, queries[i]}, context, peer.peer);
        });
      },
      16);
  std::vector<LoopCandidate> found;
  for (const std::vector<LoopCandidate>& of_query : best)
    found.insert(found.end(), of_query.begin(), of_query.end());
  std::ranges::sort(found, {},
                    [](const LoopCandidate& c) { return std::tuple(c.distance, c.query, c.match); });
  return found;
}

CandidateSearch::CandidateSearch(std::shared_ptr<const RobotMap> map, OdometryChain chain,
                                 const PlaceIndexConfig& place, const SearchConfig& config)
    : map_(std::move(map)), chain_(std::move(chain)), place_(place), config_(config) {}

const SelfSimilarity& CandidateSearch::self_similarity() {
  if (!self_similarity_)
    self_similarity_ = std::make_unique<SelfSimilarity>(map_, chain_, place_, config_.self_similarity);
  return *self_similarity_;
}

const std::vector<double>& CandidateSearch::self_distances() {
  if (self_distances_.empty()) self_distances_ = self_similarity().distances();
  return self_distances_;
}

std::vector<LoopCandidate> CandidateSearch::most_similar(const PeerPlaces& peer,
                                                         std::size_t least_stride) const {
  PlaceIndexConfig place = place_;
  place.max_distance = 1.0;  // ranked, not cut off
  place.num_candidates = config_.ring_keys;
  const std::size_t stride = std::max(static_cast<std::size_t>(config_.query_stride), least_stride);
  return most_similar_places(*map_, query_keyframes(*map_, stride), peer, place, lanes());
}

std::vector<LoopCandidate> CandidateSearch::most_promising(std::vector<LoopCandidate> found) {
  return standing_out(std::move(found), static_cast<std::size_t>(config_.candidates));
}

std::vector<LoopCandidate> CandidateSearch::standing_out(std::vector<LoopCandidate> found, std::size_t num) {
  const std::vector<double>& self = self_distances();
  const auto ratio = [&](const LoopCandidate& c) {
    return config_.stand_out ? c.distance / std::max(self[c.query.index], 1e-6) : c.distance;
  };
  std::ranges::sort(found, {},
                    [&](const LoopCandidate& c) { return std::tuple(ratio(c), c.query, c.match); });
  const auto are_of_one_place = [&](std::uint32_t i, std::uint32_t k) {
    return (i < k ? k - i : i - k) < static_cast<std::uint32_t>(config_.place_keyframes);
  };
  std::vector<LoopCandidate> chosen;
  std::set<KeyframeId> queries;
  for (const LoopCandidate& candidate : found) {
    if (chosen.size() == num) break;
    if (!queries.insert(candidate.query).second) continue;  // from another lane
    const auto of_this_place = std::ranges::count_if(chosen, [&](const LoopCandidate& c) {
      return are_of_one_place(c.query.index, candidate.query.index);
    });
    if (of_this_place < config_.of_a_place) chosen.push_back(candidate);
  }
  return chosen;
}

std::vector<LoopCandidate> CandidateSearch::revisits() {
  std::vector<std::optional<LoopCandidate>> best(chain_.size());
  parallel_for_each(best.size(), [&](std::size_t i) {
    const auto k = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> later = possible_revisits(chain_, k, config_.revisit);
    std::erase_if(later, [&](std::uint32_t other) { return !map_->searchable[other]; });
    if (later.empty() || !map_->searchable[k]) return;
    const std::vector<ScanContext> contexts = contexts_from(lanes(), *map_, k);
    for (const std::uint32_t other : later)
      for (const ScanContext& context : contexts) {
        const ContextMatch match = compare(context, map_->places[other]);
        if (!best[i] || match.distance < best[i]->distance)
          best[i] = LoopCandidate{{map_->id, k}, {map_->id, other}, match.yaw, match.distance};
      }
  });
  std::vector<LoopCandidate> found;
  for (const std::optional<LoopCandidate>& candidate : best)
    if (candidate) found.push_back(*candidate);
  if (found.empty()) return found;
  return standing_out(std::move(found), static_cast<std::size_t>(config_.revisit_candidates));
}

}  // namespace adit
