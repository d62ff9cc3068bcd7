// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/graph_judgement.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/disjoint_sets.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/ate.hpp"

namespace adit {
namespace {

Pose in_space(const Pose& T) { return T; }
Pose in_space(const Pose2& T) { return Pose::planar(T.translation().x(), T.translation().y(), T.theta()); }

struct Paths {
  std::vector<Trajectory> estimates;
  std::vector<Trajectory> truths;
};

/// The poses with a truth, a second apart, one path per robot.
template <class P>
Paths paths_of(const JrlGraph<P>& jrl, std::size_t num_robots, const std::vector<P>& poses) {
  Paths paths{std::vector<Trajectory>(num_robots), std::vector<Trajectory>(num_robots)};
  for (std::size_t i = 0; i < jrl.graph.nodes.size(); ++i) {
    if (!jrl.truth[i]) continue;
    Trajectory& estimate = paths.estimates[jrl.robot_of_node[i]];
    const Stamp stamp = Stamp{} + std::chrono::seconds(estimate.size());
    estimate.push_back({stamp, in_space(poses[i])});
    paths.truths[jrl.robot_of_node[i]].push_back({stamp, in_space(*jrl.truth[i])});
  }
  return paths;
}

/// Over the robots listed; none where one of them has no truth, or too little to be aligned.
std::optional<PositionError> error_of(const Paths& paths, const std::vector<std::size_t>& robots) {
  std::vector<Trajectory> estimates;
  std::vector<Trajectory> truths;
  for (const std::size_t r : robots) {
    if (paths.estimates[r].empty()) return std::nullopt;
    estimates.push_back(paths.estimates[r]);
    truths.push_back(paths.truths[r]);
  }
  const auto results = joint_ate(estimates, truths);
  if (!results) return std::nullopt;
  PositionError error;
  double sum = 0.0;
  std::size_t number = 0;
  for (const AteResult& result : *results) {
    error.max_m = std::max(error.max_m, result.max_m);
    sum += result.rmse_m * result.rmse_m * static_cast<double>(result.errors_m.size());
    number += result.errors_m.size();
  }
  error.rmse_m = std::sqrt(sum / static_cast<double>(number));
  return error;
}

/// Robots whose nodes the edges in use, or priors, join.
template <class P>
std::vector<std::vector<std::size_t>> maps_of(const JrlGraph<P>& jrl, std::size_t num_robots,
                                              const std::vector<double>& weights) {
  DisjointSets sets(num_robots);
  for (std::size_t e = 0; e < jrl.graph.edges.size(); ++e) {
    const auto& edge = jrl.graph.edges[e];
    if (weights[e] >= 0.5) sets.join(jrl.robot_of_node[edge.from], jrl.robot_of_node[edge.to]);
  }
  for (const auto& prior : jrl.priors)
    sets.join(jrl.robot_of_node[jrl.priors.front().node], jrl.robot_of_node[prior.node]);
  std::vector<std::vector<std::size_t>> maps;
  for (std::size_t r = 0; r < num_robots; ++r) {
    const auto same =
        std::ranges::find_if(maps, [&](const auto& map) { return sets.find(map.front()) == sets.find(r); });
    if (same == maps.end())
      maps.push_back({r});
    else
      same->push_back(r);
  }
  return maps;
}

template <class P>
std::optional<LoopScore> score_of(const JrlGraph<P>& jrl, const std::vector<double>& weights) {
  LoopScore score;
  bool has_labels = false;
  for (std::size_t e = 0; e < jrl.graph.edges.size(); ++e) {
    if (jrl.labels[e] == JrlLabel::unlabelled) continue;
    has_labels = true;
    if (jrl.graph.edges[e].kind == EdgeKind::loop)
      score.add(jrl.labels[e] == JrlLabel::inlier, weights[e] >= 0.5);
  }
  return has_labels ? std::optional(score) : std::nullopt;
}

std::string error_text(const std::optional<PositionError>& error) {
  return error ? format("ATE {:.3f} m RMSE, {:.3f} m at most", error->rmse_m, error->max_m)
               : std::string("no ground truth to compare with");
}

}  // namespace

template <class P>
GraphJudgement judged(const JrlGraph<P>& jrl, const std::vector<std::string>& robots,
                      const Solution<P>& solution) {
  GraphJudgement out;
  out.loops = score_of(jrl, solution.edge_weights);
  const Paths paths = paths_of(jrl, robots.size(), solution.poses);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const auto num_poses = static_cast<std::size_t>(std::ranges::count(jrl.robot_of_node, r));
    out.robots.push_back({robots[r], num_poses, error_of(paths, {r})});
  }
  for (const std::vector<std::size_t>& map : maps_of(jrl, robots.size(), solution.edge_weights)) {
    out.maps.push_back({{}, error_of(paths, map)});
    for (const std::size_t r : map) out.maps.back().robots.push_back(robots[r]);
  }
  return out;
}

std::vector<std::string> sentences(const GraphJudgement& judgement) {
  std::vector<std::string> lines;
  if (const auto& loops = judgement.loops) {
    const auto percent = [](const std::optional<double>& share) {
      return share ? format("{:.1f} %", 100.0 * *share) : std::string("undefined");
    };
    lines.push_back(
        format("loops by their labels: precision {}, recall {} ({} of {} true kept, {} of {} false kept)",
               percent(loops->precision()), percent(loops->recall()), loops->true_kept, loops->num_true(),
               loops->false_kept, loops->num_false()));
  }
  for (const GraphJudgement::Robot& robot : judgement.robots)
    lines.push_back(format("robot {}: {} poses, {}", robot.name, robot.num_poses, error_text(robot.error)));
  if (judgement.robots.size() < 2) return lines;
  for (const GraphJudgement::Map& map : judgement.maps) {
    std::string names;
    for (const std::string& robot : map.robots) names += (names.empty() ? "" : ", ") + robot;
    lines.push_back(map.robots.size() > 1 ? format("one map of {}: {}", names, error_text(map.error))
                                          : format("{} is joined to no other robot", names));
  }
  return lines;
}

template GraphJudgement judged(const JrlGraph<Pose>& jrl, const std::vector<std::string>& robots,
                               const Solution<Pose>& solution);
template GraphJudgement judged(const JrlGraph<Pose2>& jrl, const std::vector<std::string>& robots,
                               const Solution<Pose2>& solution);

}  // namespace adit
