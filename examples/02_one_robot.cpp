// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One robot's map: keyframes, the odometry that joins them, the places to which it came back.
/// Usage: 02_one_robot [RECORDING [SESSION]]
#include <cstdio>
#include <filesystem>

#include "adit/io/recording_files.hpp"
#include "adit/slam/slam.hpp"
#include "simulated.hpp"

namespace {

adit::Result<adit::Recording> input(int argc, char** argv) {
  if (argc > 1) return adit::open_recording(argv[1]);
  return example::zab_robots().map(
      [](const std::vector<adit::Recording>& robots) { return example::part_of(robots.front(), 0, 200); });
}

int failed(const adit::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recording = input(argc, argv);
  if (!recording) return failed(recording.error());
  const auto run = adit::slam({*recording});
  if (!run) return failed(run.error());
  const adit::RobotMap& map = *run->session.maps.front();
  std::printf("%s: %zu scans, %zu keyframes, %.1f m by %s\n", map.name.c_str(), map.odometry.size(),
              map.keyframes.size(), adit::path_length(map.odometry),
              run->session.provenance.robots.front().odometry.c_str());
  if (argc > 2) {
    std::filesystem::create_directories(argv[2]);
    if (const auto written = adit::write_slam(argv[2], *run); !written) return failed(written.error());
  }
}
