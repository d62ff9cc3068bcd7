// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// `adit convert`, `adit info` and `adit simulate` on files, as a user runs them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adit/io/cloud_files.hpp"
#include "adit/io/ply.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/tum.hpp"
#include "support/data.hpp"
#include "support/foreign_mcap.hpp"
#include "support/hall.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::get_file;
using test::put_file;

PointCloud cloud_in(const std::filesystem::path& path) {
  const Result<PointCloud> cloud = read_cloud(path);
  EXPECT_TRUE(cloud) << cloud.error().message;
  return cloud.value_or(PointCloud{});
}

TEST(Convert, CloudFormatsKeepEveryBitOfThePoints) {
  ADIT_NEED_DATA("registration/kitti_pair/source.ply");
  const test::TemporaryFolder folder;
  const std::string base = (folder / "cloud").string();
  const std::string source = test::shared_data("registration/kitti_pair/source.ply").string();
  expect_done("convert " + source + " " + base + ".pcd");
  expect_done("convert " + base + ".pcd " + base + ".bin");
  expect_done("convert " + base + ".bin " + base + ".ply");
  EXPECT_EQ(cloud_in(base + ".pcd").points, cloud_in(source).points);
  EXPECT_EQ(cloud_in(base + ".ply").points, cloud_in(source).points);
}

TEST(Convert, AFolderOfScansToARecordingAndBack) {
  ADIT_NEED_DATA("scans/nclt/0000.pcd");
  const test::TemporaryFolder folder;
  const std::filesystem::path source = test::shared_data("scans/nclt");
  const std::string mcap = (folder / "nclt.mcap").string();
  const std::string back = (folder / "back").string();
  expect_done("convert " + source.string() + " " + mcap);
  expect_done("convert " + mcap + " " + back);
  const Recording a = open_recording(source.string()).value();
  const Recording b = open_recording(back).value();
  ASSERT_EQ(a.scan_stamps, b.scan_stamps);
  for (const std::size_t i : {std::size_t{0}, std::size_t{17}, a.num_scans() - 1})
    EXPECT_EQ(a.read_scan(i).value().cloud.points, b.read_scan(i).value().cloud.points) << i;
  EXPECT_EQ(tum_text(a.truth), tum_text(b.truth));
}

/// A drive through the hall, simulated; its path.
std::string hall_recording(const test::TemporaryFolder& folder) {
  test::put_hall(folder.path());
  test::put_route(folder / "routes.yaml", 3, 8);
  expect_done("simulate --routes " + (folder / "routes.yaml").string() + " --lidar vlp-16 --imu none --out " +
              (folder / "recordings").string());
  return (folder / "recordings/alpha.mcap").string();
}

TEST(Convert, ARecordingComesBackFromAFolderByteForByte) {
  const test::TemporaryFolder folder;
  const std::string recording = hall_recording(folder);
  for (const std::string format : {"pcd", "ply", "bin"}) {
    const std::string scans = (folder / format).string();
    expect_done("convert " + recording + " " + scans + " --clouds " + format);
    expect_done("convert " + scans + " " + scans + ".mcap");
    EXPECT_TRUE(get_file(scans + ".mcap") == get_file(recording)) << format;
  }
  test::expect_refused("convert " + recording + " " + (folder / "x").string() + " --clouds xyz", 2, "xyz");
}

TEST(Convert, TheMountGivenByTheUserIsKept) {
  const test::TemporaryFolder folder;
  const std::string recording = hall_recording(folder);
  const std::string moved = (folder / "moved.mcap").string();
  expect_done("convert " + recording + " " + moved + " --mount 0.5,-0.25,1.25,0,10,0");
  const Pose mount = open_recording(moved).value().T_base_lidar;
  EXPECT_EQ(mount.translation(), Vector3(0.5, -0.25, 1.25));
  EXPECT_NEAR(mount.angle(), 10.0 * 3.14159265358979 / 180.0, 1e-9);
  test::expect_refused("convert " + recording + " " + moved + " --mount 1,2", 2, "2 numbers");
}

TEST(Convert, TrajectoriesKeepEveryBit) {
  const test::TemporaryFolder folder;
  const std::string base = (folder / "poses").string();
  put_file(base + ".tum", "0.100000001 1 2 3 0 0 0 1\n1699999999.123456789 0.1 -0.2 1e-9 0.6 0 0 0.8\n");
  expect_done("convert " + base + ".tum " + base + ".csv");
  EXPECT_TRUE(get_file(base + ".csv").starts_with("stamp_s,x,y,z,qx,qy,qz,qw\n0.100000001,1,2,3,0,0,0,1\n"));
  expect_done("convert " + base + ".csv " + base + "_back.tum");
  expect_done("convert " + base + ".tum " + base + "_again.tum");
  EXPECT_EQ(get_file(base + "_back.tum"), get_file(base + "_again.tum"));
  expect_done("convert " + base + ".tum " + base + ".kitti");
  EXPECT_TRUE(get_file(base + ".kitti").starts_with("1 0 0 1 0 1 0 2 0 0 1 3\n"));
}

