// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robot_name.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(RobotName, AFineNameStays) {
  for (const char* name : {"robot_0", "Husky-3", "spot.v2", "Bergwerk Süd", "a"})
    EXPECT_EQ(robot_name(name), name);
}

TEST(RobotName, NothingLeavesTheFolderOfTheSession) {
  EXPECT_EQ(robot_name(".."), "robot");
  EXPECT_EQ(robot_name("."), "robot");
  EXPECT_EQ(robot_name(""), "robot");
  EXPECT_EQ(robot_name("   "), "robot");
  EXPECT_EQ(robot_name("../../etc/passwd"), "___.._etc_passwd");
  EXPECT_EQ(robot_name("/x"), "_x");
  EXPECT_EQ(robot_name("a\\b"), "a_b");
  EXPECT_EQ(robot_name(".hidden"), "_hidden");
  EXPECT_EQ(robot_name("a. "), "a__");
}

TEST(RobotName, NothingBreaksATable) {
  EXPECT_EQ(robot_name("a,b;c\"d"), "a_b_c_d");
  EXPECT_EQ(robot_name(std::string("a\nb\0c\x7f", 6)), "a_b_c_");
}

TEST(RobotName, LongNamesAreCutBetweenCharacters) {
  EXPECT_EQ(robot_name(std::string(300, 'x')), std::string(64, 'x'));
  std::string umlauts = "x";
  for (int i = 0; i < 60; ++i) umlauts += "ü";  // two bytes each, the 64th in the middle of one
  EXPECT_EQ(robot_name(umlauts), umlauts.substr(0, 63));
}

TEST(RobotName, EqualNamesGetNumbers) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(distinct_names({"a", "b"}), (Names{"a", "b"}));
  EXPECT_EQ(distinct_names({"a", "a", "b", "a"}), (Names{"a", "a_2", "b", "a_3"}));
  EXPECT_EQ(distinct_names({"a", "a", "a_2"}), (Names{"a", "a_3", "a_2"}));
  EXPECT_EQ(distinct_names({"a_2", "a", "a"}), (Names{"a_2", "a", "a_3"}));
  EXPECT_TRUE(distinct_names({}).empty());
}

}  // namespace
}  // namespace adit
