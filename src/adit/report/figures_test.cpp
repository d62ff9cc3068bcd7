// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/figures.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "adit/core/check.hpp"
#include "adit/report/made_up_study.hpp"
#include "adit/report/plots.hpp"
#include "adit/report/png.hpp"

namespace adit {
namespace {

void expect_renders(const std::string& svg) {
  const Result<std::string> png = png_from_svg(svg, 400);
  EXPECT_TRUE(png) << png.error().message;
}

TEST(Figures, AWholeStudyHasThePapersFigures) {
  const std::vector<Figure> figures = study_figures(made_up::study());
  std::set<std::string> names;
  for (const Figure& figure : figures) {
    names.insert(figure.name);
    expect_renders(figure.svg);
    EXPECT_LT(figure.svg.size(), 200000U) << figure.name;
  }
  EXPECT_EQ(names.size(), figures.size());
  for (const char* name :
       {"routes", "odometry_ate", "merged_map", "ate_joint", "graph_robot_0_robot_1_all_initial",
        "graph_robot_0_robot_1_tunnel_filter_optimized", "ate_robot_0_robot_1_tunnel_filter"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
  EXPECT_EQ(figures.size(), 12U);  // 4 of the study, 6 graphs, 2 errors
}

TEST(Figures, AnEmptyStudyHasNone) { EXPECT_TRUE(study_figures({}).empty()); }

TEST(Plots, LoopsHaveTheColoursOfTheirClass) {
  const PairResult pair = made_up::pair("all", true);
  const std::vector<RobotPath> robots = {{"a", 0, {}}, {"b", 1, {}}};
  const std::string svg = plot_graph(pair.initial, robots);
  for (const char* label : {"correct: 1", "wrong place: 1", "wrong registration: 1"}) {
    EXPECT_NE(svg.find(label), std::string::npos);
  }
  EXPECT_THROW((void)plot_graph(pair.initial, std::span(robots).first(1)), ContractViolation);
}

TEST(Plots, DegenerateInputStillDraws) {
  expect_renders(plot_routes({}, {}));
  expect_renders(
      plot_routes({}, std::vector<RobotPath>{{"empty", 0, {}}, {"one point", 1, {Vector3(5, 5, 5)}}}));
  expect_renders(plot_boxes({}, {}, "m"));
  const std::vector<std::string> methods = {"a", "b"};
  expect_renders(plot_boxes(methods, std::vector<BoxGroup>{{"r", {{}, {0.0, 0.0}}}}, "m"));
  expect_renders(plot_graph({{{}, {}}, {}}, std::vector<RobotPath>{{"a", 0, {}}, {"b", 1, {}}}));
  expect_renders(plot_error_paths({}, {}));
  expect_renders(
      plot_error_paths({}, std::vector<ErrorPath>{{"r", {Vector3::Zero(), Vector3::Zero()}, {0.0, 0.0}}}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points = {{nan, 0.0F, 0.0F}, {1.0F, 2.0F, 3.0F}};
  expect_renders(plot_merged_map(std::vector<RobotCloud>{{"r", 0, points}, {"none", 1, {}}}));
}

TEST(Plots, WideSpansTurnTheAxisLogarithmic) {
  const std::vector<std::string> methods = {"a", "b"};
  const std::string wide =
      plot_boxes(methods, std::vector<BoxGroup>{{"r", {{40.0, 50.0}, {0.1, 0.2}}}}, "ATE (m)");
  const std::string narrow =
      plot_boxes(methods, std::vector<BoxGroup>{{"r", {{4.0, 5.0}, {1.0, 2.0}}}}, "ATE (m)");
  EXPECT_NE(wide.find("log scale"), std::string::npos);
  EXPECT_EQ(narrow.find("log scale"), std::string::npos);
}

TEST(Plots, ManyPointsDoNotMakeALargeFigure) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300000; ++i)
    points.emplace_back(0.001F * static_cast<float>(i), static_cast<float>(i % 97) * 0.1F, 0.0F);
  EXPECT_LT(plot_merged_map(std::vector<RobotCloud>{{"r", 0, points}}).size(), 300000U);
}

}  // namespace
}  // namespace adit
