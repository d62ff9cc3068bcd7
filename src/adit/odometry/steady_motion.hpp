// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"
#include "adit/geometry/deskew.hpp"

namespace adit {

/// So long a velocity is kept where nothing else is known, or for as long as it was measured.
inline constexpr Duration kVelocityHorizon = std::chrono::seconds(2);

/// Where a robot is, and how it moved between its last two scans: what predicts the next where no sensor
/// does.
class SteadyMotion {
 public:
  /// Throws ContractViolation where the stamp is not after the last one.
  void arrive(Stamp stamp, const Pose& T_odom_base);
  /// Whether a scan has arrived.
  [[nodiscard]] bool has_begun() const { return stamp_.has_value(); }
  /// At the last scan; identity before.
  [[nodiscard]] const Pose& T_odom_base() const { return T_odom_base_; }
  /// Between the last two scans; none before.
  [[nodiscard]] const std::optional<ConstantVelocity>& last() const { return last_; }
  /// T_last_now at `stamp` with the velocity so far, kept for kVelocityHorizon; identity before two scans.
  /// Throws ContractViolation where the stamp is not after the last one.
  [[nodiscard]] Pose until(Stamp stamp) const;

 private:
  Pose T_odom_base_;
  std::optional<Stamp> stamp_;
  std::optional<ConstantVelocity> last_;
};

}  // namespace adit
