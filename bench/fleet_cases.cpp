// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a growing fleet costs each robot: 4 to 64 robots drive 1 km each through one mine, all meet all, and
/// one of them solves. Keyframes are artificial but realistic: clouds of a generated mine with their
/// descriptors.
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/transport/loopback_bus.hpp"
#include "harness/bench_case.hpp"

namespace adit::bench {
namespace {

constexpr int kStreets = 8;      // drifts each way
constexpr double kBlock = 60.0;  // metres between them
constexpr double kHalfWidth = 2.5;
constexpr double kHeight = 3.0;
constexpr double kSight = 12.0;
constexpr double kSampling = 0.8;
constexpr double kStep = 2.0;  // metres between keyframes
constexpr int kKeyframes = 500;

/// A square of drifts with rough walls, boulders along them and rooms of different width; every point of its
/// surface follows from its place alone.
class Mine {
 public:
  /// What a sensor at that pose sees of the drift it is in and of those that cross it, with 2 cm of noise.
  [[nodiscard]] PointCloud seen_from(const Pose& T_world_base, std::uint64_t seed) const {
    Rng rng(seed);
    PointCloud cloud;
    const Pose T_base_world = T_world_base.inverse();
    const Vector3& at = T_world_base.translation();
    for (const bool along_x : {true, false}) {
      const double across = along_x ? at.y() : at.x();
      const double along = along_x ? at.x() : at.y();
      for (int street = 0; street < kStreets; ++street) {
        const double offset = street * kBlock - across;
        if (std::abs(offset) > kSight) continue;
        add_street(along_x, street, along, T_base_world, rng, cloud);
      }
    }
    return cloud;
  }

 private:
  static double unit(std::uint64_t key) { return Rng(key).uniform(); }
  /// In [-1, 1], smooth along the drift.
  static double relief(std::uint64_t street, int side, double along, double up) {
    const auto corner = [&](int i, int j) {
      return 2.0 * unit(mix64(mix64(street, static_cast<std::uint64_t>(side)),
                              mix64(static_cast<std::uint64_t>(i + 1000), static_cast<std::uint64_t>(j)))) -
             1.0;
    };
    const double x = along / 2.5;
    const double y = up / 1.5;
    const int i = static_cast<int>(std::floor(x));
    const int j = static_cast<int>(std::floor(y));
    const double u = x - i;
    const double v = y - j;
    return (1 - v) * ((1 - u) * corner(i, j) + u * corner(i + 1, j)) +
           v * ((1 - u) * corner(i, j + 1) + u * corner(i + 1, j + 1));
  }
  static bool in_other_street(double along) {
    const double to_street = along - kBlock * std::round(along / kBlock);
    return std::abs(to_street) < kHalfWidth && along > -kHalfWidth &&
           along < kBlock * kStreets - kBlock + kHalfWidth;
  }

