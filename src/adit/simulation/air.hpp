// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Dust and fog between a sensor and the walls, and water that drips.
///
/// Light is scattered on its way with a probability per metre, the extinction (Beer and Lambert); visibility
/// is 3.912 / extinction (Koschmieder). Scattered light that comes back competes with the wall's, and the
/// sensor reports the stronger (M. Hahner and others, "Fog simulation on real LiDAR point clouds for 3D
/// object detection in adverse weather", ICCV 2021). In thin air that gives single points spread over metres,
/// more of them near the sensor; a dense cloud has a skin like a wall, and nothing is seen behind it
/// (T. Phillips, N. Guenther and P. McAree, "When the dust settles: the four behaviors of lidar in the
/// presence of fine airborne particulates", Journal of Field Robotics 34, 2017).
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// All zero, as by default, is clear air.
struct AirConfig {
  double fog = 0.0;            ///< Extinction everywhere.
  double clouds_per_km = 0.0;  ///< Clouds of dust that each robot meets, other ones for each.
  double cloud_density = 0.2;  ///< Their extinction; drawn from a quarter to four times this.
  double cloud_radius = 4.0;   ///< Metres; drawn from half to one and a half of it.
  double drips = 0.0;          ///< Share of rays that meet a drop, in three places of ten.
};
/// The keys are the names of the members; in the configuration of a run they begin with "simulation.air.".
[[nodiscard]] Fields fields_of(AirConfig& config);

/// Haze with a visibility of 2 km; every 500 m a cloud as vehicles raise it, in which one sees 5 to 80 m.
[[nodiscard]] AirConfig field_air();

/// A ball of dust that drifts past one point of a robot's path.
struct DustCloud {
  Stamp middle;          ///< Of its life, which lasts 90 s.
  Vector3 centre;        ///< At `middle`; world frame, metres.
  Vector3 velocity;      ///< World frame, metres per second; steady.
  double radius = 1.0;   ///< Metres.
  double density = 0.0;  ///< Extinction in it, per metre.
};

/// The air during one sweep, world frame.
struct Air {
  /// A cloud, where it is at that time.
  struct Ball {
    Eigen::Vector3f centre;  ///< Metres.
    float radius;            ///< Metres.
    float density;           ///< Extinction per metre, which adds to that of the fog.
  };
  float fog = 0.0F;              ///< Extinction everywhere, per metre.
  float drips = 0.0F;            ///< Share of rays that meet a drop; 0 where no water drips.
  std::vector<Ball> balls = {};  ///< All clouds of that time, however far away.

  /// Whether look_through() would change nothing.
  [[nodiscard]] bool is_clear() const { return fog == 0.0F && drips == 0.0F && balls.empty(); }
};

/// The clouds that a robot meets on its way (T_world_base).
[[nodiscard]] std::vector<DustCloud> draw_clouds(const Trajectory& truth, const AirConfig& config,
                                                 std::uint64_t seed);

/// The air around a sensor at that time. Where water drips depends on the position and the seed of the world.
[[nodiscard]] Air air_at(Stamp stamp, const Vector3& sensor, const AirConfig& config,
                         const std::vector<DustCloud>& clouds, std::uint64_t seed);

/// Weakens the signals of what rays met (in the units of surface_signal.hpp, for a sensor with that reach)
/// and puts those that end in the air there. `seed` draws which.
void look_through(const Air& air, float reach, std::uint64_t seed, RayBlock& rays,
                  RayBlock::Numbers& signals);

}  // namespace adit
