// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Layouts of clouds that people state, where what is found would be another one.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/io/file_info.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/topic_info.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

/// A .bin whose numbers tell where they stand: row i begins with i + 0.5, and its last number is a time.
std::string bin_rows(int num_rows, int num_columns) {
  std::string bytes;
  for (int i = 0; i < num_rows; ++i)
    for (int k = 0; k < num_columns; ++k) {
      const float value = k == 0 ? static_cast<float>(i) + 0.5F : static_cast<float>(k);
      append_little_endian(bytes, k > 3 ? -0.001F * static_cast<float>(i) : value);
    }
  return bytes;
}

std::size_t size_of_first(const std::string& path, const RecordingConfig& config) {
  return open_recording(path, config).value().read_scan(0).value().cloud.size();
}

std::string notes_of(const Recording& recording) {
  return format("{}", fmt::join(recording.assumptions, "\n"));
}

TEST(StatedLayouts, ColumnsOfFilesThatFitSeveral) {
  const TemporaryFolder folder;
  for (const char* name : {"0.bin", "1.bin"}) put_file(folder / name, bin_rows(8, 5));
  const std::string path = folder.path().string();
  EXPECT_EQ(size_of_first(path, {}), 10U) << "too few to tell: four";
  const Recording five = open_recording(path, {.bin_columns = 5}).value();
  for (std::size_t i = 0; i < 2; ++i) {
    const PointCloud cloud = five.read_scan(i).value().cloud;
    ASSERT_EQ(cloud.size(), 8U);
    EXPECT_EQ(cloud.points.back(), Eigen::Vector3f(7.5F, 1.0F, 2.0F));
    EXPECT_EQ(cloud.intensities, std::vector<float>(8, 3.0F));
    EXPECT_FALSE(cloud.has_times()) << "the fifth is not used";
  }
  EXPECT_NE(notes_of(five).find("clouds: .bin with five columns, of which the fifth (a ring, or times) is "
                                "not used; times"),
            std::string::npos)
      << notes_of(five);
  // Also where more rows would show five.
  for (const char* name : {"0.bin", "1.bin"}) put_file(folder / name, bin_rows(120, 5));
  EXPECT_EQ(size_of_first(path, {}), 120U);
  EXPECT_EQ(size_of_first(path, {.bin_columns = 4}), 150U);
}

TEST(StatedLayouts, ColumnsThatAreNotFound) {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  for (const int num_columns : {3, 6, 8}) {
    for (const char* name : {"0.bin", "1.bin"}) put_file(folder / name, bin_rows(10, num_columns));
    const Recording recording = open_recording(path, {.bin_columns = num_columns}).value();
    const PointCloud cloud = recording.read_scan(1).value().cloud;
    ASSERT_EQ(cloud.size(), 10U);
    EXPECT_EQ(cloud.points.back(), Eigen::Vector3f(9.5F, 1.0F, 2.0F));
    EXPECT_EQ(cloud.intensities, std::vector<float>(num_columns > 3 ? 10 : 0, 3.0F));
    EXPECT_EQ(notes_of(recording).find("those behind the fourth are not used") != std::string::npos,
              num_columns > 4)
        << notes_of(recording);
  }
}

