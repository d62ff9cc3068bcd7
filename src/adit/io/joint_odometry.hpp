// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Wheel odometry from the joints of wheels (sensor_msgs/JointState) and a description of the drive.
///
/// Differential and skid-steer drives: the mean of the left wheels and that of the right ones roll by d_l and
/// d_r metres; the axle moves by (d_l + d_r) / 2 along an arc and turns by (d_r - d_l) / track_width.
/// Ackermann steering: the axle moves by the mean of its wheels, with the curvature tan(steering) /
/// wheelbase, of two steering joints the harmonic mean of their tangents, which is exact where both point at
/// one centre. Sources: Siegwart, Nourbakhsh, Scaramuzza, Introduction to Autonomous Mobile Robots (2nd ed.),
/// section 3.2 (rolling constraints) and 5.2.4 (odometry).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit {

/// The odometry that joints give.
struct JointTrack {
  Trajectory poses;                   ///< T_odom_base, the first the identity.
  std::vector<std::string> warnings;  ///< A sentence each.
};

/// Angles are taken where the messages have them, and where they change; else angular velocities, between two
/// messages their mean. Angles that stay within one turn and leap by more than half a turn are counted modulo
/// one turn. Any other step that would need more than 30 m/s is a jump (a driver that was started again): for
/// a second after it the wheels say nothing, and they go on from there.
class JointOdometry {
 public:
  /// Fails where the description is not complete: the fields to set are named.
  static Result<JointOdometry> create(const JointDriveConfig& drive);

  /// Whether the message has all joints of the drive, with finite angles or velocities.
  [[nodiscard]] bool has_wheels(const ros::JointStateMessage& message);
  /// A message that has the wheels. Those whose stamps do not ascend with the others' are left out at the
  /// end (longest_ascending), with a warning.
  void add(const ros::JointStateMessage& message);
  /// Fails where no message had the wheels: the joints that there are are named.
  Result<JointTrack> finish() &&;

 private:
  /// A joint of the drive; a minus before its name turns it round.
  struct Joint {
    std::string name;
    double sign = 1.0;
  };
  explicit JointOdometry(JointDriveConfig drive);
  [[nodiscard]] std::optional<double> value_of(const ros::JointStateMessage& message, std::size_t joint,
                                               const std::vector<double>& values) const;
  [[nodiscard]] double angle(std::size_t sample, std::size_t joint) const;
  [[nodiscard]] double velocity(std::size_t sample, std::size_t joint) const;
  [[nodiscard]] bool has_moving_angles() const;
  [[nodiscard]] bool is_wrapped(std::size_t joint) const;
  [[nodiscard]] std::vector<double> rolled(std::size_t sample) const;
  [[nodiscard]] double curvature(std::size_t sample) const;
  [[nodiscard]] Pose step(std::size_t sample) const;
  std::optional<std::string> put_in_order();

  JointDriveConfig drive_;
  std::vector<Joint> joints_;  ///< Left wheels, right wheels, steering.
  std::size_t num_left_ = 0;
  std::size_t num_wheels_ = 0;
  std::vector<Stamp> stamps_;
  std::vector<double> angles_;      ///< Per sample and joint; NaN where a message has none.
  std::vector<double> velocities_;  ///< The same.
  std::vector<std::string> seen_;   ///< Joints of messages without the wheels.
  bool by_angles_ = true;
  std::vector<bool> wrapped_;
};

/// The joints that the first messages of a topic name, in alphabetical order; none where they are damaged.
[[nodiscard]] std::vector<std::string> first_joints(const Bag& bag, std::size_t topic);
/// "a, b, c", the first twenty of them.
[[nodiscard]] std::string joints_text(const std::vector<std::string>& joints);
/// The options that describe a drive, with the joints that seem to be its wheels.
[[nodiscard]] std::string drive_options(const std::vector<std::string>& joints);

}  // namespace adit
