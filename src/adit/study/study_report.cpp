// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The files of a study: tables.md, metrics.json, report.html and the figures.
#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/html_report.hpp"
#include "adit/report/metrics_json.hpp"
#include "adit/report/png.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/study.hpp"

namespace adit {
namespace {

constexpr int kFigureWidthPx = 1400;
constexpr std::size_t kRobotsOfThePaper = 4;

Result<> write_figures(const std::vector<Figure>& figures, const std::filesystem::path& folder) {
  if (const Result<> made = make_folder(folder); !made) return made;
  for (const Figure& figure : figures) {
    if (const Result<> done = write_bytes(folder / (figure.name + ".svg"), figure.svg); !done) return done;
    const Result<std::string> png = png_from_svg(figure.svg, kFigureWidthPx);
    if (!png) return fail(figure.name, png.error());
    if (const Result<> done = write_bytes(folder / (figure.name + ".png"), *png); !done) return done;
  }
  return {};
}

}  // namespace

std::vector<Table> tables_of(const StudyResult& result) {
  const bool like_the_paper = result.world == "zab" && result.robots.size() == kRobotsOfThePaper;
  return study_tables(result, like_the_paper ? PaperFigures::show : PaperFigures::hide);
}

Result<> write_study_report(const StudyResult& result, const std::vector<Table>& tables,
                            const std::filesystem::path& folder) {
  const std::vector<Figure> figures = study_figures(result);
  std::string markdown;
  for (const Table& table : tables) markdown += markdown_of(table) + "\n";
  Result<> done = write_figures(figures, folder / "figures");
  if (done) done = write_bytes(folder / "tables.md", markdown);
  if (done) done = write_bytes(folder / "metrics.json", metrics_json(result));
  if (done) done = write_bytes(folder / "report.html", html_report(result, tables, figures));
  return done;
}

}  // namespace adit
