// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/recording_files.hpp"

#include <gtest/gtest.h>

#include "adit/io/cloud_files.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

TEST(OpenRecording, SelectsPartsOfAFolder) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(write_cloud(folder / (std::to_string(i) + ".bin"), cloud));
  const std::string path = folder.path().string();
  EXPECT_EQ(open_recording(path)->num_scans(), 6U);
  EXPECT_EQ(open_recording(path + "@even")->scan_stamps[1].ns, 2'000'000'000);
  EXPECT_EQ(open_recording(path + "@odd")->scan_stamps[1].ns, 3'000'000'000);
  EXPECT_EQ(open_recording(path + "@1:3")->num_scans(), 2U);
  EXPECT_TRUE(open_recording(path + "@1:3")->name.ends_with("_1_3"));
  EXPECT_ERROR(open_recording(path + "@1:0"), "@even, @odd or @FIRST:STEP");
  EXPECT_ERROR(open_recording(path + "@9:1"), "0 scan(s) taken");
  EXPECT_ERROR(open_recording(path + "/absent"), "no such file or folder");
  put_file(folder / "a.txt", "");
  EXPECT_ERROR(open_recording(path + "/a.txt"), "is not a recording");
}

TEST(OpenRecording, AFolderOfCloudsHasNoTopics) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(write_cloud(folder / (std::to_string(i) + ".bin"), cloud));
  const std::string path = folder.path().string();
  EXPECT_ERROR(open_recording(path, {.points = "/ouster/points"}),
               "there is no topic '/ouster/points', as this is a folder of clouds: its clouds are the files");
  EXPECT_ERROR(open_recording(path, {.wheel = "/odom"}), "odometry.tum beside the clouds; leave --wheel out");
  EXPECT_ERROR(open_recording(path, {.imu = "/imu"}), "it holds no IMU; leave --imu out");
  EXPECT_ERROR(open_recording(path, {.truth = "/gt"}),
               "groundtruth.tum beside the clouds; leave --truth out");
  EXPECT_ERROR(open_recording(path + "@even", {.tf = "/tf"}), "given by --mount; leave --tf out");
  EXPECT_ERROR(open_recording(path, {.topics_under = "/husky1"}), "leave --set recording.topics_under out");
  EXPECT_TRUE(open_recording(path, {.wheel = "none", .imu = "none", .truth = "none"}));
  EXPECT_ERROR(open_recording(path + "/absent", {.points = "/points"}), "no such file or folder");
}

TEST(OpenRecording, OfASessionItIsSaidWhichCommandsTakeIt) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  ASSERT_TRUE(write_cloud(folder / "map.ply", cloud));
  put_file(folder / "session.toml", "");
  EXPECT_ERROR(open_recording(folder.path().string()), "is a session, not a recording; adit slam --session ");
}

TEST(OpenRecording, StampsOfTheEndOfTheSweep) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {2, 2, 3}, {3, 2, 3}};
  cloud.time_offsets_ns = {0, 50'000'000, 100'000'000};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(write_cloud(folder / (std::to_string(i) + ".pcd"), cloud));
  const std::string path = folder.path().string();
  EXPECT_EQ(open_recording(path)->read_scan(1)->cloud.time_offsets_ns, cloud.time_offsets_ns);
  EXPECT_EQ(open_recording(path, {.stamp_at = "end"})->read_scan(1)->cloud.time_offsets_ns,
            std::vector<std::int32_t>({-100'000'000, -50'000'000, 0}));
  EXPECT_ERROR(open_recording(path, {.point_times = "us"}), "span 100.000 s");
  EXPECT_ERROR(open_recording(path, {.stamp_at = "middle"}), "'middle' is not start, end or auto");
  EXPECT_ERROR(open_recording(path, {.point_times = "min"}), "'min' is not a unit of point times");
}

TEST(OpenRecording, TheUnitOfPointTimesIsTheOneThatIsStated) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {2, 2, 3}, {3, 2, 3}};
  cloud.time_offsets_ns = {0, 50, 100};  // milliseconds
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(write_cloud(folder / (std::to_string(i) + ".pcd"), cloud));
  const std::string path = folder.path().string();
  const auto says = [](const std::vector<std::string>& all, std::string_view text) {
    return std::ranges::count_if(all,
                                 [&](const std::string& one) { return one.find(text) != std::string::npos; });
  };
  const Recording right = open_recording(path, {.point_times = "ms"}).value();
  EXPECT_EQ(right.read_scan(1)->cloud.time_offsets_ns.back(), 100'000'000);
  EXPECT_EQ(says(right.assumptions, "point times: in ms, as stated by --point-times"), 1);
  EXPECT_TRUE(right.warnings.empty());
  const Recording wrong = open_recording(path, {.point_times = "us"}).value();
  EXPECT_EQ(says(wrong.assumptions, "as sweeps do"), 0);
  EXPECT_EQ(says(wrong.warnings, "the first sweep lasts 0.0001 s"), 1);
  EXPECT_TRUE(open_recording(path)->warnings.empty());
}

TEST(OpenRecording, RealFolderAsTwoRobots) {
  ADIT_NEED_DATA("scans/nclt/0000.pcd");
  const std::string path = test::shared_data("scans/nclt").string();
  const Result<Recording> even = open_recording(path + "@even");
  const Result<Recording> odd = open_recording(path + "@odd");
  ASSERT_TRUE(even) << even.error().message;
  ASSERT_TRUE(odd) << odd.error().message;
  EXPECT_EQ(even->num_scans() + odd->num_scans(), 300U);
  EXPECT_EQ(even->truth.size(), 300U);
  EXPECT_EQ(even->name, "nclt_even");
  const Result<Scan> scan = odd->read_scan(149);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->stamp.ns, 299'000'000'000);
  EXPECT_GT(scan->cloud.size(), 5000U);
}

}  // namespace
}  // namespace adit
