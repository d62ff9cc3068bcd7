// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/records.hpp"

namespace adit {

/// A method of odometry: follows one robot, scan by scan. Whoever implements this can be given to
/// `RobotSlam`; those that adit brings are in methods.hpp.
class Odometry {
 public:
  virtual ~Odometry() = default;

  /// `motion` is that since the scan before; of the first scan's, only how the IMU stands to gravity counts.
  /// Throws ContractViolation where the stamp is not after that of the scan before.
  virtual OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) = 0;
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] virtual const PointCloud& cloud_of_last_scan() const = 0;

 protected:
  /// For methods alone: a copy of the base would be without its method.
  ///@{
  Odometry() = default;
  Odometry(const Odometry&) = default;
  Odometry& operator=(const Odometry&) = default;
  Odometry(Odometry&&) = default;
  Odometry& operator=(Odometry&&) = default;
  ///@}
};

}  // namespace adit
