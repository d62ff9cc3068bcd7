// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two robots merge from folders of clouds as they do from MCAP files: the checks of a merge need to know
/// where the sensor stood, and no format may lose it.
#include <gtest/gtest.h>

#include "adit/io/bag_recording.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/scan_folder.hpp"
#include "examples/simulated.hpp"
#include "support/files.hpp"
#include "support/meeting.hpp"

namespace adit {
namespace {

class FolderMerge : public ::testing::Test {
 protected:
  /// The two robots as they come back from files that `write` makes, one per robot.
  /// Folders hold no IMU.
  [[nodiscard]] static std::vector<Recording> without_imu(std::vector<Recording> robots) {
    for (Recording& robot : robots) robot.imu.clear();
    return robots;
  }

  template <class Write>
  [[nodiscard]] std::vector<Recording> through(const std::string& extension, const Write& write) const {
    std::vector<Recording> read;
    for (const Recording& robot : robots_) {
      const std::filesystem::path path = folder_ / (robot.name + extension);
      const Result<> written = write(path, robot);
      EXPECT_TRUE(written) << written.error().message;
      Result<Recording> back = open_recording(path.string());
      EXPECT_TRUE(back) << back.error().message;
      read.push_back(back.value_or(Recording{}));
    }
    return read;
  }

  /// The loops in use after the two robots met under the default policy.
  [[nodiscard]] static std::vector<LoopClosure> loops_of(const std::vector<Recording>& recordings) {
    const test::Joint joint = test::map_and_meet(recordings, {});
    std::vector<LoopClosure> in_use;
    for (const LoopOutcome& outcome : joint.solution.loops)
      if (outcome.in_use() && outcome.loop.from.robot != outcome.loop.to.robot)
        in_use.push_back(outcome.loop);
    return in_use;
  }

  const test::TemporaryFolder folder_;
  const std::vector<Recording> robots_ = without_imu(example::two_robots_of_zab().value());
};

void expect_same(const std::vector<LoopClosure>& a, const std::vector<LoopClosure>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].from, b[i].from);
    EXPECT_EQ(a[i].to, b[i].to);
    EXPECT_EQ(a[i].T_from_to.matrix(), b[i].T_from_to.matrix());
  }
}

TEST_F(FolderMerge, IsThatOfTheRecordingInEveryFormat) {
  const auto from_mcap =
      through(".mcap", [](const auto& path, const Recording& robot) { return write_recording(path, robot); });
  const std::vector<LoopClosure> expected = loops_of(from_mcap);
  ASSERT_GE(expected.size(), 10U);
  for (const CloudFormat format : {CloudFormat::pcd, CloudFormat::ply, CloudFormat::kitti}) {
    SCOPED_TRACE(extension_of(format));
    const std::string extension = "_" + std::string(extension_of(format).substr(1));
    const auto from_folders = through(extension, [&](const auto& path, const Recording& robot) {
      return write_scan_folder(path, robot, format).map([](std::size_t /*num_empty*/) {});
    });
    for (const Recording& robot : from_folders) EXPECT_TRUE(robot.assumptions.empty());
    expect_same(loops_of(from_folders), expected);
  }
}

/// As other programs leave them: clouds moved to the robot's frame, and no mount stated.
TEST_F(FolderMerge, WorksInTheBaseFrameWithTheMountFoundInTheClouds) {
  const auto recordings = through("_bare", [](const auto& path, Recording robot) {
    robot.read_scan = [read = robot.read_scan, mount = robot.T_base_lidar](std::size_t i) {
      return read(i).map([&](Scan scan) {
        scan.cloud = transformed(mount, std::move(scan.cloud));
        return scan;
      });
    };
    return write_scan_folder(path, robot, CloudFormat::ply).map([&](std::size_t /*num_empty*/) {
      std::filesystem::remove(path / "recording.toml");
    });
  });
  for (const Recording& robot : recordings) {
    EXPECT_LT((robot.T_base_lidar.inverse() * robots_[0].T_base_lidar).log().norm(), 0.005)
        << robot.mount_source << robot.T_base_lidar.translation().transpose();
    EXPECT_TRUE(robot.mount_source.starts_with("found in the clouds")) << robot.mount_source;
    EXPECT_TRUE(robot.assumptions.empty());
  }
  EXPECT_GE(loops_of(recordings).size(), 10U);
}

}  // namespace
}  // namespace adit
