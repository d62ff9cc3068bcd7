// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "adit/core/pose.hpp"

namespace adit {

/// The kind of an edge, stated by its creator and never guessed from keys: odometry edges are trusted (known
/// inliers), loops may be false.
enum class EdgeKind { odometry, loop };
/// odometry, loop.
[[nodiscard]] std::string_view to_string(EdgeKind kind);

/// Poses to be estimated (nodes) and measured relative poses (edges), in space (`PoseGraph`) or in the plane
/// (`PoseGraph2`). All node poses are in one common frame, called world; robots that no edge links yet only
/// share its name.
///
/// Gauge: the node with the smallest key of each connected component is its anchor and keeps its pose.
template <class P>
struct BasicPoseGraph {
  /// Of one edge.
  using Information = Eigen::Matrix<double, P::kDof, P::kDof>;
  /// A pose to be estimated.
  struct Node {
    std::uint64_t key = 0;  ///< Unique. Keyframes use `graph_key`.
    P pose;                 ///< T_world_node: the guess that solvers start from.
  };
  /// A measured relative pose.
  struct Edge {
    std::size_t from = 0;  ///< Index into `nodes`, not a key.
    std::size_t to = 0;    ///< Different from `from`.
    P T_from_to;           ///< The measurement.
    Information information =
        Information::Identity();         ///< Inverse covariance of [translation; rotation], full.
    EdgeKind kind = EdgeKind::odometry;  ///< Trusted, or a loop.
  };
  std::vector<Node> nodes;  ///< In any order.
  std::vector<Edge> edges;  ///< In any order.

  /// Throws ContractViolation when an edge names a node that does not exist, or joins a node to itself.
  void check() const;
};
/// In space.
using PoseGraph = BasicPoseGraph<Pose>;
/// In the plane.
using PoseGraph2 = BasicPoseGraph<Pose2>;

/// The connected components of a graph, numbered in the order of their anchors' keys.
struct Components {
  std::vector<std::size_t> of_node;  ///< Component of each node.
  std::vector<std::size_t> anchors;  ///< Node index of each component's anchor: its smallest key.
};
/// `edge_weights`: one per edge (empty: all 1); edges of weight 0 connect nothing.
template <class P>
[[nodiscard]] Components connected_components(const BasicPoseGraph<P>& graph,
                                              const std::vector<double>& edge_weights = {});

/// A robot's path: nodes in the order in which it drove through them.
struct OdometryPath {
  std::vector<std::size_t> nodes;  ///< Node indices; at least one.
  std::vector<std::size_t> steps;  ///< Edge indices, one less: steps[k] leads from nodes[k] to nodes[k + 1].
};
/// The odometry edges as paths that contain every node once; a node without odometry is a path by itself.
/// Where several odometry edges leave or reach a node, the first one counts; a ring is cut open.
template <class P>
[[nodiscard]] std::vector<OdometryPath> odometry_paths(const BasicPoseGraph<P>& graph);

/// Poses T_world_node by composing edges outwards from the nodes whose pose is known, along as few loop edges
/// as possible, then as few edges as possible. A component without a known pose starts with its anchor at the
/// identity. Known poses are returned unchanged. `is_known`: one per node.
template <class P>
[[nodiscard]] std::vector<P> spanning_tree_poses(const BasicPoseGraph<P>& graph,
                                                 const std::vector<bool>& is_known);

/// The graph's poses as a list.
template <class P>
[[nodiscard]] std::vector<P> poses_of(const BasicPoseGraph<P>& graph) {
  std::vector<P> poses;
  poses.reserve(graph.nodes.size());
  for (const auto& node : graph.nodes) poses.push_back(node.pose);
  return poses;
}

}  // namespace adit
