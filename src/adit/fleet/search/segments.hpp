// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Places recognised along the way. One keyframe of a tunnel looks like hundreds of others; that keyframe
/// after keyframe looks like the one that another robot's odometry leads to, over tens of metres, happens
/// elsewhere less often. Sequences do the same for images in SeqSLAM (Milford and Wyeth, "SeqSLAM: Visual
/// route-based navigation for sunny summer days and stormy winter nights", ICRA 2012), at one speed and in
/// one direction; here odometry gives both, so that robots may drive to and fro.
#pragma once

#include <vector>

#include "adit/core/records.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Candidates that lay two ways over one another alike, within some tens of metres.
struct Segment {
  /// Metres of way that they cover: of the query's or of the match's, whichever is less. Each counts for as
  /// much as it stands out.
  double support_m = 0.0;
  /// The most similar one of each few metres, most similar first.
  std::vector<LoopCandidate> candidates;
};

/// At most `num` segments of all `found`, those with the largest support first; each candidate belongs to the
/// first one that it agrees with. `own` and `theirs` have the poses of all queries and matches. `likeness`:
/// of each keyframe of the own robot the distance of the most similar other place of its own map; a candidate
/// counts for 1 / (1 + r^2), where r is its distance over that. Without it all count for 1.
[[nodiscard]] std::vector<Segment> agreeing_segments(const OdometryChain& own, const OdometryChain& theirs,
                                                     const std::vector<LoopCandidate>& found, std::size_t num,
                                                     const std::vector<double>& likeness = {});

}  // namespace adit
