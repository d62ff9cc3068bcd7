// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Registration from clouds to transform: without a guess, and as a refinement of one.
#include <algorithm>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/registration/registration.hpp"
#include "harness/bench_case.hpp"
#include "tunnel_inputs.hpp"

namespace adit::bench {
namespace {

struct CloudPair {
  PointCloud target;
  PointCloud source;
  Pose T_target_source;
};
using CloudPairs = std::vector<CloudPair>;

PointCloud cloud_at(const std::string& relative) {
  const Result<PointCloud> cloud = read_cloud(shared_data(relative));
  if (!cloud) throw Skipped{cloud.error().message};
  return *cloud;
}

CloudPairs kitti_pair() {
  std::ifstream file(shared_data("registration/kitti_pair/T_target_source.txt"));
  Eigen::Matrix4d T;
  for (int k = 0; k < 16; ++k) file >> T(k / 4, k % 4);
  return {{cloud_at("registration/kitti_pair/target.ply"), cloud_at("registration/kitti_pair/source.ply"),
           Pose::from_matrix(T)}};
}

CloudPairs kitti_turned() {
  CloudPairs pairs = kitti_pair();
  const Pose T_turned_source = Pose::planar(4.0, 3.0, 2.0 * std::numbers::pi / 3.0);
  pairs[0].source = transformed(T_turned_source, pairs[0].source);
  pairs[0].T_target_source = pairs[0].T_target_source * T_turned_source.inverse();
  return pairs;
}

/// As a robot keeps them.
constexpr double kKeyframeVoxel = 0.15;

/// Where the robots of zab pass each other head on: keyframes 4 m apart, turned by half a turn.
CloudPairs tube_keyframes() {
  constexpr std::size_t kPairs = 6;
  const Tunnel tunnel("zab", 1, "os2-128");
  const std::vector<Pose> poses = poses_along(tunnel.paths().front(), 4.0);
  CloudPairs pairs;
  for (std::size_t k = 0; k < kPairs; ++k) {
    const std::size_t at = (k + 1) * poses.size() / (kPairs + 2);
    const Pose& T_world_a = poses[at];
    const Pose T_world_b = poses[at + 1] * Pose::planar(0.0, 1.0, std::numbers::pi);
    pairs.push_back({voxel_downsample(tunnel.seen_from(T_world_a, 2 * k), kKeyframeVoxel),
                     voxel_downsample(tunnel.seen_from(T_world_b, 2 * k + 1), kKeyframeVoxel),
                     T_world_a.inverse() * T_world_b});
  }
  return pairs;
}

/// Ten scans, 2 m apart, in the frame of the first one.
PointCloud submap(const Tunnel& tunnel, const std::vector<Pose>& poses, std::size_t first,
                  const Pose& T_world_map) {
  PointCloud merged;
  for (std::size_t i = first; i < first + 10; ++i) {
    const PointCloud scan =
        transformed(T_world_map.inverse() * poses[i], tunnel.seen_from(poses[i], 1000 + i));
    merged.points.insert(merged.points.end(), scan.points.begin(), scan.points.end());
  }
  return voxel_downsample(merged, kKeyframeVoxel);
}

CloudPairs submaps() {
  const Tunnel tunnel("zab", 1, "os2-128");
  const std::vector<Pose> poses = poses_along(tunnel.paths().front(), 2.0);
  CloudPairs pairs;
  for (const std::size_t at : {poses.size() / 4, poses.size() / 2}) {
    const Pose T_world_b = poses[at + 3] * Pose::planar(0.0, 0.0, std::numbers::pi / 2.0);
    pairs.push_back({submap(tunnel, poses, at, poses[at]), submap(tunnel, poses, at + 3, T_world_b),
                     poses[at].inverse() * T_world_b});
  }
  return pairs;
}

/// Errors of the worst pair, and the share of pairs registered within 1 m and 5 degrees.
Figures judged(const CloudPairs& pairs, const std::function<std::optional<Pose>(const CloudPair&)>& solve) {
  double worst_m = 0.0;
  double worst_deg = 0.0;
  double successes = 0.0;
  for (const CloudPair& pair : pairs) {
    const Pose error = pair.T_target_source.inverse() * solve(pair).value_or(Pose());
    const double metres = error.translation().norm();
    const double degrees = error.angle() * 180.0 / std::numbers::pi;
    worst_m = std::max(worst_m, metres);
    worst_deg = std::max(worst_deg, degrees);
    if (metres < 1.0 && degrees < 5.0) successes += 1.0;
  }
  return {{"error_m", worst_m},
          {"error_deg", worst_deg},
          {"success", successes / static_cast<double>(pairs.size())}};
}

using MakePairs = CloudPairs (*)();

Prepare global(MakePairs make) {
  return [=]() -> Work {
    return [pairs = make()] {
      return judged(
          pairs, [](const CloudPair& pair) { return register_clouds(pair.target, pair.source, {}).T_a_b; });
    };
  };
}

// With one thread and with two.
void add_cases(CaseInfo info, const Prepare& adit, const About& about) {
  const std::string name = info.name;
  for (const int threads : {1, 2}) {
    info.name = threads == 1 ? name : name + "_2_threads";
    info.num_threads = threads;
    Case(CaseInfo(info));
    Side(info.name, "adit", adit, about);
  }
}

const About kGlobalTimed{.timed =
                             "from two clouds in memory to the verified transform: voxels, features, "
                             "matching, solving, refinement"};

struct GlobalCase {
  GlobalCase(const std::string& name, const std::string& scene, MakePairs make, double num_pairs) {
    add_cases({.name = name,
               .work = "global registration without a guess",
               .scene = scene,
               .peer = "kiss-matcher",
               .aim = 2.0,
               .per_run = num_pairs,
               .unit = "pair"},
              global(make), kGlobalTimed);
  }
};
const GlobalCase kitti("registration/kitti_pair", "KITTI pair", kitti_pair, 1);
const GlobalCase turned("registration/kitti_turned",
                        "KITTI pair, one cloud turned by 120 degrees and moved 5 m", kitti_turned, 1);
const GlobalCase keyframes("registration/tube_keyframes",
                           "keyframes of zab, 4 m and half a turn apart, six pairs", tube_keyframes, 6);
const GlobalCase maps("registration/submaps", "submaps of zab of ten scans each, 6 m apart, two pairs",
                      submaps, 2);

/// The peer's settings: voxels of 0.25 m, pairs up to 1 m apart, from no motion at all.
Work refine() {
  RegistrationConfig config;
  config.voxel_size = 0.25;
  config.refine_distance_voxels = 4.0;
  return [config, pairs = kitti_pair()] {
    return judged(
        pairs, [&](const CloudPair& pair) { return align_clouds(pair.target, pair.source, Pose(), config); });
  };
}
const auto refinements = [] {
  add_cases(
      {.name = "registration/refine_kitti",
       .work = "refinement from no motion, voxels of 0.25 m on both sides",
       .scene = "KITTI pair",
       .peer = "small_gicp",
       .aim = 1.0,
       .unit = "pair"},
      refine,
      {.timed = "from two clouds in memory to the transform: voxels, normals, search trees, all iterations"});
  return 0;
}();

// NAME_K_target.bin, NAME_K_source.bin: KITTI format. NAME_K_T_target_source.txt: 4 x 4, row by row.
void write_pairs(const std::filesystem::path& folder) {
  const auto write = [&](const std::string& name, const CloudPairs& pairs) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::string stem = (folder / format("{}_{}", name, k)).string();
      (void)write_cloud(stem + "_target.bin", pairs[k].target);
      (void)write_cloud(stem + "_source.bin", pairs[k].source);
      std::ofstream transform(stem + "_T_target_source.txt");
      transform.precision(17);
      transform << pairs[k].T_target_source.matrix() << '\n';
    }
  };
  write("kitti_pair", kitti_pair());
  write("kitti_turned", kitti_turned());
  write("tube_keyframes", tube_keyframes());
  write("submaps", submaps());
}
const Export inputs("registration", write_pairs);

}  // namespace
}  // namespace adit::bench
