// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_log.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "adit/io/atomic_file.hpp"
#include "adit/io/g2o.hpp"

namespace adit {
namespace {

/// For each robot of a session its nodes, by the number of the keyframe.
using NodesOfRobots = std::vector<std::vector<std::size_t>>;

/// Graphs know robots by number, sessions by name: both in the order of their ids, without robots that have
/// no keyframes.
std::optional<NodesOfRobots> nodes_of_robots(const PoseGraph& graph, const SavedSession& session) {
  std::map<RobotId, std::map<std::uint32_t, std::size_t>> by_id;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    const KeyframeId id = keyframe_id(graph.nodes[n].key);
    by_id[id.robot][id.index] = n;
  }
  NodesOfRobots out(session.robots.size());
  auto own = by_id.begin();
  for (std::size_t robot = 0; robot < out.size(); ++robot) {
    if (session.optimized[robot].empty()) continue;
    if (own == by_id.end() || own->second.size() != session.optimized[robot].size()) return std::nullopt;
    for (const auto& [keyframe, node] : (own++)->second) out[robot].push_back(node);
  }
  return own == by_id.end() ? std::optional(out) : std::nullopt;
}

/// By the nodes that they join.
using Labels = std::map<std::pair<std::size_t, std::size_t>, JrlLabel>;

Labels labels_of(const SavedSession& session, const SessionEvaluation& evaluation,
                 const NodesOfRobots& nodes) {
  const auto node_of = [&](const std::string& name, Stamp stamp) -> std::optional<std::size_t> {
    const auto named = std::ranges::find(session.robots, name);
    if (named == session.robots.end()) return std::nullopt;
    const auto robot = static_cast<std::size_t>(named - session.robots.begin());
    const Trajectory& keyframes = session.optimized[robot];
    const auto at = std::ranges::find(keyframes, stamp, &StampedPose::stamp);
    if (at == keyframes.end()) return std::nullopt;
    return nodes[robot][static_cast<std::size_t>(at - keyframes.begin())];
  };
  Labels labels;
  for (std::size_t i = 0; i < session.loops.size(); ++i) {
    if (evaluation.loop_classes[i].empty()) continue;
    const auto from = node_of(session.loops[i].from_robot, session.loops[i].from_stamp);
    const auto to = node_of(session.loops[i].to_robot, session.loops[i].to_stamp);
    if (!from || !to) continue;
    const bool is_correct = evaluation.loop_classes[i] == to_string(LoopClass::correct);
    labels[{*from, *to}] = is_correct ? JrlLabel::inlier : JrlLabel::outlier;
  }
  return labels;
}

}  // namespace

Result<JrlFile> labelled_log(std::string name, const PoseGraph& graph, const SavedSession& session,
                             const SessionEvaluation& evaluation,
                             const std::vector<std::optional<Trajectory>>& truths) {
  const std::optional<NodesOfRobots> nodes = nodes_of_robots(graph, session);
  if (!nodes) return fail("the graph and the trajectories of the session do not belong together");
  const Labels labels = labels_of(session, evaluation, *nodes);
  PoseGraph judged{graph.nodes, {}};
  std::vector<JrlLabel> labels_of_edges;
  for (const PoseGraph::Edge& edge : graph.edges) {
    const auto label = labels.find({edge.from, edge.to});
    if (edge.kind == EdgeKind::loop && label == labels.end()) continue;
    judged.edges.push_back(edge);
    labels_of_edges.push_back(edge.kind == EdgeKind::loop ? label->second : JrlLabel::unlabelled);
  }
  return jrl_of(std::move(name), judged).map([&](JrlFile file) {
    auto& log = std::get<JrlGraph<Pose>>(file.content);
    log.labels = std::move(labels_of_edges);
    for (std::size_t robot = 0; robot < nodes->size(); ++robot) {
      if (!truths[robot]) continue;
      for (std::size_t k = 0; k < (*nodes)[robot].size(); ++k)
        if (const Result<Pose> truth = pose_at(*truths[robot], session.optimized[robot][k].stamp))
          log.truth[(*nodes)[robot][k]] = *truth;
    }
    return file;
  });
}

Result<> write_labelled_log(const std::filesystem::path& path, const std::filesystem::path& folder,
                            const SavedSession& session, const SessionEvaluation& evaluation,
                            const std::vector<std::optional<Trajectory>>& truths) {
  const std::filesystem::path graph_file = folder / "graph_initial.g2o";
  const Result<G2oFile> graph = read_g2o(graph_file);
  if (!graph) return tl::unexpected(graph.error());
  const auto* in_space = std::get_if<PoseGraph>(&graph->graph);
  if (!in_space) return fail(graph_file.string() + ": is of poses in the plane, which no session has");
  const Result<std::string> text =
      labelled_log(path.stem().string(), *in_space, session, evaluation, truths).and_then(jrl_text);
  if (!text) return fail(graph_file.string(), text.error());
  return write_bytes(path, *text);
}

}  // namespace adit
