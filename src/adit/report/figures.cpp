// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/figures.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "adit/core/format.hpp"
#include "adit/report/loop_plots.hpp"
#include "adit/report/plots.hpp"

namespace adit {
namespace {

std::string file_safe(std::string name) {
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  }
  return name;
}

std::size_t index_of(const StudyResult& study, const std::string& robot) {
  const auto found = std::find_if(study.robots.begin(), study.robots.end(),
                                  [&](const RobotResult& r) { return r.name == robot; });
  return static_cast<std::size_t>(found - study.robots.begin());
}

std::string policy_phrase(const std::string& keyframes) {
  if (keyframes == "all") return "all keyframes";
  if (keyframes == "tunnel_filter") return "tunnel-filtered keyframes";
  return keyframes + " keyframes";
}

Figure routes_figure(const StudyResult& study) {
  std::vector<RobotPath> routes;
  for (const RobotResult& robot : study.robots) routes.push_back({robot.name, routes.size(), robot.route});
  return {"routes", "", "Routes of the robots over the map",
          "True trajectories over the walls of the world, seen from above; dots mark where the robots start.",
          plot_routes(study.floor_plan, routes)};
}

Figure odometry_figure(const StudyResult& study) {
  std::vector<std::string> methods;
  std::vector<std::string> titles;
  for (const RobotResult& robot : study.robots) {
    for (const OdometryResult& odometry : robot.odometry) {
      if (std::find(methods.begin(), methods.end(), odometry.method) != methods.end()) continue;
      methods.push_back(odometry.method);
      titles.push_back(odometry.title());
    }
  }
  std::vector<BoxGroup> groups;
  for (const RobotResult& robot : study.robots) {
    BoxGroup group = {robot.name, std::vector<std::vector<double>>(methods.size())};
    for (const OdometryResult& odometry : robot.odometry) {
      const auto m = static_cast<std::size_t>(std::find(methods.begin(), methods.end(), odometry.method) -
                                              methods.begin());
      if (odometry.ate) group.samples[m] = odometry.ate->errors_m;
    }
    groups.push_back(std::move(group));
  }
  return {"odometry_ate", "", "Absolute trajectory error of the odometries",
          "ATE of every pose after the robot's own alignment. Box: quartiles and median; whiskers: 1.5 "
          "interquartile ranges; the number is the largest error in metres.",
          plot_boxes(titles, groups, "ATE (m)")};
}

struct Stage {
  const char* name;
  const char* title;
  GraphPicture PairResult::*picture;
};
constexpr std::array<Stage, 3> kStages = {{{"initial", "initial graph", &PairResult::initial},
                                           {"after_pcm", "after PCM", &PairResult::after_pcm},
                                           {"optimized", "optimized", &PairResult::optimized}}};

Figure graph_figure(const StudyResult& study, const PairResult& pair, const Stage& stage) {
  const GraphPicture& picture = pair.*stage.picture;
  std::vector<RobotPath> robots;
  for (const MergedRobot& robot : pair.robots)
    robots.push_back({robot.name, index_of(study, robot.name), {}});
  robots.resize(picture.robot_paths.size());
  const std::string& first = pair.robots[0].name;
  const std::string& second = pair.robots[1].name;
  return {file_safe(format("graph_{}_{}_{}{}_{}", first, second, pair.keyframes, pair.pcm ? "" : "_no_pcm",
                           stage.name)),
          pair_section(first, second), format("{}: {}", policy_phrase(pair.keyframes), stage.title),
          "Loops between the robots: green correct, red a wrong place, blue the right place but a wrong "
          "registration.",
          plot_graph(picture, robots)};
}

/// With PCM where the pair was run with it: six pictures per pair, as in the paper's appendix A.
bool is_pictured(const StudyResult& study, const PairResult& pair) {
  return pair.pcm ||
         find_pair(study, {pair.robots[0].name, pair.robots[1].name}, pair.keyframes, true) == nullptr;
}

Figure errors_figure(const StudyResult& study, const std::string& name, const std::string& title,
                     std::span<const MergedRobot> robots) {
  std::vector<ErrorPath> paths;
  for (const MergedRobot& robot : robots) {
    if (robot.ate) paths.push_back({robot.name, robot.ate->positions, robot.ate->errors_m});
  }
  return {file_safe(name), "", title, "Estimated trajectories after alignment, coloured by their error.",
          plot_error_paths(study.floor_plan, paths)};
}

bool has_ate(std::span<const MergedRobot> robots) {
  return std::any_of(robots.begin(), robots.end(),
                     [](const MergedRobot& robot) { return robot.ate.has_value(); });
}

void add_pair_figures(std::vector<Figure>& figures, const StudyResult& study, const PairResult& pair) {
  for (const Stage& stage : kStages) {
    if (!(pair.*stage.picture).empty()) figures.push_back(graph_figure(study, pair, stage));
  }
}

void add_pair_errors(std::vector<Figure>& figures, const StudyResult& study, const PairResult& pair) {
  if (!has_ate(pair.robots)) return;
  const std::string& first = pair.robots[0].name;
  const std::string& second = pair.robots[1].name;
  Figure figure = errors_figure(study, format("ate_{}_{}_{}", first, second, pair.keyframes),
                                format("{}: error along the paths{}", policy_phrase(pair.keyframes),
                                       pair.merged ? "" : " (not merged: each robot on its own)"),
                                pair.robots);
  figure.section = pair_section(first, second);
  figures.push_back(std::move(figure));
}

Figure loops_figure(const LoopMap& map) {
  std::string caption = format(
      "Loops that registration accepted. Weak: the scans are free to slide along the tunnel; so are {} of "
      "the loops in use. {} further candidates could not be registered.",
      map.num_weak_in_use, map.num_unregistered);
  if (std::ranges::any_of(map.robots, [](const LoopMap::Robot& robot) { return robot.map > 0; }))
    caption += " Each frame holds one map; their relative position is not known.";
  return {"loops", "", "Loops in use and refused", caption, plot_loop_map(map)};
}

bool is_worth_a_picture(const MergePicture& merge) {
  return !merge.hypotheses.empty() && (!merge.merged || merge.hypotheses.size() > 1);
}

Figure hypotheses_figure(const StudyResult& study, const MergePicture& merge) {
  const auto& [first, second] = merge.robots;
  std::string caption = merge.verdict + ".";
  caption[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(caption[0])));
  if (merge.hypotheses.size() > kHypothesesDrawn)
    caption += format(" {} more hypotheses are not drawn.", merge.hypotheses.size() - kHypothesesDrawn);
  return {file_safe(format("hypotheses_{}_{}", first, second)), kMergeSection,
          format("{}: {}", pair_section(first, second), merge.merged ? "merged" : "not merged"), caption,
          plot_hypotheses(merge, {index_of(study, first), index_of(study, second)})};
}

