// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/packed_cloud.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/robot_name.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

/// Calls `use` with a value of the C++ type that `type` stands for.
template <class Use>
auto with_type(ScalarType type, const Use& use) {
  switch (type) {
    case ScalarType::int8:
      return use(std::int8_t{});
    case ScalarType::uint8:
      return use(std::uint8_t{});
    case ScalarType::int16:
      return use(std::int16_t{});
    case ScalarType::uint16:
      return use(std::uint16_t{});
    case ScalarType::int32:
      return use(std::int32_t{});
    case ScalarType::uint32:
      return use(std::uint32_t{});
    case ScalarType::int64:
      return use(std::int64_t{});
    case ScalarType::uint64:
      return use(std::uint64_t{});
    case ScalarType::float32:
      return use(float{});
    case ScalarType::float64:
      break;
  }
  return use(double{});
}

template <class T>
T load(const char* bytes, std::endian order) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::ranges::reverse(raw);
  return std::bit_cast<T>(raw);
}

template <class T>
std::optional<T> parse_number(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Whether a cast to T has a meaning. The largest 64-bit integers are no doubles: a double as large as the
/// nearest one is out of range already.
template <class T>
bool is_in_range(double value) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_floating_point_v<T>) return std::abs(value) <= static_cast<double>(Limits::max());
  const double whole = std::trunc(value);
  return whole >= static_cast<double>(Limits::min()) && whole < std::ldexp(1.0, Limits::digits);
}

std::int64_t nanoseconds_in(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return 1'000'000'000;
    case TimeUnit::milliseconds:
      return 1'000'000;
    case TimeUnit::microseconds:
      return 1'000;
    case TimeUnit::nanoseconds:
      break;
  }
  return 1;
}

/// Calls `use` with the numbers of points `begin` to `end` and the values of their field.
template <class Use>
void for_each_value(const PackedCloud& packed, const PackedField& field, std::size_t begin, std::size_t end,
                    const Use& use) {
  with_type(field.type, [&](auto zero) {
    const char* bytes = packed.bytes.data() + field.offset + begin * field.stride;
    for (std::size_t i = begin; i < end; ++i, bytes += field.stride)
      use(i, load<decltype(zero)>(bytes, packed.order));
  });
}

/// A time that is not finite or too large.
constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

/// Nanoseconds; integers stay integers, since absolute times need all 64 bits.
template <class T>
std::int64_t nanoseconds_of(T value, std::int64_t in_unit) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  if constexpr (std::is_floating_point_v<T>) {
    const double time = value;
    if (!(std::abs(time) < 0.99 * static_cast<double>(kLargest) / static_cast<double>(in_unit)))
      return kNoTime;
    // Whole ones apart from the rest: in one product an absolute time would lose its last 100 ns.
    const double whole = std::floor(time);
    return static_cast<std::int64_t>(whole) * in_unit +
           std::llround((time - whole) * static_cast<double>(in_unit));
  } else {
    if (std::cmp_greater(value, kLargest / in_unit) || std::cmp_less(value, -kLargest / in_unit))
      return kNoTime;
    return static_cast<std::int64_t>(value) * in_unit;
  }
}

constexpr double kShortestSweep = 0.002;   // seconds; LiDARs take 0.05 to 0.2
constexpr std::size_t kEnoughTimes = 100;  // to tell what they are

/// What such times usually are.
TimeUnit usual_unit(ScalarType type) { return is_float(type) ? TimeUnit::seconds : TimeUnit::nanoseconds; }

/// The unit in which the sweep lasts as long as sweeps do; none where too few times are there, or none does.
std::optional<TimeUnit> unit_of_times(const PackedCloud& packed, const std::vector<Eigen::Vector3f>& points) {
  constexpr double kLongest = 2.0;  // seconds
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  std::size_t num = 0;
  for_each_value(packed, *packed.time, 0, packed.num_points, [&](std::size_t i, auto value) {
    const auto time = static_cast<double>(value);
    // Drivers write anything beside points that they did not see.
    if (!std::isfinite(time) || !points[i].allFinite()) return;
    low = std::min(low, time);
    high = std::max(high, time);
    ++num;
  });
  if (num < kEnoughTimes) return {};
  using enum TimeUnit;
  // Integers are never coarser than microseconds, and signed ones, as adit writes them, are nanoseconds.
  std::vector<TimeUnit> likeliest_first = {nanoseconds};
  if (is_float(packed.time->type)) likeliest_first = {seconds, nanoseconds, microseconds, milliseconds};
  if (packed.time->type == ScalarType::uint32 || packed.time->type == ScalarType::uint64)
    likeliest_first = {nanoseconds, microseconds};
  for (const TimeUnit unit : likeliest_first) {
    const double span = (high - low) * 1e-9 * static_cast<double>(nanoseconds_in(unit));
    if (span >= kShortestSweep && span <= kLongest) return unit;
  }
  return {};
}

