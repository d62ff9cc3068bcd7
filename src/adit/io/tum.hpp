// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// TUM trajectories: one line per pose, `stamp_s x y z qx qy qz qw`, metres. Stamps are kept to the
/// nanosecond: they are integers in memory and decimal text in the file, never a double.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// What files may state, to either side of zero: any two such stamps and the offsets of a scan's points can
/// be subtracted without overflow. 146 years, so that clocks since 1900 (NTP) are below it.
inline constexpr Stamp kLargestStamp{4'600'000'000'000'000'000};

/// "12.5" -> 12500000000 ns; digits beyond the ninth decimal are rounded. Exponents ("1.5e9") are read too.
/// Nothing when the text is not a decimal number or beyond kLargestStamp.
[[nodiscard]] std::optional<Stamp> parse_stamp(std::string_view text);
/// Seconds with nine decimals, exact: "1.500000000".
[[nodiscard]] std::string stamp_text(Stamp stamp);

/// Parses the text of a TUM file. Blank lines and lines that start with # are skipped. Errors name the line:
/// not eight numbers, a number that is not finite, a position more than 1e9 m out, a quaternion off unit
/// length by more than 1 %, stamps not ascending, no pose.
Result<Trajectory> parse_tum(std::string_view text);
/// The same of a file.
Result<Trajectory> read_tum(const std::filesystem::path& path);

/// Stamps with nine decimals, the other numbers in shortest form that reads back exactly.
[[nodiscard]] std::string tum_text(const Trajectory& trajectory);
/// The file appears whole or not at all.
Result<> write_tum(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace adit
