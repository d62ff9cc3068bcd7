// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_log.hpp"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "support/files.hpp"

namespace adit {
namespace {

Stamp at_second(int s) { return Stamp{1'000'000'000LL * s}; }

/// A keyframe a second and metre along y = `lane`.
Trajectory driven_along(double lane, int num) {
  Trajectory path;
  for (int k = 0; k < num; ++k) path.push_back({at_second(k), Pose::translation_of(k, lane, 0)});
  return path;
}

SavedLoop loop_to_cy(int from, int to) {
  SavedLoop saved;
  saved.from_robot = "ada";
  saved.to_robot = "cy";
  saved.from_stamp = at_second(from);
  saved.to_stamp = at_second(to);
  saved.loop.T_from_to = Pose::translation_of(0, 2, 0);
  saved.loop.verdict = LoopVerdict::accepted;
  return saved;
}

/// Three robots, of which the second has no keyframe; a correct loop, one of another place, one beyond what
/// is known to be true.
struct LoggedSession {
  LoggedSession() {
    session.robots = {"ada", "bo", "cy"};
    session.components = {{"ada", "cy"}, {"bo"}};
    session.optimized = {driven_along(0.0, 20), {}, driven_along(2.0, 30)};
    session.odometry = session.optimized;
    session.loops = {loop_to_cy(3, 3), loop_to_cy(0, 19), loop_to_cy(4, 29)};
    truths = {driven_along(0.0, 20), std::nullopt, driven_along(2.0, 25)};
    for (const auto& [robot, num] : {std::pair(0, 20U), {2, 30U}})
      for (std::uint32_t k = 0; k < num; ++k) {
        const KeyframeId id{{static_cast<std::uint8_t>(robot)}, k};
        graph.nodes.push_back({graph_key(id), Pose::translation_of(k, robot, 0)});
        if (k > 0)
          graph.edges.push_back(
              {graph.nodes.size() - 2, graph.nodes.size() - 1, Pose::translation_of(1, 0, 0)});
      }
    for (const SavedLoop& saved : session.loops)
      graph.edges.push_back({static_cast<std::size_t>(saved.from_stamp.ns / 1'000'000'000),
                             20U + static_cast<std::size_t>(saved.to_stamp.ns / 1'000'000'000),
                             saved.loop.T_from_to, Matrix6::Identity(), EdgeKind::loop});
  }
  SavedSession session;
  PoseGraph graph;
  std::vector<std::optional<Trajectory>> truths;
};

TEST(SessionLog, HasTheTruthAndTheLabelsOfLoops) {
  const LoggedSession c;
  const Result<SessionEvaluation> evaluation = evaluate(c.session, c.truths);
  ASSERT_TRUE(evaluation.has_value()) << evaluation.error().message;
  const Result<JrlFile> file = labelled_log("two", c.graph, c.session, *evaluation, c.truths);
  ASSERT_TRUE(file.has_value()) << file.error().message;
  // As others read it.
  const Result<std::string> text = jrl_text(*file);
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const Result<JrlFile> back = parse_jrl(*text, "two.jrl");
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->robots, (std::vector<std::string>{"a", "c"}));
  const auto& log = std::get<JrlGraph<Pose>>(back->content);
  ASSERT_EQ(log.graph.nodes.size(), 50U);
  for (std::size_t n = 0; n < 50; ++n) {
    const KeyframeId id = keyframe_id(log.graph.nodes[n].key);
    ASSERT_EQ(log.truth[n].has_value(), id.robot.value == 0 || id.index < 25) << n;
    if (!log.truth[n]) continue;
    EXPECT_EQ(log.truth[n]->translation(), Vector3(id.index, id.robot.value == 0 ? 0.0 : 2.0, 0.0));
  }
  std::map<std::uint32_t, JrlLabel> by_first_keyframe;
  for (std::size_t e = 0; e < log.graph.edges.size(); ++e)
    if (log.graph.edges[e].kind == EdgeKind::loop)
      by_first_keyframe[keyframe_id(log.graph.nodes[log.graph.edges[e].from].key).index] = log.labels[e];
  EXPECT_EQ(by_first_keyframe,
            (std::map<std::uint32_t, JrlLabel>{{3, JrlLabel::inlier}, {0, JrlLabel::outlier}}))
      << "a loop of which nobody knows whether it is true would count as true";
}

TEST(SessionLog, TheGraphOfAnotherSessionIsRefused) {
  const LoggedSession c;
  const Result<SessionEvaluation> evaluation = evaluate(c.session, c.truths);
  ASSERT_TRUE(evaluation.has_value());
  PoseGraph fewer = c.graph;
  fewer.nodes.pop_back();
  fewer.edges.pop_back();
  EXPECT_ERROR(labelled_log("two", fewer, c.session, *evaluation, c.truths), "do not belong together");
}

}  // namespace
}  // namespace adit
