// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/fleet_ledger.hpp"

#include <gtest/gtest.h>

#include <variant>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr RobotId kSelf{1};
constexpr RobotId kOther{0};

RobotGraph graph_with(std::size_t num_nodes) {
  GraphNode node;
  node.step_covariance = Matrix6::Identity() * 0.01;
  return {"robot", std::vector<GraphNode>(num_nodes, node)};
}

LoopClosure loop(KeyframeId from, KeyframeId to) {
  LoopClosure out;
  out.from = from;
  out.to = to;
  return out;
}

MergeCheck check(RobotId a, RobotId b) {
  MergeCheck out;
  out.a = a;
  out.b = b;
  return out;
}

Hello hello_of(const FleetLedger& ledger) {
  Hello hello;
  for (const auto& [robot, known] : ledger.summary()) hello.known.push_back(known);
  return hello;
}

void tell(FleetLedger& to, const std::vector<MessageBody>& news) {
  for (const MessageBody& body : news)
    std::visit(
        [&](const auto& part) {
          if constexpr (requires { to.take(part); }) {
            EXPECT_TRUE(to.take(part));
          }
        },
        body);
}

TEST(FleetLedger, NewsTellAllThatIsNotKnownAndNothingTwice) {
  FleetLedger one(kSelf, graph_with(kNodesPerMessage + 3), MergePolicy::adaptive);
  one.add_own(loop({kSelf, 2}, {{2}, 5}));
  one.add_own(loop({kSelf, 2}, {{2}, 5}));  // known already
  for (int i = 0; i < 20; ++i) one.add_own(check(kSelf, {2}));
  EXPECT_EQ(one.num_own_loops(), 1U);

  FleetLedger other(kOther, graph_with(2), MergePolicy::adaptive);
  const std::vector<MessageBody> news = one.news_for(kOther, hello_of(other));
  EXPECT_EQ(news.size(), 2U + 1U + 2U) << "graph in two parts, loops, checks in two parts";
  tell(other, news);
  EXPECT_EQ(other.num_nodes_of(kSelf), kNodesPerMessage + 3);
  EXPECT_EQ(other.known().loops.size(), 1U);
  EXPECT_EQ(other.known().checks.size(), 1U);
  EXPECT_TRUE(one.news_for(kOther, hello_of(other)).empty());
}

TEST(FleetLedger, IsRestoredFromAllFindingsItsOwnToo) {
  FleetLedger saved(kSelf, graph_with(3), MergePolicy::adaptive);
  for (std::uint32_t i = 0; i < kLoopsPerMessage + 5; ++i) saved.add_own(loop({kSelf, 2}, {{2}, i}));
  saved.add_own(check(kSelf, {2}));
  EXPECT_TRUE(saved.take(Loops{kOther, 0, {loop({kOther, 1}, {kSelf, 0})}}));
  EXPECT_TRUE(saved.take(MergeChecks{kOther, 0, {check(kOther, kSelf)}}));

  for (const RobotId self : {kSelf, kOther}) {
    FleetLedger ledger(self, graph_with(3), MergePolicy::adaptive);
    for (const MessageBody& finding : saved.findings()) EXPECT_TRUE(ledger.restore(finding));
    EXPECT_EQ(ledger.known().loops.size(), saved.known().loops.size());
    EXPECT_EQ(ledger.known().checks.size(), 2U);
    EXPECT_EQ(ledger.num_own_loops(), self == kSelf ? kLoopsPerMessage + 5 : 1U);
    EXPECT_EQ(ledger.num_own_checks(), 1U);
    EXPECT_FALSE(ledger.restore(GraphPart{kOther, "no finding", 0, {}}));
  }
}

TEST(FleetLedger, AnOverruledCheckIsTheLatest) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  EXPECT_TRUE(ledger.take(MergeChecks{kOther, 0, {check(kOther, kSelf)}}));
  MergeCheck overruled = check(kOther, kSelf);
  overruled.accepted = true;
  ledger.overrule(overruled);
  EXPECT_TRUE(ledger.known().checks.at({kOther, kSelf}).accepted);
  FleetLedger later(kSelf, graph_with(1), MergePolicy::adaptive);
  for (const MessageBody& finding : ledger.findings()) EXPECT_TRUE(later.restore(finding));
  EXPECT_TRUE(later.known().checks.at({kOther, kSelf}).accepted);
  EXPECT_THROW(ledger.overrule(check(kSelf, kOther)), ContractViolation);
}

