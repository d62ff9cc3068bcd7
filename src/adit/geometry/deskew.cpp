// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/deskew.hpp"

#include <algorithm>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr std::size_t kIntervals = 64;

Eigen::Matrix<float, 3, 4> matrix34(const Pose& T) { return T.matrix().topRows<3>().cast<float>(); }

}  // namespace

Pose ConstantVelocity::pose_after(Duration offset) const {
  ADIT_CHECK(duration.count() > 0, "a velocity needs a positive duration");
  return Pose::exp(to_seconds(offset) / to_seconds(duration) * T_start_end.log());
}

SweepTransform::SweepTransform(const ConstantVelocity& motion, const Pose& T_body_sensor,
                               std::span<const std::int32_t> offsets_ns) {
  ADIT_CHECK(!offsets_ns.empty(), "a sweep has at least one point");
  const auto [first, last] = std::minmax_element(offsets_ns.begin(), offsets_ns.end());
  first_ns_ = *first;
  const std::int64_t span_ns = *last - first_ns_;
  if (span_ns > 0) knots_per_ns_ = static_cast<float>(kIntervals) / static_cast<float>(span_ns);
  knots_.resize(kIntervals + 1);
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    const auto offset =
        first_ns_ + span_ns * static_cast<std::int64_t>(i) / static_cast<std::int64_t>(kIntervals);
    knots_[i].value = matrix34(motion.pose_after(Duration(offset)) * T_body_sensor);
    if (i > 0) knots_[i - 1].slope = knots_[i].value - knots_[i - 1].value;
  }
  knots_.back().slope.setZero();
}

PointCloud deskewed(PointCloud cloud, const ConstantVelocity& motion) {
  cloud.check();
  if (!cloud.has_times()) return cloud;
  const SweepTransform sweep(motion, Pose(), cloud.time_offsets_ns);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.points[i] = sweep.apply(cloud.time_offsets_ns[i], cloud.points[i]);
  cloud.time_offsets_ns.clear();
  return cloud;
}

}  // namespace adit
