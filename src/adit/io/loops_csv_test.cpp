// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/loops_csv.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "adit/io/csv.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

const std::string kHeader =
    "from_robot,from_keyframe,from_stamp,to_robot,to_keyframe,to_stamp,place_distance,inliers,overlap,weak_"
    "axis,"
    "verdict,pcm,gnc_weight,class,x,y,z,qx,qy,qz,qw,reason\n";

/// A row with that cell in place of its own.
Result<std::vector<SavedLoop>> with_cell(std::size_t column, const std::string& cell) {
  std::vector<std::string> cells = {"ada", "3",   "1.5",      "bob",  "40",  "2.5", "0.2", "120",
                                    "0.8", "0.1", "accepted", "kept", "0.9", "",    "1.5", "-2e-05",
                                    "3",   "0",   "0",        "0",    "1",   "well"};
  cells[column] = cell;
  return parse_loops_csv(kHeader + csv_row(cells));
}

TEST(LoopsCsv, ReadsNumbersAsTheyAreWritten) {
  const auto loops = with_cell(12, "");  // no weight: it took no part
  ASSERT_TRUE(loops) << loops.error().message;
  ASSERT_EQ(loops->size(), 1U);
  const SavedLoop& saved = loops->front();
  EXPECT_EQ(saved.weight, 0.0);
  EXPECT_EQ(saved.loop.to.index, 40U);
  EXPECT_EQ(saved.loop.num_inliers, 120);
  EXPECT_EQ(saved.loop.T_from_to.translation(), Vector3(1.5, -2e-5, 3.0));
  EXPECT_EQ(with_cell(12, "0.75")->front().weight, 0.75);
}

TEST(LoopsCsv, CellsThatAreNoNumbersAreNamed) {
  EXPECT_ERROR(with_cell(14, "abc"), "line 2: x: 'abc' is not a number");
  EXPECT_ERROR(with_cell(14, "1.5junk"), "line 2: x: '1.5junk' is not a number");
  EXPECT_ERROR(with_cell(15, ""), "line 2: y: '' is not a number");
  EXPECT_ERROR(with_cell(16, "inf"), "line 2: z: 'inf' is not a number");
  EXPECT_ERROR(with_cell(20, "nan"), "line 2: qw: 'nan' is not a number");
  EXPECT_ERROR(with_cell(8, "nan"), "line 2: overlap: 'nan' is not a number");
  EXPECT_ERROR(with_cell(12, "nan"), "line 2: gnc_weight: 'nan' is not a number");
  EXPECT_ERROR(with_cell(1, "-1"), "line 2: from_keyframe: '-1' is not a number");
  EXPECT_ERROR(with_cell(7, "1.5"), "line 2: inliers: '1.5' is not a number");
  EXPECT_ERROR(with_cell(2, "9e9"), "line 2: a stamp is not a number of seconds");
  EXPECT_ERROR(with_cell(20, "1.1"), "line 2: x to qw: the quaternion has norm");
  EXPECT_ERROR(with_cell(14, "1e300"), "line 2: x to qw: 1e+300 is not a coordinate");
}

}  // namespace
}  // namespace adit
