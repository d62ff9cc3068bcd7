// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "adit/core/check.hpp"
#include "adit/report/loop_plots.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/plots.hpp"
#include "adit/report/png.hpp"
#include "support/made_up_study.hpp"

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
       {"routes", "odometry_ate", "merged_map", "ate_joint", "loops", "hypotheses_robot_0_robot_1",
        "graph_robot_0_robot_1_all_initial", "graph_robot_0_robot_1_tunnel_filter_optimized",
        "ate_robot_0_robot_1_tunnel_filter"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
  EXPECT_EQ(figures.size(), 14U);  // 4 of the study, 2 of merges, 6 graphs, 2 errors
}

TEST(Figures, OnlyContestedOrRefusedMergesAreDrawnAndNotTooManyOfThem) {
  StudyResult study = made_up::study();
  std::vector<MergePicture>& merges = study.joint->merges;
  const auto num_drawn = [&] {
    return std::ranges::count(study_figures(study), kMergeSection, &Figure::section);
  };
  EXPECT_EQ(num_drawn(), 1);
  merges[0].merged = true;
  EXPECT_EQ(num_drawn(), 1) << "it had rivals";
  merges[0].hypotheses.resize(1);
  EXPECT_EQ(num_drawn(), 0);
  merges[0].merged = false;
  EXPECT_EQ(num_drawn(), 1);
  merges[0].hypotheses.clear();
  EXPECT_EQ(num_drawn(), 0) << "there is nothing to draw";
  const MergePicture refused = made_up::study().joint->merges[0];
  merges.assign(15, refused);
  for (std::size_t i = 0; i < merges.size(); ++i) merges[i].robots[1] = "robot_" + std::to_string(i);
  EXPECT_EQ(num_drawn(), 12);
  const std::vector<Figure> figures = study_figures(study);
  const auto last = std::ranges::find(figures, "hypotheses_robot_0_robot_11", &Figure::name);
  ASSERT_NE(last, figures.end());
  EXPECT_NE(last->caption.find("3 more pairs are not drawn"), std::string::npos) << last->caption;
}

TEST(Plots, StretchesOnWhichWheelsSlippedAreMarked) {
  LoopMap map = made_up::study().joint->loop_map;
  EXPECT_EQ(plot_loop_map(map).find("wheels slipped"), std::string::npos);
  map.robots[0].slips = {{map.robots[0].path[0], map.robots[0].path[1]}};
  const std::string svg = plot_loop_map(map);
  EXPECT_NE(svg.find("wheels slipped: 1"), std::string::npos);
  expect_renders(svg);
}

TEST(Plots, LoopsOfEachFateHaveTheirOwnLookAndCount) {
  const std::string svg = plot_loop_map(made_up::study().joint->loop_map);
  for (const char* label : {"in use: 1", "refused: 1", "refused, weak along the tunnel: 1"})
    EXPECT_NE(svg.find(label), std::string::npos) << label;
  std::set<std::string> colors;
  for (const LoopFate fate : {LoopFate::in_use, LoopFate::refused, LoopFate::weak})
    colors.insert(hex(fate_color(fate)));
  EXPECT_EQ(colors.size(), 3U);
  for (const char* dashes : {"stroke-dasharray=\"8 6\"", "stroke-dasharray=\"0.1 6\""})
    EXPECT_NE(svg.find(dashes), std::string::npos) << dashes;
  expect_renders(svg);
}

TEST(Plots, HypothesesSayWhatWasFoundAndOnlySomeAreDrawn) {
  const StudyResult study = made_up::study();
  const MergePicture& merge = study.joint->merges[0];
  const std::string svg = plot_hypotheses(merge, {0, 1});
  EXPECT_NE(svg.find("evidence 12.0 (9.2 needed), scans differ at 3 of 40 places, 2 loops"),
            std::string::npos);
  EXPECT_EQ(svg.find("scans differ at 4 of 40 places"), std::string::npos) << "the fifth is left out";
  const std::vector<Figure> figures = study_figures(study);
  const auto figure = std::ranges::find(figures, "hypotheses_robot_0_robot_1", &Figure::name);
  ASSERT_NE(figure, figures.end());
  EXPECT_NE(figure->caption.find("2 more hypotheses are not drawn"), std::string::npos);
  EXPECT_NE(figure->caption.find("drive on until"), std::string::npos);
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
  expect_renders(plot_loop_map({}));
  expect_renders(plot_loop_map({{{"a", 0, {}}, {"b", 1, {}}, {"c", 1, {Vector3(1, 2, 3)}}}, {}, 0, 0}));
  MergePicture merge;
  expect_renders(plot_hypotheses(merge, {0, 1}));
  merge.hypotheses.resize(5);
  expect_renders(plot_hypotheses(merge, {0, 1}));
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
