// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/progress_line.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

using Seconds = PhaseTree::Seconds;

std::string line_at(const PhaseTree& tree, double now, std::size_t width = 200) {
  return progress_line(tree.chain(), Seconds(now), width);
}

TEST(ProgressLine, ShowsShareAndTimeLeft) {
  PhaseTree tree;
  EXPECT_EQ(line_at(tree, 0.0), "");
  const PhaseId mapping = tree.begin("mapping", 200, 0, Seconds(10.0));
  EXPECT_EQ(line_at(tree, 12.0), "mapping [                        ] 0 %");
  tree.advance(mapping, 50);
  EXPECT_EQ(line_at(tree, 20.0), "mapping [######                  ] 25 %, 30 s left");
  EXPECT_EQ(line_at(tree, 20.0, 12), "mapping [###");
  tree.advance(mapping, 150);
  EXPECT_EQ(line_at(tree, 50.0), "mapping [########################] 100 %, 0 s left");
  tree.end(mapping);
  EXPECT_EQ(line_at(tree, 51.0), "");
}

TEST(ProgressLine, SaysHowLongAPhaseOfUnknownLengthTookSoFar) {
  PhaseTree tree;
  tree.begin("solving", 0, 0, Seconds(1.0));
  EXPECT_EQ(line_at(tree, 63.5), "solving, 1 min 03 s so far");
}

TEST(ProgressLine, FollowsOnePhaseInwardsAndStopsWhereSeveralRun) {
  PhaseTree tree;
  const PhaseId meetings = tree.begin("meetings", 6, 0, Seconds(0.0));
  tree.advance(meetings, 2);
  const PhaseId first = tree.begin("registering", 4, meetings, Seconds(20.0));
  tree.advance(first, 2);
  EXPECT_EQ(line_at(tree, 24.0),
            "meetings 2/6, registering [############            ] 50 %, 4 s left (meetings: 48 s left)");
  const PhaseId second = tree.begin("registering", 4, meetings, Seconds(24.0));
  EXPECT_EQ(line_at(tree, 24.0), "meetings [########                ] 33 %, 48 s left");
  tree.end(first);
  EXPECT_EQ(tree.chain().back().id, second);
}

TEST(ProgressLine, MoreStepsThanAnnouncedAreAllOfThem) {
  PhaseTree tree;
  const PhaseId phase = tree.begin("work", 2, 0, Seconds(0.0));
  tree.advance(phase, 3);
  EXPECT_EQ(line_at(tree, 1.0), "work [########################] 100 %, 0 s left");
}

TEST(ProgressLine, TimesAreRoundedUpToWhatAPersonNeeds) {
  EXPECT_EQ(rough_time(0.0), "0 s");
  EXPECT_EQ(rough_time(0.2), "1 s");
  EXPECT_EQ(rough_time(59.4), "1 min 00 s");
  EXPECT_EQ(rough_time(7511.0), "2 h 05 min");
}

}  // namespace
}  // namespace adit
