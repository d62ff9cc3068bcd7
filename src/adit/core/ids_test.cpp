// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/ids.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <unordered_set>

#include "adit/core/time.hpp"

namespace adit {
namespace {

TEST(Ids, GraphKeysAreGtsamSymbols) {
  EXPECT_EQ(graph_key({{0}, 0}), 0x6100000000000000ULL);
  EXPECT_EQ(graph_key({{2}, 17}), 0x6300000000000011ULL);
}

TEST(Ids, GraphKeysComeBackForEveryRobot) {
  for (int robot = 0; robot < 256; ++robot) {
    for (const std::uint32_t index : {0U, 1U, 123456U, std::numeric_limits<std::uint32_t>::max()}) {
      const KeyframeId id{{static_cast<std::uint8_t>(robot)}, index};
      EXPECT_EQ(keyframe_id(graph_key(id)), id);
    }
  }
}

TEST(Ids, OrderIsByRobotThenIndex) {
  EXPECT_LT((KeyframeId{{0}, 900}), (KeyframeId{{1}, 0}));
  EXPECT_LT((KeyframeId{{1}, 0}), (KeyframeId{{1}, 1}));
  EXPECT_EQ((std::unordered_set<KeyframeId>{{{0}, 1}, {{1}, 0}, {{0}, 1}}.size()), 2U);
}

TEST(Time, NanosecondsSurviveAnEpoch) {
  const Stamp stamp{1'600'000'000'000'000'001};
  EXPECT_EQ((stamp + Duration(2)) - stamp, Duration(2));
  EXPECT_EQ((stamp - Duration(1)).ns, 1'600'000'000'000'000'000);
  EXPECT_EQ(from_seconds(0.1), Duration(100'000'000));
  EXPECT_EQ(from_seconds(-1e-9), Duration(-1));
  EXPECT_DOUBLE_EQ(to_seconds(Duration(1'500'000'000)), 1.5);
}

}  // namespace
}  // namespace adit
