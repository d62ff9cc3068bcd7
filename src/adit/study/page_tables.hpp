// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/evaluation/tables.hpp"

namespace adit {

/// Puts the tables between the lines that mark `section` in a Markdown page (`with_section`); the rest of the
/// page stays. Fails where the page cannot be read or written, or lacks the marks.
Result<> write_tables(const std::filesystem::path& page, std::string_view section,
                      const std::vector<Table>& tables);

}  // namespace adit
