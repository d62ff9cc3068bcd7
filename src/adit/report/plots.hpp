// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The figures of a study, each a self-contained SVG document: no script, no network, no font of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// A named path in the colour of its robot (its index in the fleet).
struct RobotPath {
  std::string name;           ///< As the legend has it.
  std::size_t robot = 0;      ///< Index in the fleet, for the colour.
  std::vector<Vector3> path;  ///< In the order driven, metres, in the frame of the figure; may be empty.
};

/// Robots' routes over the walls of the world (`plan` may be empty), a dot where each starts.
[[nodiscard]] std::string plot_routes(const FloorPlan& plan, std::span<const RobotPath> routes);

/// One group of boxes per robot, one box per method. The axis turns logarithmic when the boxes span more than
/// a factor of 30.
struct BoxGroup {
  std::string name;  ///< Of the robot; stands below the group.
  std::vector<std::vector<double>>
      samples;  ///< One list per method, in the order of the methods; may be empty.
};
/// Box plots side by side; an empty list of samples leaves a gap. `axis_title` names quantity and unit.
/// Throws ContractViolation unless every group has one list per method.
[[nodiscard]] std::string plot_boxes(std::span<const std::string> methods, std::span<const BoxGroup> groups,
                                     const std::string& axis_title);

/// A pose graph: paths in their robots' colours, loops green (correct), red (wrong place), blue (wrong
/// registration). `robots` name the picture's paths and their colours; its paths are not read.
[[nodiscard]] std::string plot_graph(const GraphPicture& picture, std::span<const RobotPath> robots);

/// Paths coloured by their error, with a colour bar; errors and paths have the same lengths.
struct ErrorPath {
  std::string name;              ///< Stands above the start of the path.
  std::vector<Vector3> path;     ///< Estimated positions, metres, in the frame of the floor plan.
  std::vector<double> errors_m;  ///< At each position, 0 or more.
};
/// All paths over the walls (`plan` may be empty). One scale of colours, from 0 to the largest error of all.
/// Throws ContractViolation where a path and its errors differ in length.
[[nodiscard]] std::string plot_error_paths(const FloorPlan& plan, std::span<const ErrorPath> paths);

/// Maps of several robots from above, each in its colour, darker where more points lie.
struct RobotCloud {
  std::string name;                         ///< As the legend has it.
  std::size_t robot = 0;                    ///< Index in the fleet, for the colour.
  std::span<const Eigen::Vector3f> points;  ///< Metres, in the frame that all clouds share; not owned.
};
/// Later clouds are drawn over earlier ones.
[[nodiscard]] std::string plot_merged_map(std::span<const RobotCloud> clouds);

}  // namespace adit
