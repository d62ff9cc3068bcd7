// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/evaluation/tables.hpp"

namespace adit {

/// A figure that a page shows below its tables.
struct PageFigure {
  std::string name;   ///< Of the file, "merge_calibration.svg": in the folder figures/ beside the page.
  std::string title;  ///< One line of plain text without brackets, shown where the figure is not.
  std::string svg;    ///< The whole document.
};

/// Puts the tables between the lines that mark `section` in a Markdown page (`with_section`); the rest of the
/// page stays. Without the marks nothing is written; figures are written before the page. Fails where the
/// page cannot be read or written, or lacks the marks, and where a figure cannot be written.
Result<> write_tables(const std::filesystem::path& page, std::string_view section,
                      const std::vector<Table>& tables, const std::vector<PageFigure>& figures = {});

}  // namespace adit
