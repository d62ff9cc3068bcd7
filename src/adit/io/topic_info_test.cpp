// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/topic_info.hpp"

#include <gtest/gtest.h>

#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

std::vector<Stamp> at_ms(const std::vector<int>& times) {
  std::vector<Stamp> stamps;
  for (const int time : times) stamps.push_back({1'700'000'000'000'000'000 + 1'000'000LL * time});
  return stamps;
}

TEST(Rhythm, IsThatOfAllMessagesAndNotOfBursts) {
  const Rhythm bursts = rhythm_of(at_ms({0, 1, 2, 3, 100, 101, 102, 103, 200}));
  EXPECT_EQ(bursts.rate_hz, 40.0);
  EXPECT_NEAR(bursts.longest_gap_s, 0.097, 1e-12);
  EXPECT_EQ(rhythm_of(at_ms({0, 333, 666, 999})).rate_hz, 3.003) << "four digits";
  EXPECT_EQ(rhythm_of({{0}, {7}, {14}}).rate_hz, 142'900'000.0) << "of stamps that count from anything";
  EXPECT_FALSE(rhythm_of(at_ms({5, 5})).rate_hz) << "sent twice at one moment";
  EXPECT_FALSE(rhythm_of({}).rate_hz);
}

TEST(TopicInfo, AClockThatRunsAtAnotherSpeedIsFound) {
  // Recorded 50 ms apart.
  const auto info_of = [](int interval_ms) {
    std::vector<int> times;
    for (int i = 0; i < 40; ++i) times.push_back(interval_ms * i);
    test::ForeignFile file;
    file.odometry_stamped("/odom", at_ms(times));
    return topics_of(open_mcap_bag(memory_source(file.bytes())).value(), {}).front();
  };
  const TopicInfo fast = info_of(75);
  EXPECT_EQ(fast.rhythm.rate_hz, 20.0);
  EXPECT_EQ(fast.rate_by_stamps_hz, 13.33);
  EXPECT_NE(fast.clock_finding.find("these advance by 2.9 s in 1.9 s of recording"), std::string::npos)
      << fast.clock_finding;
  EXPECT_EQ(info_of(51).clock_finding, "");
}

TEST(TopicInfo, AClockThatWasSetBetweenIsFound) {
  std::vector<int> times;
  for (int i = 0; i < 40; ++i) times.push_back(50 * i + (i > 15 && i < 25 ? 3000 : 0));
  test::ForeignFile file;
  file.odometry_stamped("/odom", at_ms(times));
  EXPECT_NE(topics_of(open_mcap_bag(memory_source(file.bytes())).value(), {}).front().clock_finding, "")
      << "the first and the last message agree";
}

TEST(TopicInfo, OfCloudsItSaysWhereTheTimesOfPointsAreFrom) {
  test::ForeignFile file;
  file.clouds("/points");
  const Bag bag = open_mcap_bag(memory_source(file.bytes())).value();
  EXPECT_EQ(topics_of(bag, {}).front().point_times_from, "t, int32 ns, from the stamp");
  EXPECT_EQ(topics_of(bag, {.point_times = "us"}).front().point_times_from, "");
}

}  // namespace
}  // namespace adit
