// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// JSON Robot Logs (.jrl): graphs of several robots, with ground truth and labelled outliers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// What the file says of a measurement. For judging results only: no solver may read it.
enum class JrlLabel { unlabelled, inlier, outlier };

/// The pose graph of a log, and what belongs to it. P: Pose or Pose2.
template <class P>
struct JrlGraph {
  /// A measurement of a node's pose in the world.
  struct Prior {
    std::size_t node = 0;                                 ///< Index into `graph.nodes`.
    P T_world_node;                                       ///< As measured.
    typename BasicPoseGraph<P>::Information information;  ///< As of an edge from the world to the node.
  };
  BasicPoseGraph<P> graph;                 ///< Without the priors.
  std::vector<Prior> priors;               ///< By robot, each robot's in the order of the file.
  std::vector<std::size_t> robot_of_node;  ///< Index into `JrlFile::robots`, one per node.
  std::vector<std::optional<P>> truth;     ///< T_world_node, one per node. For judging only.
  std::vector<JrlLabel> labels;            ///< One per edge. For judging only.
};

/// A log, read or to be written.
struct JrlFile {
  std::string name;                                       ///< Of the data set.
  std::vector<std::string> robots;                        ///< Their letters, in the order of the file.
  std::variant<JrlGraph<Pose>, JrlGraph<Pose2>> content;  ///< By the kind of its poses.
  std::vector<std::string> edge_places;  ///< "measurements.a[3].measurements[0]", one per edge.
  std::vector<std::string> notes;        ///< What was left out, assumed or composed.
};

/// Reads PriorFactorPose3 and BetweenFactorPose3, or the same with Pose2 (not both in one file), as JSON or,
/// where the file begins as such, CBOR. Factors of points, ranges and bearings are left out with a note; any
/// other type is an error. Errors name the file and the place in it.
///
/// Nodes are the keys of these factors, ascending. A node belongs to the robot whose letter its key has in
/// the top byte (GTSAM's Symbol), else to the robot whose measurements name it first. Its pose is that of
/// `initialization`, by its own robot before others; poses that are missing are composed along edges.
///
/// Edge kinds: with `potential_outlier_factors` in the file, those are loops and all other factors are
/// trusted; without, the step to the next key of the same robot is odometry and the rest are loops.
/// Covariances are in GTSAM's order, rotation before translation for Pose3, and must be symmetric positive
/// definite. A factor that two robots repeat exactly counts once.
/// Source: github.com/DanMcGann/jrl, version 1.1.1, format/ and src/Parser.cpp.
[[nodiscard]] Result<JrlFile> read_jrl(const std::filesystem::path& path);
/// The same of bytes in memory. Errors name `name`.
[[nodiscard]] Result<JrlFile> parse_jrl(const std::string& bytes, const std::string& name);

/// The graph of one or several robots as such a log: loops are the potential outliers. The robot of a node is
/// the letter in the top byte of its key, 'a' where there is none. Fails where that byte is no printable
/// character.
[[nodiscard]] Result<JrlFile> jrl_of(std::string name, const std::variant<PoseGraph, PoseGraph2>& graph);

/// As JSON. A measurement is that of the robot of its second node; an entry has those of one node, and its
/// stamp is its number, since graphs know no time. Read again it is the same graph, but for nodes without an
/// edge, with nodes in the order of their keys and edges in that of robots and nodes. Fails without edges,
/// and on one whose information is singular.
[[nodiscard]] Result<std::string> jrl_text(const JrlFile& file);

/// The graph in which priors are edges from an additional last node, the world, at the identity. Without
/// priors, or with one, which is mere gauge, there is no such node.
template <class P>
[[nodiscard]] BasicPoseGraph<P> with_priors_as_edges(const JrlGraph<P>& jrl);

/// Brings a solution of `with_priors_as_edges` to the frame of the priors and drops the world. `poses`: one
/// per node of that graph. The part of the graph that holds no prior stays where it is.
template <class P>
[[nodiscard]] std::vector<P> in_frame_of_priors(const JrlGraph<P>& jrl, std::vector<P> poses);

}  // namespace adit
