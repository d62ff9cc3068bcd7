// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which topics of a bag are a robot's clouds, wheels, ground truth, IMU and mounts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// Indices into Bag::topics.
using TopicIndices = std::vector<std::size_t>;

/// The topics of one robot by what they hold. Topics in other encodings than CDR and that of ROS 1 are in
/// none.
struct BagTopics {
  TopicIndices points;      ///< PointCloud2, or CustomMsg of Livox.
  TopicIndices wheel;       ///< nav_msgs/Odometry; or another one of wheels, where it was asked for by name.
  TopicIndices truth;       ///< nav_msgs/Odometry that is called ground truth, or was asked for as such.
  TopicIndices imu;         ///< sensor_msgs/Imu
  TopicIndices transforms;  ///< Links that may move, /tf.
  TopicIndices static_transforms;  ///< /tf_static
  TopicIndices twists;             ///< TwistStamped that is not used: measured, or only commanded.
  TopicIndices joints;             ///< JointState that is not used.
};

/// Their names, apart by commas.
[[nodiscard]] std::string names_of(const Bag& bag, const TopicIndices& topics);

/// One topic of clouds, and at most one of each other kind but transforms, twists and joints, as
/// bag_recording.hpp says. Fails where several fit, with the options to type, the likeliest first, and where
/// there are no clouds or not the topic asked for.
[[nodiscard]] Result<BagTopics> choose_topics(const Bag& bag, const RecordingConfig& config);

/// Fails as `choose_topics` does where a topic that `config` names is not there, or is of another kind: what
/// was typed is wrong then, whatever else the bag lacks.
[[nodiscard]] Result<> check_named_topics(const Bag& bag, const RecordingConfig& config);

/// `config` with the likeliest topic wherever `choose_topics` would fail because several fit; of one
/// robot, where namespaces with clouds have wheels, too.
[[nodiscard]] RecordingConfig with_likeliest_topics(const Bag& bag, RecordingConfig config);

/// The namespaces that have clouds, "/husky1", in alphabetical order: the first part of the topics' names in
/// which they differ, with what is before it. None where a bag has no clouds, or they have no namespace.
[[nodiscard]] std::vector<std::string> namespaces_of(const Bag& bag);

}  // namespace adit
