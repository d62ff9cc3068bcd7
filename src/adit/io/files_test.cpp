// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Routes, configuration and folders of scans.
#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "adit/io/byte_source.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/scan_folder.hpp"
#include "adit/io/tum.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

TEST(ByteSource, ReadsInsideTheFileOnly) {
  const TemporaryFolder folder;
  put_file(folder / "a", "0123456789");
  const Result<ByteSource> file = open_source(folder / "a");
  ASSERT_TRUE(file);
  for (const ByteSource& source : {*file, memory_source("0123456789")}) {
    EXPECT_EQ(source.read(3, 4), "3456");
    EXPECT_EQ(source.read(10, 0), "");
    EXPECT_ERROR(source.read(8, 3), "past the end at byte 10");
    EXPECT_FALSE(source.read(~std::uint64_t{0}, 2));
    EXPECT_FALSE(source.read(2, ~std::uint64_t{0}));
  }
  EXPECT_ERROR(open_source(folder / "absent"), "no such file");
  EXPECT_FALSE(open_source(folder.path()));
}

TEST(Routes, RoundTrip) {
  RoutesFile routes;
  routes.world = "a b.ply";
  routes.routes = {{"robot_0", 1.87, {{0, 0, 0}, {1, 0.1, -0.3}}},
                   {"r\"1", 2.0, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}}};
  const Result<RoutesFile> back = parse_routes(routes_text(routes));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->world, routes.world);
  ASSERT_EQ(back->routes.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->routes[i].name, routes.routes[i].name);
    EXPECT_EQ(back->routes[i].speed_mps, routes.routes[i].speed_mps);
    EXPECT_EQ(back->routes[i].waypoints, routes.routes[i].waypoints);
  }
}

TEST(Routes, TheWorldIsRelativeToTheFile) {
  const TemporaryFolder folder;
  put_file(folder / "routes.yaml", "world: sub/w.ply\nrobots: [{name: a, waypoints: [[0,0,0],[1,0,0]]}]\n");
  const Result<RoutesFile> routes = read_routes(folder / "routes.yaml");
  ASSERT_TRUE(routes) << routes.error().message;
  EXPECT_EQ(routes->world, folder.path() / "sub/w.ply");
  EXPECT_EQ(routes->routes[0].speed_mps, 1.87);
}

TEST(Routes, ErrorsNameTheLine) {
  const auto robot = [](std::string_view entries) {
    return parse_routes("robots:\n  - " + std::string(entries));
  };
  EXPECT_ERROR(parse_routes("world: w\nrobot: []\n"),
               "line 2, column 1: unknown key 'robot'; did you mean 'robots'?");
  EXPECT_ERROR(parse_routes("world: w\n"), "no robots");
  EXPECT_ERROR(parse_routes(""), "a map of world and robots");
  EXPECT_ERROR(parse_routes("a: [1, 2"), "line ");
  EXPECT_ERROR(robot("speed: 1\n"), "line 2, column 5: the robot has no name");
  EXPECT_ERROR(robot("{name: a, speed: 0, waypoints: [[0,0,0],[1,0,0]]}"), "more than 0 m/s");
  EXPECT_ERROR(robot("{name: a, sped: 1, waypoints: [[0,0,0],[1,0,0]]}"), "did you mean 'speed'?");
  EXPECT_ERROR(robot("{name: a, name: b}"), "appears twice");
  EXPECT_ERROR(robot("{name: ../a, waypoints: [[0,0,0],[1,0,0]]}"), "no name for files");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0]]}"), "at least two waypoints");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,0]]}"), "[x, y, z]");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,.nan,0]]}"), "finite number");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,0,0]]}\n  - {name: a, waypoints: [[0,0,0],[1,0,0]]}"),
               "line 3, column 5: a second robot named 'a'");
}

TEST(Routes, TruncationAndGarbageAreSurvived) {
  const std::string text = routes_text({"w.ply", {{"a", 1.5, {{0, 0, 0}, {1, 0, 0}}}}});
  for (std::size_t size = 0; size < text.size(); ++size)
    static_cast<void>(parse_routes(text.substr(0, size)));
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 2; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    static_cast<void>(parse_routes(damaged));
  }
}