  void add_street(bool along_x, int street, double middle, const Pose& T_base_world, Rng& rng,
                  PointCloud& cloud) const {
    const std::uint64_t name = mix64(along_x ? 1U : 2U, static_cast<std::uint64_t>(street));
    const double first = std::ceil((middle - kSight) / kSampling) * kSampling;
    for (double s = first; s < middle + kSight; s += kSampling) {
      if (s < -kHalfWidth || s > kBlock * (kStreets - 1) + kHalfWidth) continue;
      const double width =
          kHalfWidth * (0.8 + 0.4 * unit(mix64(name, static_cast<std::uint64_t>(1000 + s / 15.0))));
      const auto add = [&](double t, double z) {
        const Vector3 p = along_x ? Vector3(s, street * kBlock + t, z) : Vector3(street * kBlock + t, s, z);
        const Vector3 q = T_base_world * p;
        if (q.head<2>().norm() > kSight) return;
        const Vector3 noise(rng.normal(), rng.normal(), rng.normal());
        cloud.points.push_back((q + 0.02 * noise).cast<float>());
      };
      if (!in_other_street(s)) {
        for (const int side : {-1, 1}) {
          const bool boulder =
              unit(mix64(name, mix64(static_cast<std::uint64_t>(2000 + s / 3.0), side > 0))) < 0.25;
          for (double z = 0.2; z < kHeight; z += kSampling) {
            const double in = boulder && z < 1.4 ? 0.9 : 0.0;
            add(side * (width - in + 0.35 * relief(name, side + 1, s, z)), z);
          }
        }
      }
      for (double t = -width; t < width; t += kSampling) {
        add(t, 0.0);
        add(t, kHeight + 0.35 * relief(name, 5, s, t + 10.0));
      }
    }
  }
};

/// Through the mine for 1 km, at crossings in any direction but back.
std::vector<Pose> wander(Rng& rng) {
  int x = static_cast<int>(rng.below(kStreets));
  int y = static_cast<int>(rng.below(kStreets));
  int heading = static_cast<int>(rng.below(4));
  constexpr int kDx[] = {1, 0, -1, 0};
  constexpr int kDy[] = {0, 1, 0, -1};
  const auto inside = [](int v) { return v >= 0 && v < kStreets; };
  std::vector<Pose> poses;
  while (static_cast<int>(poses.size()) < kKeyframes) {
    int next = heading;
    do {
      next = (heading + static_cast<int>(rng.below(3)) + 3) % 4;  // left, on, right
      if (rng.below(20) == 0) next = static_cast<int>(rng.below(4));
    } while (!inside(x + kDx[next]) || !inside(y + kDy[next]));
    heading = next;
    const double lane = rng.uniform(-0.5, 0.5);
    for (double s = 0.0; s < kBlock && static_cast<int>(poses.size()) < kKeyframes; s += kStep) {
      const double yaw = heading * std::numbers::pi / 2.0;
      poses.push_back(Pose::planar(x * kBlock + s * kDx[heading] - lane * kDy[heading],
                                   y * kBlock + s * kDy[heading] + lane * kDx[heading],
                                   yaw + 0.05 * rng.normal()));
    }
    x += kDx[heading];
    y += kDy[heading];
  }
  return poses;
}

RobotMap drive(const Mine& mine, RobotId id) {
  Rng rng(mix64(7, id.value));
  const std::vector<Pose> truth = wander(rng);
  RobotMap map;
  map.id = id;
  map.name = "robot_" + std::to_string(id.value);
  map.scan_context.max_radius_m = kSight;
  Pose T_odom_base;
  for (std::uint32_t k = 0; k < truth.size(); ++k) {
    Matrix6 covariance = Matrix6::Zero();
    if (k > 0) {
      const Pose step = truth[k - 1].inverse() * truth[k];
      covariance = random_walk(PathNoise{}, step.translation().norm());
      const Vector6 noise =
          covariance.diagonal().cwiseSqrt().cwiseProduct(Vector6::NullaryExpr([&] { return rng.normal(); }));
      T_odom_base = T_odom_base * step * Pose::exp(noise);
    }
    const Stamp stamp{std::int64_t{k} * 1'000'000'000};
    auto cloud = std::make_shared<PointCloud>(mine.seen_from(truth[k], mix64(id.value, k)));
    map.places.push_back(describe(*cloud, map.scan_context));
    map.searchable.push_back(true);
    map.unconfirmed.push_back(0.0F);
    map.step_covariances.push_back(covariance);
    map.odometry.push_back({stamp, T_odom_base});
    map.keyframes.push_back({{id, k}, stamp, T_odom_base, std::move(cloud)});
  }
  return map;
}

double heap_mb() { return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd) * 1e-6; }

double num_robots(double num_met) { return num_met + 1.0; }

/// All robots meet all others twice, as `adit slam` lets them; then the first solves.
Work fleet(double num_met) {
  const Mine mine;
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (int r = 0; r < static_cast<int>(num_robots(num_met)); ++r)
    maps.push_back(std::make_shared<const RobotMap>(drive(mine, {static_cast<std::uint8_t>(r)})));
  return [maps] {
    const double before_mb = heap_mb();
    AgentConfig config;
    config.policy = MergePolicy::paper;
    config.registration.voxel_size = 0.6;
    config.max_candidates = 128;
    config.candidates_per_peer = 2;
    LoopbackBus bus;
    std::vector<Agent> agents;
    agents.reserve(maps.size());
    for (const auto& map : maps) {
      agents.emplace_back(map, config);
      bus.join(agents.back());
    }
    for (int round = 0; round < 2; ++round) {
      for (std::size_t a = 0; a < agents.size(); ++a) {
        for (std::size_t b = a + 1; b < agents.size(); ++b) (void)bus.meet(agents[a].id(), agents[b].id());
      }
    }
    const double after_mb = heap_mb();
    const FleetSolution solution = agents.front().solve({});
    double sent = 0.0;
    for (const auto& map : maps) sent += static_cast<double>(bus.bytes_sent(map->id));
    const auto robots = static_cast<double>(maps.size());
    const auto count = [](const auto& items, const auto& property) {
      return static_cast<double>(std::ranges::count_if(items, property));
    };
    return Figures{
        {"mb_per_robot", (after_mb - before_mb) / robots},
        {"sent_mb_per_robot", sent * 1e-6 / robots},
        {"registrations", static_cast<double>(agents.front().known().loops.size())},
        {"loops_in_use", count(solution.loops, [](const LoopOutcome& loop) { return loop.in_use(); })},
        {"pairs_merged", count(solution.pairs, [](const PairOutcome& pair) { return pair.merged; })},
        {"components", static_cast<double>(solution.components.size())}};
  };
}

const Growth growth("fleet/robots_met", "A robot's share of a fleet, 1 km each, one thread",
                    "robots that it met", {3, 7, 15, 31, 63}, fleet, num_robots);

}  // namespace
}  // namespace adit::bench
