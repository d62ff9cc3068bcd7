// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/pose_graph.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/disjoint_sets.hpp"

namespace adit {
namespace {

/// What a path costs: loops first, then hops; the node index breaks ties, so that the tree is always the same
/// one.
struct PathEnd {
  std::size_t loops;
  std::size_t hops;
  std::size_t node;
  auto operator<=>(const PathEnd&) const = default;
};
constexpr std::size_t kUnreached = std::numeric_limits<std::size_t>::max();

}  // namespace

std::string_view to_string(EdgeKind kind) { return kind == EdgeKind::odometry ? "odometry" : "loop"; }

template <class P>
void BasicPoseGraph<P>::check() const {
  for (const Edge& edge : edges) {
    ADIT_CHECK(edge.from < nodes.size() && edge.to < nodes.size(), "an edge joins nodes of its graph");
    ADIT_CHECK(edge.from != edge.to, "an edge joins two different nodes");
  }
}

template <class P>
Components connected_components(const BasicPoseGraph<P>& graph, const std::vector<double>& edge_weights) {
  const std::size_t n = graph.nodes.size();
  DisjointSets sets(n);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (edge_weights.empty() || edge_weights[e] > 0.0) sets.join(graph.edges[e].from, graph.edges[e].to);
  }
  std::vector<std::size_t> by_key(n);
  std::iota(by_key.begin(), by_key.end(), std::size_t{0});
  std::ranges::sort(by_key, {}, [&](std::size_t i) { return graph.nodes[i].key; });
  Components components{std::vector<std::size_t>(n), {}};
  std::vector<std::size_t> number(n, kUnreached);
  for (const std::size_t i : by_key) {
    std::size_t& component = number[sets.find(i)];
    if (component == kUnreached) {
      component = components.anchors.size();
      components.anchors.push_back(i);
    }
    components.of_node[i] = component;
  }
  return components;
}

template <class P>
std::vector<OdometryPath> odometry_paths(const BasicPoseGraph<P>& graph) {
  const std::size_t n = graph.nodes.size();
  std::vector<std::size_t> next(n, kUnreached);  // edge to the following node
  std::vector<bool> has_previous(n, false);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto& edge = graph.edges[e];
    if (edge.kind != EdgeKind::odometry || next[edge.from] != kUnreached || has_previous[edge.to]) continue;
    next[edge.from] = e;
    has_previous[edge.to] = true;
  }
  std::vector<OdometryPath> paths;
  std::vector<bool> is_taken(n, false);
  // Paths begin where nothing comes before; what then is left are rings, begun anywhere.
  for (const bool rings : {false, true}) {
    for (std::size_t start = 0; start < n; ++start) {
      if (is_taken[start] || (has_previous[start] && !rings)) continue;
      is_taken[start] = true;
      OdometryPath path{{start}, {}};
      for (std::size_t e = next[start]; e != kUnreached && !is_taken[graph.edges[e].to];) {
        const std::size_t node = graph.edges[e].to;
        is_taken[node] = true;
        path.nodes.push_back(node);
        path.steps.push_back(e);
        e = next[node];
      }
      paths.push_back(std::move(path));
    }
  }
  return paths;
}

template <class P>
std::vector<P> spanning_tree_poses(const BasicPoseGraph<P>& graph, const std::vector<bool>& is_known) {
  const std::size_t n = graph.nodes.size();
  ADIT_CHECK(is_known.size() == n, "one flag per node");
  graph.check();
  std::vector<std::vector<std::size_t>> edges_of(n);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    edges_of[graph.edges[e].from].push_back(e);
    edges_of[graph.edges[e].to].push_back(e);
  }
  const Components components = connected_components(graph);
  std::vector<bool> has_known(components.anchors.size(), false);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_known[i]) has_known[components.of_node[i]] = true;
  }
  std::vector<P> poses(n);
  std::vector<PathEnd> best(n, {kUnreached, kUnreached, 0});
  std::priority_queue<PathEnd, std::vector<PathEnd>, std::greater<>> queue;
  const auto start_at = [&](std::size_t node, const P& pose) {
    poses[node] = pose;
    best[node] = {0, 0, node};
    queue.push(best[node]);
  };
  for (std::size_t c = 0; c < components.anchors.size(); ++c) {
    if (!has_known[c]) start_at(components.anchors[c], P());
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (is_known[i]) start_at(i, graph.nodes[i].pose);
  }
  while (!queue.empty()) {
    const PathEnd end = queue.top();
    queue.pop();
    if (end != best[end.node]) continue;
    for (const std::size_t e : edges_of[end.node]) {
      const auto& edge = graph.edges[e];
      const bool forward = edge.from == end.node;
      const std::size_t next = forward ? edge.to : edge.from;
      const PathEnd longer{end.loops + (edge.kind == EdgeKind::loop ? 1U : 0U), end.hops + 1, next};
      if (longer >= best[next]) continue;
      best[next] = longer;
      poses[next] = poses[end.node] * (forward ? edge.T_from_to : edge.T_from_to.inverse());
      queue.push(longer);
    }
  }
  return poses;
}

template struct BasicPoseGraph<Pose>;
template struct BasicPoseGraph<Pose2>;
template Components connected_components(const PoseGraph&, const std::vector<double>&);
template Components connected_components(const PoseGraph2&, const std::vector<double>&);
template std::vector<OdometryPath> odometry_paths(const PoseGraph&);
template std::vector<OdometryPath> odometry_paths(const PoseGraph2&);
template std::vector<Pose> spanning_tree_poses(const PoseGraph&, const std::vector<bool>&);
template std::vector<Pose2> spanning_tree_poses(const PoseGraph2&, const std::vector<bool>&);

}  // namespace adit
