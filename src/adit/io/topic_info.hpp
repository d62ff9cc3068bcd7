// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the topics of a bag hold, as `adit info` lists it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/time.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// From one stamp to another, whose difference in nanoseconds may not fit 64 bits.
[[nodiscard]] double seconds_between(Stamp earlier, Stamp later);

/// How often something comes.
struct Rhythm {
  /// How many a second from the first to the last, as `ros2 topic hz` has it, to four digits; none where
  /// there is one alone, or all have one time.
  std::optional<double> rate_hz;
  double longest_gap_s = 0.0;  ///< Between one and the next.
};
/// Of stamps in order.
[[nodiscard]] Rhythm rhythm_of(const std::vector<Stamp>& stamps);

/// One topic.
struct TopicInfo {
  std::size_t num_messages = 0;     ///< Of it in the bag.
  Rhythm rhythm;                    ///< By the times of recording.
  std::string used_as;              ///< "points", "wheel", "truth", "imu" or "mounts"; "": not used.
  std::vector<std::string> joints;  ///< Of JointState: their names in the first message.
  /// The rest is of clouds, odometry and IMUs, by their headers; `frame` "" where these cannot be read.
  ///@{
  std::string frame;
  std::optional<double> rate_by_stamps_hz;  ///< As `rhythm`, by the stamps of the first and the last message.
  /// How long after its stamp a message was recorded: the first, and the last.
  std::pair<double, double> recorded_after_stamp_s;
  std::string fields;            ///< Of PointCloud2, and how many points.
  std::string point_times_from;  ///< Of clouds: "timestamp, float64 s, absolute", as in the first; "": none.
  /// How the clock of the stamps went against that of the recorder, one sentence with the remedy; "" where
  /// they agree to half a second.
  std::string clock_finding;
  ///@}
};

/// Of each of Bag::topics. Some ten messages of a topic are looked into.
[[nodiscard]] std::vector<TopicInfo> topics_of(const Bag& bag, const RecordingConfig& config);

}  // namespace adit
