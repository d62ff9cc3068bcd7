// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/lanes.hpp"

#include <map>

namespace adit {

std::vector<ScanContext> contexts_from(const Lanes& lanes, const RobotMap& map, std::uint32_t k) {
  std::vector<ScanContext> contexts{map.places[k]};
  if (lanes.on_each_side == 0) return contexts;
  const PointCloud& seen = *map.keyframes[k].cloud;
  PointCloud cloud = seen;
  for (int lane = -lanes.on_each_side; lane <= lanes.on_each_side; ++lane) {
    if (lane == 0) continue;
    const auto aside = static_cast<float>(lane * lanes.apart_m);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) cloud.points[i].y() = seen.points[i].y() - aside;
    const Vector3 viewpoint = map.viewpoint - aside * Vector3::UnitY();
    contexts.push_back(describe(cloud, map.scan_context, viewpoint));
  }
  return contexts;
}

std::vector<LoopCandidate> most_similar_from(const Lanes& lanes, const RobotMap& map, std::uint32_t k,
                                             const FindSimilar& find) {
  std::map<KeyframeId, LoopCandidate> nearest;
  for (const ScanContext& context : contexts_from(lanes, map, k)) {
    const std::optional<LoopCandidate> match = find(context);
    if (!match) continue;
    LoopCandidate& known = nearest.try_emplace(match->match, *match).first->second;
    if (match->distance < known.distance) known = *match;
  }
  std::vector<LoopCandidate> found;
  for (const auto& [match, candidate] : nearest) found.push_back(candidate);
  return found;
}

}  // namespace adit
