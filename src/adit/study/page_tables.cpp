// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/page_tables.hpp"

#include "adit/io/atomic_file.hpp"
#include "adit/report/page_section.hpp"
#include "adit/report/text_tables.hpp"

namespace adit {

Result<> write_tables(const std::filesystem::path& page, std::string_view section,
                      const std::vector<Table>& tables) {
  std::string markdown = "\n";
  for (const Table& table : tables) markdown += markdown_of(table) + "\n";
  const Result<std::string> old = read_bytes(page);
  if (!old) return tl::unexpected(old.error());
  const Result<std::string> text = with_section(*old, section, markdown);
  if (!text) return fail(page.string(), text.error());
  return write_bytes(page, *text);
}

}  // namespace adit
