// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A simulated recording on disk is the recording itself, to the last bit.
#include <gtest/gtest.h>

#include "adit/io/bag_recording.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/odometry/kiss_icp.hpp"
#include "adit/simulation/scenario.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// The first 30 scans of robot 0 in the zab preset, with the poses that they need.
Recording short_recording() {
  ScenarioConfig config;
  config.lidar = lidar_preset("os2-32").value();
  const World world = make_world(WorldConfig{}).value();
  Recording recording = simulate(world, config).value().front();
  recording.scan_stamps.resize(30);
  const auto is_later = [end = recording.scan_stamps.back() + from_seconds(0.1)](const StampedPose& pose) {
    return pose.stamp > end;
  };
  std::erase_if(recording.wheel, is_later);
  std::erase_if(recording.truth, is_later);
  return recording;
}

void expect_equal(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stamp, b[i].stamp) << i;
    EXPECT_EQ(a[i].T_world_body.translation(), b[i].T_world_body.translation()) << i;
    EXPECT_EQ(a[i].T_world_body.rotation().coeffs(), b[i].T_world_body.rotation().coeffs()) << i;
  }
}

Trajectory odometry_of(const Recording& recording) {
  KissIcp odometry(KissIcpConfig{}, recording.T_base_lidar);
  Trajectory trajectory;
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    trajectory.push_back(
        {recording.scan_stamps[i], odometry.register_scan(recording.read_scan(i).value(), {}).T_odom_base});
  }
  return trajectory;
}

TEST(RecordingOnDisk, IsTheSimulatedOneToTheLastBit) {
  const test::TemporaryFolder folder;
  const Recording simulated = short_recording();
  const Result<> written = write_recording(folder / "robot.mcap", simulated);
  ASSERT_TRUE(written) << written.error().message;
  const Result<Recording> read = open_recording((folder / "robot.mcap").string());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->name, simulated.name);
  EXPECT_EQ(read->lidar, "os2-32");
  EXPECT_EQ(read->scan_stamps, simulated.scan_stamps);
  EXPECT_EQ(read->T_base_lidar.translation(), simulated.T_base_lidar.translation());
  expect_equal(read->wheel, simulated.wheel);
  expect_equal(read->truth, simulated.truth);
  for (std::size_t i = 0; i < simulated.num_scans(); ++i) {
    const Scan a = simulated.read_scan(i).value();
    const Scan b = read->read_scan(i).value();
    EXPECT_EQ(a.stamp, b.stamp) << i;
    EXPECT_EQ(a.cloud.points, b.cloud.points) << i;
    EXPECT_EQ(a.cloud.time_offsets_ns, b.cloud.time_offsets_ns) << i;
    EXPECT_EQ(a.cloud.intensities, b.cloud.intensities) << i;
    EXPECT_GT(a.cloud.size(), 1000U) << i;
  }
  expect_equal(odometry_of(*read), odometry_of(simulated));
}

}  // namespace
}  // namespace adit
