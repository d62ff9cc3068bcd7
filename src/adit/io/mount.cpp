// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mount.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/io/far_out.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

/// R = Rz(yaw) Ry(pitch) Rx(roll), degrees.
Eigen::Quaterniond rotation_of(double roll, double pitch, double yaw) {
  const auto about = [](double degrees, const Vector3& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis));
  };
  return about(yaw, Vector3::UnitZ()) * about(pitch, Vector3::UnitY()) * about(roll, Vector3::UnitX());
}

/// Roll, pitch and yaw in degrees; straight up or down all of the turn is in the yaw.
Vector3 angles_of(const Matrix3& R) {
  const double cos_pitch = std::hypot(R(2, 1), R(2, 2));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  const bool is_upright = cos_pitch < 1e-9;
  const double roll = is_upright ? 0.0 : std::atan2(R(2, 1), R(2, 2));
  const double yaw = is_upright ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  return Vector3(roll, pitch, yaw) / kDegree;
}

}  // namespace

Result<Pose> parse_mount(std::string_view text) {
  std::string blanks(text);
  std::ranges::replace(blanks, ',', ' ');
  std::vector<double> numbers;
  for (const std::string_view word : split_words(blanks)) {
    const std::optional<double> number = parse_double(word);
    if (!number || !std::isfinite(*number))
      return fail(format("mount '{}': '{}' is not a finite number", text, word));
    numbers.push_back(*number);
  }
  if (numbers.size() != 3 && numbers.size() != 6) {
    return fail(
        format("mount '{}': {} numbers; 'x,y,z' or 'x,y,z,roll,pitch,yaw' in metres and degrees are needed",
               text, numbers.size()));
  }
  const Vector3 position(numbers[0], numbers[1], numbers[2]);
  if (const Result<> checked = check_not_far_out(position); !checked)
    return fail(format("mount '{}'", text), checked.error());
  if (numbers.size() == 3) return Pose::translation_of(numbers[0], numbers[1], numbers[2]);
  return Pose(rotation_of(numbers[3], numbers[4], numbers[5]), position);
}

std::string mount_text(const Pose& T_base_lidar) {
  const Vector3& t = T_base_lidar.translation();
  const std::string place = format("{} {} {}", t.x(), t.y(), t.z());
  if (T_base_lidar.rotation().coeffs() == Eigen::Quaterniond::Identity().coeffs()) return place;
  const Vector3 angles = angles_of(T_base_lidar.rotation_matrix());
  return place + format(" {} {} {}", angles.x(), angles.y(), angles.z());
}

namespace {

Result<std::optional<Pose>> optional_mount(const std::string& text) {
  if (text.empty()) return std::optional<Pose>();
  return parse_mount(text).map([](const Pose& T_base_sensor) { return std::optional(T_base_sensor); });
}

void erase_assumption(Recording& recording, std::string_view start) {
  std::erase_if(recording.assumptions,
                [&](const std::string& assumption) { return assumption.starts_with(start); });
}

}  // namespace

Result<std::optional<Pose>> mount_of(const RecordingConfig& config) { return optional_mount(config.mount); }
Result<std::optional<Pose>> imu_mount_of(const RecordingConfig& config) {
  return optional_mount(config.imu_mount);
}

void set_mount(Recording& recording, const Pose& T_base_lidar) {
  recording.T_base_lidar = T_base_lidar;
  recording.mount_source = kMountGiven;
  erase_assumption(recording, kMountAssumption);
}

void set_imu_mount(Recording& recording, const Pose& T_base_imu) {
  recording.T_base_imu = T_base_imu;
  recording.imu_mount_source = kMountGiven;
  erase_assumption(recording, kImuMountAssumption);
}

}  // namespace adit
