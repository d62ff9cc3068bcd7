// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One LiDAR as it left the factory and was bolted to a robot: the constant and slow errors that tell it from
/// another of its kind. Noise, which changes from ray to ray, is in lidar_model.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"

namespace adit {

/// How units differ: standard deviations over units, in metres unless said otherwise. No draw is farther than
/// two of them from zero. All zero, as by default, is a sensor without such errors.
///
/// Sources of field_lidar_errors(): range accuracy of 25 to 80 mm and angular accuracy of 0.01 degrees in the
/// data sheets of Ouster (OS0, OS1, OS2) and +-30 mm in that of the VLP-16, of which calibrations found a
/// part to be one number per laser and to drift while the sensor warms up (Glennie, Kusari and Facchin,
/// "Calibration and stability analysis of the VLP-16 laser scanner", 2016; Glennie and Lichti, "Static
/// calibration and analysis of the Velodyne HDL-64E S2", 2010). Mounts and clocks: what a careful workshop
/// reaches without calibration; that one mount in ten is careless is chosen.
struct LidarErrorConfig {
  double divergence_factor = 0.0;  ///< Width of the beams, of the stated one; no spread. 0: rays.
  double range_bias = 0.0;         ///< Added to every range.
  double ring_bias = 0.0;          ///< Added to every range of one ring.
  double incidence_walk = 0.0;     ///< Added where a surface is met at 80 degrees; less where more head-on.
  double intensity_walk = 0.0;     ///< Added to the weakest return, half of it to one 100 times as strong.
  double warm_up_drift = 0.0;      ///< Added once the sensor is warm.
  double warm_up_s = 600.0;        ///< Time in which the drift has come to 63 %; units were switched on up to
                                   ///< as long before the drive.
  double ring_azimuth_deg = 0.0;   ///< A ring looks elsewhere than it reports.
  double ring_elevation_deg = 0.0;
  double mount = 0.0;      ///< Per axis: the sensor sits elsewhere than the recording says,
  double mount_deg = 0.0;  ///< and is turned.
  double careless = 0.0;   ///< Share of the robots on which it is off by 10/3 of both, 1 degree beside 0.3.
  double clock_s = 0.0;    ///< By which wheels and IMU are stamped late, each by its own.
  double jitter_s = 0.0;   ///< Of each scan's stamp.
  double false_returns = 0.0;  ///< Share of rays that report a range between the sensor and the surface.
  double response = 0.0;       ///< Intensities are reported to the power of 1 and this.
  double fall_off = 0.0;       ///< They change with range / 10 m to this power: raw, or overcorrected.
  /// Range bias, walk and drift are one standard deviation instead of drawn, up on robots 0 and 3, down on 1
  /// and 2, and so on: the worst pairs of a fleet, for curves of the outcome over an amplitude.
  bool opposed = false;
};
/// The keys are the names of the members; in the configuration of a run they begin with
/// "simulation.lidar_errors.".
[[nodiscard]] Fields fields_of(LidarErrorConfig& config);

/// Errors as in practice.
[[nodiscard]] LidarErrorConfig field_lidar_errors();

/// The errors of one unit. By default it has none.
struct LidarUnit {
  double divergence_factor = 0.0;      ///< Width of the beams divided by the stated one; 0: rays.
  double range_bias = 0.0;             ///< Metres, added to every range.
  double incidence_walk = 0.0;         ///< Metres, added where a surface is met at 80 degrees.
  double intensity_walk = 0.0;         ///< Metres, added to the weakest return; felt where surfaces differ.
  double warm_up_drift = 0.0;          ///< Metres, added once the sensor is warm.
  double warm_up_s = 1.0;              ///< Seconds in which the drift has come to 63 %.
  double on_before_s = 0.0;            ///< Seconds before the drive at which the sensor was switched on.
  std::vector<double> ring_range;      ///< Metres by beam, from the highest down; empty: none.
  std::vector<double> ring_azimuth;    ///< Radians, the same.
  std::vector<double> ring_elevation;  ///< Radians, the same.
  Pose T_nominal_true;                 ///< The sensor's true frame in the one that the recording states.
  Duration wheels_late{};              ///< Added to the stamps of the wheel odometry; may be negative.
  Duration imu_late{};                 ///< The same of the IMU.
  double jitter_s = 0.0;               ///< Standard deviation of the stamps of scans, seconds.
  double false_returns = 0.0;          ///< Share of rays that report too short a range.
  double response = 1.0;               ///< Power to which intensities are reported.
  double fall_off = 0.0;               ///< Power of range / 10 m with which they change beside.

  /// What is added to ranges at that time after the start of the drive whatever they meet, rings apart.
  [[nodiscard]] double bias_at(Duration since_start) const;
};

/// The unit of robot number `robot`. `rings`: beams that are lasers of their own, 0 for a sensor with one
/// laser.
[[nodiscard]] LidarUnit draw_lidar_unit(const LidarErrorConfig& config, std::size_t rings, std::size_t robot,
                                        std::uint64_t seed);

}  // namespace adit
