// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Sequences of matches that agree: stretches of tunnel that look alike all along. One keyframe of a tunnel
/// looks like hundreds of others; that one keyframe after the other, over tens of metres, looks like the one
/// that odometry leads to is rarer. SeqSLAM does the same for images (Milford and Wyeth, "SeqSLAM: Visual
/// route-based navigation for sunny summer days and stormy winter nights", ICRA 2012), at one speed and in
/// one direction; here odometry gives both, so that robots may drive to and fro.
#pragma once

#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Which candidates agree with one another.
struct SegmentConfig {
  double reach_m = 60.0;
  double bin_m = 3.0;
  double off_m = 3.0;
  double off_deg_per_m = 3.0;
  double turned_deg = 18.0;
};
/// The keys are the names of the fields.
inline Fields fields_of(SegmentConfig& c) {
  return {{"reach_m", &c.reach_m, "m", 1.0, 10000.0,
           "candidates of one segment lie within this distance along the own path, ahead or behind"},
          {"bin_m", &c.bin_m, "m", 0.1, 1000.0, "stretch of path that counts once"},
          {"off_m", &c.off_m, "m", 0.0, 1000.0,
           "agreeing candidates place the other robot within this distance; a descriptor matches some metres "
           "ahead or behind"},
          {"off_deg_per_m", &c.off_deg_per_m, "deg", 0.0, 90.0,
           "that grows by this angle times the distance between them: half a sector of 6 degrees"},
          {"turned_deg", &c.turned_deg, "deg", 0.0, 180.0, "largest difference of their headings"}};
}

/// Candidates that align two paths alike, within some tens of metres.
struct Segment {
  /// Metres of path that they cover, of the query's or of the match's, whichever is less.
  double support_m = 0.0;
  /// The most similar one of each bin, most similar first.
  std::vector<LoopCandidate> candidates;
};

/// What agreeing_segments is asked for.
struct SegmentQuery {
  std::size_t num = 0;        ///< Segments at most.
  SegmentConfig config = {};  ///< Which candidates agree.
};

/// Segments of all `found`, those with the largest support first; each candidate belongs to the first one
/// that it agrees with. `own` and `theirs`: odometry of the robots of all queries and matches.
[[nodiscard]] std::vector<Segment> agreeing_segments(const OdometryChain& own, const OdometryChain& theirs,
                                                     const std::vector<LoopCandidate>& found,
                                                     const SegmentQuery& query);

}  // namespace adit
