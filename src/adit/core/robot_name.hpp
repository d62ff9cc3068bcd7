// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Names of robots. They come from recordings, routes and command lines, and become folder names, CSV cells
/// and labels; so every name that enters passes through here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// `text` as a name that is one folder of its own on any file system: control characters, separators of paths
/// and of tables, quotes, wildcards and dots or blanks at either end become '_', and at most 64 bytes are
/// kept (whole UTF-8 characters). A text without any other character becomes "robot". A name that is fine
/// stays.
[[nodiscard]] std::string robot_name(std::string_view text);

/// The names with numbers added where one was there before: a, a, b, a -> a, a_2, b, a_3. A name that this
/// would make twice takes the next number.
[[nodiscard]] std::vector<std::string> distinct_names(const std::vector<std::string>& names);

/// `text` in one line of a message: control characters become "?".
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace adit