/// Refused pairs before merged ones; not more than a page can hold.
void add_merge_figures(std::vector<Figure>& figures, const StudyResult& study, const JointResult& joint) {
  constexpr std::size_t kMost = 12;
  std::vector<const MergePicture*> worth;
  for (const MergePicture& merge : joint.merges)
    if (is_worth_a_picture(merge)) worth.push_back(&merge);
  std::ranges::stable_sort(worth, {}, &MergePicture::merged);
  const std::size_t num_left_out = worth.size() - std::min(worth.size(), kMost);
  worth.resize(worth.size() - num_left_out);
  for (const MergePicture* merge : worth) figures.push_back(hypotheses_figure(study, *merge));
  if (num_left_out > 0)
    figures.back().caption += format(" {} more pairs are not drawn; session.toml lists them.", num_left_out);
}

void add_joint_figures(std::vector<Figure>& figures, const StudyResult& study, const JointResult& joint) {
  std::vector<RobotCloud> clouds;
  for (std::size_t i = 0; i < joint.maps.size() && i < joint.robots.size(); ++i) {
    if (joint.maps[i].empty()) continue;
    clouds.push_back({joint.robots[i].name, index_of(study, joint.robots[i].name), joint.maps[i].points});
  }
  if (!clouds.empty()) {
    figures.push_back({"merged_map", "", "The merged map of all robots",
                       "Every robot's points from above in its colour; the denser, the darker. In a good "
                       "merge the walls of different robots coincide.",
                       plot_merged_map(clouds)});
  }
  if (has_ate(joint.robots)) {
    figures.push_back(
        errors_figure(study, "ate_joint", "Error along the paths of the joint run", joint.robots));
  }
  if (!joint.loop_map.robots.empty()) figures.push_back(loops_figure(joint.loop_map));
  add_merge_figures(figures, study, joint);
}

}  // namespace

std::string pair_section(const std::string& first, const std::string& second) {
  return first + " and " + second;
}

std::vector<Figure> study_figures(const StudyResult& study) {
  std::vector<Figure> figures;
  const bool has_routes =
      std::ranges::any_of(study.robots, [](const RobotResult& robot) { return !robot.route.empty(); });
  if (has_routes) figures.push_back(routes_figure(study));
  const bool has_odometry = std::any_of(study.robots.begin(), study.robots.end(),
                                        [](const RobotResult& robot) { return !robot.odometry.empty(); });
  if (has_odometry) figures.push_back(odometry_figure(study));
  if (study.joint) add_joint_figures(figures, study, *study.joint);
  for (const PairResult& pair : study.pairs) {
    if (is_pictured(study, pair)) add_pair_figures(figures, study, pair);
  }
  for (const PairResult& pair : study.pairs) {
    if (is_pictured(study, pair)) add_pair_errors(figures, study, pair);
  }
  return figures;
}

}  // namespace adit
