// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/tum.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

bool is_tum_digit(char c) { return c >= '0' && c <= '9'; }

/// A decimal number as its digits and the place of the point: value = digits * 10^-decimals.
struct Decimal {
  bool negative = false;
  std::string digits;
  int decimals = 0;
};

std::optional<int> parse_exponent(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > 30)
    return std::nullopt;
  return exponent;
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  if (text.starts_with('-') || text.starts_with('+')) {
    decimal.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  bool after_point = false;
  std::size_t i = 0;
  for (; i < text.size() && (is_tum_digit(text[i]) || (text[i] == '.' && !after_point)); ++i) {
    if (text[i] == '.') {
      after_point = true;
    } else {
      decimal.digits += text[i];
      decimal.decimals += after_point ? 1 : 0;
    }
  }
  if (decimal.digits.empty() || decimal.digits.size() > 60) return std::nullopt;
  if (i == text.size()) return decimal;
  if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
  const std::optional<int> exponent = parse_exponent(text.substr(i + 1));
  if (!exponent) return std::nullopt;
  decimal.decimals -= *exponent;
  return decimal;
}

Result<StampedPose> parse_pose(const std::vector<std::string_view>& words) {
  if (words.size() != 8) {
    return fail(format("{} words; a pose is 'stamp x y z qx qy qz qw'", words.size()));
  }
  const std::optional<Stamp> stamp = parse_stamp(words[0]);
  if (!stamp)
    return fail(format("stamp '{}' is not a decimal number of seconds, {} at most", words[0],
                       kLargestStamp.ns / kNanosecondsPerSecond));
  std::array<double, 7> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> value = parse_double(words[i + 1]);
    if (!value || !std::isfinite(*value)) return fail(format("'{}' is not a finite number", words[i + 1]));
    values[i] = *value;
  }
  return stated_pose({values[0], values[1], values[2]}, {values[6], values[3], values[4], values[5]})
      .map([&](const Pose& pose) {
        return StampedPose{*stamp, pose};
      });
}

}  // namespace

std::optional<Stamp> parse_stamp(std::string_view text) {
  const std::optional<Decimal> decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  const auto num_digits = static_cast<int>(decimal->digits.size());
  const int num_taken =
      num_digits + 9 - decimal->decimals;  // those of whole nanoseconds; may be more than there are
  const auto digit = [&](int i) {
    return i < num_digits ? decimal->digits[static_cast<std::size_t>(i)] - '0' : 0;
  };
  constexpr std::int64_t kLargest = kLargestStamp.ns / 10;
  std::int64_t ns = 0;
  for (int i = 0; i < num_taken; ++i) {
    if (ns > kLargest) return std::nullopt;
    ns = ns * 10 + digit(i);
  }
  if (num_taken >= 0 && digit(num_taken) >= 5) ++ns;
  if (ns > kLargestStamp.ns) return std::nullopt;
  return Stamp{decimal->negative ? -ns : ns};
}

std::string stamp_text(Stamp stamp) {
  // Through unsigned, so that the most negative stamp has an absolute value too.
  const std::uint64_t ns = stamp.ns < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(stamp.ns)
                                        : static_cast<std::uint64_t>(stamp.ns);
  return format("{}{}.{:09}", stamp.ns < 0 ? "-" : "", ns / kNanosecondsPerSecond,
                ns % kNanosecondsPerSecond);
}

Result<Trajectory> parse_tum(std::string_view text) {
  Trajectory trajectory;
  LineReader lines(text);
  while (lines.next()) {
    const std::vector<std::string_view> words = split_words(lines.line());
    if (words.empty() || words.front().starts_with('#')) continue;
    const std::string place = format("line {}", lines.number());
    Result<StampedPose> pose = parse_pose(words);
    if (!pose) return fail(place, pose.error());
    if (!trajectory.empty() && pose->stamp <= trajectory.back().stamp) {
      return fail(format("{}: stamp {} is not after {}, that of the pose before; sort the poses by stamp",
                         place, words[0], stamp_text(trajectory.back().stamp)));
    }
    trajectory.push_back(*pose);
  }
  if (trajectory.empty()) return fail("no poses in it; a line is 'stamp x y z qx qy qz qw'");
  return trajectory;
}

Result<Trajectory> read_tum(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Trajectory> trajectory = parse_tum(*bytes);
  if (!trajectory) return fail(path.string(), trajectory.error());
  return trajectory;
}

std::string tum_text(const Trajectory& trajectory) {
  std::string text;
  for (const auto& [stamp, pose] : trajectory) {
    const Vector3& t = pose.translation();
    const Eigen::Quaterniond& q = pose.rotation();
    text += format("{} {} {} {} {} {} {} {}\n", stamp_text(stamp), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                   q.w());
  }
  return text;
}

Result<> write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  return write_bytes(path, tum_text(trajectory));
}

}  // namespace adit
