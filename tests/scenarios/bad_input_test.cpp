// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whatever is wrong with the input: one line on stderr that names the file and the problem, exit code 1
/// (data) or 2 (usage), and what lies at the output stays as it was.
#include <gtest/gtest.h>

#include "adit/io/cloud_files.hpp"
#include "adit/io/ply.hpp"
#include "support/hall.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

using test::expect_refused;
using test::put_file;

/// A folder for inputs, and an output directory of adit's own kind with a marker in it that must survive.
class BadInput : public ::testing::Test {
 protected:
  BadInput() {
    std::filesystem::create_directories(out());
    for (const char* kind : {"world", "session", "study", "scans"}) put_file(out() + "/.adit-" + kind, "");
    put_file(out() + "/marker", "as it was");
    put_file(existing(), "as it was");
  }

  ~BadInput() override {
    EXPECT_EQ(test::get_file(out() + "/marker"), "as it was");
    EXPECT_EQ(test::get_file(existing()), "as it was");
    EXPECT_EQ(test::num_entries(out()), 5U) << "something was left in the output directory";
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      EXPECT_EQ(entry.path().string().find(".partial-"), std::string::npos) << entry.path();
  }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string out() const { return path("out"); }
  [[nodiscard]] std::string existing() const { return path("existing.tum"); }

