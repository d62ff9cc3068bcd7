// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/imu_topic.hpp"

#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/ascending.hpp"
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

void ImuReader::add(const BagMessage& message) {
  const Result<ros::ImuMessage> imu = decoded(bag_, message, ros::decode_imu);
  if (!imu) return left_out_.leave(imu.error());
  if (std::exchange(is_first_, false)) track_.covariance = imu->covariance;
  const ImuSample& sample = imu->sample;
  if (!sample.angular_velocity.allFinite() || !sample.specific_force.allFinite())
    return left_out_.leave(
        {format("at {} s its numbers are not finite; check the driver", stamp_text(sample.stamp))});
  left_out_.take();
  track_.samples.push_back(sample);
}

ImuTrack ImuReader::finish() {
  const std::vector<Stamp> stamps = stamps_of(track_.samples);
  const std::vector<std::size_t> kept = longest_ascending(stamps);
  track_.samples = taken(std::move(track_.samples), kept);
  if (const auto note = note_of_left_out("samples", stamps, kept)) track_.remarks.push_back("imu: " + *note);
  if (const auto sentence = left_out_.sentence()) track_.remarks.push_back("imu: " + *sentence);
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
