// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/stated_pose.hpp"

#include <cmath>

#include "adit/core/format.hpp"
#include "adit/io/far_out.hpp"

namespace adit {

Result<Pose> stated_pose(const Vector3& position, const Eigen::Quaterniond& rotation, double norm_error) {
  constexpr double kOfPose = 1e-4;  // Pose itself sees to less
  const double off = std::abs(rotation.norm() - 1.0);
  if (!(off <= norm_error))
    return fail(
        format("the quaternion has norm {:.4g}, not 1; check the order of its numbers", rotation.norm()));
  if (const Result<> checked = check_not_far_out(position); !checked) return tl::unexpected(checked.error());
  return Pose(off > kOfPose ? rotation.normalized() : rotation, position);
}

}  // namespace adit
