// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/study_result.hpp"

#include <algorithm>

namespace adit {

std::string OdometryResult::title() const {
  if (method == "kiss_icp") return "KISS-ICP";
  if (method == "kinematic_icp") return "Kinematic-ICP";
  if (method == "plane_icp") return "plane-icp";
  return method;
}

std::optional<double> MergedRobot::ate_max_over_path_pct() const {
  if (!ate || path_length_m <= 0.0) return std::nullopt;
  return 100.0 * ate->max_m / path_length_m;
}

bool PairResult::success() const {
  return merged && std::all_of(robots.begin(), robots.end(), [](const MergedRobot& robot) {
           const std::optional<double> ratio = robot.ate_max_over_path_pct();
           return ratio && *ratio < 1.0;
         });
}

const PairResult* find_pair(const StudyResult& study, std::array<std::string, 2> robots,
                            const std::string& keyframes, bool pcm) {
  const auto found = std::find_if(study.pairs.begin(), study.pairs.end(), [&](const PairResult& pair) {
    return pair.robots[0].name == robots[0] && pair.robots[1].name == robots[1] &&
           pair.keyframes == keyframes && pair.pcm == pcm;
  });
  return found == study.pairs.end() ? nullptr : &*found;
}

}  // namespace adit
