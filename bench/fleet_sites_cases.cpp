// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a growing fleet costs under the default policy: robots of several sites, four to a site, all meet
/// all, and one of them solves. Most pairs share nothing, as in a company with many mines: what they cost is
/// searching, registering and refusing.
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/slam/meeting.hpp"
#include "adit/study/processor_time.hpp"
#include "harness/bench_case.hpp"
#include "tunnel_inputs.hpp"

namespace adit::bench {
namespace {

constexpr int kRobotsPerSite = 4;
constexpr double kDriven = 130.0;      // metres, of each robot
constexpr double kStartsApart = 30.0;  // metres along one route: the first and the last share 40 m
constexpr double kKeyframesApart = 0.5;

/// A robot of a site: keyframes cast along a part of the site's first route, and odometry that drifts.
RobotMap site_robot(const Tunnel& site, const LidarConfig& lidar, int on_site, RobotId id) {
  const std::vector<Pose> all = poses_along(site.paths().front(), kKeyframesApart);
  const auto first = static_cast<std::size_t>(on_site * kStartsApart / kKeyframesApart);
  const auto num = std::min(static_cast<std::size_t>(kDriven / kKeyframesApart), all.size() - first);
  const RobotSlamConfig config;
  const PathNoise noise{.translation = 0.02, .rotation_deg = 0.05};
  RobotMap map;
  map.id = id;
  map.name = "robot_" + std::to_string(id.value);
  map.viewpoint = T_base_lidar(lidar).translation();
  map.scan_context = config.scan_context;
  std::vector<std::shared_ptr<const PointCloud>> clouds(num);
  parallel_for_each(num, [&](std::size_t k) {
    clouds[k] = std::make_shared<const PointCloud>(
        voxel_downsample(site.seen_from(all[first + k], mix64(id.value, k)), config.cloud_voxel));
  });
  Rng rng(mix64(11, id.value));
  Pose T_odom_base;
  for (std::size_t k = 0; k < num; ++k) {
    Matrix6 covariance = Matrix6::Zero();
    if (k > 0) {
      const Pose step = all[first + k - 1].inverse() * all[first + k];
      covariance = random_walk(noise, step.translation().norm());
      Vector6 error;
      for (int i = 0; i < 6; ++i) error[i] = std::sqrt(covariance(i, i)) * rng.normal();
      T_odom_base = T_odom_base * step * Pose::exp(error);
    }
    const Stamp stamp{static_cast<std::int64_t>(k) * 1'000'000'000};
    map.places.push_back(describe(*clouds[k], map.scan_context));
    map.searchable.push_back(true);
    map.unconfirmed.emplace_back();
    map.step_covariances.push_back(covariance);
    map.pose_noise.push_back(Matrix6::Identity() * 1e-6);
    map.odometry.push_back({stamp, T_odom_base});
    map.keyframes.push_back({{id, static_cast<std::uint32_t>(k)}, stamp, T_odom_base, clouds[k]});
  }
  return map;
}

int site_of(RobotId id) { return id.value / kRobotsPerSite; }

/// Robots 0 to 3 are at the first site, 4 to 7 at the second: road tunnels, mines and metros in turn.
std::vector<std::shared_ptr<const RobotMap>> robots_of_sites(int num) {
  static constexpr std::array kKinds = {"zab", "mine", "metro"};
  const std::string sensor = "os2-32";
  const Result<LidarConfig> lidar = lidar_preset(sensor);
  if (!lidar) throw Skipped{lidar.error().message};
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (int site = 0; site * kRobotsPerSite < num; ++site) {
    const auto kind = static_cast<std::size_t>(site) % kKinds.size();
    const Tunnel tunnel(kKinds[kind], 901 + static_cast<std::uint64_t>(site), sensor);
    for (int r = 0; r < kRobotsPerSite && static_cast<int>(maps.size()) < num; ++r)
      maps.push_back(std::make_shared<const RobotMap>(
          site_robot(tunnel, *lidar, r, {static_cast<std::uint8_t>(maps.size())})));
  }
  return maps;
}

double num_pairs(double num_robots) { return num_robots * (num_robots - 1.0) / 2.0; }

double heap_mb() { return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd) * 1e-6; }

Figures figures_of(const Meeting& meeting, const FleetSolution& solution) {
  Figures figures{{"pairs_of_one_site", 0.0}, {"of_them_merged", 0.0}, {"merged_across_sites", 0.0}};
  for (const PairOutcome& pair : solution.pairs) {
    const bool is_of_one_site = site_of(pair.a) == site_of(pair.b);
    if (pair.merged) figures[is_of_one_site ? "of_them_merged" : "merged_across_sites"] += 1.0;
  }
  const auto num = static_cast<double>(meeting.maps.size());
  for (std::size_t a = 0; a < meeting.maps.size(); ++a)
    for (std::size_t b = a + 1; b < meeting.maps.size(); ++b)
      if (site_of(meeting.maps[a]->id) == site_of(meeting.maps[b]->id)) figures["pairs_of_one_site"] += 1.0;
  double sent = 0.0;
  double most = 0.0;
  for (const std::uint64_t bytes : meeting.bytes_sent) {
    sent += static_cast<double>(bytes) * 1e-6;
    most = std::max(most, static_cast<double>(bytes) * 1e-6);
  }
  figures["sent_mb_per_pair"] = sent / num_pairs(num);
  figures["sent_mb_by_one"] = most;
  figures["registrations"] = static_cast<double>(meeting.agents.front().known().loops.size());
  figures["messages_failed"] = static_cast<double>(meeting.failures.size());
  return figures;
}

/// All robots meet all others twice, as `adit slam` lets them; then the first solves.
Work sites(double num_robots) {
  const auto maps = robots_of_sites(static_cast<int>(num_robots));
  return [maps] {
    const double before_mb = heap_mb();
    const double start_s = processor_s();
    const SlamConfig config;
    const Result<Meeting> meeting = hold_meeting(maps, config);
    if (!meeting) throw std::runtime_error(meeting.error().message);
    const double met_s = processor_s();
    const FleetSolution solution = meeting->agents.front().solve(config.back_end);
    Figures figures = figures_of(*meeting, solution);
    const auto num = static_cast<double>(maps.size());
    figures["cpu_s_per_pair"] = (met_s - start_s) / num_pairs(num);
    figures["solving_cpu_s"] = processor_s() - met_s;
    figures["mb_per_robot"] = (heap_mb() - before_mb) / num;
    return figures;
  };
}

const Growth growth("fleet/sites",
                    "A pair of a fleet under the default policy, four robots a site, 130 m each, one thread",
                    "robots that all meet", {2, 4, 8, 16}, sites, num_pairs);
/// 64 robots take the better part of an hour.
Work many_sites(double num_robots) {
  if (std::getenv("ADIT_BENCH_LARGE") == nullptr) throw Skipped{"only with ADIT_BENCH_LARGE=1"};
  return sites(num_robots);
}
const Growth large("fleet/many_sites", "A pair of a large fleet, four robots a site, 130 m each, one thread",
                   "robots that all meet", {32, 64}, many_sites, num_pairs);

}  // namespace
}  // namespace adit::bench
