// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The messages of an IMU (sensor_msgs/msg/Imu) of a bag.
#pragma once

#include <string>
#include <vector>

#include "adit/core/left_out.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// What an IMU's topic holds.
struct ImuTrack {
  std::vector<ImuSample> samples;    ///< Strictly ascending; empty where the IMU cannot be used.
  ImuCovariance covariance;          ///< As the first message states it.
  std::vector<std::string> remarks;  ///< What was left out and why, a sentence each with its remedy.
};

/// Takes the messages in their order. Messages that are damaged, and samples whose stamps do not ascend with
/// the others' or whose numbers are not finite, are left out, as is an IMU that measures only rates or only
/// accelerations; `remarks` says so.
class ImuReader {
 public:
  /// `bag` must outlive it.
  explicit ImuReader(const Bag& bag) : bag_(bag) {}
  /// The next message of the topic.
  void add(const BagMessage& message);
  /// Once, after all messages.
  [[nodiscard]] ImuTrack finish();

 private:
  const Bag& bag_;
  ImuTrack track_;
  LeftOut left_out_{"samples"};
  bool is_first_ = true;
};

}  // namespace adit
