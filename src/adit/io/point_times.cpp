// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/point_times.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/core/robot_name.hpp"

namespace adit {
namespace {

constexpr std::string_view kOneTime = "is the same for every point";

}  // namespace

std::string_view to_string(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return "s";
    case TimeUnit::milliseconds:
      return "ms";
    case TimeUnit::microseconds:
      return "us";
    case TimeUnit::nanoseconds:
      break;
  }
  return "ns";
}

Result<std::optional<TimeUnit>> parse_time_unit(std::string_view text) {
  using enum TimeUnit;
  if (text.empty()) return std::optional<TimeUnit>();
  for (const TimeUnit unit : {seconds, milliseconds, microseconds, nanoseconds})
    if (text == to_string(unit)) return std::optional(unit);
  return fail(format("'{}' is not a unit of point times; s, ms, us and ns are", text));
}

Result<KnownTimes> stated_times(const RecordingConfig& config) {
  return parse_time_unit(config.point_times).map([&](std::optional<TimeUnit> unit) {
    return KnownTimes{unit, {}, false, config.point_time_field};
  });
}

KnownTimes known_after(const PointTimes& first, KnownTimes stated) {
  stated.none = first.are_one;
  if (first.field.empty() || first.are_one) return stated;
  if (first.unit) stated.unit = first.unit;
  stated.from_first_point = first.from_first_point;
  return stated;
}

std::string no_stated_field(std::string_view field, std::string_view remedy) {
  return format("no field '{}', which --point-time-field names for the times of points; {}", printable(field),
                remedy);
}

std::string point_times_text(const PointTimes& times) {
  if (times.field.empty()) return "";
  const std::string name = printable(times.field);
  if (times.are_one) return format("{}, {}, the same for every point", name, times.type);
  const bool is_float = times.type.starts_with("float");
  const TimeUnit unit = times.unit.value_or(is_float ? TimeUnit::seconds : TimeUnit::nanoseconds);
  return format("{}, {} {}, {}", name, times.type, to_string(unit),
                times.clock_apart_s  ? "of another clock than the stamp"
                : times.are_absolute ? "absolute"
                                     : "from the stamp");
}

std::string point_times_note(TimeUnit unit, UnitSource source) {
  if (source == UnitSource::stated)
    return format("point times: in {}, as stated by --point-times", to_string(unit));
  return format(
      "point times: in {}, in which a sweep lasts as long as sweeps do; if that is wrong, give "
      "--point-times",
      to_string(unit));
}

std::string no_point_times_note(const PointTimes& times) {
  return format("point times: {}, so that scans are not corrected for the motion during a sweep",
                times.are_one ? format("field '{}' {}", printable(times.field), kOneTime) : "none");
}

bool says_times_are_one(std::string_view note) { return note.find(kOneTime) != std::string_view::npos; }

std::optional<std::string> stated_unit_warning(TimeUnit unit, const PointCloud& sweep) {
  constexpr std::int64_t kShortest = 1'000'000;  // nanoseconds; LiDARs take 50 to 200 ms
  constexpr std::int64_t kLongest = 1'000'000'000;
  if (!sweep.has_times()) return std::nullopt;
  const auto [first, last] = std::ranges::minmax(sweep.time_offsets_ns);
  const std::int64_t lasts = std::int64_t{last} - first;
  if (lasts >= kShortest && lasts <= kLongest) return std::nullopt;
  return format(
      "point times: in {}, as stated by --point-times, the first sweep lasts {:.3g} s, where LiDARs take "
      "0.05 to 0.2 s; state the unit in which the driver writes them (s, ms, us or ns), or leave the option "
      "out",
      to_string(unit), 1e-9 * static_cast<double>(lasts));
}

}  // namespace adit
