// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <benchmark/benchmark.h>

#include <cmath>

#include "adit/core/rng.hpp"
#include "adit/geometry/oriented_box.hpp"
#include "adit/keyframes/alignability.hpp"
#include "adit/place/place_index.hpp"

namespace adit {
namespace {

/// A tunnel of 10 x 7 m as a lidar sees it: dense near the robot, thin far off.
PointCloud tunnel_scan(std::size_t num_points, std::uint64_t seed) {
  Rng rng(seed);
  PointCloud cloud;
  while (cloud.size() < num_points) {
    const double azimuth = rng.uniform(-M_PI, M_PI);
    const double elevation = rng.uniform(-0.2, 0.2);
    const Vector3 ray(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                      std::sin(elevation));
    const double to_side = 5.0 / std::max(std::abs(ray.y()), 1e-3);
    const double to_floor_or_roof = (ray.z() < 0.0 ? 1.0 : 6.0) / std::max(std::abs(ray.z()), 1e-3);
    const double range = std::min({to_side, to_floor_or_roof, 100.0}) + 0.02 * rng.normal();
    cloud.points.emplace_back((range * ray + Vector3(0, 0, 1)).cast<float>());
  }
  return cloud;
}

ScanContext random_context(Rng& rng) {
  std::vector<float> heights(20 * 60);
  for (float& height : heights)
    height = rng.uniform() < 0.4 ? static_cast<float>(rng.uniform(0.5, 8.0)) : 0.0F;
  return from_heights(20, 60, heights);
}

void scan_context_describe(benchmark::State& state) {
  const PointCloud cloud = tunnel_scan(static_cast<std::size_t>(state.range(0)), 1);
  for (auto _ : state) benchmark::DoNotOptimize(describe(cloud, {}));
}
BENCHMARK(scan_context_describe)->Arg(8400)->Arg(122000)->Unit(benchmark::kMicrosecond);

void scan_context_compare(benchmark::State& state) {
  Rng rng(2);
  const ScanContext a = random_context(rng);
  const ScanContext b = random_context(rng);
  for (auto _ : state) benchmark::DoNotOptimize(compare(a, b));
}
BENCHMARK(scan_context_compare)->Unit(benchmark::kMicrosecond);

void place_index_query(benchmark::State& state, const char* search) {
  Rng rng(3);
  PlaceIndexConfig config;
  config.search = search;
  config.max_distance = 1.0;
  PlaceIndex index(config);
  const auto num_places = static_cast<std::uint32_t>(state.range(0));
  for (std::uint32_t i = 0; i < num_places; ++i) index.add({{1}, i}, random_context(rng));
  const ScanContext query = random_context(rng);
  for (auto _ : state) benchmark::DoNotOptimize(index.best_match({{0}, 0}, query, {1}));
}
BENCHMARK_CAPTURE(place_index_query, ring_key, "ring_key")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(place_index_query, brute_force, "brute_force")->Arg(1000)->Unit(benchmark::kMicrosecond);

void oriented_box_of_a_scan(benchmark::State& state) {
  const PointCloud cloud = tunnel_scan(static_cast<std::size_t>(state.range(0)), 4);
  for (auto _ : state) benchmark::DoNotOptimize(oriented_box(cloud.points));
}
BENCHMARK(oriented_box_of_a_scan)->Arg(30000)->Arg(130000)->Unit(benchmark::kMicrosecond);

void alignability_of_a_scan(benchmark::State& state) {
  const PointCloud cloud = tunnel_scan(static_cast<std::size_t>(state.range(0)), 5);
  for (auto _ : state) benchmark::DoNotOptimize(alignability_of_points(cloud.points));
}
BENCHMARK(alignability_of_a_scan)->Arg(30000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace adit
