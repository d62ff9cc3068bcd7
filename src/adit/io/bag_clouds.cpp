// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_clouds.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"

namespace adit {
namespace {

/// The latest time of a point, seconds after the stamp; none where times do not count from the stamp.
std::optional<double> sweep_after_stamp(const Scan& scan) {
  constexpr double kShortest = 0.01;  // seconds; less is within the jitter of clocks
  if (!scan.cloud.has_times()) return std::nullopt;
  const auto [earliest, latest] = std::ranges::minmax(scan.cloud.time_offsets_ns);
  const double sweep = to_seconds(Duration(latest));
  return earliest >= 0 && sweep >= kShortest ? std::optional(sweep) : std::nullopt;
}

/// Whether sweeps were recorded before they could have ended, did their times count from the stamp; looked at
/// in the first, the middle and the last scan. The time of recording has to lie within the sweep, as clocks
/// may differ, and behind the stamp, which programs that convert recordings write as the time of recording.
bool is_stamped_at_end(const Bag& bag, const std::vector<BagMessage>& scans, const KnownTimes& known) {
  bool any = false;
  for (const std::size_t i : {std::size_t{0}, scans.size() / 2, scans.size() - 1}) {
    const Result<ros::CloudMessage> message = read_cloud_message(bag, scans[i], known);
    if (!message || message->scan.cloud.empty()) continue;
    any = true;
    const std::optional<double> sweep = sweep_after_stamp(message->scan);
    const double recorded_after = to_seconds(scans[i].log_time - message->scan.stamp);
    if (!sweep || recorded_after <= 0.0 || recorded_after > 0.5 * *sweep) return false;
  }
  return any;
}

/// Of times of another clock than the stamps.
std::string clock_note(double apart_s, bool at_end, bool is_stated) {
  return format(
      "point times: they are {:.3f} s from the stamps, as by another clock, and count from the first "
      "point of the sweep{}{}",
      apart_s, at_end ? "" : ", taken for the time of the stamp",
      at_end || is_stated ? "" : "; if that is of the sweep's end, --set recording.stamp_at=end");
}

}  // namespace

Result<ros::CloudMessage> read_cloud_message(const Bag& bag, const BagMessage& message,
                                             const KnownTimes& known) {
  const bool from_livox = ros::is_livox(bag.topics[message.topic].type);
  return decoded(bag, message, [&](std::string_view content, MessageEncoding encoding) {
    return from_livox ? ros::decode_livox(content, encoding, known)
                      : ros::decode_cloud(content, encoding, known);
  });
}

Result<ros::CloudMessage> first_cloud(const Bag& bag, const TopicIndices& topics, const KnownTimes& known) {
  std::size_t num = 0;
  std::string first_fault;
  for (const BagMessage& message : bag.messages) {
    if (std::ranges::find(topics, message.topic) == topics.end()) continue;
    throw_if_cancelled();
    Result<ros::CloudMessage> cloud = read_cloud_message(bag, message, known);
    if (cloud && !cloud->scan.cloud.empty()) return cloud;
    const bool lacks_field = !cloud && lacks_stated_field(known, [&](const KnownTimes& untimed) {
      return read_cloud_message(bag, message, untimed);
    });
    if (!cloud && (first_fault.empty() || lacks_field))
      first_fault = format("scan {}: {}", num, cloud.error().message);
    if (lacks_field) break;
    ++num;
  }
  if (!first_fault.empty()) return fail(names_of(bag, topics) + ", " + first_fault);
  if (num == 0) return fail(format("{}: no message; there are no scans to read", names_of(bag, topics)));
  return fail(format("{}: none of {} clouds has a point; look at the driver", names_of(bag, topics), num));
}

Result<KnownTimes> stated_times(const Bag& bag, const RecordingConfig& config) {
  return stated_times(config).map([&](KnownTimes stated) {
    if (!bag.own) return stated;
    stated.unit = stated.unit.value_or(TimeUnit::nanoseconds);
    stated.from_first_point = false;
    return stated;
  });
}

bool stamp_at_end(const Bag& bag, const std::vector<BagMessage>& scans, const KnownTimes& known,
                  const RecordingConfig& config) {
  if (config.stamp_at != "auto" || bag.own) return config.stamp_at == "end";
  return is_stamped_at_end(bag, scans, known);
}

void note_point_times(Recording& recording, const Bag& bag, const ros::CloudMessage& first, bool at_end,
                      const RecordingConfig& config) {
  const PointTimes& times = first.times;
  // Messages of Livox have their own unit, whatever is stated.
  const bool is_stated = times.unit && to_string(*times.unit) == config.point_times;
  const UnitSource source = is_stated ? UnitSource::stated : UnitSource::found;
  const auto note = [&](std::string sentence) { recording.assumptions.push_back(std::move(sentence)); };
  if (is_stated)
    if (auto warning = stated_unit_warning(*times.unit, first.scan.cloud))
      recording.warnings.push_back(std::move(*warning));
  if (bag.own && source == UnitSource::found) return;
  const bool is_stamp_stated = config.stamp_at != "auto";
  if (!first.scan.cloud.has_times())
    note(no_point_times_note(times));
  else if (!times.has_usual_unit)
    note(point_times_note(*times.unit, source));
  if (times.clock_apart_s) note(clock_note(*times.clock_apart_s, at_end, is_stamp_stated));
  if (at_end && !is_stamp_stated)
    note(
        "point times: they count from the start of the sweep and the stamp is of its end, as scans were "
        "recorded before they could have ended otherwise; if that is wrong, --set recording.stamp_at=start");
}

}  // namespace adit
