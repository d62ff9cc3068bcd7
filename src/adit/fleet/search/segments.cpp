// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/segments.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

#include "adit/core/parallel.hpp"
#include "adit/fleet/merge/discernment.hpp"

namespace adit {
namespace {

constexpr double kReach = 60.0;  // metres along the own way, before and behind
constexpr double kBin = 3.0;     // metres of way that count once
// A descriptor finds its like some metres ahead or behind, and its heading to half of a sector of 6 degrees.
constexpr double kOff = 3.0;  // metres
const double kOffPerMetre = 3.0 * std::numbers::pi / 180.0;
const double kTurned = 18.0 * std::numbers::pi / 180.0;

struct Match {
  const LoopCandidate* candidate;
  double own_way;
  double their_way;
  Vector3 own_position;    // in the own odometry's frame
  Vector3 their_position;  // in theirs
  Pose T_own_theirs;       // between those frames, as this match alone says
  double weight;
};

double weight_of(const LoopCandidate& candidate, const std::vector<double>& likeness) {
  if (likeness.empty()) return 1.0;
  const double ratio = candidate.distance / std::max(likeness[candidate.query.index], 1e-6);
  return 1.0 / (1.0 + ratio * ratio);
}

std::vector<Match> along_the_way(const OdometryChain& own, const OdometryChain& theirs,
                                 const std::vector<LoopCandidate>& found,
                                 const std::vector<double>& likeness) {
  const std::vector<double> own_way = way_along(own);
  const std::vector<double> their_way = way_along(theirs);
  std::vector<Match> matches;
  matches.reserve(found.size());
  for (const LoopCandidate& c : found) {
    const Pose& T_own_query = own.pose(c.query.index);
    const Pose& T_their_match = theirs.pose(c.match.index);
    const Pose T_match_query = Pose::planar(0.0, 0.0, c.yaw);
    matches.push_back({&c, own_way[c.query.index], their_way[c.match.index], T_own_query.translation(),
                       T_their_match.translation(),
                       T_own_query * T_match_query.inverse() * T_their_match.inverse(),
                       weight_of(c, likeness)});
  }
  std::ranges::sort(matches, {},
                    [](const Match& m) { return std::tuple(m.candidate->query, m.candidate->match); });
  return matches;
}

bool agree(const Match& anchor, const Match& other) {
  const double metres = (other.own_position - anchor.own_position).norm();
  const Vector3 there = anchor.T_own_theirs * other.their_position;
  return (there - other.own_position).norm() <= kOff + kOffPerMetre * metres &&
         anchor.T_own_theirs.rotation().angularDistance(other.T_own_theirs.rotation()) <= kTurned;
}

std::span<const Match> within_reach(const std::vector<Match>& matches, const Match& anchor) {
  const auto first = std::ranges::lower_bound(matches, anchor.own_way - kReach, {}, &Match::own_way);
  const auto last = std::ranges::upper_bound(matches, anchor.own_way + kReach, {}, &Match::own_way);
  return {first, last};
}

std::size_t bin_of(double way) { return static_cast<std::size_t>(way / kBin); }

double support_of(const std::vector<Match>& matches, const Match& anchor, std::size_t num_bins) {
  std::vector<double> own_bins(num_bins, 0.0);  // the largest weight in each
  std::vector<double> their_bins(num_bins, 0.0);
  for (const Match& other : within_reach(matches, anchor)) {
    if (!agree(anchor, other)) continue;
    for (double* bin : {&own_bins[bin_of(other.own_way)], &their_bins[bin_of(other.their_way)]})
      *bin = std::max(*bin, other.weight);
  }
  const auto sum = [](const std::vector<double>& bins) {
    return std::accumulate(bins.begin(), bins.end(), 0.0);
  };
  return kBin * std::min(sum(own_bins), sum(their_bins));
}

}  // namespace

std::vector<Segment> agreeing_segments(const OdometryChain& own, const OdometryChain& theirs,
                                       const std::vector<LoopCandidate>& found, std::size_t num,
                                       const std::vector<double>& likeness) {
  const std::vector<Match> matches = along_the_way(own, theirs, found, likeness);
  std::size_t num_bins = 0;
  for (const Match& match : matches)
    num_bins = std::max({num_bins, bin_of(match.own_way) + 1, bin_of(match.their_way) + 1});
  std::vector<double> support(matches.size());
  parallel_for_each(
      matches.size(), [&](std::size_t i) { support[i] = support_of(matches, matches[i], num_bins); }, 16);
  std::vector<std::size_t> order(matches.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return support[i]; });

  std::vector<Segment> segments;
  std::vector<bool> taken(matches.size(), false);
  for (const std::size_t i : order) {
    if (segments.size() == num) break;
    if (taken[i]) continue;
    std::map<std::size_t, const LoopCandidate*> best;
    for (const Match& other : within_reach(matches, matches[i])) {
      if (!agree(matches[i], other)) continue;
      const auto at = static_cast<std::size_t>(&other - matches.data());
      if (taken[at]) continue;
      taken[at] = true;
      const LoopCandidate*& in_bin = best[bin_of(other.own_way)];
      if (in_bin == nullptr || other.candidate->distance < in_bin->distance) in_bin = other.candidate;
    }
    Segment segment{support[i], {}};
    for (const auto& [bin, candidate] : best) segment.candidates.push_back(*candidate);
    std::ranges::stable_sort(segment.candidates, {}, &LoopCandidate::distance);
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace adit
