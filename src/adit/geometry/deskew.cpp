// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/deskew.hpp"

#include <algorithm>
#include <array>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

// Turn between two knots: the matrix halfway is then off by kStep^2 / 8 = 3e-6.
constexpr double kStep = 0.0048;
constexpr double kMaxIntervals = 4096.0;  // against senseless velocities

// Points that are moved together.
constexpr std::size_t kBlock = 512;

SweepTransform::Matrix34 matrix34(const Pose& T) { return T.matrix().topRows<3>().cast<float>(); }

ADIT_WIDE_VECTORS std::pair<std::int32_t, std::int32_t> bounds_of(const std::int32_t* values, std::size_t n) {
  std::int32_t low = values[0];
  std::int32_t high = values[0];
  for (std::size_t i = 1; i < n; ++i) {
    low = std::min(low, values[i]);
    high = std::max(high, values[i]);
  }
  return {low, high};
}

// Where each offset lies: position of the knot before it, and how far it is on the way to the next.
ADIT_WIDE_VECTORS void locate(const std::int32_t* offsets_ns, std::size_t n, std::int32_t first_ns,
                              float knots_per_step, std::int32_t* knot, float* fraction) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto steps =
        (static_cast<std::uint32_t>(offsets_ns[i]) - static_cast<std::uint32_t>(first_ns)) >> 1U;
    const float s = static_cast<float>(static_cast<std::int32_t>(steps)) * knots_per_step;
    knot[i] = static_cast<std::int32_t>(s);
    fraction[i] = s - static_cast<float>(knot[i]);
  }
}

// out = (value + fraction * slope) * in, for runs of points between the same two knots.
ADIT_WIDE_VECTORS void move_block(const SweepTransform::Knot* knots, const std::int32_t* knot,
                                  const float* fraction, std::size_t n, const float* __restrict in,
                                  float* __restrict out) {
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = begin + 1;
    while (end < n && knot[end] == knot[begin]) ++end;
    const SweepTransform::Matrix34 A = knots[knot[begin]].value;
    const SweepTransform::Matrix34 B = knots[knot[begin]].slope;
    for (std::size_t i = begin; i < end; ++i) {
      const float s = fraction[i];
      const float x = in[3 * i];
      const float y = in[3 * i + 1];
      const float z = in[3 * i + 2];
      for (Eigen::Index k = 0; k < 3; ++k)
        out[3 * i + static_cast<std::size_t>(k)] = (A(k, 0) + s * B(k, 0)) * x + (A(k, 1) + s * B(k, 1)) * y +
                                                   (A(k, 2) + s * B(k, 2)) * z + (A(k, 3) + s * B(k, 3));
    }
    begin = end;
  }
}

ADIT_WIDE_VECTORS void move_all(const SweepTransform::Matrix34& T, std::size_t n, const float* __restrict in,
                                float* __restrict out) {
  // A copy that `out` cannot overlap stays in registers.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const SweepTransform::Matrix34 A = T;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = in[3 * i];
    const float y = in[3 * i + 1];
    const float z = in[3 * i + 2];
    for (Eigen::Index k = 0; k < 3; ++k)
      out[3 * i + static_cast<std::size_t>(k)] = A(k, 0) * x + A(k, 1) * y + A(k, 2) * z + A(k, 3);
  }
}

}  // namespace

Pose ConstantVelocity::pose_after(Duration offset) const {
  ADIT_CHECK(duration.count() > 0, "a velocity needs a positive duration");
  return Pose::exp(to_seconds(offset) / to_seconds(duration) * T_start_end.log());
}

SweepMotion sweep_of(const ConstantVelocity& motion) {
  const double seconds = to_seconds(motion.duration);
  const double turn_rate = seconds > 0.0 ? motion.T_start_end.angle() / seconds : 0.0;
  return {[motion](Duration offset) { return motion.pose_after(offset); }, turn_rate / kStep};
}

SweepTransform::SweepTransform(const SweepMotion& motion, const Pose& T_body_sensor,
                               std::span<const std::int32_t> offsets_ns) {
  ADIT_CHECK(!offsets_ns.empty(), "a sweep has at least one point");
  const auto [first, last] = bounds_of(offsets_ns.data(), offsets_ns.size());
  first_ns_ = first;
  const std::int64_t span_ns = std::int64_t{last} - first;
  const double knots = motion.knots_per_second * to_seconds(Duration(span_ns));
  const auto intervals = static_cast<std::int64_t>(std::clamp(std::ceil(knots), 1.0, kMaxIntervals));
  if (span_ns > 0) knots_per_step_ = 2.0F * static_cast<float>(intervals) / static_cast<float>(span_ns);
  knots_.resize(static_cast<std::size_t>(intervals) + 1);
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const auto offset = first + span_ns * static_cast<std::int64_t>(i) / intervals;
    knots_[i].value = matrix34(motion.pose_after(Duration(offset)) * T_body_sensor);
    if (i > 0) knots_[i - 1].slope = knots_[i].value - knots_[i - 1].value;
  }
  knots_.back().slope.setZero();
}

void SweepTransform::apply(std::span<const std::int32_t> offsets_ns,
                           std::span<const Eigen::Vector3f> p_sensor,
                           std::span<Eigen::Vector3f> p_body) const {
  std::array<std::int32_t, kBlock> knot;
  std::array<float, kBlock> fraction;
  for (std::size_t begin = 0; begin < offsets_ns.size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, offsets_ns.size() - begin);
    locate(&offsets_ns[begin], n, first_ns_, knots_per_step_, knot.data(), fraction.data());
    move_block(knots_.data(), knot.data(), fraction.data(), n, p_sensor[begin].data(), p_body[begin].data());
  }
}

void transform_points(const SweepTransform::Matrix34& T_a_b, std::span<const Eigen::Vector3f> p_b,
                      std::span<Eigen::Vector3f> p_a) {
  if (!p_b.empty()) move_all(T_a_b, p_b.size(), p_b.data()->data(), p_a.data()->data());
}

PointCloud deskewed(PointCloud cloud, const ConstantVelocity& motion) {
  cloud.check();
  if (!cloud.has_times()) return cloud;
  const SweepTransform sweep(sweep_of(motion), Pose(), cloud.time_offsets_ns);
  std::vector<Eigen::Vector3f> points(cloud.size());
  sweep.apply(cloud.time_offsets_ns, cloud.points, points);
  cloud.points = std::move(points);
  cloud.time_offsets_ns.clear();
  return cloud;
}

}  // namespace adit
