// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/topic_info.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/io/bag_clouds.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/joint_odometry.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit {
namespace {

/// To four digits; none where no time passed.
std::optional<double> rate_of(std::size_t num_intervals, double seconds) {
  if (num_intervals == 0 || seconds <= 0.0) return std::nullopt;
  const double rate = static_cast<double>(num_intervals) / seconds;
  // Powers of ten of at least 1 are exact, and a quotient by one is printed in so few digits.
  const double digits = std::floor(std::log10(rate)) - 3.0;
  const double power = std::pow(10.0, std::abs(digits));
  return digits > 0.0 ? std::round(rate / power) * power : std::round(rate * power) / power;
}

/// A message by both clocks.
struct Sighting {
  Stamp stamp;
  Stamp recorded;
  [[nodiscard]] double recorded_after_s() const { return seconds_between(stamp, recorded); }
};

/// Some messages of a topic from the first to the last; those whose header cannot be read are left out.
std::vector<Sighting> sightings_of(const Bag& bag, const std::vector<const BagMessage*>& messages) {
  constexpr std::size_t kNum = 9;
  std::vector<Sighting> sightings;
  const std::size_t num = std::min(kNum, messages.size());
  for (std::size_t i = 0; i < num; ++i) {
    const BagMessage& message = *messages[num < 2 ? 0 : i * (messages.size() - 1) / (num - 1)];
    if (const auto header = decoded(bag, message, ros::decode_header))
      sightings.push_back({header->stamp, message.log_time});
  }
  return sightings;
}

/// Messages that come late by a busy network stay below half a second; a clock that was set, or runs at
/// another speed, does not.
std::string clock_finding(const std::string& topic, const std::vector<Sighting>& sightings) {
  constexpr double kAgree = 0.5;  // seconds
  const auto [soonest, latest] = std::ranges::minmax(sightings, {}, &Sighting::recorded_after_s);
  if (latest.recorded_after_s() - soonest.recorded_after_s() <= kAgree) return "";
  return format(
      "clocks: {} was recorded from {:.2f} to {:.2f} s after its stamps, and these advance by {:.1f} s in "
      "{:.1f} s of recording: one of the clocks was set or runs at another speed, or messages came late. "
      "adit goes by stamps; where other topics were stamped by another clock (compare "
      "recorded_after_stamp_s), "
      "synchronise the clocks (chrony, PTP) and record again",
      topic, soonest.recorded_after_s(), latest.recorded_after_s(),
      seconds_between(sightings.front().stamp, sightings.back().stamp),
      seconds_between(sightings.front().recorded, sightings.back().recorded));
}

/// What the headers say.
void add_headers(TopicInfo& info, const Bag& bag, std::size_t topic,
                 const std::vector<const BagMessage*>& messages, const RecordingConfig& config) {
  const std::string& type = bag.topics[topic].type;
  if (!ros::is_cloud(type) && type != ros::kOdometry && type != ros::kImu) return;
  const auto header = decoded(bag, *messages.front(), ros::decode_header);
  const std::vector<Sighting> sightings = sightings_of(bag, messages);
  if (!header || sightings.empty()) return;
  info.frame = header->frame;
  info.recorded_after_stamp_s = {sightings.front().recorded_after_s(), sightings.back().recorded_after_s()};
  info.rate_by_stamps_hz =
      rate_of(messages.size() - 1, seconds_between(sightings.front().stamp, sightings.back().stamp));
  info.clock_finding = clock_finding(bag.topics[topic].name, sightings);
  if (!ros::is_cloud(type)) return;
  const Result<KnownTimes> stated = stated_times(bag, config);
  if (const auto cloud = read_cloud_message(bag, *messages.front(), stated.value_or(KnownTimes())))
    info.point_times_from = point_times_text(cloud->times);
  if (type != ros::kPointCloud2) return;
  if (const auto fields = decoded(bag, *messages.front(), ros::describe_cloud)) info.fields = *fields;
}

/// What adit would take each topic for; empty where it cannot choose.
std::vector<std::string> uses_of(const Bag& bag, const RecordingConfig& config) {
  std::vector<std::string> uses(bag.topics.size());
  const Result<BagTopics> chosen = choose_topics(bag, config);
  if (!chosen) return uses;
  const auto mark = [&](const TopicIndices& topics, const char* use) {
    for (const std::size_t i : topics) uses[i] = use;
  };
  mark(chosen->points, "points");
  if (config.wheel != kNoWheel) mark(chosen->wheel, "wheel");
  mark(chosen->truth, "truth");
  mark(chosen->imu, "imu");
  mark(chosen->transforms, "mounts");
  mark(chosen->static_transforms, "mounts");
  return uses;
}

}  // namespace

double seconds_between(Stamp earlier, Stamp later) {
  return static_cast<double>((static_cast<long double>(later.ns) - static_cast<long double>(earlier.ns)) /
                             1e9L);
}

Rhythm rhythm_of(const std::vector<Stamp>& stamps) {
  if (stamps.empty()) return {};
  Rhythm rhythm{rate_of(stamps.size() - 1, seconds_between(stamps.front(), stamps.back()))};
  for (std::size_t i = 1; i < stamps.size(); ++i)
    rhythm.longest_gap_s = std::max(rhythm.longest_gap_s, seconds_between(stamps[i - 1], stamps[i]));
  return rhythm;
}

std::vector<TopicInfo> topics_of(const Bag& bag, const RecordingConfig& config) {
  std::vector<std::vector<const BagMessage*>> messages(bag.topics.size());
  for (const BagMessage& message : bag.messages) messages[message.topic].push_back(&message);
  std::vector<std::string> uses = uses_of(bag, config);
  std::vector<TopicInfo> all;
  for (std::size_t topic = 0; topic < bag.topics.size(); ++topic) {
    TopicInfo info;
    info.num_messages = messages[topic].size();
    std::vector<Stamp> recorded;
    for (const BagMessage* message : messages[topic]) recorded.push_back(message->log_time);
    info.rhythm = rhythm_of(recorded);
    info.used_as = std::move(uses[topic]);
    if (bag.topics[topic].type == ros::kJointState) info.joints = first_joints(bag, topic);
    if (!messages[topic].empty()) add_headers(info, bag, topic, messages[topic], config);
    all.push_back(std::move(info));
  }
  return all;
}

}  // namespace adit