TEST(StatedLayouts, ColumnsThatDoNotFitAreAnError) {
  const TemporaryFolder folder;
  put_file(folder / "0.bin", bin_rows(6, 5));
  put_file(folder / "1.bin", bin_rows(8, 5));
  put_file(folder / "2.bin", bin_rows(7, 5));
  const std::string path = folder.path().string();
  EXPECT_ERROR(
      open_recording(path, {.bin_columns = 6}),
      "1.bin: 160 bytes are not a whole number of rows of 6 columns (24 bytes each), as --bin-columns "
      "(recording.bin_columns) states, and so it is in 2 of 3 files; state how many there are, or "
      "leave the option out");
  EXPECT_ERROR(open_recording(path, {.bin_columns = 2}), "recording.bin_columns: 2 is not 3 to 8, or 0");
  EXPECT_ERROR(
      open_recording(path, {.point_time_field = "time"}),
      "0.bin: no field 'time', which --point-time-field names for the times of points; the columns of a "
      ".bin have no names; leave the option out");
  // Of one cloud alone.
  const std::string cloud = (folder / "1.bin").string();
  EXPECT_ERROR(file_info(cloud, {.bin_columns = 6}),
               "1.bin: 160 bytes are not a whole number of points of 6");
  EXPECT_ERROR(file_info(cloud, {.bin_columns = -1}), "recording.bin_columns: -1 is not 3 to 8");
  EXPECT_NE(file_info(cloud, {}).value().find("\"bin_columns\": 4"), std::string::npos);
  const std::string info = file_info(cloud, {.bin_columns = 5}).value();
  EXPECT_NE(info.find("\"points\": 8"), std::string::npos) << info;
  EXPECT_NE(info.find("\"bin_columns\": 5"), std::string::npos) << info;
}

TEST(StatedLayouts, AFileThatWasCutIsAScanThatCannotBeRead) {
  const TemporaryFolder folder;
  for (const char* name : {"0.bin", "1.bin", "2.bin"}) put_file(folder / name, bin_rows(10, 4));
  const std::string cut = bin_rows(10, 4);
  put_file(folder / "3.bin", cut.substr(0, cut.size() - 7));
  const std::string path = folder.path().string();
  for (const int num_columns : {0, 4}) {
    const Recording recording = open_recording(path, {.bin_columns = num_columns}).value();
    ASSERT_EQ(recording.num_scans(), 4U);
    EXPECT_EQ(recording.read_scan(2).value().cloud.size(), 10U);
    EXPECT_ERROR(recording.read_scan(3), "3.bin: 153 bytes are not a whole number of points of 4 columns");
  }
  // Every second file has whole rows of eight, too.
  put_file(folder / "1.bin", bin_rows(11, 4));
  EXPECT_ERROR(open_recording(path, {.bin_columns = 8}), "in 2 of 4 files");
}

/// 200 points whose field `t` counts half a millisecond each, and another one the half of that.
constexpr int kNumTimed = 200;

