// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// At which places two maps are compared that loops lay over one another.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adit/posegraph/pcm.hpp"

namespace adit {

/// Two keyframes that stand next to one another if the loops are true.
struct PlannedCheck {
  std::uint32_t own = 0;
  std::uint32_t theirs = 0;
  Pose T_own_theirs;
};

class CheckPlanner {
 public:
  /// Loops that agree with one another; places up to `reach_m` along the way from the nearest of them. With
  /// the same chain given twice: revisits, the earlier keyframe of the two as `own`. All must outlive it.
  CheckPlanner(const OdometryChain& own, const OdometryChain& theirs, const std::vector<PcmLoop>& loops,
               double reach_m);

  /// Along the whole stretch that both drove, every `spacing_m`, at most `max_checks`; places far apart
  /// first, those between them later.
  [[nodiscard]] std::vector<PlannedCheck> plan(double spacing_m, std::size_t max_checks) const;
  /// The same place by two other keyframes, a metre on.
  [[nodiscard]] std::optional<PlannedCheck> again(const PlannedCheck& check) const;

 private:
  /// Their keyframe j beside the own one that is nearest.
  [[nodiscard]] std::optional<PlannedCheck> at(std::uint32_t j) const;

  const OdometryChain& own_;
  const OdometryChain& theirs_;
  std::vector<double> own_way_;
  std::vector<double> their_way_;
  const std::vector<PcmLoop>& loops_;
  double reach_m_;
};

}  // namespace adit
