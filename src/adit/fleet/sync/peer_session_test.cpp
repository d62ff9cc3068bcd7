// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/peer_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace adit {
namespace {

constexpr RobotId kPeer{1};

Places part_of(std::uint32_t first, const std::vector<std::uint32_t>& keyframes, bool last) {
  Places part;
  part.first = first;
  for (const std::uint32_t k : keyframes) part.places.push_back({k, {}});
  part.last = last;
  return part;
}

Clouds clouds_of(const std::vector<std::uint32_t>& keyframes, CloudKind kind) {
  Clouds clouds;
  clouds.kind = kind;
  for (const std::uint32_t k : keyframes) clouds.clouds.push_back({k, Eigen::Vector3f::Zero(), {}});
  return clouds;
}

LoopCandidate candidate_of_peer(std::uint32_t own, std::uint32_t theirs) {
  return {{{0}, own}, {kPeer, theirs}, 0.0, 0.1};
}

Hello hello_with(std::uint32_t num_nodes) {
  Hello hello;
  hello.known.push_back({kPeer, num_nodes, 0, 0, 0});
  return hello;
}

PeerSession after_hello(std::uint32_t num_nodes) {
  PeerSession session;
  EXPECT_TRUE(session.hear(hello_with(num_nodes), kPeer));
  return session;
}

TEST(PeerSession, GoesFromGreetingToDecided) {
  PeerSession session = after_hello(100);
  EXPECT_EQ(session.state(), PeerState::greeting);
  ASSERT_TRUE(session.take(part_of(0, {3, 4}, false)));
  EXPECT_EQ(session.state(), PeerState::receiving_places);
  ASSERT_TRUE(session.take(part_of(2, {5}, true)));
  EXPECT_EQ(session.state(), PeerState::awaiting_path);
  EXPECT_FALSE(session.lie_within(5));
  EXPECT_TRUE(session.lie_within(6));
  EXPECT_EQ(session.places().size(), 3U);
  EXPECT_EQ(session.state(), PeerState::awaiting_path) << "the search may be broken off";
  session.finish_search();
  EXPECT_TRUE(session.places().empty());
  EXPECT_EQ(session.state(), PeerState::decided) << "searched, and nothing was found";
  session.await_clouds_of({candidate_of_peer(7, 4), candidate_of_peer(8, 4), candidate_of_peer(9, 5)});
  EXPECT_EQ(session.state(), PeerState::awaiting_clouds);
  EXPECT_EQ(session.num_waiting(), 3U);
  EXPECT_EQ(session.request()->indices, (std::vector<std::uint32_t>{4, 5}));
  const auto arrived = session.arrived(clouds_of({4, 5, 4}, CloudKind::submap));
  EXPECT_EQ(arrived.size(), 3U) << "each once, though a cloud came twice";
  EXPECT_EQ(session.num_waiting(), 3U) << "registration may be broken off";
  session.finish_registration(arrived);
  EXPECT_EQ(session.num_waiting(), 0U);
  session.await_comparison_of({10, 20});
  EXPECT_EQ(session.state(), PeerState::comparing);
  session.take_views(clouds_of({10, 20}, CloudKind::submap));
  EXPECT_FALSE(session.has_comparison()) << "late clouds of candidates";
  EXPECT_EQ(session.request()->indices, (std::vector<std::uint32_t>{10, 20}));
  session.take_views(clouds_of({10, 30}, CloudKind::view));
  EXPECT_FALSE(session.has_comparison());
  EXPECT_EQ(session.request()->indices, std::vector<std::uint32_t>{20});
  session.take_views(clouds_of({20}, CloudKind::view));
  EXPECT_TRUE(session.has_comparison());
  session.await_comparison_of({20, 30});
  EXPECT_EQ(session.request()->indices, std::vector<std::uint32_t>{30})
      << "20 has come, 30 was not asked for";
  session.await_comparison_of({});
  EXPECT_TRUE(session.views().empty()) << "nothing is kept beyond the check";
  EXPECT_EQ(session.state(), PeerState::decided);
  EXPECT_FALSE(session.request());
}

TEST(PeerSession, RepeatedAndLostPlacesAreNoticed) {
  PeerSession session = after_hello(100);
  EXPECT_FALSE(session.take(part_of(2, {5}, true))) << "a part before it was lost";
  EXPECT_EQ(session.num_places(), 0U);
  ASSERT_TRUE(session.take(part_of(0, {3, 4}, true)));
  ASSERT_TRUE(session.take(part_of(0, {3, 4}, true)));
  EXPECT_EQ(session.num_places(), 2U);
  EXPECT_EQ(session.places().size(), 2U);
  session.finish_search();
  EXPECT_TRUE(session.is_searched());
  ASSERT_TRUE(session.take(part_of(0, {3, 4}, true)));
  EXPECT_FALSE(session.has_all_places()) << "what was searched is not searched again";
}

TEST(PeerSession, ForgottenPlacesAreAskedForAgain) {
  PeerSession session = after_hello(100);
  ASSERT_TRUE(session.take(part_of(0, {3, 4}, true)));
  session.forget_places();
  EXPECT_EQ(session.num_places(), 0U);
  EXPECT_EQ(session.state(), PeerState::greeting);
}

TEST(PeerSession, KeepsABoundedNumberOfViewsAndAllThatAreAwaited) {
  PeerSession session;
  std::size_t most = 0;
  for (std::uint32_t first = 0; first < 2000; first += 16) {
    std::vector<std::uint32_t> keyframes(16);
    std::iota(keyframes.begin(), keyframes.end(), first);
    session.await_comparison_of(keyframes);
    session.take_views(clouds_of(keyframes, CloudKind::view));
    session.await_comparison_of(keyframes);
    ASSERT_TRUE(session.has_comparison());
    most = std::max(most, session.views().size());
  }
  EXPECT_GT(most, 100U);
  EXPECT_LE(most, 600U);
  session.forget_views();
  EXPECT_TRUE(session.has_comparison());
  EXPECT_EQ(session.views().size(), 16U);
}

TEST(PeerSession, ASubmapIsNotTakenForTheViewThatIsAwaited) {
  PeerSession session = after_hello(100);
  session.await_comparison_of({3});
  ASSERT_TRUE(session.request());
  EXPECT_EQ(session.request()->kind, CloudKind::view);
  session.take_views(clouds_of({3}, CloudKind::submap));
  EXPECT_FALSE(session.has_comparison());
  session.take_views(clouds_of({3}, CloudKind::view));
  EXPECT_TRUE(session.has_comparison());
}

TEST(PeerSession, WhatThePeerDoesNotHaveBlocksNothing) {
  PeerSession session;
  session.hear(hello_with(10), kPeer);
  ASSERT_TRUE(session.take(part_of(0, {3, 4'000'000'000U}, true)));
  EXPECT_TRUE(session.lie_within(10)) << "no graph will ever have the second one";
  EXPECT_EQ(session.places().size(), 1U);

  session.await_clouds_of({candidate_of_peer(1, 3), candidate_of_peer(2, 11)});
  session.hear(hello_with(10), kPeer);
  EXPECT_EQ(session.request()->indices, std::vector<std::uint32_t>{3});
}

TEST(PeerSession, AsksForABoundedNumberOfCloudsAtATime) {
  PeerSession session;
  std::vector<LoopCandidate> candidates;
  for (std::uint32_t k = 0; k < 40; ++k) candidates.push_back(candidate_of_peer(k, k));
  session.await_clouds_of(candidates);
  EXPECT_EQ(session.request()->indices.size(), kCloudsPerMessage);
}

TEST(PeerSession, TakesNoMorePlacesThanThePeerHasKeyframes) {
  PeerSession session;
  EXPECT_FALSE(session.is_whole(1'000'000)) << "the peer has not said how many there are";
  session.hear(hello_with(3), kPeer);
  EXPECT_TRUE(session.is_whole(3));
  EXPECT_FALSE(session.is_whole(2));
  ASSERT_TRUE(session.take(part_of(0, {0, 1}, false)));
  EXPECT_FALSE(session.take(part_of(2, {2, 2}, false)));
  EXPECT_EQ(session.num_places(), 2U);
  ASSERT_TRUE(session.take(part_of(2, {2}, true)));
  EXPECT_EQ(session.places().size(), 3U);
}

TEST(PeerSession, TakesNoPlacesBeforeAHelloAndNotAnyNumberAfterIt) {
  PeerSession session;
  EXPECT_FALSE(session.take(part_of(0, {0, 1}, false)));
  EXPECT_EQ(session.state(), PeerState::greeting);
  session = after_hello(4'000'000'000U);  // the peer's own word
  session.restore_searched(kKeyframesPerRobot - 1);
  ASSERT_TRUE(session.take(part_of(kKeyframesPerRobot - 1, {7}, false)));
  EXPECT_FALSE(session.take(part_of(kKeyframesPerRobot, {8}, false)));
}

TEST(PeerSession, AComparisonOfWhatThePeerHasNoLongerIsGivenUp) {
  PeerSession session = after_hello(100);
  session.await_comparison_of({10, 70});
  session.take_views(clouds_of({10}, CloudKind::view));
  EXPECT_TRUE(session.hear(hello_with(71), kPeer));
  EXPECT_EQ(session.state(), PeerState::comparing);
  EXPECT_FALSE(session.hear(hello_with(50), kPeer));
  EXPECT_EQ(session.state(), PeerState::greeting) << "70 would be awaited for ever";
  EXPECT_TRUE(session.views().empty());
  EXPECT_FALSE(session.request());
  EXPECT_TRUE(session.hear(hello_with(50), kPeer));
}

}  // namespace
}  // namespace adit