std::string rows_with_two_times() {
  std::string rows;
  for (int i = 0; i < kNumTimed; ++i) rows += format("1 2 3 {} {}\n", 500'000 * i, 250 * i);
  return rows;
}

void put_pcd_with_two_times(const std::filesystem::path& path) {
  put_file(path,
           "FIELDS x y z t fired_us\nSIZE 4 4 4 4 4\nTYPE F F F I U\nWIDTH 200\nHEIGHT 1\nPOINTS 200\n"
           "DATA ascii\n" +
               rows_with_two_times());
}

void put_ply_with_two_times(const std::filesystem::path& path) {
  put_file(path,
           "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float y\n"
           "property float z\nproperty int t\nproperty uint fired_us\nend_header\n" +
               rows_with_two_times());
}

std::int32_t last_time(const Recording& recording) {
  return std::ranges::max(recording.read_scan(1).value().cloud.time_offsets_ns);
}

TEST(StatedLayouts, TheFieldOfTimesInAFolder) {
  for (const std::string extension : {".pcd", ".ply"}) {
    SCOPED_TRACE(extension);
    const TemporaryFolder folder;
    const auto put = extension == ".pcd" ? put_pcd_with_two_times : put_ply_with_two_times;
    for (const char* name : {"0", "1", "2"}) put(folder / (name + extension));
    const std::string path = folder.path().string();
    EXPECT_EQ(last_time(open_recording(path).value()), 500'000 * (kNumTimed - 1));
    const Recording other = open_recording(path, {.point_time_field = "fired_us"}).value();
    EXPECT_EQ(last_time(other), 250'000 * (kNumTimed - 1)) << "microseconds, as they show";
    const Result<Recording> missing = open_recording(path, {.mount = "0,0,1", .point_time_field = "when"});
    EXPECT_ERROR(missing,
                 "no field 'when', which --point-time-field names for the times of points; the fields are: "
                 "x, y, z, t, fired_us; name one of them, or leave the option out");
    EXPECT_ERROR(missing, "0" + extension + ": no field");
    // As the first that can be read says, not as the first of all.
    put_file(folder / ("0" + extension), "damaged");
    EXPECT_ERROR(open_recording(path, {.mount = "0,0,1", .point_time_field = "when"}),
                 "1" + extension + ": no field");
    EXPECT_TRUE(open_recording(path, {.mount = "0,0,1", .point_time_field = "fired_us"}));
    put(folder / ("0" + extension));
    // Of one cloud alone.
    const std::string cloud = (folder / ("0" + extension)).string();
    EXPECT_NE(file_info(cloud, {}).value().find("t, int32 ns, from the stamp"), std::string::npos);
    const std::string info = file_info(cloud, {.point_time_field = "fired_us"}).value();
    EXPECT_NE(info.find("fired_us, uint32 us, from the stamp"), std::string::npos) << info;
    EXPECT_ERROR(file_info(cloud, {.point_time_field = "when"}), "no field 'when'");
  }
}

/// Three clouds with nanoseconds in `t`, and the half of that in `sweeptime`, in seconds.
test::ForeignFile bag_with_two_times() {
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (std::size_t k = 0; k < 3; ++k) {
    Scan scan = test::make_scan(k, kNumTimed);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      scan.cloud.time_offsets_ns[i] = static_cast<std::int32_t>(500'000 * i);
      scan.cloud.intensities[i] = 250e-6F * static_cast<float>(i);
    }
    std::string cloud = ros::encode_cloud(scan, "lidar");
    const std::string_view name = "intensity";
    cloud.replace(cloud.find(name), name.size(), "sweeptime");
    clouds.emplace_back(scan.stamp, std::move(cloud));
  }
  test::ForeignFile file;
  file.cloud_messages("/points", clouds, std::chrono::milliseconds(110))
      .links({test::link("base_link", "lidar", Pose())});
  return file;
}

TEST(StatedLayouts, TheFieldOfTimesInABag) {
  const test::ForeignFile file = bag_with_two_times();
  EXPECT_EQ(last_time(file.read().value()), 500'000 * (kNumTimed - 1));
  const RecordingConfig stated{.point_time_field = "sweeptime"};
  EXPECT_NEAR(last_time(file.read(stated).value()), 250'000 * (kNumTimed - 1), 10);  // of 32-bit seconds
  const Bag bag = open_mcap_bag(memory_source(file.bytes())).value();
  EXPECT_EQ(topics_of(bag, {}).front().point_times_from, "t, int32 ns, from the stamp");
  EXPECT_EQ(topics_of(bag, stated).front().point_times_from, "sweeptime, float32 s, from the stamp");
  EXPECT_ERROR(
      file.read({.point_time_field = "when"}),
      "/points, scan 0: no field 'when', which --point-time-field names for the times of points; the "
      "fields are: x, y, z, sweeptime, t; name one of them, or leave the option out");
}

TEST(StatedLayouts, TheNextCommandStatesColumnsWhereThereAreSome) {
  const TemporaryFolder folder;
  const std::filesystem::path bins = folder / "kitti/velodyne";
  const std::filesystem::path pcds = folder / "pcds";
  for (const std::filesystem::path& path : {bins, pcds}) std::filesystem::create_directories(path);
  for (const char* name : {"0.bin", "1.bin", "2.bin"}) put_file(bins / name, bin_rows(10, 5));
  for (const char* name : {"0.pcd", "1.pcd"}) put_pcd_with_two_times(pcds / name);
  const RecordingConfig five{.mount = "0,0,1", .bin_columns = 5};
  const auto states_five = [&](const std::string& path) {
    return file_info(path, five).value().find(" --bin-columns 5") != std::string::npos;
  };
  for (const std::string& path : {bins.string(), bins.string() + "@even", bins.parent_path().string()})
    EXPECT_TRUE(states_five(path)) << path;
  EXPECT_FALSE(states_five(pcds.string()));
}

}  // namespace
}  // namespace adit
