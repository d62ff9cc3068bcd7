// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which pairs of keyframes are worth registering, most promising first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/search/lanes.hpp"
#include "adit/fleet/search/revisits.hpp"
#include "adit/fleet/search/self_similarity.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Which matches of descriptors are registered (CandidateSearch).
struct SearchConfig {
  int candidates = 64;
  int query_stride = 2;
  int ring_keys = 200;
  bool stand_out = true;
  int of_a_place = 3;
  int place_keyframes = 6;
  double lane_m = 1.0;
  int lanes = 2;
  bool revisits = true;
  int revisit_candidates = 32;
  SelfSimilarityConfig self_similarity;
  RevisitConfig revisit;
};
/// Keys of `self_similarity` and `revisit` begin with these names.
Fields fields_of(SearchConfig& config);

/// A peer and its descriptors.
struct PeerPlaces {
  RobotId peer;                       ///< Whose keyframes `places` are.
  std::vector<Places::Place> places;  ///< Of a keyframe that is named twice the first one counts.
};

/// Every so many-th of the keyframes that take part in loop search, in the order driven.
[[nodiscard]] std::vector<std::uint32_t> query_keyframes(const RobotMap& map, std::size_t stride);

/// The most similar place of the peer to each of the keyframes `queries` of `map`, as seen from each lane
/// (another one only if it names another place); most similar first.
[[nodiscard]] std::vector<LoopCandidate> most_similar_places(const RobotMap& map,
                                                             const std::vector<std::uint32_t>& queries,
                                                             const PeerPlaces& peer,
                                                             const PlaceIndexConfig& place,
                                                             const Lanes& lanes = {});

/// Ranks candidates by what the own map says about them. What it needs of the map is computed when first
/// needed.
class CandidateSearch {
 public:
  /// `chain`: the odometry of `map`.
  CandidateSearch(std::shared_ptr<const RobotMap> map, OdometryChain chain, const PlaceIndexConfig& place,
                  const SearchConfig& config);

  /// As configured: the lanes from which own keyframes are described.
  [[nodiscard]] Lanes lanes() const { return {config_.lanes, config_.lane_m}; }
  /// Of the own map; made when it is first asked for, valid as long as this.
  [[nodiscard]] const SelfSimilarity& self_similarity();

  /// SelfSimilarity::distances; computed when they are first asked for.
  [[nodiscard]] const std::vector<double>& self_distances();

  /// What `most_similar_places` finds of the peer's with these settings: as seen from each lane, however
  /// similar. Every max(query_stride, least_stride)-th own keyframe is looked for.
  [[nodiscard]] std::vector<LoopCandidate> most_similar(const PeerPlaces& peer,
                                                        std::size_t least_stride) const;

  /// Of what `most_similar` found, those that stand out most from look-alikes in the own map, at most
  /// a few of each place.
  [[nodiscard]] std::vector<LoopCandidate> most_promising(std::vector<LoopCandidate> found);

  /// Candidates within the own map.
  [[nodiscard]] std::vector<LoopCandidate> revisits();

 private:
  [[nodiscard]] std::vector<LoopCandidate> standing_out(std::vector<LoopCandidate> found, std::size_t num);

  std::shared_ptr<const RobotMap> map_;
  OdometryChain chain_;
  PlaceIndexConfig place_;
  SearchConfig config_;
  std::unique_ptr<SelfSimilarity> self_similarity_;
  std::vector<double> self_distances_;
};

}  // namespace adit
