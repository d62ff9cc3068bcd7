// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// A figure of a study's report.
struct Figure {
  std::string name;     ///< Safe as a file name: "routes", "graph_robot_0_robot_1_all_initial".
  std::string section;  ///< That of a pair (pair_section), or kMergeSection; empty: of the whole study.
  std::string title;    ///< One line.
  std::string caption;  ///< A sentence or two; says what the colours mean.
  std::string svg;      ///< The whole document, self-contained.
};

/// Every figure that the study has data for, in this order: routes, odometry boxes, the merged map, the joint
/// run's trajectories coloured by their error, its loops, the hypotheses about pairs of robots that were
/// refused or had several, the pose graphs of each pair, and the trajectories of each pair coloured by their
/// error.
[[nodiscard]] std::vector<Figure> study_figures(const StudyResult& study);

/// The section of figures that show how merges were decided.
inline constexpr const char* kMergeSection = "merges";

/// The section that figures of two robots belong to.
[[nodiscard]] std::string pair_section(const std::string& first, const std::string& second);

}  // namespace adit
