// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/smooth_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

// Control points per second. More of them would turn the millimetre between neighbouring poses of a drive,
// which are not smooth, into accelerations; fewer would cut curves short.
constexpr double kSegmentsPerSecond = 25.0;

// Weights of the last three control points' steps, and their derivatives by u (Sommer et al., equation 19 for
// k = 4).
struct Weights {
  explicit Weights(double u)
      : value{(5.0 + 3.0 * u - 3.0 * u * u + u * u * u) / 6.0,
              (1.0 + 3.0 * u + 3.0 * u * u - 2.0 * u * u * u) / 6.0, u * u * u / 6.0},
        first{0.5 * (1.0 - 2.0 * u + u * u), 0.5 * (1.0 + 2.0 * u - 2.0 * u * u), 0.5 * u * u},
        second{u - 1.0, 1.0 - 2.0 * u, u} {}
  std::array<double, 3> value;
  std::array<double, 3> first;
  std::array<double, 3> second;
};

Vector3 step(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  return so3::log(from.conjugate() * to);
}

// A spline smooths its control points by (1, 4, 1) / 6; that moves it by a sixth of their second difference,
// which is therefore taken off in advance.
template <class Value, class SecondDifference, class Moved>
std::vector<Value> sharpened(const std::vector<Value>& values, const SecondDifference& second_difference,
                             const Moved& moved) {
  std::vector<Value> out = values;
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    out[i] = moved(values[i], -second_difference(values[i - 1], values[i], values[i + 1]) / 6.0);
  return out;
}

}  // namespace

SmoothMotion::SmoothMotion(const Trajectory& trajectory, const Pose& T_body_sensor)
    : begin_(trajectory.empty() ? Stamp{} : trajectory.front().stamp) {
  ADIT_CHECK(trajectory.size() > 1, "a motion has two poses or more");
  const Duration duration = trajectory.back().stamp - begin_;
  const double segments = std::max(1.0, std::ceil(to_seconds(duration) * kSegmentsPerSecond));
  seconds_per_segment_ = to_seconds(duration) / segments;
  for (double k = 0.0; k <= segments; ++k) {
    const Stamp stamp = std::min(begin_ + from_seconds(k * seconds_per_segment_), trajectory.back().stamp);
    const Pose T_world_sensor = *pose_at(trajectory, stamp) * T_body_sensor;
    positions_.push_back(T_world_sensor.translation());
    rotations_.push_back(T_world_sensor.rotation());
  }
  positions_ = sharpened(
      positions_,
      [](const Vector3& a, const Vector3& b, const Vector3& c) { return Vector3(a - 2.0 * b + c); },
      [](const Vector3& p, const Vector3& by) { return Vector3(p + by); });
  using Rotation = Eigen::Quaterniond;
  rotations_ = sharpened(
      rotations_,
      [](const Rotation& a, const Rotation& b, const Rotation& c) {
        return Vector3(step(b, a) + step(b, c));
      },
      [](const Rotation& q, const Vector3& by) { return Rotation(q * so3::exp(by)); });
  // Straight on beyond both ends.
  const std::size_t n = positions_.size();
  const Vector3 before = 2.0 * positions_[0] - positions_[1];
  const Rotation turned_before = rotations_[0] * so3::exp(step(rotations_[1], rotations_[0]));
  positions_.push_back(2.0 * positions_[n - 1] - positions_[n - 2]);
  rotations_.push_back(rotations_[n - 1] * so3::exp(step(rotations_[n - 2], rotations_[n - 1])));
  positions_.insert(positions_.begin(), before);
  rotations_.insert(rotations_.begin(), turned_before);
}

Kinematics SmoothMotion::at(Stamp stamp) const {
  const double last = static_cast<double>(positions_.size()) - 3.0;  // segments
  const double place = std::clamp(to_seconds(stamp - begin_) / seconds_per_segment_, 0.0, last);
  const auto segment = static_cast<std::size_t>(std::min(std::floor(place), last - 1.0));
  const Weights weights(place - static_cast<double>(segment));
  const double rate = 1.0 / seconds_per_segment_;
  Vector3 position = positions_[segment];
  Eigen::Quaterniond rotation = rotations_[segment];
  Kinematics out{Pose(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (std::size_t j = 0; j < 3; ++j) {
    const Vector3 moved = positions_[segment + j + 1] - positions_[segment + j];
    position += weights.value[j] * moved;
    out.velocity += rate * weights.first[j] * moved;
    out.acceleration += rate * rate * weights.second[j] * moved;
    const Vector3 turned = step(rotations_[segment + j], rotations_[segment + j + 1]);
    const Eigen::Quaterniond part = so3::exp(weights.value[j] * turned);
    rotation = rotation * part;
    out.angular_velocity = part.conjugate() * out.angular_velocity + rate * weights.first[j] * turned;
  }
  out.T_world_body = Pose(rotation.normalized(), position);
  return out;
}

}  // namespace adit