TEST(Convert, AGraphIsRewrittenBitForBit) {
  ADIT_NEED_DATA("g2o/single/sphere2500.g2o");
  const test::TemporaryFolder folder;
  const std::string base = (folder / "graph").string();
  expect_done("convert " + test::shared_data("g2o/single/sphere2500.g2o").string() + " " + base + "1.g2o");
  expect_done("convert " + base + "1.g2o " + base + "2.g2o");
  EXPECT_EQ(get_file(base + "1.g2o"), get_file(base + "2.g2o"));
  EXPECT_FALSE(get_file(base + "1.g2o").empty());
}

TEST(Convert, AMeshStaysAMeshAndItsVerticesAreACloud) {
  const test::TemporaryFolder folder;
  test::put_hall(folder.path());
  const std::string mesh = (folder / "hall.ply").string();
  expect_done("convert " + mesh + " " + (folder / "copy.ply").string());
  EXPECT_EQ(get_file(folder / "copy.ply"), write_ply(read_mesh(mesh).value()));
  expect_done("convert " + mesh + " " + (folder / "hall.pcd").string());
  EXPECT_EQ(cloud_in(folder / "hall.pcd").points, cloud_in(mesh).points);
  // Cut in its faces it is a damaged mesh, not a cloud.
  const std::string bytes = get_file(mesh);
  put_file(folder / "cut.ply", bytes.substr(0, bytes.size() - 5));
  test::expect_refused("convert " + (folder / "cut.ply").string() + " " + (folder / "out.ply").string(), 1,
                       "truncated");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.ply"));
}

TEST(Info, SaysWhatAFileHolds) {
  const test::TemporaryFolder folder;
  test::put_hall(folder.path());
  test::put_route(folder / "routes.yaml", 3, 8);
  const std::string recordings = (folder / "recordings").string();
  expect_done("simulate --routes " + (folder / "routes.yaml").string() + " --lidar vlp-16 --out " +
              recordings);
  const auto expect_kind = [](const std::filesystem::path& path, const std::string& kind) {
    const test::ProgramRun run = test::run_adit("info " + path.string());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_TRUE(run.out.starts_with("kind: " + kind + "\n")) << run.out;
  };
  expect_kind(folder / "hall.ply", "mesh");
  expect_kind(folder / "routes.yaml", "routes");
  expect_kind(folder / "recordings/alpha.mcap", "recording");
  expect_kind(folder / "recordings/alpha_truth.tum", "trajectory");
  expect_done("convert " + recordings + "/alpha.mcap " + (folder / "scans").string());
  expect_kind(folder / "scans", "recording");
  expect_kind(folder / "scans/000000.pcd", "cloud");
}

