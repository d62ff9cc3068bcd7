// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Odometry of complete scans of a spinning LiDAR with 128 beams (about 131,000 points), and of real ones.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/odometry/methods.hpp"
#include "harness/bench_case.hpp"
#include "odometry_scenes.hpp"

namespace adit::bench {
namespace {

OdometryConfig config_of(const std::string& method, double voxel_size) {
  OdometryConfig config;
  ADIT_CHECK(set_field(fields_of(config), "method", method), "a known method");
  for (ScanToMapConfig* settings :
       {&config.kiss_icp.scan_to_map, &config.kinematic_icp.scan_to_map, &config.plane_icp.scan_to_map})
    settings->voxel_size = voxel_size;
  return config;
}

// Errors are distances from the truth with both first poses laid on one another, without alignment.
Figures driven(const OdometryConfig& config, const RecordedDrive& input) {
  const auto odometry = make_odometry(config, input.T_base_lidar);
  double squares = 0.0;
  double largest = 0.0;
  double iterations = 0.0;
  for (std::size_t i = 0; i < input.scans.size(); ++i) {
    const auto wheels = input.wheels.empty() ? std::nullopt : std::optional(input.wheels[i]);
    const OdometryStep step = odometry->register_scan(input.scans[i], {wheels});
    const double error = (step.T_odom_base.translation() - input.truth[i]).norm();
    squares += error * error;
    largest = std::max(largest, error);
    iterations += step.iterations;
  }
  const auto n = static_cast<double>(input.scans.size());
  return {{"rmse_m", std::sqrt(squares / n)}, {"max_m", largest}, {"iterations", iterations / n}};
}

struct Row {
  std::string scene;
  std::string method;
  double voxel_size;
  int num_threads;
  std::string peer;
  double aim;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {"tube", "kiss-icp", 1.0, 1, "kiss-icp", 3.0},
      {"zab", "kiss-icp", 1.0, 1, "kiss-icp", 3.0},
      {"cave", "kiss-icp", 1.0, 1, "kiss-icp", 3.0},
      {"mine", "kiss-icp", 1.0, 1, "kiss-icp", 3.0},
      {"nclt", "kiss-icp", 1.0, 1, "kiss-icp", 3.0},
      {"zab", "kiss-icp", 1.0, 2, "kiss-icp", 3.0},
      {"nclt", "kiss-icp", 1.0, 2, "kiss-icp", 3.0},
      {"zab", "kiss-icp", 0.5, 1, "kiss-icp", 3.0},
      {"tube", "kinematic-icp", 1.0, 1, "kinematic-icp", 2.0},
      {"zab", "kinematic-icp", 1.0, 1, "kinematic-icp", 2.0},
      {"cave", "kinematic-icp", 1.0, 1, "kinematic-icp", 2.0},
      {"mine", "kinematic-icp", 1.0, 1, "kinematic-icp", 2.0},
      {"zab", "kinematic-icp", 0.5, 1, "kinematic-icp", 2.0},
      // plane-icp beside the peer with the same voxels; its default is 0.5 m, the peer's 1 m.
      {"zab", "plane-icp", 0.5, 1, "kinematic-icp", 2.0},
      {"zab", "plane-icp", 1.0, 1, "kinematic-icp", 2.0},
      {"mine", "plane-icp", 0.5, 1, "kinematic-icp", 2.0},
      {"mine", "plane-icp", 1.0, 1, "kinematic-icp", 2.0}};
  return all;
}

std::string name_of(const Row& row) {
  return format("odometry/{}/{}_{:.1f}{}", row.scene, row.method, row.voxel_size,
                row.num_threads == 1 ? "" : format("_{}threads", row.num_threads));
}

const About kTimed{
    .timed = "all scans one after another, from the point cloud in memory to the pose, map included"};

const auto registered = [] {
  for (const Row& row : rows()) {
    const OdometryScene& scene = odometry_scene(row.scene);
    const std::string name = name_of(row);
    Case({.name = name,
          .work = format("{}, voxels of {:.1f} m on both sides", row.method, row.voxel_size),
          .scene = scene.what,
          .num_threads = row.num_threads,
          .peer = row.peer,
          .aim = row.aim,
          .per_run = static_cast<double>(scene.num_scans),
          .unit = "scan"});
    Side(
        name, "adit",
        [row, load = scene.load]() -> Work {
          return [config = config_of(row.method, row.voxel_size), input = load()] {
            return driven(config, input);
          };
        },
        kTimed);
    if (row.num_threads == 1) continue;
    About one = kTimed;
    one.num_threads = 1;
    Side(
        name, "adit-one-thread",
        [row, load = scene.load]() -> Work {
          set_num_threads(1);
          return [config = config_of(row.method, row.voxel_size), input = load()] {
            return driven(config, input);
          };
        },
        one);
  }
  return 0;
}();

// The robot drives on with a map of `scans` scans; a thinner sensor, so that casting them does not take
// minutes.
Work later_scan(double scans) {
  constexpr int kLater = 10;
  const TubeDrive tube(64, 512);
  KissIcp odometry(config_of("kiss-icp", 1.0).kiss_icp, Pose());
  const int first = static_cast<int>(scans);
  for (int i = 0; i < first; ++i) odometry.register_scan(tube.scan(i), {});
  std::vector<Scan> later;
  for (int i = 0; i < kLater; ++i) later.push_back(tube.scan(first + i));
  return [odometry, later] {
    KissIcp from_here = odometry;
    for (const Scan& scan : later) from_here.register_scan(scan, {});
    return Figures{};
  };
}
const Growth growth("odometry/scans_so_far", "KISS-ICP: ten scans of 32,768 points, one thread",
                    "scans in the map", {10, 30, 100, 300, 600}, later_scan);

void write_pose(std::ostream& out, const Pose& T) {
  out << T.translation().transpose() << ' ' << T.rotation().coeffs().transpose() << '\n';
}

// A folder per scene. scan_0000.bin...: x, y, z in metres (lidar frame) and the point's time in nanoseconds
// relative to the stamp, little-endian float32 each, the time 0 throughout where there is none. wheels.txt: a
// line per scan, tx ty tz qx qy qz qw of the base's motion since the last; absent without wheels. truth.txt:
// a line per scan, x y z, from the first pose. T_base_lidar.txt: one line like wheels.txt.
void write_drive(const std::filesystem::path& folder, const RecordedDrive& drive) {
  std::filesystem::create_directories(folder);
  std::ofstream truth(folder / "truth.txt");
  std::ofstream mount(folder / "T_base_lidar.txt");
  truth.precision(17);
  mount.precision(17);
  write_pose(mount, drive.T_base_lidar);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    std::ofstream file(folder / format("scan_{:04}.bin", i), std::ios::binary);
    const PointCloud& cloud = drive.scans[i].cloud;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      const float time = cloud.time_offsets_ns.empty() ? 0.0F : static_cast<float>(cloud.time_offsets_ns[k]);
      const float values[] = {cloud.points[k].x(), cloud.points[k].y(), cloud.points[k].z(), time};
      file.write(reinterpret_cast<const char*>(values), sizeof values);
    }
    truth << drive.truth[i].transpose() << '\n';
  }
  if (drive.wheels.empty()) return;
  std::ofstream wheels(folder / "wheels.txt");
  wheels.precision(17);
  for (const WheelDelta& delta : drive.wheels) write_pose(wheels, delta.T_base0_base1);
}

const Export inputs("odometry", [](const std::filesystem::path& folder) {
  for (const OdometryScene& scene : odometry_scenes()) {
    try {
      write_drive(folder / scene.name, scene.load());
    } catch (const Skipped&) {  // the cases of that scene are skipped on both sides
    }
  }
});

}  // namespace
}  // namespace adit::bench
