// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A small made-up world for tests that need robots with real clouds but no simulator: boxes of random size
/// on a flat floor along a street, their faces sampled densely.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit::test {

class BoxWorld {
 public:
  explicit BoxWorld(std::uint64_t seed, double length = 60.0) {
    Rng rng(seed);
    for (double x = -20.0; x < length + 20.0; x += rng.uniform(3.0, 6.0)) {
      for (const double side : {-1.0, 1.0}) {
        add_box(rng, {x + rng.uniform(-1.0, 1.0), side * rng.uniform(5.0, 9.0), 0.0});
      }
    }
    for (double x = -20.0; x < length + 20.0; x += 0.4) {
      for (double y = -10.0; y < 10.0; y += 0.4)
        points_.emplace_back(x + rng.uniform(0, 0.3), y + rng.uniform(0, 0.3), 0);
    }
  }

  /// What a sensor of 25 m range sees, in the base frame, with 1 cm of noise that differs from seed to seed.
  [[nodiscard]] PointCloud seen_from(const Pose& T_world_base, std::uint64_t seed) const {
    Rng rng(seed);
    PointCloud cloud;
    const Pose T_base_world = T_world_base.inverse();
    for (const Vector3& p : points_) {
      const Vector3 q = T_base_world * p;
      if (q.norm() > 25.0) continue;
      const Vector3 noise(rng.normal(), rng.normal(), rng.normal());
      cloud.points.push_back((q + 0.01 * noise).cast<float>());
    }
    return cloud;
  }

 private:
  void add_box(Rng& rng, const Vector3& centre) {
    const Vector3 half(rng.uniform(0.5, 1.8), rng.uniform(0.5, 1.5), 0.0);
    const double height = rng.uniform(1.0, 6.0);
    const double yaw = rng.uniform(0.0, 3.0);
    const int count = static_cast<int>(60.0 * (half.x() + half.y()) * height);
    for (int i = 0; i < count; ++i) {
      const double u = rng.uniform(-1.0, 1.0);
      const double s = rng.below(2) == 0 ? -1.0 : 1.0;
      const bool along_x = rng.uniform() < half.x() / (half.x() + half.y());
      const Vector3 local =
          along_x ? Vector3(u * half.x(), s * half.y(), 0.0) : Vector3(s * half.x(), u * half.y(), 0.0);
      const Vector3 turned = Pose::planar(0, 0, yaw) * local;
      points_.push_back(centre + turned + Vector3(0.0, 0.0, rng.uniform(0.0, height)));
    }
  }

  std::vector<Vector3> points_;
};

/// A robot that drove through true poses `T_world_base`; its odometry starts at the identity and drifts by
/// `yaw_drift` radians per step.
inline RobotMap drive(const BoxWorld& world, RobotId id, const std::vector<Pose>& T_world_base,
                      double yaw_drift) {
  RobotMap map;
  map.id = id;
  map.scan_context.max_radius_m = 25.0;
  map.name = "robot_" + std::to_string(id.value);
  Pose T_odom_base;
  for (std::uint32_t k = 0; k < T_world_base.size(); ++k) {
    Matrix6 covariance = Matrix6::Zero();
    if (k > 0) {
      const Pose step = T_world_base[k - 1].inverse() * T_world_base[k];
      T_odom_base = T_odom_base * step * Pose::planar(0.0, 0.0, yaw_drift);
      covariance = random_walk(PathNoise{}, step.translation().norm());
    }
    const Stamp stamp{static_cast<std::int64_t>(k) * 1'000'000'000};
    auto cloud = std::make_shared<PointCloud>(world.seen_from(T_world_base[k], mix64(id.value, k)));
    map.places.push_back(describe(*cloud, map.scan_context));
    map.searchable.push_back(true);
    map.unconfirmed.push_back(0.0F);
    map.step_covariances.push_back(covariance);
    map.pose_noise.push_back(Matrix6::Zero());
    map.odometry.push_back({stamp, T_odom_base});
    map.keyframes.push_back({{id, k}, stamp, T_odom_base, std::move(cloud)});
  }
  return map;
}

}  // namespace adit::test