/// "x, y, ring", in one line whatever the file says; "none" if there are no names.
std::string names_text(std::vector<std::string> names) {
  constexpr std::size_t kMost = 20;
  if (names.empty()) return "none";
  const bool are_more = names.size() > kMost;
  if (are_more) names.resize(kMost);
  for (std::string& name : names) name = printable(name);
  return format("{}{}", fmt::join(names, ", "), are_more ? ", ..." : "");
}

Result<> check_field(const PackedCloud& cloud, const std::optional<PackedField>& field, const char* name) {
  if (!field)
    return fail(format("no field '{}'; the fields are: {}; points need x, y and z, in metres", name,
                       names_text(cloud.names)));
  const std::size_t size = size_of(field->type);
  const std::size_t available = cloud.bytes.size();
  const bool fits =
      field->offset <= available && size <= available - field->offset &&
      (field->stride == 0 || cloud.num_points - 1 <= (available - field->offset - size) / field->stride);
  if (fits) return {};
  return fail(format("field '{}' of {} points reaches past the {} bytes of data; the file is truncated", name,
                     cloud.num_points, available));
}

Result<> check_layout(const PackedCloud& cloud) {
  if (cloud.num_points == 0) return fail("the cloud has no points");
  Result<> checked = check_field(cloud, cloud.x, "x")
                         .and_then([&] { return check_field(cloud, cloud.y, "y"); })
                         .and_then([&] { return check_field(cloud, cloud.z, "z"); });
  if (checked && cloud.intensity) checked = check_field(cloud, cloud.intensity, "intensity");
  if (checked && cloud.time) checked = check_field(cloud, cloud.time, "t");
  const std::string& stated = cloud.known_times.field;
  if (checked && !cloud.time && !stated.empty() && !cloud.known_times.none)
    return fail(no_stated_field(
        stated,
        format("the fields are: {}; name one of them, or leave the option out", names_text(cloud.names))));
  return checked;
}

/// Makes them offsets from the scan's stamp: as they are when they lie about zero as those of a sweep do,
/// else relative to the stamp, else to the earliest point. Under stamps the first cloud decides for all.
Result<> take_times(CloudFile& file, const std::vector<std::int64_t>& times, const PackedCloud& packed) {
  constexpr std::int64_t kLimit = std::numeric_limits<std::int32_t>::max();
  constexpr double kNear = 0.25;  // seconds from zero: a sweep, stamped at its start, middle or end
  const auto [low_at, high_at] = std::ranges::minmax_element(times);
  const std::int64_t low = *low_at;
  const std::int64_t high = *high_at;
  // Absolute times may lie anywhere in 64 bits, so their differences need more.
  __extension__ using Wide = __int128;
  const auto fits = [&](Wide origin) { return low - origin >= -kLimit && high - origin <= kLimit; };
  const KnownTimes& known = packed.known_times;
  const double span_s = static_cast<double>(Wide{high} - low) * 1e-9;
  if (Wide{high} - low > kLimit)
    return fail(
        format("the point times of the sweep span {:.3f} s, more than 2.1 s: another field "
               "(--point-time-field), or another unit than was taken (--point-times)",
               span_s));
  const std::int64_t absolute = packed.stamp ? packed.stamp->ns : 0;
  const double from_stamp_s = static_cast<double>(Wide{low} - absolute) * 1e-9;
  const bool is_known = packed.stamp && known.from_first_point;
  const double farthest_s =
      1e-9 * std::max(std::abs(static_cast<double>(low)), std::abs(static_cast<double>(high)));
  const bool is_relative = fits(0) && (is_known || farthest_s <= std::max(kNear, 2.0 * span_s));
  const bool is_apart = !is_relative && !(packed.stamp && fits(absolute));
  if (is_apart && packed.stamp && span_s < kShortestSweep && !known.unit && !known.from_first_point)
    return fail(
        format("the point times span {:.3g} s and lie {:.3f} s from the scan's stamp: another field "
               "(--point-time-field), or another unit than was taken (--point-times)",
               span_s, from_stamp_s));
  const bool from_first = is_known ? *known.from_first_point : is_apart;
  if (is_apart && !from_first)
    return fail(format(
        "its point times lie {:.3f} s from its stamp, those of the first scan do not; was a clock set?",
        from_stamp_s));
  file.times.from_first_point = from_first;
  if (from_first && packed.stamp) file.times.clock_apart_s = from_stamp_s;
  const std::int64_t origin = from_first ? low : is_relative ? 0 : absolute;
  file.times.are_absolute = origin != 0;
  file.cloud.time_offsets_ns.resize(times.size());
  std::ranges::transform(times, file.cloud.time_offsets_ns.begin(),
                         [&](std::int64_t t) { return static_cast<std::int32_t>(t - origin); });
  return {};
}

