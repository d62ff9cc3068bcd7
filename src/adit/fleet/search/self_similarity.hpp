// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which places of a robot's own map look like others that its odometry keeps apart from them: how much a
/// descriptor distance is worth at this site.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/search/lanes.hpp"
#include "adit/place/place_index.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Which places of one map are different ones, and how those that look alike are searched.
struct SelfSimilarityConfig {
  double other_place_m = 15.0;
  double sigmas = 3.0;
  int matches = 32;
  int stride = 3;
};
/// The keys are the names of the fields.
inline Fields fields_of(SelfSimilarityConfig& c) {
  return {{"other_place_m", &c.other_place_m, "m", 1.0, 1000.0,
           "two places of one map this far apart share little of what is seen"},
          {"sigmas", &c.sigmas, "", 0.0, 100.0, "sigmas of odometry added to that distance"},
          {"matches", &c.matches, "", 1, 10000,
           "most similar keyframes among which the nearest other place is looked for"},
          {"stride", &c.stride, "", 1, 1000, "look-alikes are looked for at every so many keyframes"}};
}

/// Searches the descriptors of a map in that map, leaving out what odometry does not keep apart.
class SelfSimilarity {
 public:
  /// `place` as in the search for peers; `chain`: the odometry of `map`.
  SelfSimilarity(std::shared_ptr<const RobotMap> map, const OdometryChain& chain, PlaceIndexConfig place,
                 const SelfSimilarityConfig& config = {});

  /// The most similar other place of keyframe `k`, by its own descriptor or by `context` (as from another
  /// lane).
  ///@{
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k) const {
    return most_similar(k, map_->places[k]);
  }
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k, const ScanContext& context) const;
  ///@}
  /// Of each keyframe the descriptor distance to its most similar other place; 1 where there is none.
  [[nodiscard]] std::vector<double> distances() const;
  /// Places all along the path and others that look like them from one of the lanes; each pair once.
  [[nodiscard]] std::vector<LoopCandidate> look_alikes(const Lanes& lanes) const;

 private:
  [[nodiscard]] bool is_elsewhere(std::uint32_t k, std::uint32_t other) const;

  std::shared_ptr<const RobotMap> map_;
  OdometryChain chain_;
  PlaceIndex index_;
  SelfSimilarityConfig config_;
};

}  // namespace adit
