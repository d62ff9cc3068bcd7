// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Odometry of one robot, scan by scan. Usage: 01_odometry [RECORDING]
#include <cstdio>

#include "adit/evaluation/ate.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/odometry/methods.hpp"
#include "adit/robot/scan_loop.hpp"
#include "simulated.hpp"

namespace {

adit::Result<adit::Recording> input(int argc, char** argv) {
  if (argc > 1) return adit::open_recording(argv[1]);
  return example::zab_robots().map(
      [](const std::vector<adit::Recording>& robots) { return example::part_of(robots.front(), 0, 200); });
}

adit::Result<adit::Trajectory> run_odometry(const adit::Recording& recording) {
  adit::OdometryConfig config;  // every field has a default; docs/configuration.md lists them
  if (recording.wheel.empty()) config.method = adit::OdometryMethod::kiss_icp;
  const auto odometry = adit::make_odometry(config, recording.T_base_lidar);
  adit::Trajectory trajectory;
  const auto done = adit::for_each_scan(recording, [&](const adit::Scan& scan, const auto& motion) {
    const adit::OdometryStep step = odometry->register_scan(scan, motion);
    trajectory.push_back({step.stamp, step.T_odom_base});
    return true;
  });
  if (!done) return tl::unexpected(done.error());
  return trajectory;
}

int failed(const adit::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recording = input(argc, argv);
  if (!recording) return failed(recording.error());
  const auto trajectory = run_odometry(*recording);
  if (!trajectory) return failed(trajectory.error());
  std::printf("%s: %zu scans, %.1f m\n", recording->name.c_str(), trajectory->size(),
              adit::path_length(*trajectory));
  if (recording->truth.empty()) return 0;
  const auto error = adit::ate(*trajectory, recording->truth);
  if (!error) return failed(error.error());
  std::printf("greatest error %.3f m\n", error->max_m);
}