/// Whether a first cloud shows that its field of times tells nothing.
bool are_one_time(const std::vector<std::int64_t>& times, const KnownTimes& known) {
  return !known.from_first_point && times.size() >= kEnoughTimes &&
         std::ranges::all_of(times, [&](std::int64_t t) { return t == times.front(); });
}

}  // namespace

std::size_t size_of(ScalarType type) {
  return with_type(type, [](auto value) { return sizeof(value); });
}

std::string_view to_string(ScalarType type) {
  static constexpr std::string_view kNames[] = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                                "uint32", "int64", "uint64", "float32", "float64"};
  return kNames[static_cast<std::size_t>(type)];
}

bool is_float(ScalarType type) { return type == ScalarType::float32 || type == ScalarType::float64; }

double load_scalar(ScalarType type, const char* bytes, std::endian order) {
  return with_type(type,
                   [&](auto value) { return static_cast<double>(load<decltype(value)>(bytes, order)); });
}

bool append_scalar(std::string& bytes, ScalarType type, std::string_view word) {
  return with_type(type, [&](auto zero) {
    using T = decltype(zero);
    if (const std::optional<T> exact = parse_number<T>(word)) {
      append_little_endian(bytes, *exact);
      return true;
    }
    // Some writers print whole numbers as "12.0" or "1e3".
    const std::optional<double> value = parse_double(word);
    if (!value || !is_in_range<T>(*value)) return false;
    append_little_endian(bytes, static_cast<T>(*value));
    return true;
  });
}

void assign_field(PackedCloud& cloud, std::string_view name, PackedField field) {
  const auto take = [&](std::optional<PackedField>& place, std::initializer_list<std::string_view> names) {
    if (!place && std::ranges::find(names, name) != names.end()) place = field;
  };
  cloud.names.emplace_back(name);
  take(cloud.x, {"x"});
  take(cloud.y, {"y"});
  take(cloud.z, {"z"});
  take(cloud.intensity, {"intensity", "intensities", "i", "scalar_Intensity"});
  take(cloud.reflectivity, {"reflectivity"});
  const bool had_time = cloud.time.has_value();
  if (const std::string& stated = cloud.known_times.field; !stated.empty())
    take(cloud.time, {stated});
  else
    take(cloud.time, {"t", "time", "time_offset", "offset_time", "timestamp", "time_stamp"});
  if (!had_time && cloud.time) cloud.time_name = name;
}