TEST(FleetLedger, PartsAfterALostOneWaitForIt) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  EXPECT_FALSE(ledger.take(GraphPart{kOther, "late", 2, graph_with(2).nodes}));
  EXPECT_FALSE(ledger.take(Loops{kOther, 1, {loop({kOther, 1}, {kSelf, 0})}}));
  EXPECT_FALSE(ledger.take(MergeChecks{kOther, 1, {check(kOther, kSelf)}}));
  EXPECT_TRUE(ledger.known().loops.empty());
  EXPECT_TRUE(ledger.known().checks.empty());
  EXPECT_FALSE(ledger.known().robots.contains(kOther));
}

TEST(FleetLedger, RefusesWhatIsNotTheAuthorsAndWhatIsAboutItself) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  EXPECT_FALSE(ledger.take(GraphPart{kSelf, "me", 0, graph_with(5).nodes}));
  EXPECT_FALSE(ledger.take(Loops{kSelf, 0, {loop({kSelf, 1}, {{2}, 0})}}));
  EXPECT_FALSE(ledger.take(Loops{kOther, 0, {loop({kSelf, 1}, {{2}, 0})}}));
  EXPECT_FALSE(ledger.take(Loops{kOther, 0, {loop({kOther, 1}, {kOther, 1})}})) << "a loop to itself";
  EXPECT_FALSE(ledger.take(MergeChecks{kOther, 0, {check(kSelf, {2})}}));
  EXPECT_EQ(ledger.num_nodes_of(kSelf), 1U);
  EXPECT_EQ(ledger.num_own_loops(), 0U);
}

TEST(FleetLedger, RefusesWhatTheSolverCouldNotInvert) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  Matrix6 indefinite = Matrix6::Identity();
  indefinite(2, 2) = -1.0;
  const Matrix6 tiny = Matrix6::Identity() * 1e-310;  // with an infinite inverse
  for (const Matrix6& matrix : {Matrix6(Matrix6::Zero()), indefinite, tiny}) {
    GraphNode node;
    node.step_covariance = matrix;
    EXPECT_FALSE(ledger.take(GraphPart{kOther, "odd", 0, {node, node}}));
  }
  EXPECT_FALSE(ledger.known().robots.contains(kOther));
  LoopClosure rejected = loop({kOther, 1}, {kSelf, 0});
  rejected.information = Matrix6::Zero();
  EXPECT_TRUE(ledger.take(Loops{kOther, 0, {rejected}})) << "that it was tried is told to all";
}

TEST(FleetLedger, AnAcceptedLoopThatTheSolverCouldNotUseIsKeptAsRejectedAndSilencesNobody) {
  const Matrix6 tiny = Matrix6::Identity() * 1e-310;  // with an infinite inverse
  for (const Matrix6& matrix : {Matrix6(Matrix6::Zero()), tiny}) {
    LoopClosure odd = loop({kOther, 1}, {kSelf, 0});
    odd.information = matrix;
    odd.verdict = LoopVerdict::accepted;
    LoopClosure sound = loop({kOther, 2}, {kSelf, 0});
    sound.information = Matrix6::Identity();
    sound.verdict = LoopVerdict::accepted;
    FleetLedger received(kSelf, graph_with(1), MergePolicy::adaptive);
    EXPECT_TRUE(received.take(Loops{kOther, 0, {odd}}));
    EXPECT_TRUE(received.take(Loops{kOther, 1, {sound}}));
    FleetLedger restored(kOther, graph_with(1), MergePolicy::adaptive);
    EXPECT_TRUE(restored.restore(Loops{kOther, 0, {odd, sound}}));
    FleetLedger own(kOther, graph_with(1), MergePolicy::adaptive);
    own.add_own(odd);
    own.add_own(sound);
    for (const FleetLedger* ledger : {&received, &restored, &own}) {
      const LoopClosure& kept = ledger->known().loops.at({odd.from, odd.to});
      EXPECT_EQ(kept.verdict, LoopVerdict::rejected);
      EXPECT_NE(kept.reason.find("inverse"), std::string::npos);
      EXPECT_EQ(ledger->known().loops.at({sound.from, sound.to}).verdict, LoopVerdict::accepted);
    }
  }
}

