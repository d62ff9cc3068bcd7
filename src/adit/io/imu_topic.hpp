// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The messages of an IMU (sensor_msgs/msg/Imu) of a bag.
#pragma once

#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

struct ImuTrack {
  std::vector<ImuSample> samples;  ///< Strictly ascending; empty where the IMU cannot be used.
  std::string frame;
  ImuCovariance covariance;          ///< As the first message states it.
  std::vector<std::string> remarks;  ///< What was left out and why, a sentence each with its remedy.
};

/// Reads the messages in the order given. Samples whose stamps do not ascend or whose numbers are not finite
/// are left out, as is an IMU that measures only rates or only accelerations; `remarks` says so. Fails when a
/// message is damaged.
Result<ImuTrack> read_imu(const Bag& bag, const std::vector<BagMessage>& messages);

}  // namespace adit
