// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Rays a second on one core in a tunnel of a million triangles: Embree alone, and whole scans with noise.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/simulation/lidar_model.hpp"

namespace adit {
namespace {

// A bent tube of about 4 m radius and 400 m length with 5 cm relief: 2500 rings of 200 corners.
TriangleMesh rough_tunnel() {
  constexpr int kRings = 2500;
  constexpr int kCorners = 200;
  TriangleMesh mesh;
  Rng rng(7);
  for (int ring = 0; ring < kRings; ++ring) {
    const double x = 0.16 * ring;
    for (int corner = 0; corner < kCorners; ++corner) {
      const double angle = 2.0 * std::numbers::pi * corner / kCorners;
      const double radius = 4.0 + rng.uniform(-0.05, 0.05);
      const Vector3 p(x, 20.0 * std::sin(x / 100.0) + radius * std::cos(angle), radius * std::sin(angle));
      mesh.vertices.push_back(p.cast<float>());
      if (ring == 0) continue;
      const int here = ring * kCorners + corner;
      const int beside = ring * kCorners + (corner + 1) % kCorners;
      mesh.triangles.emplace_back(here - kCorners, here, beside);
      mesh.triangles.emplace_back(here - kCorners, beside, beside - kCorners);
    }
  }
  return mesh;
}

const Raycaster& tunnel() {
  static const Raycaster raycaster = Raycaster::build(rough_tunnel()).value();
  return raycaster;
}

Pose on_the_way(double x) {
  const double yaw = std::atan(0.2 * std::cos(x / 100.0));
  return Pose::planar(x, 20.0 * std::sin(x / 100.0), yaw, -1.0);
}

void count_rays(benchmark::State& state, std::size_t rays_per_iteration) {
  const double rays = static_cast<double>(state.iterations()) * static_cast<double>(rays_per_iteration);
  state.counters["rays_per_second"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
}

void build_tree(benchmark::State& state) {
  const TriangleMesh mesh = rough_tunnel();
  for (auto _ : state) benchmark::DoNotOptimize(Raycaster::build(mesh));
}
BENCHMARK(build_tree)->Unit(benchmark::kMillisecond);

void cast_packets(benchmark::State& state) {
  std::vector<Ray> rays;
  for (int column = 0; column < 1024; ++column) {
    for (int beam = 0; beam < 128; ++beam) {
      const double azimuth = 2.0 * std::numbers::pi * column / 1024;
      const double elevation = (11.25 - 22.5 * beam / 127) * std::numbers::pi / 180.0;
      const Vector3 direction(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      rays.push_back({on_the_way(200.0).translation().cast<float>(), direction.cast<float>()});
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(tunnel().cast(rays, 200.0F));
  count_rays(state, rays.size());
}
BENCHMARK(cast_packets)->Unit(benchmark::kMillisecond);

void cast_whole_scans(benchmark::State& state) {
  const LidarConfig lidar;
  double x = 150.0;
  for (auto _ : state) {
    const Sweep sweep{on_the_way(x), on_the_way(x + 0.187), Stamp{1'000'000'000}, 1};
    benchmark::DoNotOptimize(cast_scan(tunnel(), lidar, sweep));
    x = x < 250.0 ? x + 0.187 : 150.0;
  }
  count_rays(state, static_cast<std::size_t>(lidar.beams) * static_cast<std::size_t>(lidar.columns));
}
BENCHMARK(cast_whole_scans)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace adit
