// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/imu_topic.hpp"

#include "adit/core/format.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

/// What the covariances of the first message say is missing; "" when nothing is.
std::string_view missing_in(const ImuCovariance& covariance) {
  if (ros::is_unmeasured(covariance.angular_velocity)) return "angular velocity";
  if (ros::is_unmeasured(covariance.specific_force)) return "acceleration";
  return "";
}

}  // namespace

void ImuReader::LeftOut::add(Stamp stamp) {
  if (count++ == 0) first = stamp;
}

Result<> ImuReader::add(const BagMessage& message) {
  const Result<ros::ImuMessage> imu = decoded(bag_, message, ros::decode_imu);
  if (!imu) return fail(format("IMU, message {}", num_messages_), imu.error());
  if (num_messages_++ == 0) {
    track_.covariance = imu->covariance;
  }
  const ImuSample& sample = imu->sample;
  if (!sample.angular_velocity.allFinite() || !sample.specific_force.allFinite()) {
    not_finite_.add(sample.stamp);
  } else if (!track_.samples.empty() && sample.stamp <= track_.samples.back().stamp) {
    backward_.add(sample.stamp);
  } else {
    track_.samples.push_back(sample);
  }
  return {};
}

void ImuReader::report(const LeftOut& left_out, std::string_view what) {
  if (left_out.count == 0) return;
  track_.remarks.push_back(format("imu: {} of {} samples are left out, {}; the first is at {} s",
                                  left_out.count, num_messages_, what, stamp_text(left_out.first)));
}

ImuTrack ImuReader::finish() {
  report(backward_, "whose stamps are not after those before (check the driver's clock)");
  report(not_finite_, "whose numbers are not finite (check the driver)");
  if (const std::string_view missing = missing_in(track_.covariance); !missing.empty()) {
    track_.samples.clear();
    track_.remarks = {format(
        "imu: it is left out, as its messages say that {} was not measured (covariance -1); if it was, make "
        "the driver state a covariance",
        missing)};
  }
  return std::move(track_);
}

}  // namespace adit
