// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Global registration, stage by stage, on the real KITTI pair (skipped where it is absent).
#include <benchmark/benchmark.h>

#include <filesystem>
#include <span>
#include <vector>

#include "adit/core/parallel.hpp"
#include "adit/geometry/radius_search.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/registration/correspondence_graph.hpp"
#include "adit/registration/matching.hpp"
#include "adit/registration/registration.hpp"

namespace adit {
namespace {

struct CloudPair {
  PointCloud a;
  PointCloud b;
};

/// Empty clouds when the data are not there.
CloudPair kitti_pair(benchmark::State& state) {
  const auto folder = std::filesystem::path(ADIT_SHARED_DATA) / "registration/kitti_pair";
  const Result<PointCloud> a = read_cloud(folder / "target.ply");
  const Result<PointCloud> b = read_cloud(folder / "source.ply");
  if (!a || !b) {
    state.SkipWithError("no KITTI pair in the shared data");
    return {};
  }
  return {*a, *b};
}

void kitti_clouds_to_transform(benchmark::State& state) {
  set_num_threads(static_cast<int>(state.range(0)));
  const CloudPair pair = kitti_pair(state);
  for (auto _ : state) benchmark::DoNotOptimize(register_clouds(pair.a, pair.b, {}));
  set_num_threads(1);
}
BENCHMARK(kitti_clouds_to_transform)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void kitti_features(benchmark::State& state) {
  set_num_threads(1);
  const CloudPair pair = kitti_pair(state);
  for (auto _ : state) benchmark::DoNotOptimize(compute_features(pair.a, {}));
}
BENCHMARK(kitti_features)->Unit(benchmark::kMillisecond);

void kitti_neighbor_pairs(benchmark::State& state) {
  const std::vector<Eigen::Vector3f> points = voxel_centroids(kitti_pair(state).a, 0.3).points;
  for (auto _ : state) benchmark::DoNotOptimize(find_pairs_within(points, 1.5F));
}
BENCHMARK(kitti_neighbor_pairs)->Unit(benchmark::kMillisecond);

void kitti_matching(benchmark::State& state) {
  set_num_threads(1);
  const CloudPair pair = kitti_pair(state);
  const Features a = compute_features(pair.a, {});
  const Features b = compute_features(pair.b, {});
  for (auto _ : state) benchmark::DoNotOptimize(match_descriptors(a.descriptors, b.descriptors, {}));
}
BENCHMARK(kitti_matching)->Unit(benchmark::kMillisecond);

void kitti_features_to_transform(benchmark::State& state) {
  set_num_threads(1);
  const CloudPair pair = kitti_pair(state);
  const Features a = compute_features(pair.a, {});
  const Features b = compute_features(pair.b, {});
  RegistrationConfig config;
  config.refine = state.range(0) != 0;
  for (auto _ : state) benchmark::DoNotOptimize(register_features(a, b, config));
}
BENCHMARK(kitti_features_to_transform)->ArgName("refine")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void consistency_core(benchmark::State& state) {
  set_num_threads(1);
  const CloudPair pair = kitti_pair(state);
  const auto n = std::min(static_cast<std::size_t>(state.range(0)), pair.a.size());
  const std::span points_a(pair.a.points.data(), n);
  const std::span points_b(pair.b.points.data(), std::min(n, pair.b.size()));
  for (auto _ : state) benchmark::DoNotOptimize(max_core(consistency_graph(points_a, points_b, 0.3F)));
}
BENCHMARK(consistency_core)->Arg(1000)->Arg(5000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace adit
