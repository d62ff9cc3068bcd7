// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/faults.hpp"

#include <gtest/gtest.h>

#include <array>

namespace adit {
namespace {

constexpr std::array kKinds{FaultKind{"slip", FaultAmount::needed}, FaultKind{"silent"}};

Result<std::vector<SensorFault>> parse(const std::string& text) {
  return parse_faults(text, "wheels", kKinds, Stamp{7});
}

TEST(Faults, AreReadFromText) {
  const std::vector<SensorFault> faults = parse("slip 10:13 0.5, silent 20:24.5").value();
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].sensor, "wheels");
  EXPECT_EQ(faults[0].kind, "slip");
  EXPECT_EQ(faults[0].begin, Stamp{7} + from_seconds(10));
  EXPECT_EQ(faults[0].end, Stamp{7} + from_seconds(13));
  EXPECT_EQ(faults[0].amount, 0.5);
  EXPECT_EQ(faults[1].end, Stamp{7} + from_seconds(24.5));
  EXPECT_TRUE(parse("")->empty());
}

TEST(Faults, LastFromTheirBeginToBeforeTheirEnd) {
  const std::vector<SensorFault> faults = parse("silent 1:2").value();
  EXPECT_FALSE(is_faulty(faults, "silent", Stamp{6} + from_seconds(1)));
  EXPECT_TRUE(is_faulty(faults, "silent", Stamp{7} + from_seconds(1)));
  EXPECT_FALSE(is_faulty(faults, "slip", Stamp{7} + from_seconds(1)));
  EXPECT_FALSE(is_faulty(faults, "silent", Stamp{7} + from_seconds(2)));
}

TEST(Faults, WhatCannotBeReadIsRefusedWithWhatIsNeeded) {
  const auto error = [](const std::string& text) {
    const auto faults = parse(text);
    return faults ? "" : faults.error().message;
  };
  EXPECT_EQ(error("skid 1:2"), "fault 'skid 1:2': it starts with one of slip, silent");
  EXPECT_EQ(error("silent 1:2,"), "");
  for (const char* text : {"slip 1:2", "slip 1:2 x", "slip 1:2 inf", "silent 2:1", "silent 1", "silent 1:2 3",
                           "silent -1:2", "slip 1:2 0.5 6", "silent 1:1"})
    EXPECT_NE(error(text).find("BEGIN:END"), std::string::npos) << text << ": " << error(text);
}

}  // namespace
}  // namespace adit
