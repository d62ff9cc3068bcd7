// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

/// Which keyframes a query is compared with: those with the nearest ring keys, or all.
enum class PlaceSearch { ring_key, brute_force };
/// Both ways.
inline constexpr std::array kPlaceSearches{PlaceSearch::ring_key, PlaceSearch::brute_force};
/// ring_key, brute_force.
[[nodiscard]] std::string_view to_string(PlaceSearch search);

/// Which keyframes are searched, and how similar a match has to be.
struct PlaceIndexConfig {
  /// Swarm-SLAM's similarity of 0.9, the system that the paper follows (the paper leaves its value open; Scan
  /// Context's own is 0.13).
  double max_distance = 0.1;
  int num_candidates = 10;
  int exclude_recent = 50;
  PlaceSearch search = PlaceSearch::ring_key;
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(PlaceIndexConfig& config);

/// "Have we been here before?": the contexts of many keyframes of one or several robots.
///
/// Search by ring key is a flat scan over all ring keys: up to about 100,000 keyframes that is faster than a
/// tree in 20 dimensions, needs no rebuilding, and the order of insertion does not show in the answer.
/// Brute force compares with every keyframe. Equal distances: the smallest id wins.
class PlaceIndex {
 public:
  /// Throws ContractViolation when `config` is out of its documented ranges.
  explicit PlaceIndex(const PlaceIndexConfig& config);

  /// An empty context is taken but never found. Throws ContractViolation when the id is already there or the
  /// grid differs in size from the first one's.
  void add(KeyframeId id, ScanContext context);

  /// The nearest keyframe of robot `of`, no farther than `max_distance`; none when there is none so near, or
  /// when the query is empty. Of the query's own robot, keyframes within `exclude_recent` of its index are
  /// left out, and so is the query itself.
  [[nodiscard]] std::optional<LoopCandidate> best_match(KeyframeId query, const ScanContext& context,
                                                        RobotId of) const;

  /// The nearest `num_matches` keyframes of robot `of`, nearest first, by the same rules.
  [[nodiscard]] std::vector<LoopCandidate> best_matches(KeyframeId query, const ScanContext& context,
                                                        RobotId of, std::size_t num_matches) const;

  /// Keyframes of all robots, those with an empty context among them.
  [[nodiscard]] std::size_t size() const;

 private:
  /// The keyframes of one robot, by ascending index.
  struct Places {
    std::vector<std::uint32_t> indices;
    std::vector<ScanContext> contexts;
    std::vector<float> ring_keys;  ///< One after the other: the search streams through them.
  };
  [[nodiscard]] std::vector<std::size_t> positions_to_compare(const Places& places, KeyframeId query,
                                                              const ScanContext& context, RobotId of) const;

  PlaceIndexConfig config_;
  std::map<RobotId, Places> places_;
};

}  // namespace adit