struct TestConfig {
  double voxel = 1.0;
  int count = 3;
  bool on = false;
  std::string mode = "fast";
};
Fields fields_of(TestConfig& c) {
  Fields fields = {{"on", &c.on, "", 0, 1, "whether"}};
  append(fields, "icp",
         {{"voxel", &c.voxel, "m", 0.1, 10, "edge"}, {"count", &c.count, "", 1, 9, "how often"}});
  append(fields, "icp.deep", {{"mode", &c.mode, "", 0, 0, "which", {"fast", "exact"}}});
  return fields;
}

TEST(ConfigToml, SetsNestedFieldsAndReadsItsOwnText) {
  TestConfig config;
  ASSERT_TRUE(
      parse_config(fields_of(config), "on = true\n[icp]\nvoxel = 2\ncount = 4\ndeep.mode = 'exact'\n"));
  EXPECT_EQ(config.voxel, 2.0);
  EXPECT_TRUE(config.on);
  EXPECT_EQ(config.mode, "exact");
  TestConfig back;
  const Result<> parsed = parse_config(fields_of(back), to_toml(fields_of(config)));
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(to_toml(fields_of(back)), to_toml(fields_of(config)));
  EXPECT_EQ(back.count, 4);
}

TEST(ConfigToml, ErrorsNameTheLine) {
  TestConfig config;
  const Fields fields = fields_of(config);
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxl = 2.0\n"),
               "line 2: unknown configuration key 'icp.voxl'; did you mean 'icp.voxel'?");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = 20.0\n"), "outside 0.1 to 10 m");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = '2.0'\n"), "no string");
  EXPECT_ERROR(parse_config(fields, "[icp]\ncount = 2.5\n"), "whole number");
  EXPECT_ERROR(parse_config(fields, "[icp.deep]\nmode = 3\n"), "string in quotes");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = [1]\n"), "line 2: icp.voxel");
  EXPECT_ERROR(parse_config(fields, "on = \n"), "line 1");
  EXPECT_ERROR(load_config("/absent.toml", fields), "/absent.toml: no such file");
}

struct ListEntry {
  std::string name;
  int size = 1;
};

Result<std::vector<ListEntry>> entries_of(const TemporaryFolder& folder, const std::string& text) {
  put_file(folder / "list.toml", text);
  std::vector<ListEntry> entries;
  return load_entries(folder / "list.toml", "box",
                      [&]() -> Fields {
                        ListEntry& entry = entries.emplace_back();
                        return {{"name", &entry.name, "", 0, 0, "its name"},
                                {"shape.size", &entry.size, "", 1, 9, "its size"}};
                      })
      .map([&] { return entries; });
}

TEST(ConfigToml, AListHasOneEntryATable) {
  const TemporaryFolder folder;
  const auto entries = entries_of(folder, "[[box]]\nname = 'a'\nshape = {size = 3}\n[[box]]\nname = 'b'\n");
  ASSERT_TRUE(entries) << entries.error().message;
  ASSERT_EQ(entries->size(), 2U);
  EXPECT_EQ((*entries)[0].name, "a");
  EXPECT_EQ((*entries)[0].size, 3);
  EXPECT_EQ((*entries)[1].name, "b");
  EXPECT_EQ((*entries)[1].size, 1);
  EXPECT_TRUE(entries_of(folder, "")->empty());
}

TEST(ConfigToml, AListRefusesWhatIsNotItsOwn) {
  const TemporaryFolder folder;
  EXPECT_ERROR(entries_of(folder, "[[bok]]\n"), "line 1");
  EXPECT_ERROR(entries_of(folder, "[box]\nname = 'a'\n"), "[[box]]");
  EXPECT_ERROR(entries_of(folder, "box = [1]\n"), "a table is needed");
  EXPECT_ERROR(entries_of(folder, "[[box]]\nnam = 'a'\n"), "did you mean");
  EXPECT_ERROR(entries_of(folder, "[[box]]\nshape.size = 10\n"), "line 2");
  EXPECT_ERROR(entries_of(folder, "[[box]\n"), "line 1");
  EXPECT_ERROR(load_entries(folder / "absent.toml", "box", [] { return Fields{}; }), "absent.toml");
}

