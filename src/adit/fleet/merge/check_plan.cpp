// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/check_plan.hpp"

#include <algorithm>
#include <cmath>

#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/search/revisits.hpp"

namespace adit {
namespace {

constexpr double kSide = 3.0;  // metres between two keyframes that are compared

// Places far apart first: the middle, the quarters, and so on.
std::vector<PlannedCheck> coarse_to_fine(const std::vector<PlannedCheck>& plan) {
  std::vector<PlannedCheck> out;
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

}  // namespace

CheckPlanner::CheckPlanner(const OdometryChain& own, const OdometryChain& theirs,
                           const std::vector<PcmLoop>& loops, double reach_m)
    : own_(own),
      theirs_(theirs),
      own_way_(way_along(own)),
      their_way_(way_along(theirs)),
      loops_(loops),
      reach_m_(reach_m) {}

std::vector<PlannedCheck> CheckPlanner::plan(double spacing_m, std::size_t max_checks) const {
  std::vector<PlannedCheck> plan;
  double last = -spacing_m;
  for (std::uint32_t j = 0; j < theirs_.size(); ++j) {
    if (their_way_[j] - last < spacing_m) continue;
    const std::optional<PlannedCheck> check = at(j);
    if (!check) continue;
    plan.push_back(*check);
    last = their_way_[j];
  }
  plan = coarse_to_fine(plan);
  plan.resize(std::min(plan.size(), max_checks));
  return plan;
}

std::optional<PlannedCheck> CheckPlanner::again(const PlannedCheck& check) const {
  for (const double metres : {kSecondLook, -kSecondLook})
    if (const auto j = keyframe_at(their_way_, their_way_[check.theirs] + metres))
      if (const std::optional<PlannedCheck> other = at(*j)) return other;
  return {};
}

std::optional<PlannedCheck> CheckPlanner::at(std::uint32_t j) const {
  if (loops_.empty()) return {};
  const auto& loop = *std::ranges::min_element(
      loops_, {}, [&](const PcmLoop& l) { return std::abs(their_way_[l.b] - their_way_[j]); });
  const double from_loop = std::abs(their_way_[loop.b] - their_way_[j]);
  if (from_loop > reach_m_) return {};
  const Pose T_loop_theirs = loop.T_a_b * theirs_.between(loop.b, j);
  const Vector3 at = own_.pose(loop.a) * T_loop_theirs.translation();
  std::optional<std::uint32_t> nearest;
  double best = kSide;
  for (std::uint32_t i = 0; i < own_.size(); ++i) {
    if (std::abs(own_way_[i] - own_way_[loop.a]) > from_loop + 2.0 * kSide) continue;
    if (&own_ == &theirs_ && their_way_[j] - own_way_[i] < kRevisitWay) continue;
    const double distance = (own_.pose(i).translation() - at).norm();
    if (distance < best) {
      best = distance;
      nearest = i;
    }
  }
  if (!nearest) return {};
  return PlannedCheck{*nearest, j, own_.between(*nearest, loop.a) * T_loop_theirs};
}

}  // namespace adit
