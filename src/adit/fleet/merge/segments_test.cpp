// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr std::uint32_t kKeyframes = 400;  // keyframes, half a metre apart

OdometryChain chain_of(const std::vector<Pose>& poses) {
  return {poses, std::vector<Matrix6>(poses.size() - 1, Matrix6::Identity() * 1e-4)};
}

OdometryChain along_x() {
  std::vector<Pose> poses;
  for (std::uint32_t k = 0; k < kKeyframes; ++k) poses.push_back(Pose::translation_of(0.5 * k, 0, 0));
  return chain_of(poses);
}

LoopCandidate candidate(std::uint32_t query, std::uint32_t match, double yaw = 0.0, double distance = 0.3) {
  return {{{0}, query}, {{1}, match}, yaw, distance};
}

/// For every keyframe one that it does not see again.
std::vector<LoopCandidate> anywhere(std::uint64_t seed) {
  Rng rng(seed);
  std::vector<LoopCandidate> found;
  for (std::uint32_t k = 0; k < kKeyframes; ++k)
    found.push_back(candidate(k, static_cast<std::uint32_t>(rng.uniform(0.0, kKeyframes - 1.0)),
                              rng.uniform() < 0.5 ? 0.0 : std::numbers::pi, 0.1));
  return found;
}

bool operator==(const LoopCandidate& a, const LoopCandidate& b) {
  return a.query == b.query && a.match == b.match && a.yaw == b.yaw && a.distance == b.distance;
}

TEST(AgreeingSegments, FindTheStretchAmongBetterLooksAnywhereElse) {
  std::vector<LoopCandidate> found = anywhere(1);
  for (std::uint32_t k = 200; k < 280; k += 2) found.push_back(candidate(k, k - 150));  // 40 m
  const std::vector<Segment> segments = agreeing_segments(along_x(), along_x(), found, {5});
  ASSERT_EQ(segments.size(), 5U);
  EXPECT_GE(segments[0].support_m, 39.0);
  EXPECT_LE(segments[0].support_m, 60.0);  // some of those anywhere happen to agree
  EXPECT_LT(segments[1].support_m, 0.7 * segments[0].support_m);
  const auto is_true = [](const LoopCandidate& c) { return c.match.index + 150 == c.query.index; };
  EXPECT_GE(std::ranges::count_if(segments[0].candidates, is_true), 10);
  EXPECT_TRUE(std::ranges::is_sorted(segments[0].candidates, {}, &LoopCandidate::distance));
  for (std::size_t s = 1; s < segments.size(); ++s)
    EXPECT_GE(segments[s - 1].support_m, segments[s].support_m);
}

TEST(AgreeingSegments, HoldAgainstTheDriveAndRoundABend) {
  // Up a street, and back down it after a turn; the other robot came the other way.
  std::vector<Pose> there;
  for (std::uint32_t k = 0; k < 100; ++k) there.push_back(Pose::planar(0.5 * k, 0, 0));
  for (std::uint32_t k = 0; k < 100; ++k)
    there.push_back(Pose::planar(50.0, 0.5 * k, 0.5 * std::numbers::pi));
  std::vector<Pose> back;
  for (auto pose = there.rbegin(); pose != there.rend(); ++pose)
    back.push_back(*pose * Pose::planar(0.0, 0.0, std::numbers::pi));
  std::vector<LoopCandidate> found;
  for (std::uint32_t k = 60; k < 140; ++k) found.push_back(candidate(k, 199 - k, std::numbers::pi));
  const std::vector<Segment> segments = agreeing_segments(chain_of(there), chain_of(back), found, {3});
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_NEAR(segments[0].support_m, 40.0, 7.0);
  // The same matches, but as if both had driven the same way: the bend contradicts.
  for (LoopCandidate& c : found) c.yaw = 0.0;
  EXPECT_LT(agreeing_segments(chain_of(there), chain_of(back), found, {3})[0].support_m, 15.0);
}

TEST(AgreeingSegments, AStretchThatAllLooksLikeOnePlaceIsNotLong) {
  std::vector<LoopCandidate> found;
  for (std::uint32_t k = 100; k < 300; ++k) found.push_back(candidate(k, 50));
  EXPECT_LE(agreeing_segments(along_x(), along_x(), found, {1})[0].support_m, 3.0);
}

TEST(AgreeingSegments, EachCandidateBelongsToOneAndThreadsDoNotMatter) {
  std::vector<LoopCandidate> found = anywhere(2);
  for (std::uint32_t k = 0; k < kKeyframes; ++k)
    found.push_back(candidate(k, (k + 99) % kKeyframes, 0.0, 0.2));
  std::vector<std::vector<Segment>> answers;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    answers.push_back(agreeing_segments(along_x(), along_x(), found, {1000}));
  }
  set_num_threads(1);
  std::vector<std::pair<KeyframeId, KeyframeId>> seen;
  ASSERT_EQ(answers[0].size(), answers[1].size());
  for (std::size_t s = 0; s < answers[0].size(); ++s) {
    EXPECT_EQ(answers[0][s].support_m, answers[1][s].support_m);
    EXPECT_TRUE(std::ranges::equal(answers[0][s].candidates, answers[1][s].candidates,
                                   [](const auto& a, const auto& b) { return a == b; }));
    for (const LoopCandidate& c : answers[0][s].candidates) seen.emplace_back(c.query, c.match);
  }
  std::ranges::sort(seen);
  EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end());
}

TEST(AgreeingSegments, OfNothingAreNone) {
  EXPECT_TRUE(agreeing_segments(along_x(), along_x(), {}, {5}).empty());
  EXPECT_TRUE(agreeing_segments(along_x(), along_x(), anywhere(3), {0}).empty());
}

}  // namespace
}  // namespace adit
