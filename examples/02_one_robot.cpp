// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One robot's map: keyframes, the odometry that joins them, a descriptor of each place.
/// Usage: 02_one_robot [RECORDING [MAP.ply]]
#include <cstdio>

#include "adit/io/cloud_files.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/robot/robot_slam.hpp"
#include "simulated.hpp"

namespace {

adit::Result<adit::Recording> input(int argc, char** argv) {
  if (argc > 1) return adit::open_recording(argv[1]);
  return example::zab_robots().map(
      [](const std::vector<adit::Recording>& robots) { return example::part_of(robots.front(), 0, 200); });
}

/// All keyframe clouds in the frame in which the odometry started.
adit::PointCloud whole_cloud(const adit::RobotMap& map) {
  adit::PointCloud whole;
  for (const adit::Keyframe& keyframe : map.keyframes) {
    for (const Eigen::Vector3f& p_base : keyframe.cloud->points) {
      whole.points.emplace_back((keyframe.T_odom_base * p_base.cast<double>()).cast<float>());
    }
  }
  return whole;
}

int failed(const adit::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recording = input(argc, argv);
  if (!recording) return failed(recording.error());
  adit::RobotSlamConfig config;
  if (recording->wheel.empty()) config.odometry.method = adit::OdometryMethod::kiss_icp;
  const auto map = adit::map_recording(*recording, adit::RobotId{0}, config);
  if (!map) return failed(map.error());
  const adit::PointCloud cloud = whole_cloud(*map);
  std::printf("%s: %zu scans, %zu keyframes, %zu points\n", map->name.c_str(), map->odometry.size(),
              map->keyframes.size(), cloud.size());
  if (argc > 2) {
    if (const auto written = adit::write_cloud(argv[2], cloud); !written) return failed(written.error());
  }
}
