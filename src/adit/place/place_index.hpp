// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/place/context_spectra.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

struct PlaceIndexConfig {
  /// Swarm-SLAM's similarity of 0.9, the system that the paper follows (the paper leaves its value open; Scan
  /// Context's own is 0.13).
  double max_distance = 0.1;
  int num_candidates = 10;
  int exclude_recent = 50;
  std::string search = "ring_key";
};
inline Fields fields_of(PlaceIndexConfig& c) {
  return {
      {"max_distance", &c.max_distance, "", 0.0, 1.0,
       "descriptor distance that a loop candidate may have at most"},
      {"num_candidates", &c.num_candidates, "", 1, 100000, "nearest ring keys whose columns are compared"},
      {"exclude_recent", &c.exclude_recent, "", 0, 100000,
       "keyframes of the query's own robot this near in index are no loop candidates"},
      {"search",
       &c.search,
       "",
       0,
       0,
       "nearest by ring key first, or the best of all keyframes at the shift that aligns their sector keys, "
       "or at every shift",
       {"ring_key", "brute_force", "every_shift"}}};
}

/// "Have we been here before?": the contexts of many keyframes of one or several robots.
///
/// Search by ring key is a flat scan over all ring keys: up to about 100,000 keyframes that is faster than a
/// tree in 20 dimensions, needs no rebuilding and no order of insertion shows in the answer. The other two
/// searches give what comparing with each keyframe would give (`compare`, `compare_all_shifts`), and compare
/// only with those that lower bounds of the distance leave. Equal distances: the smallest id wins.
class PlaceIndex {
 public:
  /// Throws ContractViolation when `config` is out of its documented ranges.
  explicit PlaceIndex(const PlaceIndexConfig& config);

  /// An empty context is taken but never found. Throws ContractViolation when the id is already there or the
  /// grid differs in size from the first one's.
  void add(KeyframeId id, ScanContext context);

  /// The nearest keyframe of robot `of`, no farther than `max_distance`; nothing when there is none, or when
  /// the query is empty. Of the query's own robot, keyframes within `exclude_recent` of its index are left
  /// out, and so is itself.
  [[nodiscard]] std::optional<LoopCandidate> best_match(KeyframeId query, const ScanContext& context,
                                                        RobotId of) const;

  /// The nearest `num_matches` keyframes of robot `of`, nearest first, by the same rules.
  [[nodiscard]] std::vector<LoopCandidate> best_matches(KeyframeId query, const ScanContext& context,
                                                        RobotId of, std::size_t num_matches) const;

  [[nodiscard]] std::size_t size() const;

 private:
  /// The keyframes of one robot, in the order of `add`.
  struct Places {
    std::vector<std::uint32_t> indices;
    std::vector<ScanContext> contexts;
    std::vector<float> ring_keys;           ///< One after the other: the search streams through them.
    std::optional<ContextSpectra> spectra;  ///< Where the search is not by ring key.
  };
  struct Search;
  [[nodiscard]] bool is_left_out(std::uint32_t index, KeyframeId query, RobotId of) const;
  [[nodiscard]] std::vector<std::size_t> nearest_ring_keys(const Places& places, const Search& search) const;
  void compare_with(const Places& places, const ContextSpectra::Query& query, std::size_t position,
                    Search& search) const;
  void search_all(const Places& places, Search& search) const;

  PlaceIndexConfig config_;
  std::map<RobotId, Places> places_;
};

}  // namespace adit
