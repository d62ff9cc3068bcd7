// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/segments.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

struct Match {
  const LoopCandidate* candidate;
  double own_path_m;
  double their_path_m;
  Vector3 own_position;    // in the own odometry's frame
  Vector3 their_position;  // in theirs
  Pose T_own_theirs;       // between those frames, as this match alone says
};

/// In the order of the own path.
std::vector<Match> matches_of(const OdometryChain& own, const OdometryChain& theirs,
                              const std::vector<LoopCandidate>& found) {
  const std::vector<double>& own_path_m = own.path_m();
  const std::vector<double>& their_path_m = theirs.path_m();
  std::vector<Match> matches;
  matches.reserve(found.size());
  for (const LoopCandidate& c : found) {
    const Pose& T_own_query = own.pose(c.query.index);
    const Pose& T_their_match = theirs.pose(c.match.index);
    const Pose T_match_query = Pose::planar(0.0, 0.0, c.yaw);
    matches.push_back({&c, own_path_m[c.query.index], their_path_m[c.match.index], T_own_query.translation(),
                       T_their_match.translation(),
                       T_own_query * T_match_query.inverse() * T_their_match.inverse()});
  }
  std::ranges::sort(matches, {},
                    [](const Match& m) { return std::tuple(m.candidate->query, m.candidate->match); });
  return matches;
}

/// The matches, and which of them agree with one another.
class Agreeing {
 public:
  Agreeing(std::vector<Match> matches, const SegmentConfig& config)
      : matches_(std::move(matches)),
        config_(config),
        off_per_metre_(config.off_deg_per_m * kDegree),
        turned_(config.turned_deg * kDegree) {
    for (const Match& match : matches_)
      num_bins_ = std::max({num_bins_, bin_of(match.own_path_m) + 1, bin_of(match.their_path_m) + 1});
  }

  [[nodiscard]] std::size_t size() const { return matches_.size(); }
  [[nodiscard]] const Match& at(std::size_t i) const { return matches_[i]; }
  [[nodiscard]] std::size_t bin_of(double metres) const {
    return static_cast<std::size_t>(metres / config_.bin_m);
  }

  /// Indices of the matches near `anchor` along the own path that align the paths as it does.
  [[nodiscard]] std::vector<std::size_t> with(const Match& anchor) const {
    const double from = anchor.own_path_m - config_.reach_m;
    const double to = anchor.own_path_m + config_.reach_m;
    const auto first = std::ranges::lower_bound(matches_, from, {}, &Match::own_path_m) - matches_.begin();
    const auto last = std::ranges::upper_bound(matches_, to, {}, &Match::own_path_m) - matches_.begin();
    std::vector<std::size_t> out;
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
      if (agree(anchor, matches_[i])) out.push_back(i);
    return out;
  }

  [[nodiscard]] double support_of(const Match& anchor) const {
    std::vector<bool> own_bins(num_bins_, false);
    std::vector<bool> their_bins(num_bins_, false);
    for (const std::size_t i : with(anchor)) {
      own_bins[bin_of(matches_[i].own_path_m)] = true;
      their_bins[bin_of(matches_[i].their_path_m)] = true;
    }
    const auto num = std::min(std::ranges::count(own_bins, true), std::ranges::count(their_bins, true));
    return config_.bin_m * static_cast<double>(num);
  }

 private:
  [[nodiscard]] bool agree(const Match& anchor, const Match& other) const {
    const double metres = (other.own_position - anchor.own_position).norm();
    const Vector3 there = anchor.T_own_theirs * other.their_position;
    return (there - other.own_position).norm() <= config_.off_m + off_per_metre_ * metres &&
           anchor.T_own_theirs.rotation().angularDistance(other.T_own_theirs.rotation()) <= turned_;
  }

  std::vector<Match> matches_;
  SegmentConfig config_;
  double off_per_metre_;
  double turned_;
  std::size_t num_bins_ = 0;
};

/// The matches that agree with `anchor` and are not taken yet, the most similar one of each bin; takes them
/// all.
Segment segment_around(const Agreeing& matches, std::size_t anchor, double support_m,
                       std::vector<bool>& taken) {
  std::map<std::size_t, const LoopCandidate*> best;
  for (const std::size_t i : matches.with(matches.at(anchor))) {
    if (taken[i]) continue;
    taken[i] = true;
    const Match& match = matches.at(i);
    const LoopCandidate*& in_bin = best[matches.bin_of(match.own_path_m)];
    if (in_bin == nullptr || match.candidate->distance < in_bin->distance) in_bin = match.candidate;
  }
  Segment segment{support_m, {}};
  for (const auto& [bin, candidate] : best) segment.candidates.push_back(*candidate);
  std::ranges::stable_sort(segment.candidates, {}, &LoopCandidate::distance);
  return segment;
}

}  // namespace

std::vector<Segment> agreeing_segments(const OdometryChain& own, const OdometryChain& theirs,
                                       const std::vector<LoopCandidate>& found, const SegmentQuery& query) {
  const Agreeing matches(matches_of(own, theirs, found), query.config);
  std::vector<double> support_m(matches.size());
  parallel_for_each(
      matches.size(), [&](std::size_t i) { support_m[i] = matches.support_of(matches.at(i)); }, 16);
  std::vector<std::size_t> order(matches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return support_m[i]; });

  std::vector<Segment> segments;
  std::vector<bool> taken(matches.size(), false);
  for (const std::size_t i : order) {
    if (segments.size() == query.num) break;
    if (!taken[i]) segments.push_back(segment_around(matches, i, support_m[i], taken));
  }
  return segments;
}

}  // namespace adit
