// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The messages of wheel odometry (nav_msgs/Odometry, geometry_msgs/TwistStamped, sensor_msgs/JointState) of
/// a bag, and of ground truth (nav_msgs/Odometry).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// The poses that a topic gives.
struct PoseTrack {
  Trajectory poses;                        ///< T_odom_body, stamps strictly ascending.
  WheelCovariance covariance = {};         ///< Zero where the type of message states none.
  std::vector<std::string> warnings = {};  ///< What was left out or bridged, a sentence each.
};

/// Takes the messages of one topic one by one. Messages that are damaged, and those whose stamps do not
/// ascend with the others' (longest_ascending), are left out, which warnings count.
class PoseReader {
 public:
  virtual ~PoseReader() = default;
  /// The next message of the topic.
  virtual void add(const BagMessage& message) = 0;
  /// Once, after all messages. Fails where all of them are damaged.
  virtual Result<PoseTrack> finish() = 0;
};

/// The reader for a topic of `bag`, by its type. Twists are added up, between two of them their mean; joints
/// as joint_odometry.hpp says. Fails where joints have no complete description of the drive. `bag` must
/// outlive it.
Result<std::unique_ptr<PoseReader>> pose_reader(const Bag& bag, std::size_t topic,
                                                const JointDriveConfig& drive);

}  // namespace adit