std::string info_of(const std::string& arguments) {
  const test::ProgramRun run = test::run_adit("info " + arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.out;
}

TEST(Info, SaysWhereTheLidarSitsAndHowThatIsKnown) {
  const test::TemporaryFolder folder;
  const std::string recording = hall_recording(folder);
  const std::string scans = (folder / "scans").string();
  expect_done("convert " + recording + " " + scans);
  EXPECT_NE(
      info_of(recording).find("mount: 0 0 0.9\nmount_from: /tf_static: alpha/base_link -> alpha/lidar\n"),
      std::string::npos);
  EXPECT_NE(info_of(scans).find("mount: 0 0 0.9\nmount_from: recording.toml\n"), std::string::npos);
  std::filesystem::remove(folder / "scans/recording.toml");
  EXPECT_NE(info_of(scans).find("mount: 0 0 0.9\nmount_from: VIEWPOINT of the clouds\n"), std::string::npos);
  EXPECT_NE(info_of(scans + " --mount 0,0,1").find("mount: 0 0 1\nmount_from: given by the user\n"),
            std::string::npos);
}

// tests/fuzz/make_seeds.py: wheels of radius 0.1 m that turn by 3.0 and 3.6 radians.
TEST(Info, OfWheelsThatAreRecordedAsJoints) {
  for (const std::string ending : {"mcap", "db3", "bag"}) {
    const std::string bag = std::string(ADIT_CONFORMANCE) + "/../fuzz/seeds/joints." + ending;
    const std::string drive =
        " --wheel /joint_states --set recording.drive.left=left_wheel --set recording.drive.right=right_wheel"
        " --set recording.drive.wheel_radius=0.1 --set recording.drive.track_width=0.5";
    EXPECT_NE(info_of(bag).find("\"joints\":[\"left_wheel\",\"right_wheel\"]"), std::string::npos) << ending;
    const std::string info = info_of(bag + drive);
    EXPECT_NE(info.find("\"path_length_m\":0.3299"), std::string::npos) << info;
    EXPECT_NE(info.find("mount_from: /tf: base_link -> lidar, which moves"), std::string::npos) << info;
    EXPECT_NE(info.find("next: adit doctor "), std::string::npos) << info;
    EXPECT_NE(info.find("joints." + ending + drive + "\n"), std::string::npos) << info;
    const test::ProgramRun incomplete =
        test::run_adit("odometry " + bag + " --wheel /joint_states --out x.tum");
    EXPECT_EQ(incomplete.exit_code, 1);
    EXPECT_NE(incomplete.err.find("its joints are left_wheel, right_wheel"), std::string::npos)
        << incomplete.err;
  }
}

TEST(Info, SaysWhatToTypeWhereABagIsNoRecordingYet) {
  const test::TemporaryFolder folder;
  const std::string bag = (folder / "bag.mcap").string();
  const auto next_for = [&](const test::ForeignFile& file) {
    test::put_file(bag, file.bytes());
    const nlohmann::json info = nlohmann::json::parse(test::run_adit("--json info " + bag).out);
    EXPECT_TRUE(info.contains("cannot_be_mapped")) << info;
    return info.value("next", "");
  };
  const auto link = test::link("base", "os_lidar", test::T_base_ouster);
  EXPECT_EQ(next_for(test::ForeignFile().clouds("/camera/points").clouds("/os/points").links({link})),
            "adit doctor " + bag + " --points /os/points");
  test::ForeignFile fleet;
  for (const std::string robot : {"/b", "/a"})
    fleet.clouds(robot + "/points").odometry(robot + "/odom", "base");
  EXPECT_EQ(next_for(fleet.links({link})), "adit doctor " + bag + " --set recording.topics_under=/b");
  EXPECT_EQ(next_for(test::ForeignFile().clouds("/points")),
            "adit doctor " + bag + " --mount X,Y,Z,ROLL,PITCH,YAW");
  EXPECT_EQ(next_for(test::ForeignFile().clouds("/left").clouds("/lidar").links({link})),
            "adit doctor " + bag + " --points /lidar");
  EXPECT_EQ(next_for(test::ForeignFile().odometry("/odom")), "") << "no clouds";
}

TEST(Info, OfABagThatCannotBeMappedYetSaysThatItIsTorn) {
  const test::TemporaryFolder folder;
  const std::string bytes = test::ForeignFile().clouds("/points").odometry("/odom").bytes();
  put_file(folder / "torn.mcap", bytes.substr(0, bytes.size() - 200));
  const std::string torn = (folder / "torn.mcap").string();
  const nlohmann::json without = nlohmann::json::parse(test::run_adit("--json info " + torn).out);
  ASSERT_EQ(without["warnings"].size(), 1U) << without;
  EXPECT_TRUE(without.contains("cannot_be_mapped"));
  const nlohmann::json with =
      nlohmann::json::parse(test::run_adit("--json info " + torn + " --mount 0,0,0").out);
  EXPECT_EQ(with["kind"], without["kind"]);
  EXPECT_EQ(with["warnings"][0], without["warnings"][0]);
}

TEST(Info, OfAFolderOfCloudsSaysWhatToTypeToo) {
  const test::TemporaryFolder folder;
  const std::string scans = (folder / "scans").string();
  std::filesystem::create_directories(scans);
  PointCloud cloud;
  cloud.points.emplace_back(1.0F, 2.0F, 3.0F);
  for (const char* name : {"0000.pcd", "0001.pcd"}) ASSERT_TRUE(write_cloud(folder / "scans" / name, cloud));
  const std::string info = info_of(scans + " --mount 0,0,1");
  EXPECT_NE(info.find("next: adit doctor " + scans + " --mount 0,0,1\n"), std::string::npos) << info;
  EXPECT_NE(info.find("put a stamps.txt beside them"), std::string::npos) << info;
}

TEST(Info, OfSharedFiles) {
  ADIT_NEED_DATA("recordings/mcap_small/wbag_0.mcap");
  const test::ProgramRun mcap =
      test::run_adit("info --json " + test::shared_data("recordings/mcap_small/wbag_0.mcap").string());
  EXPECT_EQ(mcap.exit_code, 0) << mcap.err;
  EXPECT_NE(mcap.out.find("\"messages\": 1246"), std::string::npos) << mcap.out;
  const test::ProgramRun graph =
      test::run_adit("info " + test::shared_data("g2o/single/sphere2500.g2o").string());
  EXPECT_NE(graph.out.find("nodes: 2500\nedges: 4949\n"), std::string::npos) << graph.out;
}

}  // namespace
}  // namespace adit
