// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How the clouds of a bag are read: what the first one shows of the times of points, and what is said of it.
#pragma once

#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/point_times.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit {

/// A PointCloud2 or CustomMsg.
[[nodiscard]] Result<ros::CloudMessage> read_cloud_message(const Bag& bag, const BagMessage& message,
                                                           const KnownTimes& known);

/// The first cloud that has points: what it shows of fields, times and frames holds for all. Fails where none
/// can be read, and where the field that is stated for times is not there.
[[nodiscard]] Result<ros::CloudMessage> first_cloud(const Bag& bag, const TopicIndices& topics,
                                                    const KnownTimes& known);

/// What is known before the first cloud, as stated: adit's own times are nanoseconds from the stamp.
[[nodiscard]] Result<KnownTimes> stated_times(const Bag& bag, const RecordingConfig& config);

/// Whether the stamp is of the end of a sweep whose times count from its start: what `config.stamp_at` says
/// or, without a word, what `scans` show. At least one.
[[nodiscard]] bool stamp_at_end(const Bag& bag, const std::vector<BagMessage>& scans, const KnownTimes& known,
                                const RecordingConfig& config);

/// Says what is assumed of the times of points; of adit's own files only what the user stated.
void note_point_times(Recording& recording, const Bag& bag, const ros::CloudMessage& first, bool at_end,
                      const RecordingConfig& config);

}  // namespace adit