TEST(FleetLedger, TakesNoMoreOfOneRobotThanItsBounds) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  const std::vector<GraphNode> nodes = graph_with(kNodesPerMessage).nodes;
  const auto send_nodes = [&](std::size_t first) {
    return ledger.take(GraphPart{kOther, "big", static_cast<std::uint32_t>(first), nodes});
  };
  std::size_t first = 0;
  for (; first + kNodesPerMessage <= kKeyframesPerRobot; first += kNodesPerMessage)
    ASSERT_TRUE(send_nodes(first));
  EXPECT_FALSE(send_nodes(first));
  EXPECT_EQ(ledger.num_nodes_of(kOther), first);

  std::vector<MergeCheck> checks(kChecksPerMessage, check(kOther, kSelf));
  first = 0;
  for (; first + kChecksPerMessage <= kChecksPerRobot; first += kChecksPerMessage)
    ASSERT_TRUE(ledger.take(MergeChecks{kOther, static_cast<std::uint32_t>(first), checks}));
  EXPECT_FALSE(ledger.take(MergeChecks{kOther, static_cast<std::uint32_t>(first), checks}));
  EXPECT_EQ(ledger.summary().at(kOther).num_checks, kChecksPerRobot);
  MergeCheck overruled = check(kOther, kSelf);
  overruled.accepted = true;
  ledger.overrule(overruled);
  EXPECT_TRUE(ledger.known().checks.at({kOther, kSelf}).accepted) << "a person still decides";

  const RobotId third{2};
  const auto send_loops = [&](std::uint32_t at) {
    Loops part{third, at, {}};
    for (std::uint32_t l = at; l < at + kLoopsPerMessage; ++l)
      part.loops.push_back(loop({third, l}, {{3}, 0}));
    return ledger.take(part);
  };
  std::uint32_t at = 0;
  for (; at + kLoopsPerMessage <= kLoopsPerRobot; at += kLoopsPerMessage) ASSERT_TRUE(send_loops(at));
  EXPECT_FALSE(send_loops(at));
}

TEST(FleetLedger, TakesNoTextsAndChecksOfAnyLength) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  const std::string endless(kBytesPerText + 1, 'a');
  EXPECT_FALSE(ledger.take(GraphPart{kOther, endless, 0, graph_with(1).nodes}));
  LoopClosure wordy = loop({kOther, 1}, {kSelf, 0});
  wordy.reason = endless;
  EXPECT_FALSE(ledger.take(Loops{kOther, 0, {wordy}}));
  MergeCheck of_words = check(kOther, kSelf);
  of_words.reason = endless;
  EXPECT_FALSE(ledger.take(MergeChecks{kOther, 0, {of_words}}));
  MergeCheck of_loops = check(kOther, kSelf);
  of_loops.hypotheses.emplace_back().loops.resize(kItemsPerCheck);
  EXPECT_TRUE(ledger.take(MergeChecks{kOther, 0, {of_loops}}));
  of_loops.hypotheses.back().places.resize(1);
  EXPECT_FALSE(ledger.take(MergeChecks{kOther, 1, {of_loops}}));
}

TEST(FleetLedger, ALoopThatIsRepeatedIsListedOnce) {
  FleetLedger ledger(kSelf, graph_with(1), MergePolicy::adaptive);
  const LoopClosure first = loop({kOther, 1}, {kSelf, 0});
  const LoopClosure second = loop({kOther, 2}, {kSelf, 0});
  EXPECT_TRUE(ledger.take(Loops{kOther, 0, {first, first}}));
  EXPECT_TRUE(ledger.take(Loops{kOther, 1, {first, second}}));
  EXPECT_EQ(ledger.known().loops.size(), 2U);
  EXPECT_EQ(ledger.summary().at(kOther).num_loops, 2U);
}

}  // namespace
}  // namespace adit
