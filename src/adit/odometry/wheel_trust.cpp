// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/wheel_trust.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double kKept = 0.8;         // of the sums from scan to scan: five scans
constexpr double kBurst = 0.15;       // share of the distance; on firm ground wheels slip by a few per cent
constexpr double kLeastBurst = 0.04;  // metres: what registration may be off by
constexpr double kOver = 0.5;         // of that, below which a burst is over
constexpr double kSigmas = 2.0;

}  // namespace

void WheelTrust::compare(double counted_m, double driven_m, double sigma_m) {
  counted_m_ = kKept * counted_m_ + counted_m;
  driven_m_ = kKept * driven_m_ + driven_m;
  sigma_m_ = kKept * sigma_m_ + sigma_m;
  const double bound = kBurst * std::max(std::abs(counted_m_), std::abs(driven_m_)) + kLeastBurst;
  const double off = std::abs(counted_m_ - driven_m_);
  are_slipping_ = off > (are_slipping_ ? kOver * bound : bound) + kSigmas * sigma_m_;
}

}  // namespace adit
