// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// A bag of several robots, of which one cannot be read.
#include <gtest/gtest.h>

#include "support/foreign_mcap.hpp"
#include "support/program.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

/// Scans of a drive through a furnished room from x on, as messages.
std::vector<std::pair<Stamp, std::string>> drive_of(const std::string& frame, double x) {
  const test::Lidar lidar{32, 256, 0.35, 120.0, 0.0};
  const test::Drive drive{Pose::planar(x, 0, 0.1), (Vector6() << 1.5, 0, 0, 0, 0, 0.1).finished()};
  std::vector<std::pair<Stamp, std::string>> messages;
  for (int i = 0; i < 30; ++i) {
    Scan scan = test::scan_of(test::furnished_room(), lidar, test::T_base_ouster, drive, i);
    scan.stamp = scan.stamp + std::chrono::seconds(1'700'000'000);
    messages.emplace_back(scan.stamp, ros::encode_cloud(scan, frame));
  }
  return messages;
}

TEST(Namespaces, ARobotWithoutAMountStopsNoOther) {
  const test::TemporaryFolder folder;
  test::ForeignFile file;
  for (const std::string robot : {"husky1", "husky2"})
    file.cloud_messages("/" + robot + "/points", drive_of(robot + "/lidar", robot == "husky1" ? -6.0 : -5.5),
                        std::chrono::milliseconds(5));
  file.clouds("/camera/depth/points", "depth_optical_frame")
      .links({test::link("husky1/base_link", "husky1/lidar", test::T_base_ouster),
              test::link("husky2/base_link", "husky2/lidar", test::T_base_ouster)});
  test::put_file(folder / "fleet.mcap", file.bytes());
  const std::string session = (folder / "s").string();
  const test::ProgramRun run =
      test::run_adit("slam --namespaces " + (folder / "fleet.mcap").string() + " --out " + session);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("1 of 3 recordings could not be mapped"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("/camera: "), std::string::npos) << run.err;
  for (const char* robot : {"husky1", "husky2"})
    EXPECT_TRUE(std::filesystem::exists(folder / "s" / robot / "map.adit")) << robot;
}

TEST(Namespaces, WhereNoRobotCanBeReadEachHasItsReason) {
  const test::TemporaryFolder folder;
  test::ForeignFile file;
  for (const std::string robot : {"husky1", "husky2"}) file.clouds("/" + robot + "/points", robot + "/lidar");
  test::put_file(folder / "fleet.mcap", file.bytes());
  const std::string command =
      "slam --namespaces " + (folder / "fleet.mcap").string() + " --out " + (folder / "s").string();
  for (const std::string robot : {"/husky1: ", "/husky2: "}) test::expect_refused(command, 1, robot);
}

}  // namespace
}  // namespace adit
