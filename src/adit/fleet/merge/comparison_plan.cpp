// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/comparison_plan.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "adit/fleet/search/path.hpp"

namespace adit {
namespace {

/// Places far apart first: the middle, the quarters, and so on.
std::vector<PlannedComparison> coarse_to_fine(const std::vector<PlannedComparison>& plan) {
  std::vector<PlannedComparison> out;
  std::vector<bool> taken(plan.size(), false);
  for (std::size_t parts = 2; out.size() < plan.size(); parts *= 2) {
    for (std::size_t part = 1; part < 2 * parts; part += 2) {
      const std::size_t i = part * plan.size() / (2 * parts);
      if (!taken[i]) out.push_back(plan[i]);
      taken[i] = true;
    }
    if (parts <= 2 * plan.size()) continue;
    for (std::size_t i = 0; i < plan.size(); ++i)
      if (!taken[i]) out.push_back(plan[i]);
  }
  return out;
}

std::vector<std::uint32_t> keyframes_of(const std::vector<PlannedComparison>& places,
                                        std::uint32_t PlannedComparison::*whose) {
  std::vector<std::uint32_t> keyframes;
  for (const PlannedComparison& place : places) keyframes.push_back(place.*whose);
  return keyframes;
}

}  // namespace

std::vector<std::uint32_t> own_keyframes(const std::vector<PlannedComparison>& places) {
  return keyframes_of(places, &PlannedComparison::own);
}

std::vector<std::uint32_t> their_keyframes(const std::vector<PlannedComparison>& places) {
  return keyframes_of(places, &PlannedComparison::theirs);
}

ComparisonPlanner::ComparisonPlanner(const OdometryChain& own, const OdometryChain& theirs,
                                     const std::vector<PcmLoop>& loops, const ComparisonSpacing& spacing)
    : own_(own),
      theirs_(theirs),
      own_path_m_(own.path_m()),
      their_path_m_(theirs.path_m()),
      loops_(loops),
      spacing_(spacing) {}

std::vector<PlannedComparison> ComparisonPlanner::plan(std::size_t max_places) const {
  std::vector<PlannedComparison> plan;
  double last_m = -spacing_.spacing_m;
  for (std::uint32_t j = 0; j < theirs_.size(); ++j) {
    if (their_path_m_[j] - last_m < spacing_.spacing_m) continue;
    const std::optional<PlannedComparison> place = at(j);
    if (!place) continue;
    plan.push_back(*place);
    last_m = their_path_m_[j];
  }
  plan = coarse_to_fine(plan);
  plan.resize(std::min(plan.size(), max_places));
  return plan;
}

std::optional<PlannedComparison> ComparisonPlanner::second_look(const PlannedComparison& first) const {
  for (const double metres : {spacing_.second_look_m, -spacing_.second_look_m})
    if (const auto j = keyframe_at(their_path_m_, their_path_m_[first.theirs] + metres))
      // The pair itself, where keyframes are farther apart, would confirm whatever it showed.
      if (const auto other = *j == first.theirs ? std::nullopt : at(*j)) return other;
  return {};
}

std::vector<PlannedComparison> ComparisonPlanner::between(const std::vector<PlannedComparison>& plan,
                                                          std::size_t max_pairs) const {
  constexpr double kRounding = 1e-6;  // metres
  std::set<std::uint32_t> own;
  std::set<std::uint32_t> theirs;
  for (const PlannedComparison& place : plan) {
    own.insert(place.own);
    theirs.insert(place.theirs);
  }
  std::vector<PlannedComparison> out;
  for (const PlannedComparison& place : plan) {
    for (double metres = spacing_.wall_spacing_m; metres < spacing_.spacing_m - kRounding;
         metres += spacing_.wall_spacing_m) {
      if (out.size() == max_pairs) return out;
      const auto j = keyframe_at(their_path_m_, their_path_m_[place.theirs] + metres);
      const auto pair = j ? at(*j) : std::nullopt;
      if (pair && !own.contains(pair->own) && !theirs.contains(pair->theirs)) {
        own.insert(pair->own);
        theirs.insert(pair->theirs);
        out.push_back(*pair);
      }
    }
  }
  return out;
}

std::optional<PlannedComparison> ComparisonPlanner::at(std::uint32_t j) const {
  if (loops_.empty()) return {};
  const PcmLoop& loop = nearest_loop(loops_, their_path_m_, j);
  const double from_loop_m = std::abs(their_path_m_[loop.b] - their_path_m_[j]);
  if (from_loop_m > spacing_.reach_m) return {};
  const Pose T_loop_theirs = loop.T_a_b * theirs_.between(loop.b, j);
  const Vector3 position = own_.pose(loop.a) * T_loop_theirs.translation();
  const auto may_be = [&](std::uint32_t i) {
    if (std::abs(own_path_m_[i] - own_path_m_[loop.a]) > from_loop_m + 2.0 * kSideBySide) return false;
    return &own_ != &theirs_ || !(their_path_m_[j] - own_path_m_[i] < spacing_.revisit_m);
  };
  const std::optional<std::uint32_t> nearest = nearest_beside(own_, position, may_be);
  if (!nearest) return {};
  return PlannedComparison{*nearest, j, own_.between(*nearest, loop.a) * T_loop_theirs};
}

}  // namespace adit
