// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Configuration: one plain struct a module, its defaults in the struct, and one function `fields_of` beside
/// it that describes each field once. From that description come TOML reading, `--set key=value`, range
/// checks, the saved configuration and docs/configuration.md.
///
///     struct IcpConfig { double voxel_size = 1.0; int max_iterations = 500; };
///     inline Fields fields_of(IcpConfig& c) {
///       return {{"voxel_size", &c.voxel_size, "m", 0.01, 10.0, "edge of a map voxel"},
///               {"max_iterations", &c.max_iterations, "", 1, 10000, "Gauss-Newton iterations a scan, at
///               most"}};
///     }
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/core/result.hpp"

namespace adit {

using FieldTarget = std::variant<double*, int*, bool*, std::uint64_t*, std::string*>;

struct Field {
  std::string key;     ///< "voxel_size"; with the module's prefix "kiss_icp.voxel_size".
  FieldTarget target;  ///< Points into the struct that `fields_of` was given.
  std::string unit;    ///< "m", "deg", "" ...
  double min = 0.0;    ///< Inclusive range of a number.
  double max = 0.0;
  std::string meaning;                    ///< One line.
  std::vector<std::string> choices = {};  ///< Allowed values of a string; empty: any.
};
using Fields = std::vector<Field>;

/// Puts "prefix." in front of each key of `nested` and appends them.
void append(Fields& fields, const std::string& prefix, Fields nested);

/// Sets one field from text. An unknown key fails with the nearest known key; a value of the wrong type, out
/// of range or not among the choices fails with what is allowed. Nothing is changed on failure.
Result<> set_field(const Fields& fields, std::string_view key, std::string_view value);

/// The value as text that `set_field` reads back: numbers shortest-exact, bools `true`/`false`, strings bare.
[[nodiscard]] std::string value_text(const Field& field);

/// Checks every number against its range and every string against its choices (after a struct was filled by
/// code).
Result<> check_fields(const Fields& fields);

/// The key among `known` that `key` was most likely meant to be; "" when none is near.
[[nodiscard]] std::string nearest_key(const std::vector<std::string>& known, std::string_view key);

}  // namespace adit
