// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// What is written for people and programs: tables, metrics.json, report.html.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "adit/core/check.hpp"
#include "adit/report/html_report.hpp"
#include "adit/report/markup.hpp"
#include "adit/report/metrics_json.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/png.hpp"
#include "adit/report/rate_plot.hpp"
#include "adit/report/reliability_plot.hpp"
#include "adit/report/text_tables.hpp"
#include "support/made_up_study.hpp"

namespace adit {
namespace {

Table small_table() {
  return {"Title",
          "A caption.",
          {{"", 1}, {"Both together", 2}},
          {"Robot", "a", "b"},
          {{"0", "✓", "12.5"}, {"1|2", "-", "<x>"}}};
}

TEST(TextTables, ColumnsAlignByCharacters) {
  const std::string text = text_of(small_table());
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  ASSERT_EQ(lines.size(), 9U);
  for (const std::size_t i : {2U, 3U, 5U, 6U})
    EXPECT_EQ(num_characters(lines[i]), num_characters(lines[1])) << lines[i];
  EXPECT_EQ(lines.back(), "A caption.");
}

TEST(TextTables, MarkdownAndHtmlEscape) {
  const std::string markdown = markdown_of(small_table());
  EXPECT_NE(markdown.find("| Robot | Both together: a | Both together: b |"), std::string::npos);
  EXPECT_NE(markdown.find("| 1\\|2 | - | \\<x> |"), std::string::npos);
  const std::string html = html_of(small_table());
  EXPECT_NE(html.find("&lt;x&gt;"), std::string::npos);
  EXPECT_EQ(html.find("<x>"), std::string::npos);
  EXPECT_NE(html.find("colspan=\"2\""), std::string::npos);
}

TEST(TextTables, RaggedTablesAreABug) {
  Table table = small_table();
  table.rows[0].pop_back();
  EXPECT_THROW((void)text_of(table), ContractViolation);
  EXPECT_NO_THROW((void)text_of(Table{}));
}

TEST(Metrics, HasTheKeysOfTheInterface) {
  const nlohmann::json metrics = nlohmann::json::parse(metrics_json(made_up::study()));
  for (const char* key : {"version", "world", "lidar", "wall_s", "peak_rss_mb", "robots", "pairs", "joint"}) {
    EXPECT_TRUE(metrics.contains(key)) << key;
  }
  EXPECT_EQ(metrics["version"], 1);
  for (const char* key :
       {"name", "path_length_m", "duration_s", "speed_mean_mps", "scans", "keyframes", "odometry"}) {
    EXPECT_TRUE(metrics["robots"][0].contains(key)) << key;
  }
  for (const char* key : {"ate_max_m", "ate_rmse_m", "ate_median_m", "ms_per_scan_median"}) {
    EXPECT_TRUE(metrics["robots"][1]["odometry"]["kiss_icp"][key].is_number()) << key;
    EXPECT_TRUE(metrics["robots"][1]["odometry"]["kinematic_icp"][key].is_number()) << key;
  }
  for (const char* key : {"robots", "keyframes", "pcm", "loops_before_pcm", "wrong_place_before_pcm",
                          "wrong_registration_before_pcm", "loops_after_pcm", "wrong_place_after_pcm",
                          "wrong_registration_after_pcm", "wrong_loops_in_solution", "merged",
                          "refused_reason", "success", "ate_max_m", "ate_rmse_m", "ate_max_over_path_pct"}) {
    EXPECT_TRUE(metrics["pairs"][0].contains(key)) << key;
  }
  for (const char* key : {"keyframes", "components", "ate_max_m", "ate_max_over_path_pct",
                          "wrong_loops_in_solution", "bytes_sent_per_robot"}) {
    EXPECT_TRUE(metrics["joint"].contains(key)) << key;
  }
  EXPECT_EQ(metrics["pairs"][3]["merged"], false);
  EXPECT_EQ(metrics["pairs"][3]["success"], false);
  EXPECT_EQ(metrics["pairs"][0]["success"], true);
  EXPECT_EQ(metrics["pairs"][0]["wrong_place_before_pcm"], 1);
  EXPECT_DOUBLE_EQ(metrics["pairs"][0]["ate_max_over_path_pct"][1].get<double>(), 100.0 * 0.9 / 400.0);
}

TEST(Metrics, WhatIsUnknownOrNotFiniteIsNull) {
  StudyResult study = made_up::study();
  study.wall_s = std::numeric_limits<double>::infinity();
  study.world = "\xff broken";
  study.robots[0].odometry[0].ate.reset();
  study.pairs[0].robots[1].ate.reset();
  study.joint.reset();
  const nlohmann::json metrics = nlohmann::json::parse(metrics_json(study));
  EXPECT_TRUE(metrics["wall_s"].is_null());
  EXPECT_TRUE(metrics["joint"].is_null());
  EXPECT_TRUE(metrics["robots"][0]["odometry"]["kiss_icp"]["ate_max_m"].is_null());
  EXPECT_TRUE(metrics["pairs"][0]["ate_max_m"][1].is_null());
  EXPECT_FALSE(metrics["pairs"][0]["ate_max_m"][0].is_null());
}

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(HtmlReport, IsSelfContainedEscapedAndComplete) {
  const StudyResult study = made_up::study();
  const std::vector<Table> tables = study_tables(study, PaperFigures::show);
  const std::vector<Figure> figures = study_figures(study);
  const std::string html = html_report(study, tables, figures);
  EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0U);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_NE(html.find("a &lt;b&gt; &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_NE(html.find("two &lt;equally&gt; good answers"), std::string::npos);
  EXPECT_EQ(occurrences(html, "<svg "), figures.size());
  EXPECT_EQ(occurrences(html, "<table>"), tables.size());
  for (const char* element : {"div", "figure", "ul", "li", "h2", "dl", "details", "pre", "svg", "table"}) {
    EXPECT_EQ(occurrences(html, std::string("<") + element + ">") +
                  occurrences(html, std::string("<") + element + " "),
              occurrences(html, std::string("</") + element + ">"))
        << element;
  }
  // The only addresses are the names of the SVG format.
  EXPECT_EQ(occurrences(html, "http"), occurrences(html, "xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(html, html_report(study, tables, figures));
}

TEST(HtmlReport, ASessionWithoutGroundTruthClaimsNothingAboutIt) {
  StudyResult session;
  session.joint = made_up::study().joint;
  session.joint->robots.clear();
  session.joint->maps.clear();
  session.joint->refusals = {"robot_0 and robot_1: two hypotheses"};
  const std::vector<Figure> figures = study_figures(session);
  EXPECT_EQ(figures.size(), 2U);
  const std::string html = html_report(session, {}, figures);
  EXPECT_EQ(occurrences(html, "<svg "), 2U);
  EXPECT_NE(html.find("not merged: robot_0 and robot_1: two hypotheses"), std::string::npos);
  EXPECT_NE(html.find("agree; drive on until both pass a junction"), std::string::npos);
  for (const char* unknown : {"wrong loops", "In short", "Tables", "Peak memory", "study of"})
    EXPECT_EQ(html.find(unknown), std::string::npos) << unknown;
}

TEST(ReliabilityPlot, EachCurveIsALineAndIsNamed) {
  const std::vector<ReliabilityCurve> curves = {{"loops", {{0.0, 0.0}, {0.5, 0.7}, {1.0, 1.0}}},
                                                {"steps", {{0.0, 0.1}, {1.0, 0.9}}}};
  const std::string svg = plot_reliability(curves);
  EXPECT_EQ(occurrences(svg, "stroke-linejoin"), 2U);
  EXPECT_EQ(occurrences(svg, ">loops<"), 1U);
  EXPECT_NE(plot_reliability({}).find("</svg>"), std::string::npos);
}

constexpr const char* kRateLine = "fill=\"none\" stroke-linejoin";

TEST(RatePlot, EachCurveIsALineAndTheRateInUseIsMarked) {
  RateFigure figure;
  figure.title = "Claimed & observed";
  figure.note = "of 94";
  figure.curves = {{"limit", {{1.0, 0.2}, {0.01, 0.2}, {0.01, 0.1}, {1e-5, 0.1}}, kInk, Dash::dashes},
                   {"false ones", {{1.0, 0.1}, {0.01, 0.1}}, kWall},
                   {"none", {}, kWall}};
  figure.rate_in_use = 0.002;
  const std::string svg = plot_rates(figure);
  EXPECT_EQ(occurrences(svg, kRateLine), 2U);
  for (const char* text : {">limit<", ">false ones<", ">claimed = observed<", ">error rate in use: 0.002<",
                           ">Claimed &amp; observed<", ">of 94<"})
    EXPECT_EQ(occurrences(svg, text), 1U) << text;
  EXPECT_EQ(occurrences(svg, ">1e-05<"), 2U) << "on both axes";
  EXPECT_EQ(svg.find(">none<"), std::string::npos);
  EXPECT_EQ(svg, plot_rates(figure));
  EXPECT_TRUE(png_from_svg(svg, 400)) << png_from_svg(svg, 400).error().message;
  figure.rate_in_use = 1e-7;
  EXPECT_EQ(plot_rates(figure).find("in use"), std::string::npos) << "the axis does not have it";
}

TEST(RatePlot, DrawsWhatLacksItsDataAndNothingThatALogarithmDoesNotHave) {
  RateFigure figure;
  figure.absent = "no false ones";
  const std::string svg = plot_rates(figure);
  EXPECT_EQ(occurrences(svg, kRateLine), 0U);
  EXPECT_EQ(occurrences(svg, ">no false ones<"), 1U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  figure.curves = {{"beyond", {{1e-9, 1e-9}, {2.0, 2.0}}, kInk}};
  EXPECT_EQ(occurrences(plot_rates(figure), kRateLine), 1U) << "at the ends of the axes";
  figure.curves = {{"none", {{1.0, 0.0}, {0.5, 0.0}}, kInk}};
  EXPECT_THROW((void)plot_rates(figure), ContractViolation);
}

TEST(HtmlReport, AnEmptyStudyIsAPageToo) {
  EXPECT_NE(html_report({}, {}, {}).find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace adit
