// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/trajectory_files.hpp"

#include <gtest/gtest.h>

#include "adit/io/file_info.hpp"
#include "adit/io/tum.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

const Trajectory kTwoPoses{{{1'000'000'001}, Pose::planar(1.0, -2.0, 0.5)},
                           {{2'000'000'000}, Pose::planar(0.1, 3.0, -3.0)}};

TEST(TrajectoryFiles, CsvAndTumReadBackExactly) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.csv", "a.tum", "a.txt", "A.CSV"}) {
    ASSERT_TRUE(write_trajectory(folder / name, kTwoPoses));
    const Result<Trajectory> read = read_trajectory(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(tum_text(*read), tum_text(kTwoPoses)) << name;
  }
}

TEST(TrajectoryFiles, CsvNeedsNoHeading) {
  const test::TemporaryFolder folder;
  test::put_file(folder / "bare.csv", "1.5,1,2,3,0,0,0,1\n2.5,2,2,3,0,0,0,1\n");
  EXPECT_EQ(read_trajectory(folder / "bare.csv").value().at(1).T_world_body.translation().x(), 2.0);
}

TEST(TrajectoryFiles, InfoKnowsAllThatAreRead) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.csv", "a.tum", "a.txt"}) {
    ASSERT_TRUE(write_trajectory(folder / name, kTwoPoses));
    const Result<std::string> info = file_info((folder / name).string(), {});
    ASSERT_TRUE(info) << info.error().message;
    EXPECT_NE(info->find("\"kind\": \"trajectory\""), std::string::npos) << *info;
    EXPECT_NE(info->find("\"poses\": 2"), std::string::npos) << *info;
  }
  ASSERT_TRUE(write_trajectory(folder / "a.kitti", kTwoPoses));
  EXPECT_ERROR(file_info((folder / "a.kitti").string(), {}), "KITTI poses have no stamps");
  test::put_file(folder / "a.doc", "");
  EXPECT_ERROR(file_info((folder / "a.doc").string(), {}),
               "trajectories (.tum .txt .csv), graphs (.g2o .jrl .cbor)");
}

TEST(TrajectoryFiles, KittiIsWrittenAndNotRead) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_trajectory(folder / "a.kitti", kTwoPoses));
  EXPECT_ERROR(read_trajectory(folder / "a.kitti"), "KITTI poses have no stamps");
}

TEST(TrajectoryFiles, TablesOfAnotherKindAreNamed) {
  const test::TemporaryFolder folder;
  const auto read = [&](const char* text) {
    test::put_file(folder / "a.csv", text);
    return read_trajectory(folder / "a.csv");
  };
  EXPECT_ERROR(read("name,x,y,z,sigma\nA,1,2,3,0.01\n"),
               "a.csv: has control points, not a trajectory; 'adit geo");
  EXPECT_ERROR(read("from_robot,from_keyframe,from_stamp\na,1,2\n"), "a.csv: is the loops.csv of a session");
  EXPECT_ERROR(read("stamp_s,x_x,x_y\n1,2,3\n"), "a.csv: has the covariances of poses");
}

TEST(TrajectoryFiles, ErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  test::put_file(folder / "bad.csv", "stamp_s,x,y,z,qx,qy,qz,qw\n1.5,1,2,3,0,0,0\n");
  EXPECT_ERROR(read_trajectory(folder / "bad.csv"), "bad.csv: line 2");
}

}  // namespace
}  // namespace adit
