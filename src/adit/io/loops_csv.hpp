// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// loops.csv: every candidate that was registered, one per row, and what became of it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/io/session_dir.hpp"

namespace adit {

/// The text of the file, rows ordered by the ends of the loops.
[[nodiscard]] std::string loops_csv(const Session& session);

/// Reads what any version wrote. Fails, with the line, on another header, on a row of another length and on
/// cells that are not what their column holds.
[[nodiscard]] Result<std::vector<SavedLoop>> parse_loops_csv(std::string_view text);

/// The same text with `classes` in the column `class`, one per row ("" for none).
[[nodiscard]] Result<std::string> with_classes(std::string_view text,
                                               const std::vector<std::string>& classes);

}  // namespace adit
