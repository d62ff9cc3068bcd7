// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/page_section.hpp"

#include "adit/core/format.hpp"

namespace adit {

Result<std::string> with_section(std::string_view page, std::string_view name, std::string_view content) {
  const std::string begin_line = format("<!-- {} begin -->\n", name);
  const std::string end_line = format("<!-- {} end -->\n", name);
  const std::size_t begin = page.find(begin_line);
  const std::size_t end = begin == std::string_view::npos ? begin : page.find(end_line, begin);
  if (end == std::string_view::npos)
    return fail(format("the page needs the lines '<!-- {0} begin -->' and '<!-- {0} end -->'", name));
  return format("{}{}{}", page.substr(0, begin + begin_line.size()), content, page.substr(end));
}

}  // namespace adit
