// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/tum.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "adit/core/rng.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

TEST(Tum, StampsKeepTheirNanoseconds) {
  const auto ns = [](std::string_view text) { return parse_stamp(text).value_or(Stamp{-1}).ns; };
  EXPECT_EQ(ns("0"), 0);
  EXPECT_EQ(ns("12.5"), 12'500'000'000);
  EXPECT_EQ(ns("1700000000.123456789"), 1'700'000'000'123'456'789);  // a double would give ...456768
  EXPECT_EQ(ns("1.7e9"), 1'700'000'000'000'000'000);
  EXPECT_EQ(ns("1.305031098000000123e+09"), 1'305'031'098'000'000'123);
  EXPECT_EQ(ns("1e-9"), 1);
  EXPECT_EQ(ns("0.0000000004"), 0);
  EXPECT_EQ(ns("0.0000000005"), 1);
  EXPECT_EQ(ns("4e-30"), 0);
  EXPECT_EQ(ns("-0.25"), -250'000'000);
  EXPECT_EQ(ns("+3."), 3'000'000'000);
  for (const char* bad :
       {"", ".", "abc", "1.2.3", "1e", "1e99", "0x10", "nan", "1 2", "--1", "99999999999"}) {
    EXPECT_FALSE(parse_stamp(bad)) << bad;
  }
}

TEST(Tum, StampTextReadsBack) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Stamp stamp{static_cast<std::int64_t>(rng()) >> rng.below(63)};
    if (stamp > kLargestStamp || stamp < Stamp{-kLargestStamp.ns}) continue;
    EXPECT_EQ(parse_stamp(stamp_text(stamp)), stamp) << stamp.ns;
  }
  EXPECT_EQ(stamp_text({-1}), "-0.000000001");
  EXPECT_EQ(stamp_text({std::numeric_limits<std::int64_t>::min()}), "-9223372036.854775808");
}

TEST(Tum, RoundTripIsExact) {
  Rng rng(2);
  Trajectory trajectory;
  for (int i = 0; i < 100; ++i) {
    Vector6 xi;
    for (double& value : xi) value = rng.uniform(-1.5, 1.5);
    trajectory.push_back({Stamp{1'700'000'000'000'000'000 + i * 100'000'001LL}, Pose::exp(xi)});
  }
  const Result<Trajectory> back = parse_tum(tum_text(trajectory));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->size(), trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ((*back)[i].stamp, trajectory[i].stamp);
    EXPECT_EQ((*back)[i].T_world_body.translation(), trajectory[i].T_world_body.translation());
    EXPECT_LT(((*back)[i].T_world_body.inverse() * trajectory[i].T_world_body).log().norm(), 1e-12);
  }
  EXPECT_EQ(tum_text(*back), tum_text(trajectory));
}

TEST(Tum, CommentsAndBlankLinesAreSkipped) {
  const Result<Trajectory> poses =
      parse_tum("# stamp x y z\n\n 1.0 1 2 3 0 0 0 1 \r\n\t\n2 1 2 3 0 0 0.6 0.8");
  ASSERT_TRUE(poses) << poses.error().message;
  EXPECT_EQ(poses->size(), 2U);
}

TEST(Tum, ErrorsNameTheLine) {
  EXPECT_ERROR(parse_tum("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "line 2: stamp 1 is not after 1.000000000");
  EXPECT_ERROR(parse_tum("1 0 0 0 0 0 0\n"), "line 1: 7 words");
  EXPECT_ERROR(parse_tum("1 0 0 nan 0 0 0 1\n"), "'nan' is not a finite number");
  EXPECT_ERROR(parse_tum("x 0 0 0 0 0 0 1\n"), "stamp 'x'");
  EXPECT_ERROR(parse_tum("1 0 0 0 0 0 0 0\n"), "norm 0, not 1");
  EXPECT_ERROR(parse_tum("# nothing\n"), "no pose");
  EXPECT_ERROR(read_tum("/absent/file.tum"), "/absent/file.tum: no such file");
}

TEST(Tum, EveryTruncationAndGarbageIsSurvived) {
  const std::string text = "1.5 0.25 -1 3 0 0 0.6 0.8\n2.5 1 2 3 0 0 0 1\n";
  for (std::size_t size = 0; size < text.size(); ++size) {
    const Result<Trajectory> poses = parse_tum(text.substr(0, size));
    EXPECT_LE(poses ? poses->size() : 0U, 2U);
  }
  Rng rng(3);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 3; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    static_cast<void>(parse_tum(damaged));
  }
}

TEST(Tum, RealFile) {
  ADIT_NEED_DATA("scans/nclt/groundtruth.tum");
  const Result<Trajectory> truth = read_tum(test::shared_data("scans/nclt/groundtruth.tum"));
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->size(), 300U);
  EXPECT_NEAR(path_length(*truth), 201.0, 1.0);
}

TEST(Tum, StampsAndPositionsThatOverflowAreRefused) {
  // The difference of the two largest fits; beyond them it would not.
  const Stamp largest = parse_stamp("4600000000").value();
  EXPECT_EQ(largest - parse_stamp("-4600000000").value(), Duration(9'200'000'000'000'000'000));
  EXPECT_FALSE(parse_stamp("4600000000.000000001"));
  EXPECT_FALSE(parse_stamp("-9220000000"));
  EXPECT_ERROR(parse_tum("9220000000 0 0 0 0 0 0 1\n"),
               "line 1: stamp '9220000000' is not a decimal number of seconds, 4600000000 at most");
  EXPECT_ERROR(parse_tum("1 0 0 0 0 0 0 1\n2 0 1.7e308 0 0 0 0 1\n"),
               "line 2: 1.7e+308 is not a coordinate in metres");
  EXPECT_TRUE(parse_tum("1 5e5 -6.3e6 1e9 0 0 0 1\n"));
}

}  // namespace
}  // namespace adit
