// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Odometry at the resolution of an Ouster OS2-128 (128 x 1024 rays, 131,000 points a scan) in a tube with
/// boxes, from rest to 1.87 m/s.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/odometry/odometry.hpp"
#include "harness/bench_case.hpp"
#include "support/synthetic_scan.hpp"

namespace adit::bench {
namespace {

test::Scene tube_with_boxes() {
  test::Scene scene = test::smooth_tube();
  for (int i = 0; i < 12; ++i) {
    const double x = 8.0 + 11.0 * i + 2.0 * (i % 3);
    const double y = i % 2 == 0 ? -3.4 : 2.6;
    scene.boxes.push_back({{x, y, -2.0}, {x + 0.8, y + 0.8, -0.5}});
  }
  return scene;
}

// A robot on its way through the tube; scan i is cast when it is asked for.
struct Way {
  test::Scene scene = tube_with_boxes();
  test::Lidar lidar;
  test::Drive drive{Pose(), (Vector6() << 1.87, 0, 0, 0, 0, 0.02).finished()};

  Way(int rows, int columns) : lidar{rows, columns, 0.196, 120.0, 0.02} { lidar.jitter = 0.5; }
  [[nodiscard]] Scan scan(int i) const { return test::scan_of(scene, lidar, Pose(), drive, i); }
  [[nodiscard]] WheelDelta wheels(int i) const { return test::wheels_of(lidar, drive, i, 1.02); }
  [[nodiscard]] Pose truth(int i) const { return drive.at(i * to_seconds(lidar.period)); }
};

struct Recorded {
  std::vector<Scan> scans;
  std::vector<WheelDelta> wheels;
  std::vector<Vector3> truth;
};

Recorded recorded(int num_scans) {
  const Way way(128, 1024);
  Recorded out;
  for (int i = 0; i < num_scans; ++i) {
    out.scans.push_back(way.scan(i));
    out.wheels.push_back(way.wheels(i));
    out.truth.push_back((way.truth(0).inverse() * way.truth(i)).translation());
  }
  return out;
}

OdometryConfig config_of(const std::string& method, double voxel_size) {
  OdometryConfig config;
  config.method = method;
  config.kiss_icp.voxel_size = config.kinematic_icp.voxel_size = voxel_size;
  return config;
}

Prepare drive(const std::string& method, double voxel_size, int num_scans, int num_threads) {
  return [=]() -> Work {
    set_num_threads(num_threads);
    return [config = config_of(method, voxel_size), input = recorded(num_scans)] {
      Odometry odometry(config, Pose());
      double squares = 0.0;
      double largest = 0.0;
      double iterations = 0.0;
      for (std::size_t i = 0; i < input.scans.size(); ++i) {
        const OdometryStep step = odometry.register_scan(input.scans[i], input.wheels[i]);
        const double error = (step.T_odom_base.translation() - input.truth[i]).norm();
        squares += error * error;
        largest = std::max(largest, error);
        iterations += step.iterations;
      }
      const auto n = static_cast<double>(input.scans.size());
      return Figures{{"ate_m", std::sqrt(squares / n)}, {"max_m", largest}, {"iterations", iterations / n}};
    };
  };
}

constexpr int kScans = 60;
constexpr int kScansOfFineMap = 30;  // a peer's run stays below five seconds

CaseInfo info(const std::string& name, const std::string& work, const std::string& peer, double aim,
              int num_scans) {
  return {"odometry/" + name, work, peer, aim, "", static_cast<double>(num_scans), "scan"};
}

const Case kiss(info("kiss_1.0", "KISS-ICP, voxels of 1 m, one thread", "kiss-icp", 3.0, kScans));
const Side kiss_adit("odometry/kiss_1.0", "adit", drive("kiss-icp", 1.0, kScans, 1));

const Case kiss_fine(info("kiss_0.5", "KISS-ICP, voxels of 0.5 m, one thread", "kiss-icp", 3.0,
                          kScansOfFineMap));
const Side kiss_fine_adit("odometry/kiss_0.5", "adit", drive("kiss-icp", 0.5, kScansOfFineMap, 1));

const Case kinematic(info("kinematic_1.0", "Kinematic-ICP, voxels of 1 m, one thread", "kinematic-icp", 2.0,
                          kScans));
const Side kinematic_adit("odometry/kinematic_1.0", "adit", drive("kinematic-icp", 1.0, kScans, 1));

const Case kinematic_fine(info("kinematic_0.5", "Kinematic-ICP, voxels of 0.5 m, one thread", "kinematic-icp",
                               2.0, kScansOfFineMap));
const Side kinematic_fine_adit("odometry/kinematic_0.5", "adit",
                               drive("kinematic-icp", 0.5, kScansOfFineMap, 1));

const Case plane(info("plane_0.5", "plane-icp beside Kinematic-ICP with voxels of 1 m, one thread",
                      "kinematic-icp", 2.0, kScans));
const Side plane_adit("odometry/plane_0.5", "adit", drive("plane-icp", 0.5, kScans, 1));

const Case threads(info("kiss_1.0_2threads", "KISS-ICP, voxels of 1 m, two threads", "one-thread", 1.6,
                        kScans));
const Side threads_adit("odometry/kiss_1.0_2threads", "adit", drive("kiss-icp", 1.0, kScans, 2));
const Side threads_one("odometry/kiss_1.0_2threads", "one-thread", drive("kiss-icp", 1.0, kScans, 1));

// The robot drives on with a map of `scans` scans; a thinner sensor, so that casting them does not take
// minutes.
Work later_scan(double scans) {
  constexpr int kLater = 10;
  set_num_threads(1);
  const Way way(64, 512);
  Odometry odometry(config_of("kiss-icp", 1.0), Pose());
  const int first = static_cast<int>(scans);
  for (int i = 0; i < first; ++i) odometry.register_scan(way.scan(i), way.wheels(i));
  std::vector<Scan> later;
  for (int i = 0; i < kLater; ++i) later.push_back(way.scan(first + i));
  return [odometry, later] {
    Odometry from_here = odometry;
    for (const Scan& scan : later) from_here.register_scan(scan, {});
    return Figures{};
  };
}
const Growth growth("odometry/scans_so_far", "KISS-ICP: ten scans of 32,768 points, one thread",
                    "scans in the map", {10, 30, 100, 300, 600}, later_scan);

// scan_00.bin...: x, y, z in metres and the point's time in nanoseconds before the stamp, little-endian
// float32 each. wheels.txt: a line a scan, tx ty tz qx qy qz qw of its motion since the last.
// truth.txt: a line a scan, x y z, from the first pose.
void write_drive(const std::filesystem::path& folder) {
  const Recorded drive = recorded(kScans);
  std::ofstream wheels(folder / "wheels.txt");
  std::ofstream truth(folder / "truth.txt");
  wheels.precision(17);
  truth.precision(17);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    std::ofstream file(folder / format("scan_{:02}.bin", i), std::ios::binary);
    const PointCloud& cloud = drive.scans[i].cloud;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      const float values[] = {cloud.points[k].x(), cloud.points[k].y(), cloud.points[k].z(),
                              static_cast<float>(cloud.time_offsets_ns[k])};
      file.write(reinterpret_cast<const char*>(values), sizeof values);
    }
    const Pose& T = drive.wheels[i].T_base0_base1;
    wheels << T.translation().transpose() << ' ' << T.rotation().coeffs().transpose() << '\n';
    truth << drive.truth[i].transpose() << '\n';
  }
}
const Export inputs("odometry", write_drive);

}  // namespace
}  // namespace adit::bench
