// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/page_tables.hpp"

#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/page_section.hpp"
#include "adit/report/text_tables.hpp"

namespace adit {
namespace {

constexpr const char* kFiguresFolder = "figures";

Result<> write_page_figures(const std::filesystem::path& page, const std::vector<PageFigure>& figures) {
  if (figures.empty()) return {};
  const std::filesystem::path folder = page.parent_path() / kFiguresFolder;
  Result<> done = make_folder(folder);
  for (const PageFigure& figure : figures)
    if (done) done = write_bytes(folder / figure.name, figure.svg);
  return done;
}

}  // namespace

Result<> write_tables(const std::filesystem::path& page, std::string_view section,
                      const std::vector<Table>& tables, const std::vector<PageFigure>& figures) {
  std::string markdown = "\n";
  for (const Table& table : tables) markdown += markdown_of(table) + "\n";
  for (const PageFigure& figure : figures)
    markdown += "![" + figure.title + "](" + kFiguresFolder + "/" + figure.name + ")\n\n";
  const Result<std::string> old = read_bytes(page);
  if (!old) return tl::unexpected(old.error());
  const Result<std::string> text = with_section(*old, section, markdown);
  if (!text) return fail(page.string(), text.error());
  if (const Result<> done = write_page_figures(page, figures); !done) return done;
  return write_bytes(page, *text);
}

}  // namespace adit
