// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Odometry at the resolution of an Ouster OS2-128 (128 x 1024 rays) in a tube with boxes, on one thread; the
/// counters say what the time is spent on. `run once`: the whole of register_scan over a drive at 1.87 m/s.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "../tests/support/synthetic_scan.hpp"
#include "adit/core/parallel.hpp"
#include "adit/odometry/odometry.hpp"
#include "adit/odometry/preprocess.hpp"

namespace {

using namespace adit;

constexpr int kNumScans = 60;

struct Recorded {
  std::vector<Scan> scans;
  std::vector<WheelDelta> wheels;
};

test::Scene tube_with_boxes() {
  test::Scene scene = test::smooth_tube();
  for (int i = 0; i < 12; ++i) {
    const double x = 8.0 + 11.0 * i + 2.0 * (i % 3);
    const double y = i % 2 == 0 ? -3.4 : 2.6;
    scene.boxes.push_back({{x, y, -2.0}, {x + 0.8, y + 0.8, -0.5}});
  }
  return scene;
}

const Recorded& recorded() {
  static const Recorded drive = [] {
    const test::Scene scene = tube_with_boxes();
    test::Lidar lidar{128, 1024, 0.196, 120.0, 0.02};
    lidar.jitter = 0.5;
    test::Drive way;
    way.velocity << 1.87, 0, 0, 0, 0, 0.02;
    Recorded out;
    for (int i = 0; i < kNumScans; ++i) {
      out.scans.push_back(test::scan_of(scene, lidar, Pose(), way, i));
      out.wheels.push_back(test::wheels_of(lidar, way, i, 1.02));
    }
    return out;
  }();
  return drive;
}

void register_scans(benchmark::State& state, const std::string& method) {
  const Recorded& drive = recorded();
  set_num_threads(1);
  OdometryConfig config;
  config.method = method;
  config.kiss_icp.voxel_size = config.kinematic_icp.voxel_size = static_cast<double>(state.range(0)) * 0.01;
  double iterations = 0.0;
  double scans = 0.0;
  for (auto _ : state) {
    Odometry odometry(config, Pose());
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      iterations += odometry.register_scan(drive.scans[i], drive.wheels[i]).iterations;
      scans += 1.0;
    }
  }
  state.counters["points"] = static_cast<double>(drive.scans.back().cloud.size());
  state.counters["iterations_a_scan"] = iterations / scans;
  // Shown as "3.2m": seconds of one scan.
  state.counters["s_a_scan"] =
      benchmark::Counter(scans, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(register_scans, kiss_icp, "kiss-icp")->Arg(100)->Arg(50)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(register_scans, kinematic_icp, "kinematic-icp")
    ->Arg(100)
    ->Arg(50)
    ->Unit(benchmark::kMillisecond);

void crop_and_deskew(benchmark::State& state) {
  const Scan& scan = recorded().scans.back();
  const ConstantVelocity motion{Pose::planar(0.187, 0.0, 0.01), std::chrono::milliseconds(100)};
  for (auto _ : state) benchmark::DoNotOptimize(preprocess(scan.cloud, {}, Pose(), motion));
}
BENCHMARK(crop_and_deskew)->Unit(benchmark::kMillisecond);

void thin(benchmark::State& state) {
  const Scan& scan = recorded().scans.back();
  for (auto _ : state) benchmark::DoNotOptimize(thinned(scan.cloud.points, 1.0));
}
BENCHMARK(thin)->Unit(benchmark::kMillisecond);

void one_linearization(benchmark::State& state) {
  set_num_threads(1);
  const Scan& scan = recorded().scans.back();
  const ThinnedScan thin_scan = thinned(scan.cloud.points, 1.0);
  LocalMap map(1.0, 20);
  for (const Scan& other : recorded().scans) map.add(thinned(other.cloud.points, 1.0).map_points, Pose());
  for (auto _ : state) benchmark::DoNotOptimize(linearize_rigid(thin_scan.source, map, Pose(), 1.0, 0.3));
  state.counters["source_points"] = static_cast<double>(thin_scan.source.size());
}
BENCHMARK(one_linearization)->Unit(benchmark::kMicrosecond);

}  // namespace
