// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

namespace adit {

/// Judges whether wheels are to be believed, by the metres that they count and those that were driven, over
/// the last scans. Wheels spin, lock and stand while the robot is carried; then they are not used until both
/// agree again.
class WheelTrust {
 public:
  /// Of the interval before a scan; `driven_m` as the odometry has it in the end, with its standard
  /// deviation: where neither scans nor wheels hold it, wheels are not to be judged by it.
  void compare(double counted_m, double driven_m, double sigma_m);
  /// Whether wheels are not to be believed at present.
  [[nodiscard]] bool are_slipping() const { return are_slipping_; }

 private:
  double counted_m_ = 0.0;  ///< Over the last scans, the latest ones weighing most.
  double driven_m_ = 0.0;
  double sigma_m_ = 0.0;  ///< Of `driven_m_`; errors of a velocity last.
  bool are_slipping_ = false;
};

}  // namespace adit
