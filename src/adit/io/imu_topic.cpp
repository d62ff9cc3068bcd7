// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/imu_topic.hpp"

#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

/// Samples left out for one reason.
struct LeftOut {
  std::size_t count = 0;
  Stamp first;

  void add(Stamp stamp) {
    if (count++ == 0) first = stamp;
  }
};

/// What the covariances of the first message say is missing; "" when nothing is.
std::string_view missing_in(const ImuCovariance& covariance) {
  if (ros::is_unmeasured(covariance.angular_velocity)) return "angular velocity";
  if (ros::is_unmeasured(covariance.specific_force)) return "acceleration";
  return "";
}

}  // namespace

Result<ImuTrack> read_imu(const Bag& bag, const std::vector<BagMessage>& messages) {
  ImuTrack track;
  LeftOut backward;
  LeftOut not_finite;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const Result<ros::ImuMessage> imu = decoded(bag, messages[i], ros::decode_imu);
    if (!imu) return fail(format("IMU, message {}", i), imu.error());
    if (i == 0) {
      track.frame = imu->frame;
      track.covariance = imu->covariance;
    }
    const ImuSample& sample = imu->sample;
    if (!sample.angular_velocity.allFinite() || !sample.specific_force.allFinite()) {
      not_finite.add(sample.stamp);
    } else if (!track.samples.empty() && sample.stamp <= track.samples.back().stamp) {
      backward.add(sample.stamp);
    } else {
      track.samples.push_back(sample);
    }
  }
  const auto report = [&](const LeftOut& left_out, std::string_view what) {
    if (left_out.count == 0) return;
    track.remarks.push_back(format("imu: {} of {} samples are left out, {}; the first is at {} s",
                                   left_out.count, messages.size(), what, stamp_text(left_out.first)));
  };
  report(backward, "whose stamps are not after those before (check the driver's clock)");
  report(not_finite, "whose numbers are not finite (check the driver)");
  if (const std::string_view missing = missing_in(track.covariance); !missing.empty()) {
    track.samples.clear();
    track.remarks = {format(
        "imu: it is left out, as its messages say that {} was not measured (covariance -1); if it was, make "
        "the driver state a covariance",
        missing)};
  }
  return track;
}

}  // namespace adit
