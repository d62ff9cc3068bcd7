// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_unit.hpp"

#include <bit>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// Of a careless mount, beside a careful one: 1 degree beside 0.3, so that the worst is off by 2. Chosen.
constexpr double kCareless = 10.0 / 3.0;

std::vector<double> by_ring(std::size_t rings, double sigma, Rng& rng) {
  if (sigma == 0.0) return {};
  std::vector<double> draws(rings);
  for (double& draw : draws) draw = sigma * rng.normal_within_two_sigma();
  return draws;
}

Vector3 by_axis(double sigma, Rng& rng) {
  const double x =
      rng.normal_within_two_sigma();  // one after the other: compilers evaluate arguments in any order
  const double y = rng.normal_within_two_sigma();
  const double z = rng.normal_within_two_sigma();
  return sigma * Vector3(x, y, z);
}

}  // namespace

Fields fields_of(LidarErrorConfig& c) {
  return {
      {"divergence_factor", &c.divergence_factor, "", 0, 10,
       "width of the beams, of the sensor's divergence; 0: rays, which hit no edge"},
      {"range_bias", &c.range_bias, "m", 0, 1, "added to every range, constant per robot (sigma, as below)"},
      {"ring_bias", &c.ring_bias, "m", 0, 1, "added to every range of one ring"},
      {"incidence_walk", &c.incidence_walk, "m", 0, 1, "added where a surface is met at 80 degrees"},
      {"intensity_walk", &c.intensity_walk, "m", 0, 1,
       "added to the weakest returns, less to stronger ones; see surfaces"},
      {"warm_up_drift", &c.warm_up_drift, "m", 0, 1, "added once the sensor is warm"},
      {"warm_up_s", &c.warm_up_s, "s", 1, 1e5,
       "time in which the drift has come to 63 %; sensors were switched on up to as long before the drive"},
      {"ring_azimuth_deg", &c.ring_azimuth_deg, "deg", 0, 5, "a ring looks to the side of what it reports"},
      {"ring_elevation_deg", &c.ring_elevation_deg, "deg", 0, 5, "a ring looks above what it reports"},
      {"mount", &c.mount, "m", 0, 1, "position of the sensor against the stated mount, per axis"},
      {"mount_deg", &c.mount_deg, "deg", 0, 10, "rotation of the sensor against the stated mount, per axis"},
      {"careless", &c.careless, "", 0, 1, "share of the robots on which mounts are off by 3.3 times that"},
      {"clock_s", &c.clock_s, "s", 0, 1, "by which the stamps of wheels and IMU are late, each by its own"},
      {"jitter_s", &c.jitter_s, "s", 0, 0.02, "of the stamp of each scan"},
      {"false_returns", &c.false_returns, "", 0, 0.5,
       "share of rays that report a range between sensor and surface"},
      {"response", &c.response, "", 0, 0.45, "intensities are reported to the power of 1 and this"},
      {"fall_off", &c.fall_off, "", 0, 3,
       "intensities change with the range, in tens of metres, to this power"},
      {"opposed", &c.opposed, "", 0, 0,
       "bias, walk and drift are one sigma instead of drawn, up on robots 0, 3, ..., down on 1, 2, ..."}};
}

LidarErrorConfig field_lidar_errors() {
  LidarErrorConfig c;
  c.divergence_factor = 1.0;
  c.range_bias = 0.015;
  c.ring_bias = 0.008;
  c.incidence_walk = 0.015;
  c.intensity_walk = 0.015;
  c.warm_up_drift = 0.0025;
  c.ring_azimuth_deg = 0.01;
  c.ring_elevation_deg = 0.01;
  c.mount = 0.01;
  c.mount_deg = 0.3;
  c.careless = 0.1;
  c.clock_s = 0.01;
  c.jitter_s = 0.0005;
  c.false_returns = 1e-4;
  c.response = 0.15;
  c.fall_off = 0.5;
  return c;
}

double LidarUnit::bias_at(Duration since_start) const {
  return range_bias + warm_up_drift * -std::expm1(-(on_before_s + to_seconds(since_start)) / warm_up_s);
}

LidarUnit draw_lidar_unit(const LidarErrorConfig& c, std::size_t rings, std::size_t robot,
                          std::uint64_t seed) {
  Rng rng(seed);
  // Up, down, down, up, ... (Thue and Morse): robots of equal parity differ too.
  const double side = std::popcount(robot) % 2 == 0 ? 1.0 : -1.0;
  const auto one = [&](double sigma) {
    const double draw = rng.normal_within_two_sigma();
    return sigma * (c.opposed ? side : draw);
  };
  LidarUnit unit;
  unit.divergence_factor = c.divergence_factor;
  unit.range_bias = one(c.range_bias);
  unit.incidence_walk = one(c.incidence_walk);
  unit.warm_up_drift = one(c.warm_up_drift);
  unit.warm_up_s = c.warm_up_s;
  const Vector3 position = by_axis(c.mount, rng);
  const Vector3 rotation = by_axis(c.mount_deg * kDegree, rng);
  unit.wheels_late = from_seconds(c.clock_s * rng.normal_within_two_sigma());
  unit.imu_late = from_seconds(c.clock_s * rng.normal_within_two_sigma());
  unit.jitter_s = c.jitter_s;
  unit.false_returns = c.false_returns;
  unit.ring_range = by_ring(rings, c.ring_bias, rng);
  unit.ring_azimuth = by_ring(rings, c.ring_azimuth_deg * kDegree, rng);
  unit.ring_elevation = by_ring(rings, c.ring_elevation_deg * kDegree, rng);
  unit.intensity_walk =
      one(c.intensity_walk);  // draws that are new come last and leave the others as they were
  unit.on_before_s = c.warm_up_s * rng.uniform();
  unit.response = 1.0 + c.response * rng.normal_within_two_sigma();
  unit.fall_off = c.fall_off * rng.normal_within_two_sigma();
  const double carelessness = rng.uniform() < c.careless ? kCareless : 1.0;
  unit.T_nominal_true = {so3::exp(carelessness * rotation), carelessness * position};
  return unit;
}

}  // namespace adit
