// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Configuration fields from and to TOML. A dotted key `kiss_icp.voxel_size` is the entry `voxel_size` of the
/// table
/// `[kiss_icp]`.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"

namespace adit {

/// Sets every field that the text names. An unknown key fails with the nearest known one, a value of the
/// wrong type or out of range with what is allowed, each with its line. On failure the fields before it may
/// have been set.
Result<> parse_config(const Fields& fields, std::string_view toml);
/// The same of a configuration that another version may have saved: what this one does not know, or does not
/// take any more, stays as it is. Returns a line about each of those.
Result<std::vector<std::string>> parse_saved_config(const Fields& fields, std::string_view toml);
/// `parse_config` of a file, which errors name.
Result<> load_config(const std::filesystem::path& path, const Fields& fields);

/// A file that is a list: every table of the array `name`, written [[name]], sets the fields that `entry`
/// hands out for it, in their order. Anything else at the top of the file is refused, and so is what
/// `parse_config` refuses.
Result<> load_entries(const std::filesystem::path& path, std::string_view name,
                      const std::function<Fields()>& entry);

/// All fields with their present values, grouped in tables; meaning, unit and range as comments.
/// `parse_config` reads it back.
[[nodiscard]] std::string to_toml(const Fields& fields);

/// The tables of docs/configuration.md: key, default (the present value), unit, range, meaning; a section a
/// table.
[[nodiscard]] std::string to_markdown(const Fields& fields);

}  // namespace adit
