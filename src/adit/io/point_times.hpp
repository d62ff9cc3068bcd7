// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The times of points: what is known of them before a cloud is read, what a cloud shows, and what to say.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "adit/core/point_cloud.hpp"
#include "adit/core/recording_config.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Of the times of points.
enum class TimeUnit : std::uint8_t { seconds, milliseconds, microseconds, nanoseconds };
/// "s", "ms", "us" or "ns".
[[nodiscard]] std::string_view to_string(TimeUnit unit);
/// None for "", as RecordingConfig::point_times has it.
Result<std::optional<TimeUnit>> parse_time_unit(std::string_view text);

/// What is known of the times of a cloud before it is read; none: as the cloud shows it (packed_cloud.hpp).
struct KnownTimes {
  std::optional<TimeUnit> unit = {};  ///< As stated, or as the first cloud of the recording shows it.
  /// Whether the times of the recording's first cloud are of another clock than its stamp.
  std::optional<bool> from_first_point = {};
  /// Times are not taken: the first cloud has one for all its points, so that the field tells nothing.
  bool none = false;
  std::string field = {};  ///< Name of the field that has them, as stated; "": as found.
};
/// What `config` states of them. Fails where `point_times` is not "", s, ms, us or ns.
[[nodiscard]] Result<KnownTimes> stated_times(const RecordingConfig& config);

/// What a cloud shows of the times of its points.
struct PointTimes {
  std::string field = {};             ///< Name of the field, also of times not taken; "": no field.
  std::string_view type = {};         ///< Of the field, "float64".
  std::optional<TimeUnit> unit = {};  ///< Given, or found; none where there are too few times to tell.
  bool has_usual_unit = true;         ///< Seconds of floats, nanoseconds of integers.
  bool are_absolute = false;          ///< Rather than counted from the scan's stamp.
  bool from_first_point = false;      ///< So that they count from the earliest point.
  bool are_one = false;               ///< All points have one time, which is as none: the cloud has no times.
  /// By how many seconds the earliest point is after the scan's stamp, where there is one and times are of
  /// another clock.
  std::optional<double> clock_apart_s = {};
};

/// What a first cloud shows holds for all. Of what it does not show, `stated` stays.
[[nodiscard]] KnownTimes known_after(const PointTimes& first, KnownTimes stated);

/// The fault of a cloud without the field that is stated. `remedy` says what the cloud has, and what to do.
[[nodiscard]] std::string no_stated_field(std::string_view field, std::string_view remedy);
/// Whether a cloud lacks the field that is stated, so that the others of the recording need not be tried.
/// `read`, from KnownTimes to a Result with `times`, reads it; where it cannot do that even without times,
/// the cloud tells nothing.
template <class Read>
[[nodiscard]] bool lacks_stated_field(KnownTimes known, const Read& read) {
  known.none = true;
  if (known.field.empty()) return false;
  const auto cloud = read(known);
  return cloud && cloud->times.field.empty();
}

/// "timestamp, float64 s, absolute"; "" without a field.
[[nodiscard]] std::string point_times_text(const PointTimes& times);

/// Whether somebody stated the unit of the times of points, or it was found (packed_cloud.hpp).
enum class UnitSource : std::uint8_t { stated, found };
/// What to say of times that are not in seconds as floats or nanoseconds as integers.
[[nodiscard]] std::string point_times_note(TimeUnit unit, UnitSource source);
/// What to say of a first cloud without times: that there are none, or that all are one.
[[nodiscard]] std::string no_point_times_note(const PointTimes& times);
/// Whether a note says the latter.
[[nodiscard]] bool says_times_are_one(std::string_view note);
/// A warning where the sweep that these times make, in a unit that was stated, is shorter than 1 ms or longer
/// than 1 s. Without times none.
[[nodiscard]] std::optional<std::string> stated_unit_warning(TimeUnit unit, const PointCloud& sweep);

}  // namespace adit