  /// A wall of 10 x 10 points.
  static PointCloud wall() {
    PointCloud cloud;
    for (int i = 0; i < 100; ++i)
      cloud.points.emplace_back(5.0F, 0.3F * static_cast<float>(i % 10), 0.2F * static_cast<float>(i / 10));
    return cloud;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(BadInput, MissingFiles) {
  const std::string absent = path("absent");
  expect_refused("info " + absent + ".pcd", 1, "absent.pcd: no such file");
  expect_refused("info " + absent, 1, "absent: no such file or folder");
  expect_refused("odometry " + absent + ".mcap --method kiss-icp --out " + existing(), 1,
                 "absent.mcap: no such file");
  expect_refused("slam " + absent + ".mcap --out " + out(), 1, "absent.mcap: no such file");
  expect_refused("slam " + absent + ".yaml --out " + out(), 1, "absent.yaml: no such file");
  expect_refused("register " + absent + ".ply " + absent + ".ply", 1, "absent.ply: no such file");
  expect_refused("solve " + absent + ".g2o", 1, "absent.g2o: no such file");
  expect_refused("convert " + absent + ".tum " + existing(), 1, "absent.tum: no such file");
  expect_refused("simulate --routes " + absent + ".yaml --out " + out(), 1, "absent.yaml: no such file");
}

TEST_F(BadInput, UnknownKinds) {
  put_file(path("notes.doc"), "hello");
  expect_refused("info " + path("notes.doc"), 1, "notes.doc: not a kind of file that adit knows");
  expect_refused("convert " + path("notes.doc") + " " + existing(), 2, "cannot become");
  expect_refused("convert " + path("a.pcd") + " " + existing(), 2, "a.pcd cannot become");
  expect_refused("convert " + path("a.mcap") + " " + path("a.las"), 2, "becomes .mcap, a folder of clouds");
  put_file(path("a.db3.zstd"), "packed");
  expect_refused("info " + path("a.db3.zstd"), 1, "unpack it: zstd -d");
}

TEST_F(BadInput, TheMetadataOfABagInPlaceOfItsFolder) {
  std::filesystem::create_directories(path("bag"));
  const std::string metadata = path("bag/metadata.yaml");
  put_file(metadata, "rosbag2_bagfile_information:\n  relative_file_paths: [a_0.db3]\n");
  for (const std::string& command :
       {"slam " + metadata + " --out " + out(), "slam a=" + metadata + " --out " + out(),
        "slam " + metadata + " " + path("b.mcap") + " --out " + out(),
        "slam --namespaces " + metadata + " --out " + out(), "info " + metadata, "doctor " + metadata,
        "odometry " + metadata + " --method kiss-icp --out " + existing(),
        "convert " + metadata + " " + path("b.mcap")})
    expect_refused(command, 1,
                   "metadata.yaml: belongs to a bag and is no recording by itself; give the folder");
}

TEST_F(BadInput, Clouds) {
  put_file(path("empty.pcd"), "");
  put_file(path("none.pcd"),
           "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA "
           "ascii\n");
  put_file(path("nan.pcd"),
           "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA "
           "ascii\nnan 0 0\n0 inf 0\n");
  const std::string whole = write_ply(wall());
  put_file(path("cut.ply"), whole.substr(0, whole.size() / 2));
  put_file(path("good.ply"), whole);
  for (const char* name : {"empty.pcd", "none.pcd", "nan.pcd", "cut.ply"}) {
    expect_refused("info " + path(name), 1, name);
    expect_refused("register " + path("good.ply") + " " + path(name), 1, name);
    expect_refused("convert " + path(name) + " " + path("new.ply"), 1, name);
    EXPECT_FALSE(std::filesystem::exists(path("new.ply")));
  }
}

TEST_F(BadInput, SomePointsThatAreNotFiniteAreLeftOutAndCounted) {
  put_file(path("some.pcd"),
           "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA "
           "ascii\nnan 0 0\n1 2 3\n");
  const test::ProgramRun run = test::run_adit("info " + path("some.pcd"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("points: 1\nskipped_nan: 1\n"), std::string::npos) << run.out;
}

TEST_F(BadInput, Recordings) {
  std::filesystem::create_directories(path("one"));
  ASSERT_TRUE(write_cloud(path("one/0.pcd"), wall()));
  expect_refused("odometry " + path("one") + " --method kiss-icp --out " + existing(), 1,
                 "a recording needs two or more");
  expect_refused("slam " + path("one") + " --out " + out(), 1, "a recording needs two or more");
  ASSERT_TRUE(write_cloud(path("one/1.pcd"), wall()));
  put_file(path("one/groundtruth.tum"), "1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n");
  expect_refused("odometry " + path("one") + " --method kiss-icp --out " + existing(), 1,
                 "groundtruth.tum: line 2");
  std::filesystem::create_directories(path("none"));
  expect_refused("slam " + path("none") + " --out " + out(), 1, "none: neither clouds");
  std::filesystem::create_directories(path("session"));
  put_file(path("session/session.toml"), "");
  put_file(path("session/map.ply"), write_ply(wall()));
  for (const std::string& command :
       {"slam " + path("session") + " --out " + out(), "doctor " + path("session"),
        "odometry " + path("session") + " --out " + existing()})
    expect_refused(command, 1, "is a session, not a recording");
  expect_refused("doctor " + path("one") + " --points /typo", 1, "there is no topic '/typo'");
  put_file(path("bad.mcap"), "\x89MCAP0\r\n");
  expect_refused("slam " + path("bad.mcap") + " --out " + out(), 1, "bad.mcap");
}

TEST_F(BadInput, ADamagedCloudCostsItself) {
  std::filesystem::create_directories(path("drive"));
  for (const char* name : {"0.pcd", "1.pcd", "2.pcd"})
    ASSERT_TRUE(write_cloud(path(std::string("drive/") + name), wall()));
  const std::string whole = test::get_file(path("drive/1.pcd"));
  put_file(path("drive/1.pcd"), whole.substr(0, whole.size() / 2));
  const test::ProgramRun run = test::run_adit("convert " + path("drive") + " " + path("drive.mcap"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("1 of 3 scans are left out; the first, 1: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("drive/1.pcd"), std::string::npos) << run.err;
  const test::ProgramRun info = test::run_adit("info " + path("drive.mcap"));
  EXPECT_NE(info.out.find("scans: 3"), std::string::npos) << info.out;
  const test::ProgramRun folder = test::run_adit("convert " + path("drive") + " " + path("copy"));
  EXPECT_EQ(folder.exit_code, 0) << folder.err;
  EXPECT_NE(folder.err.find("1 of 3 scans have no points"), std::string::npos) << folder.err;
  EXPECT_EQ(test::run_adit("info " + path("copy")).exit_code, 0);
  expect_refused("convert " + path("drive") + " " + path("drive.db3"), 1, "as .mcap, or as a folder");
  for (const char* name : {"drive/0.pcd", "drive/2.pcd"})
    put_file(path(name), whole.substr(0, whole.size() / 2));
  expect_refused("convert " + path("drive") + " " + path("none.mcap"), 1, "drive/0.pcd");
  EXPECT_FALSE(std::filesystem::exists(path("none.mcap")));
}

TEST_F(BadInput, OutputTakesNothingElsesPlace) {
  std::filesystem::create_directories(path("drive"));
  for (const char* name : {"0.pcd", "1.pcd"})
    ASSERT_TRUE(write_cloud(path(std::string("drive/") + name), wall()));
  const std::string mcap = path("drive.mcap");
  test::expect_done("convert " + path("drive") + " " + mcap);
  const std::string recording = test::get_file(mcap);
  expect_refused("convert " + mcap + " " + mcap, 2, "is what is read, and would be replaced");
  expect_refused("convert " + path("drive@even") + " " + path("drive"), 2, "is what is read");
  expect_refused("convert " + path("drive") + " " + path("drive/0.pcd"), 2, "is what is read");
  expect_refused("odometry " + path("drive") + " --out " + mcap, 2, "as .tum or .txt");
  expect_refused("localize " + out() + " " + path("drive") + " --out " + mcap, 2, "as .tum or .txt");
  EXPECT_TRUE(test::get_file(mcap) == recording);
}

TEST_F(BadInput, WrongReadingsAreWrongUsageOfInfo) {
  const std::string bag = std::string(ADIT_CONFORMANCE) + "/tube.mcap";
  expect_refused("info " + bag + " --set recording.stamp_at=middle", 2, "not one of auto, start, end");
  expect_refused("doctor " + bag + " --point-times ps", 2, "--point-times");
  expect_refused("doctor " + bag + " --point-time-field typo", 1, "no field 'typo'");
  expect_refused("doctor " + bag + " --bin-columns 2", 2, "--bin-columns");
  expect_refused("info " + bag + " --set recording.bin_columns=2", 1,
                 "recording.bin_columns: 2 is not 3 to 8");
  expect_refused("info " + bag + " --points /typo", 1, "no topic of clouds '/typo'; there are: /points");
  expect_refused("info " + bag + " --wheel /points", 1, "no topic of wheel odometry '/points'");
  expect_refused("info " + bag + " --set recording.mount=here", 1, "here");
}

TEST_F(BadInput, UnorderedStampsInATrajectory) {
  put_file(path("back.tum"), "1 0 0 0 0 0 0 1\n3 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  expect_refused("info " + path("back.tum"), 1, "back.tum: line 3");
  expect_refused("convert " + path("back.tum") + " " + existing(), 1, "back.tum: line 3");
}

TEST_F(BadInput, WorldsAndRoutes) {
  test::put_route(path("routes.yaml"), 3, 10);
  const std::string simulate = "simulate --lidar vlp-16 --out " + out() + " --routes ";
  put_file(path("hall.ply"), write_ply(wall()));
  expect_refused(simulate + path("routes.yaml"), 1, "hall.ply: the mesh has no triangles");
  test::put_hall(path(""));
  test::put_route(path("outside.yaml"), 30, 60);
  expect_refused(simulate + path("outside.yaml"), 1, "alpha");
  // A second hall beside the first, with their walls between.
  TriangleMesh two = test::room({0, -4, 0}, {10.5, 4, 4});
  append(two, test::room({10.5, -4, 0}, {20, 4, 4}));
  ASSERT_TRUE(write_mesh(path("hall.ply"), two));
  test::put_route(path("wall.yaml"), 3, 17);
  expect_refused(simulate + path("wall.yaml"), 1, "wall");
  expect_refused("slam " + path("wall.yaml") + " --out " + out(), 1, "wall");
  expect_refused(simulate + path("routes.yaml") + " --robot beta", 1, "alpha");
}

TEST_F(BadInput, ConfigurationAndUsage) {
  test::put_hall(path(""));
  test::put_route(path("routes.yaml"), 3, 10);
  const std::string routes = path("routes.yaml");
  put_file(path("run.toml"), "[simulation]\nsede = 3\n");
  expect_refused("simulate --routes " + routes + " --out " + out() + " --config " + path("run.toml"), 1,
                 "did you mean 'simulation.seed'?");
  expect_refused("simulate --routes " + routes + " --out " + out() + " --set simulation.sede=3", 2,
                 "did you mean 'simulation.seed'?");
  expect_refused("simulate --routes " + routes + " --out " + out() + " --set simulation.seed", 2,
                 "key=value");
  expect_refused("simulate --routes " + routes + " --out " + out() + " --lidar os3", 2, "os2-128");
  expect_refused("slam " + routes + " --out " + out() + " --keyframes most", 2, "tunnel_filter");
  expect_refused("world --preset zap --out " + out(), 2, "zab, mine, metro");
  expect_refused("covert a b", 2, "did you mean 'convert'?");
  expect_refused("frobnicate", 2, "frobnicate");
  expect_refused("--json infos x.mcap", 2, "did you mean 'info'?");
  expect_refused("info x.mcap --mounts 0,0,0", 2, "unknown option '--mounts', did you mean '--mount'?");
  expect_refused("info x.mcap --threads 0", 2, "not in range 1 to 1024");
  expect_refused("", 2, "required");
  expect_refused("convert a.pcd", 2, "OUT is required");
  expect_refused("odometry x.mcap --method orb --out " + existing(), 2, "kiss-icp");
}

TEST_F(BadInput, AnOutputThatIsNotAditsIsLeftAlone) {
  test::put_hall(path(""));
  test::put_route(path("routes.yaml"), 3, 10);
  std::filesystem::create_directories(path("mine"));
  put_file(path("mine/thesis.tex"), "years of work");
  expect_refused("world --preset zab --out " + path("mine"), 1, "mine");
  expect_refused("slam " + path("routes.yaml") + " --out " + path("mine"), 1, "mine");
  EXPECT_EQ(test::get_file(path("mine/thesis.tex")), "years of work");
}

}  // namespace
}  // namespace adit
