// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/scan_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/tum.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

PointCloud one_point(float x) {
  PointCloud cloud;
  cloud.points = {{x, 2, 3}};
  return cloud;
}

TEST(ScanFolder, OrderedByNumberAndStampedByIt) {
  const TemporaryFolder folder;
  for (const int i : {10, 9, 2})
    ASSERT_TRUE(write_cloud(folder / ("s1_" + std::to_string(i) + ".pcd"), one_point(static_cast<float>(i))));
  const Result<Recording> recording = read_scan_folder(folder.path());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->scan_stamps, std::vector<Stamp>({{2'000'000'000}, {9'000'000'000}, {10'000'000'000}}));
  const Result<Scan> scan = recording->read_scan(2);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->cloud.points[0].x(), 10.0F);
  EXPECT_EQ(scan->stamp, recording->scan_stamps[2]);
}

TEST(ScanFolder, StampsInNamesAreTaken) {
  const TemporaryFolder folder;
  for (const char* name : {"1271124904.905", "1271124905.004999999", "c_1271124906.000000001"})
    ASSERT_TRUE(write_cloud(folder / (std::string(name) + ".pcd"), one_point(1.0F)));
  const Result<Recording> recording = read_scan_folder(folder.path());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->scan_stamps,
            std::vector<Stamp>(
                {{1'271'124'904'905'000'000}, {1'271'124'905'004'999'999}, {1'271'124'906'000'000'001}}));
  // One of another kind: numbers order all, as ever.
  ASSERT_TRUE(write_cloud(folder / "run2.0007.pcd", one_point(1.0F)));
  EXPECT_EQ(read_scan_folder(folder.path())->scan_stamps[1], Stamp{7'000'000'000});
}

TEST(ScanFolder, ASequenceOfKittiHasItsTruth) {
  const TemporaryFolder folder;
  const auto sequence = folder / "07";
  std::filesystem::create_directories(sequence / "velodyne");
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(write_cloud(sequence / "velodyne" / format("{:06}.bin", i), one_point(1)));
  put_file(sequence / "times.txt", "0.0\n0.1\n0.2\n");
  // The camera looks ahead along its z, 2 m a scan; the LiDAR's x is ahead. It sits 0.3 m behind the camera.
  constexpr const char* kPoses =
      "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n1 0 0 0 0 1 0 0 0 0 1 4\n";
  put_file(sequence / "poses.txt", kPoses);
  const auto left_out = [&] {
    const Result<Recording> without = read_scan_folder(sequence);
    EXPECT_TRUE(without && without->truth.empty());
    return without ? format("{}", fmt::join(without->assumptions, "\n")) : without.error().message;
  };
  const std::string no_calibration = left_out();
  EXPECT_NE(no_calibration.find("ground truth: it is left out; "), std::string::npos) << no_calibration;
  EXPECT_EQ(no_calibration.find("calib.txt"), no_calibration.rfind("calib.txt")) << "named once";
  put_file(sequence / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 -0.3\n");

  const FolderReading reading{Pose::planar(1.5, 0.0, 0.0)};
  for (const auto& path : {sequence, sequence / "velodyne"}) {
    const Result<Recording> recording = read_scan_folder(path, {.first = 1}, reading);
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->name, path.filename().string());
    ASSERT_EQ(recording->truth.size(), 2U);
    EXPECT_EQ(recording->truth[0].stamp, recording->scan_stamps[0]);
    const Pose T_first_second = recording->truth[0].T_world_body.inverse() * recording->truth[1].T_world_body;
    EXPECT_LT((T_first_second.log() - Pose::translation_of(2, 0, 0).log()).norm(), 1e-9);
    // 2 m ahead, 0.3 m back to the LiDAR and 1.5 m back to the base, along the camera's z.
    EXPECT_LT((recording->truth[0].T_world_body.translation() - Vector3(0, 0, 0.2)).norm(), 1e-9);
  }
  put_file(sequence / "poses.txt",
           "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 2 0 0 0 0 1 2\n1 0 0 0 0 1 0 0 0 0 1 4\n");
  EXPECT_NE(left_out().find("poses.txt: line 2: the left part of the matrix is no rotation"),
            std::string::npos);
  put_file(sequence / "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_NE(left_out().find("poses.txt: 1 poses for 3 scans"), std::string::npos);
  // Where KITTI itself has them.
  std::filesystem::create_directories(folder / "set/sequences");
  std::filesystem::create_directories(folder / "set/poses");
  std::filesystem::rename(sequence, folder / "set/sequences/07");
  std::filesystem::remove(folder / "set/sequences/07/poses.txt");
  put_file(folder / "set/poses/07.txt", kPoses);
  EXPECT_EQ(read_scan_folder(folder / "set/sequences/07")->truth.size(), 3U);
  put_file(folder / "set/sequences/07/calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_TRUE(read_scan_folder(folder / "set/sequences/07")->truth.empty()) << "no line Tr:";
}

TEST(ScanFolder, BadFolders) {
  const TemporaryFolder folder;
  EXPECT_ERROR(read_scan_folder(folder.path()), "neither clouds (.pcd, .ply, .bin) nor bags");
  EXPECT_ERROR(read_scan_folder(folder.path()), "it is empty");
  std::filesystem::create_directories(folder / "monday");
  EXPECT_ERROR(read_scan_folder(folder.path()), "give one of what it holds: " + (folder / "monday").string());
  std::filesystem::remove(folder / "monday");
  ASSERT_TRUE(write_cloud(folder / "world.pcd", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "is given by its name: " + (folder / "world.pcd").string());
  std::filesystem::remove(folder / "world.pcd");
  EXPECT_ERROR(read_scan_folder(folder / "absent"), "cannot be listed");
  ASSERT_TRUE(write_cloud(folder / "1.pcd", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "1 scan(s) taken");
  ASSERT_TRUE(write_cloud(folder / "01.pcd", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "have the same number");
  std::filesystem::rename(folder / "01.pcd", folder / "2.pcd");
  ASSERT_TRUE(read_scan_folder(folder.path()));
  put_file(folder / "stamps.txt", "1.5\n1.5\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "stamps.txt: line 2: stamp 1.5 is not after");
  put_file(folder / "stamps.txt", "1.5\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "stamps.txt: 1 stamps for 2 scans");
  put_file(folder / "stamps.txt", "1.5\n2.5\n");
  put_file(folder / "odometry.tum", "3 0 0 0 0 0 0 1\n4 0 0 0 0 0 0 1\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "covers none of the scans");
  put_file(folder / "odometry.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  const Result<Recording> longer = read_scan_folder(folder.path(), {}, {.T_base_lidar = Pose()});
  ASSERT_TRUE(longer) << longer.error().message;
  EXPECT_EQ(longer->num_scans(), 2U) << "the last one is later than the wheels";
  ASSERT_TRUE(write_cloud(folder / "3.ply", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "several kinds");
  ASSERT_TRUE(write_cloud(folder / "map.ply", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "has no number");
}

/// Two scans of a robot whose LiDAR is turned on its mount, with all that a recording can hold.
Recording full_recording() {
  Recording recording;
  recording.name = "robot_7";
  recording.lidar = "vlp-16";
  recording.T_base_lidar = Pose::planar(0.3, -0.1, 0.5, 0.9);
  recording.scan_stamps = {{1'000'000'001}, {1'100'000'002}};
  recording.read_scan = [stamps = recording.scan_stamps](std::size_t i) -> Result<Scan> {
    Scan scan{stamps[i], one_point(0.1F * static_cast<float>(i + 1))};
    scan.cloud.points.emplace_back(-1.0F, 0.3F, 1e-7F);
    scan.cloud.intensities = {7.0F, 0.125F};
    scan.cloud.time_offsets_ns = {-7, -99'999'999};
    return scan;
  };
  recording.wheel = {{{0}, Pose()}, {{2'000'000'000}, Pose::planar(1, 0, 0.1)}};
  recording.truth = {{{0}, Pose()}, {{2'000'000'000}, Pose::planar(1.1, 0, 0.1)}};
  return recording;
}

class ScanFolderFormats : public ::testing::TestWithParam<CloudFormat> {};

TEST_P(ScanFolderFormats, LoseNothing) {
  const TemporaryFolder folder;
  const Recording recording = full_recording();
  const Result<std::size_t> written = write_scan_folder(folder / "out", recording, GetParam());
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(*written, 0U);
  const Result<Recording> back = open_recording((folder / "out").string());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, "robot_7");
  EXPECT_EQ(back->lidar, "vlp-16");
  EXPECT_LT((back->T_base_lidar.inverse() * recording.T_base_lidar).log().norm(), 1e-12);
  EXPECT_EQ(back->mount_source, "recording.toml");
  EXPECT_TRUE(back->clouds_in_mount_frame);
  EXPECT_TRUE(back->assumptions.empty());
  EXPECT_EQ(back->scan_stamps, recording.scan_stamps);
  EXPECT_EQ(tum_text(back->wheel), tum_text(recording.wheel));
  EXPECT_EQ(tum_text(back->truth), tum_text(recording.truth));
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = back->read_scan(i);
    ASSERT_TRUE(scan) << scan.error().message;
    const PointCloud expected = recording.read_scan(i)->cloud;
    EXPECT_EQ(scan->stamp, recording.scan_stamps[i]);
    EXPECT_EQ(scan->cloud.points, expected.points);  // in the LiDAR's frame, bit for bit
    EXPECT_EQ(scan->cloud.intensities, expected.intensities);
    EXPECT_EQ(scan->cloud.time_offsets_ns, expected.time_offsets_ns);
  }
}

TEST_P(ScanFolderFormats, ScansWithoutPointsAreLeftOut) {
  const TemporaryFolder folder;
  Recording recording = full_recording();
  recording.scan_stamps.insert(recording.scan_stamps.begin(), Stamp{900'000'000});
  recording.read_scan = [read = recording.read_scan](std::size_t i) -> Result<Scan> {
    if (i > 0) return read(i - 1);
    return Scan{{900'000'000}, {}};
  };
  EXPECT_EQ(write_scan_folder(folder / "out", recording, GetParam()), 1U);
  const Result<Recording> back = open_recording((folder / "out").string());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->scan_stamps, full_recording().scan_stamps);
  EXPECT_EQ(back->read_scan(0)->cloud.points, full_recording().read_scan(0)->cloud.points);
  recording.scan_stamps.resize(1);
  EXPECT_ERROR(write_scan_folder(folder / "none", recording, GetParam()), "no scan has a point");
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

INSTANTIATE_TEST_SUITE_P(All, ScanFolderFormats,
                         ::testing::Values(CloudFormat::pcd, CloudFormat::ply, CloudFormat::kitti),
                         [](const auto& item) { return std::string(extension_of(item.param).substr(1)); });

/// The folder of `full_recording` without what only recording.toml says.
std::filesystem::path written_without_toml(const TemporaryFolder& folder, Recording recording) {
  const std::filesystem::path out = folder / "out";
  EXPECT_TRUE(write_scan_folder(out, recording));
  std::filesystem::remove(out / "recording.toml");
  return out;
}

TEST(ScanFolder, AViewpointThatAllCloudsShareIsTheMount) {
  const TemporaryFolder folder;
  const std::filesystem::path out = written_without_toml(folder, full_recording());
  const Result<Recording> back = read_scan_folder(out);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_LT((back->T_base_lidar.inverse() * full_recording().T_base_lidar).log().norm(), 1e-12);
  EXPECT_EQ(back->mount_source, "VIEWPOINT of the clouds");
  EXPECT_EQ(back->name, "out");
  // One that changes from cloud to cloud is a path.
  ASSERT_TRUE(write_cloud(out / "000001.pcd", one_point(1), Pose::translation_of(5, 0, 1)));
  EXPECT_ERROR(read_scan_folder(out), "nothing says where the LiDAR sits on the robot; give --mount X,Y,Z");
}

TEST(ScanFolder, WheelsNeedAMount) {
  const TemporaryFolder folder;
  Recording recording = full_recording();
  recording.T_base_lidar = Pose();
  const std::filesystem::path out = written_without_toml(folder, recording);
  EXPECT_ERROR(read_scan_folder(out), "out: there is wheel odometry, but nothing says where the LiDAR sits");
  const Result<Recording> given = open_recording(out.string(), {"0.1 0 0.8", ""});
  ASSERT_TRUE(given) << given.error().message;
  EXPECT_EQ(given->T_base_lidar.translation(), Vector3(0.1, 0, 0.8));
  EXPECT_EQ(given->mount_source, "given by the user");
  EXPECT_TRUE(given->assumptions.empty());
}

TEST(ScanFolder, AnUnknownMountIsAssumedAloudAndTheAssumptionTravels) {
  const TemporaryFolder folder;
  Recording recording = full_recording();
  recording.T_base_lidar = Pose();
  recording.wheel.clear();
  const std::filesystem::path out = written_without_toml(folder, recording);
  const Result<Recording> assumed = read_scan_folder(out);
  ASSERT_TRUE(assumed) << assumed.error().message;
  ASSERT_EQ(assumed->assumptions.size(), 1U);
  EXPECT_TRUE(assumed->assumptions[0].starts_with("mount: nothing says where the LiDAR stood"))
      << assumed->assumptions[0];
  EXPECT_NE(assumed->assumptions[0].find("--mount"), std::string::npos);
  ASSERT_TRUE(write_scan_folder(folder / "copy", *assumed));
  EXPECT_EQ(read_scan_folder(folder / "copy")->assumptions, assumed->assumptions);
  EXPECT_TRUE(open_recording((folder / "copy").string(), {"0 0 1", ""})->assumptions.empty());
}

TEST(ScanFolder, CloudsShiftedToTheirMeansAreNoticed) {
  const TemporaryFolder folder;
  for (const char* name : {"0.ply", "1.ply"}) {
    PointCloud cloud;
    cloud.points = {{1, 2, 3}, {-1, -2, -3}};
    ASSERT_TRUE(write_cloud(folder / name, cloud));
  }
  const Result<Recording> recording = read_scan_folder(folder.path());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_TRUE(std::ranges::any_of(recording->assumptions, [](const std::string& one) {
    return one.find("each cloud was shifted to its own mean") != std::string::npos;
  }));
}

TEST(ScanFolder, CloudsInTheBaseFrameAreBroughtBackToTheLidar) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_scan_folder(folder / "out", full_recording()));
  put_file(folder / "out" / "recording.toml", "mount = '0 0 2'\nframe = 'base'\n");
  const Result<Recording> back = read_scan_folder(folder / "out");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->T_base_lidar.translation(), Vector3(0, 0, 2));
  EXPECT_FALSE(back->clouds_in_mount_frame);
  EXPECT_EQ(back->read_scan(0)->cloud.points[0], Eigen::Vector3f(0.1F, 2, 1));
  put_file(folder / "out" / "recording.toml", "mount = '0 0'\n");
  EXPECT_ERROR(read_scan_folder(folder / "out"), "out: mount '0 0': 2 numbers");
  put_file(folder / "out" / "recording.toml", "mont = '0 0'\n");
  EXPECT_ERROR(read_scan_folder(folder / "out"), "did you mean 'mount'?");
}

TEST(ScanFolder, StampsOfKittiLieBesideTheFolderOfItsScans) {
  const TemporaryFolder folder;
  const std::filesystem::path velodyne = folder / "velodyne";
  std::filesystem::create_directory(velodyne);
  for (const char* name : {"000000.bin", "000001.bin", "000002.bin"})
    ASSERT_TRUE(write_cloud(velodyne / name, one_point(1)));
  put_file(folder / "times.txt", "0.000000e+00\n1.037359e-01\n2.075160e-01\n");
  const Result<Recording> recording = read_scan_folder(velodyne);
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->scan_stamps, std::vector<Stamp>({{0}, {103'735'900}, {207'516'000}}));
  put_file(folder / "times.txt", "0.000000e+00\n1.037359e-01\n");
  EXPECT_ERROR(read_scan_folder(velodyne), "times.txt: 2 stamps for 3 scans");
  put_file(velodyne / "times.txt", "0\n1\n2\n");
  EXPECT_EQ(read_scan_folder(velodyne)->scan_stamps[2].ns, 2'000'000'000);
}

TEST(ScanFolder, MissingPointTimesAreSaidOnce) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "velodyne");
  for (const char* name : {"0.bin", "1.bin"})
    ASSERT_TRUE(write_cloud(folder / "velodyne" / name, one_point(1)));
  const auto notes = [](const std::filesystem::path& path) {
    std::vector<std::string> found = read_scan_folder(path).value().assumptions;
    std::erase_if(found, [](const std::string& one) { return !one.starts_with("point times: "); });
    return found;
  };
  const std::string none = "point times: none, so that scans are not corrected for the motion during a sweep";
  EXPECT_EQ(notes(folder / "velodyne"), std::vector{none});
  put_file(folder / "times.txt", "0\n0.1\n");
  const std::string of_kitti = none + "; clouds of KITTI are already corrected";
  EXPECT_EQ(notes(folder.path()), std::vector{of_kitti});
  ASSERT_TRUE(write_scan_folder(folder / "copy", read_scan_folder(folder.path()).value()));
  EXPECT_EQ(notes(folder / "copy"), std::vector{of_kitti});
  for (const char* name : {"0.offsets", "1.offsets"})
    put_file(folder / "velodyne" / name, std::string(4, '\0'));
  EXPECT_TRUE(notes(folder.path()).empty());
}

/// A .bin of so many points of five columns: x y z intensity and a time.
std::string five_columns(int num) {
  std::string bytes;
  for (int i = 0; i < num; ++i)
    for (const float value :
         {1.5F + static_cast<float>(i), -2.0F, 0.5F, 7.0F, -0.001F * static_cast<float>(i)})
      append_little_endian(bytes, value);
  return bytes;
}

TEST(ScanFolder, AllBinFilesHaveAsManyColumns) {
  const TemporaryFolder folder;
  put_file(folder / "0.bin", five_columns(40));  // whole rows of four columns, too
  put_file(folder / "1.bin", five_columns(41));
  put_file(folder / "2.bin", five_columns(7).substr(0, 101));  // cut short
  const Result<Recording> recording = read_scan_folder(folder.path());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->read_scan(0)->cloud.size(), 40U);
  EXPECT_EQ(recording->read_scan(1)->cloud.size(), 41U);
  EXPECT_ERROR(recording->read_scan(2), "2.bin: 101 bytes are not a whole number of points");
  EXPECT_TRUE(std::ranges::any_of(recording->assumptions, [](const std::string& one) {
    return one.starts_with("clouds: .bin with five columns");
  }));
  put_file(folder / "3.bin", five_columns(4).substr(0, 48));
  EXPECT_ERROR(read_scan_folder(folder.path()),
               "3.bin has whole rows of x y z intensity (16 bytes), 1.bin of five");
  // Where all have whole rows of either, the first one shows which.
  for (const char* name : {"0.bin", "1.bin", "2.bin", "3.bin"}) put_file(folder / name, five_columns(120));
  EXPECT_EQ(read_scan_folder(folder.path())->read_scan(3)->cloud.size(), 120U);
}

TEST(ScanFolder, TheFirstCloudDecidesWhatTimesCountFrom) {
  const TemporaryFolder folder;
  const auto put = [&](const char* name, std::int64_t start) {
    std::string rows;
    for (int i = 0; i < 200; ++i) rows += format("1 2 3 {}\n", start + 500'000 * i);
    put_file(
        folder / name,
        "FIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F U\nWIDTH 200\nHEIGHT 1\nPOINTS 200\nDATA ascii\n" + rows);
  };
  put("0.pcd", 3'000'000'000);
  put("1.pcd", 1'000'000'000);
  const Result<Recording> recording = read_scan_folder(folder.path());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->read_scan(1)->cloud.time_offsets_ns.front(), 0);
}

TEST(ScanFolder, PointTimesThatDoNotFitTheirCloudAreAnError) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_scan_folder(folder / "out", full_recording(), CloudFormat::kitti));
  put_file(folder / "out" / "000001.offsets", "1234");
  const Result<Recording> back = read_scan_folder(folder / "out");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->read_scan(0));
  EXPECT_ERROR(back->read_scan(1), "000001.offsets: 4 bytes for 2 points");
}

}  // namespace
}  // namespace adit