namespace {

/// All points, finite or not. In blocks that stay near the processor while each field is read.
void load_points(const PackedCloud& packed, PointCloud& cloud) {
  constexpr std::size_t kBlock = 512;
  const std::size_t num = packed.num_points;
  cloud.points.resize(num);
  if (packed.intensity) cloud.intensities.resize(num);
  for (std::size_t begin = 0; begin < num; begin += kBlock) {
    const std::size_t end = std::min(num, begin + kBlock);
    const auto coordinate = [&](const PackedField& field, Eigen::Index axis) {
      for_each_value(packed, field, begin, end,
                     [&](std::size_t i, auto value) { cloud.points[i][axis] = static_cast<float>(value); });
    };
    coordinate(*packed.x, 0);
    coordinate(*packed.y, 1);
    coordinate(*packed.z, 2);
    if (!packed.intensity) continue;
    for_each_value(packed, *packed.intensity, begin, end,
                   [&](std::size_t i, auto value) { cloud.intensities[i] = static_cast<float>(value); });
  }
}

std::vector<std::int64_t> load_times(const PackedCloud& packed, TimeUnit unit) {
  std::vector<std::int64_t> times(packed.num_points);
  const std::int64_t in_unit = nanoseconds_in(unit);
  for_each_value(packed, *packed.time, 0, packed.num_points,
                 [&](std::size_t i, auto value) { times[i] = nanoseconds_of(value, in_unit); });
  return times;
}

/// Leaves the points that are finite and have a time, where there are times; counts the others.
void leave_finite(CloudFile& file, std::vector<std::int64_t>& times) {
  PointCloud& cloud = file.cloud;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.points[i].allFinite() || (!times.empty() && times[i] == kNoTime)) continue;
    cloud.points[kept] = cloud.points[i];
    if (!cloud.intensities.empty()) cloud.intensities[kept] = cloud.intensities[i];
    if (!times.empty()) times[kept] = times[i];
    ++kept;
  }
  file.num_skipped_nan = cloud.points.size() - kept;
  cloud.points.resize(kept);
  if (!cloud.intensities.empty()) cloud.intensities.resize(kept);
  if (!times.empty()) times.resize(kept);
}

}  // namespace

Result<CloudFile> unpack(PackedCloud packed) {
  if (!packed.intensity) packed.intensity = packed.reflectivity;
  if (Result<> checked = check_layout(packed); !checked) return tl::unexpected(checked.error());
  CloudFile file;
  load_points(packed, file.cloud);
  std::vector<std::int64_t> times;
  file.times.field = packed.time_name;
  const bool has_times = packed.time && !packed.known_times.none;
  if (has_times) {
    const std::optional<TimeUnit> known = packed.known_times.unit;
    file.times.type = to_string(packed.time->type);
    file.times.unit = known ? known : unit_of_times(packed, file.cloud.points);
    const TimeUnit usual = usual_unit(packed.time->type);
    const TimeUnit unit = file.times.unit.value_or(usual);
    file.times.has_usual_unit = unit == usual;
    times = load_times(packed, unit);
  }
  leave_finite(file, times);
  if (!has_times || file.cloud.empty()) return file;
  file.times.are_one = are_one_time(times, packed.known_times);
  if (file.times.are_one) return file;
  return take_times(file, times, packed).map([&] { return std::move(file); });
}

Result<CloudFile> unpack_file(const PackedCloud& packed) {
  const std::size_t num_points = packed.num_points;
  return unpack(packed).and_then([&](CloudFile file) -> Result<CloudFile> {
    if (file.cloud.empty()) return fail(format("none of the {} points is finite", num_points));
    return file;
  });
}

Result<> check_stamp_at(const RecordingConfig& config) {
  if (config.stamp_at == "auto" || config.stamp_at == "start" || config.stamp_at == "end") return {};
  return fail(format("recording.stamp_at: '{}' is not start, end or auto", config.stamp_at));
}

Result<> put_stamp_at_end(Scan& scan) {
  std::vector<std::int32_t>& offsets = scan.cloud.time_offsets_ns;
  if (offsets.empty()) return {};
  const auto [earliest, latest] = std::ranges::minmax(offsets);
  if (std::int64_t{earliest} - latest < -std::numeric_limits<std::int32_t>::max())
    return fail("its points' times span more than 2.1 s");
  for (std::int32_t& offset : offsets) offset = static_cast<std::int32_t>(std::int64_t{offset} - latest);
  return {};
}

std::string packed_rows(const PointCloud& cloud) {
  const std::size_t row_size = 12 + (cloud.intensities.empty() ? 0U : 4U) + (cloud.has_times() ? 4U : 0U);
  std::string rows;
  rows.reserve(cloud.size() * row_size);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) append_little_endian(rows, cloud.points[i][axis]);
    if (!cloud.intensities.empty()) append_little_endian(rows, cloud.intensities[i]);
    if (cloud.has_times()) append_little_endian(rows, cloud.time_offsets_ns[i]);
  }
  return rows;
}

}  // namespace adit
