// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A small study with every part filled, for tests of tables, figures and reports.
#pragma once

#include <cmath>
#include <string>

#include "adit/evaluation/study_result.hpp"

namespace adit::made_up {

inline std::vector<Vector3> path(double y) {
  std::vector<Vector3> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(2.0 * i, y + 10.0 * std::sin(0.02 * i), 0.0);
  return points;
}

inline AteResult ate(const std::vector<Vector3>& positions, double max_m) {
  AteResult result;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    result.stamps.push_back({static_cast<std::int64_t>(i)});
    result.errors_m.push_back(max_m * static_cast<double>(i + 1) / static_cast<double>(positions.size()));
  }
  result.positions = positions;
  result.max_m = max_m;
  result.rmse_m = 0.58 * max_m;
  result.mean_m = result.median_m = 0.5 * max_m;
  return result;
}

inline PairResult pair(const std::string& keyframes, bool pcm) {
  PairResult result;
  const std::array<std::vector<Vector3>, 2> paths = {path(0.0), path(18.0)};
  result.robots = {MergedRobot{"robot_0", 400.0, ate(paths[0], 0.3)},
                   MergedRobot{"robot_1", 400.0, ate(paths[1], 0.9)}};
  result.keyframes = keyframes;
  result.pcm = pcm;
  result.merged = true;
  result.loops_before_pcm = {3, 1, 1};
  result.loops_after_pcm = {1, 0, 0};
  result.initial.robot_paths = {paths[0], paths[1]};
  for (const LoopClass c : {LoopClass::correct, LoopClass::wrong_place, LoopClass::wrong_registration}) {
    const auto i = 50 * static_cast<std::size_t>(c);
    result.initial.loops.push_back({paths[0][i], paths[1][i + 7], c});
  }
  result.after_pcm = result.optimized = result.initial;
  return result;
}

/// Two maps, one loop of each fate, and one pair that two hypotheses compete for.
inline void add_merges(JointResult& joint) {
  for (std::size_t i = 0; i < 2; ++i)
    joint.loop_map.robots.push_back({"robot_" + std::to_string(i), i, path(18.0 * static_cast<double>(i))});
  for (const LoopFate fate : {LoopFate::in_use, LoopFate::refused, LoopFate::weak}) {
    const auto k = 40 * static_cast<std::size_t>(fate);
    joint.loop_map.loops.push_back({{0, k}, {1, k + 3}, fate});
  }
  joint.loop_map.num_unregistered = 5;
  MergePicture merge;
  merge.robots = {"robot_0", "robot_1"};
  merge.verdict = "two hypotheses 20 m apart <both> agree; drive on until both pass a junction";
  merge.evidence_needed = 9.2;
  merge.path = path(0.0);
  for (std::size_t h = 0; h < 6; ++h) {
    const std::vector<Vector3> there = path(4.0 * static_cast<double>(h));
    merge.hypotheses.push_back({"rival", 12.0, 40, static_cast<int>(h), there, {there[50], there[60]}});
  }
  joint.merges.push_back(merge);
}

inline StudyResult study() {
  StudyResult result;
  result.version = "0.1.0";
  result.world = "a <b> & \"c\"";
  result.lidar = "os2-128";
  result.configuration = "place = \"</pre><script>alert(1)</script>\"\n";
  for (const char* name : {"robot_0", "robot_1"}) {
    const std::vector<Vector3> route = path(18.0 * static_cast<double>(result.robots.size()));
    result.robots.push_back({name,
                             400.0,
                             214.0,
                             2140,
                             800,
                             {{"kiss_icp", ate(route, 40.0), 8.0}, {"kinematic_icp", ate(route, 0.4), 11.0}},
                             route});
  }
  for (const char* keyframes : {"all", "tunnel_filter"}) {
    for (const bool pcm : {false, true}) result.pairs.push_back(pair(keyframes, pcm));
  }
  result.pairs.back().merged = false;
  result.pairs.back().refused_reason = "two <equally> good answers";
  JointResult joint;
  joint.keyframes = "adaptive";
  joint.components = {{"robot_0", "robot_1"}};
  joint.robots = {result.pairs[0].robots[0], result.pairs[0].robots[1]};
  joint.bytes_sent_per_robot = {1000, 2000};
  for (const RobotResult& robot : result.robots) {
    PointCloud map;
    for (const Vector3& p : robot.route) map.points.push_back(p.cast<float>());
    joint.maps.push_back(map);
  }
  add_merges(joint);
  result.joint = joint;
  result.floor_plan = floor_plan_of(result.joint->maps[0].points, 1.0);
  return result;
}

}  // namespace adit::made_up