TEST(ConfigToml, MarkdownHasOneRowAField) {
  TestConfig config;
  const std::string text = to_markdown(fields_of(config));
  EXPECT_NE(text.find("## `icp`"), std::string::npos);
  EXPECT_NE(text.find("| `icp.voxel` | 1 | m | 0.1 to 10 | edge |"), std::string::npos) << text;
  EXPECT_NE(text.find("| `icp.deep.mode` | fast |  | fast, exact | which |"), std::string::npos) << text;
}

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

TEST(ScanFolder, BadFolders) {
  const TemporaryFolder folder;
  EXPECT_ERROR(read_scan_folder(folder.path()), "no clouds in it");
  EXPECT_ERROR(read_scan_folder(folder / "absent"), "cannot be listed");
  ASSERT_TRUE(write_cloud(folder / "1.pcd", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "1 scan(s) taken");
  ASSERT_TRUE(write_cloud(folder / "01.pcd", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "have one number");
  std::filesystem::rename(folder / "01.pcd", folder / "2.pcd");
  ASSERT_TRUE(read_scan_folder(folder.path()));
  put_file(folder / "stamps.txt", "1.5\n1.5\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "stamps.txt: line 2: stamp 1.5 is not after");
  put_file(folder / "stamps.txt", "1.5\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "1 stamps for 2 scans");
  put_file(folder / "stamps.txt", "1.5\n2.5\n");
  put_file(folder / "odometry.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  EXPECT_ERROR(read_scan_folder(folder.path()), "does not cover the scans");
  ASSERT_TRUE(write_cloud(folder / "3.ply", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "several kinds");
  ASSERT_TRUE(write_cloud(folder / "map.ply", one_point(1)));
  EXPECT_ERROR(read_scan_folder(folder.path()), "holds no number");
}

TEST(ScanFolder, WritesWhatItReads) {
  const TemporaryFolder folder;
  Recording recording;
  recording.name = "r";
  recording.T_base_lidar = Pose::translation_of(0, 0, 1);
  recording.scan_stamps = {{1'000'000'001}, {1'100'000'002}};
  recording.read_scan = [&](std::size_t i) -> Result<Scan> {
    Scan scan{recording.scan_stamps[i], one_point(static_cast<float>(i))};
    scan.cloud.time_offsets_ns = {-7};
    return scan;
  };
  recording.wheel = {{{0}, Pose()}, {{2'000'000'000}, Pose::planar(1, 0, 0)}};
  const Result<> written = write_scan_folder(folder / "out", recording);
  ASSERT_TRUE(written) << written.error().message;
  const Result<Recording> back = open_recording((folder / "out").string());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, "out");
  EXPECT_EQ(back->scan_stamps, recording.scan_stamps);
  EXPECT_EQ(back->wheel.size(), 2U);
  EXPECT_EQ(back->read_scan(1)->cloud.points[0], Eigen::Vector3f(1, 2, 4));  // in the base frame
  EXPECT_EQ(back->read_scan(1)->cloud.time_offsets_ns[0], -7);
}

TEST(OpenRecording, SelectsPartsOfAFolder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(write_cloud(folder / (std::to_string(i) + ".bin"), one_point(1)));
  const std::string path = folder.path().string();
  EXPECT_EQ(open_recording(path)->num_scans(), 6U);
  EXPECT_EQ(open_recording(path + "@even")->scan_stamps[1].ns, 2'000'000'000);
  EXPECT_EQ(open_recording(path + "@odd")->scan_stamps[1].ns, 3'000'000'000);
  EXPECT_EQ(open_recording(path + "@1:3")->num_scans(), 2U);
  EXPECT_TRUE(open_recording(path + "@1:3")->name.ends_with("_1_3"));
  EXPECT_ERROR(open_recording(path + "@1:0"), "@even, @odd and @FIRST:STEP");
  EXPECT_ERROR(open_recording(path + "@9:1"), "0 scan(s) taken");
  EXPECT_ERROR(open_recording(path + "/absent"), "no such file or folder");
  put_file(folder / "a.txt", "");
  EXPECT_ERROR(open_recording(path + "/a.txt"), "is no recording");
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
