// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// An IMU in the LiDAR: what a gyroscope and an accelerometer measure of the robot's true motion.
///
/// A rate is the true one, times its scale, plus a bias and white noise, within the range of the sensor;
/// specific force likewise. The bias is drawn when the sensor is turned on and then walks at random (IEEE Std
/// 952-1997, annex C: angle random walk and rate random walk).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// At the equator 9.780, at the poles 9.832: the standard value (CGPM 1901), metres per second squared.
inline constexpr double kStandardGravity = 9.80665;

/// White noise is stated as a density: a sample's standard deviation is that times the root of the rate.
/// Defaults: the IMU of an Ouster OS2.
struct ImuConfig {
  bool on = true;
  std::string name = "icm-20948";
  double rate_hz = 100.0;
  double gyro_noise_deg = 0.015;  ///< (deg/s)/sqrt(Hz)
  double gyro_bias_deg = 1.7;     ///< deg/s, standard deviation when turned on.
  double gyro_walk_deg = 1e-3;    ///< (deg/s)/sqrt(s)
  double gyro_scale_sigma = 0.005;
  double gyro_max_deg = 250.0;  ///< deg/s
  double accel_noise = 2.3e-3;  ///< (m/s^2)/sqrt(Hz)
  double accel_bias = 0.16;     ///< m/s^2, standard deviation when turned on.
  double accel_walk = 5e-4;     ///< (m/s^2)/sqrt(s)
  double accel_scale_sigma = 0.0017;
  double accel_max = 2.0 * kStandardGravity;
  double vibration = 0.0;      ///< m/s^2 of acceleration per m/s of speed, standard deviation per axis.
  double vibration_deg = 0.0;  ///< deg/s of turning per m/s of speed, the same.
  double mount_x = 0.006;      ///< Position in the lidar frame, metres.
  double mount_y = -0.012;
  double mount_z = 0.008;
  double mount_roll_deg = 0.0;
  double mount_pitch_deg = 0.0;
  double mount_yaw_deg = 0.0;
  std::string faults;  ///< "silent 10:15", see faults.hpp.
};
/// The keys are the names of the members; in the configuration of a run they begin with "simulation.imu.".
[[nodiscard]] Fields fields_of(ImuConfig& config);

/// Ranges of the fields, and the text of the faults.
Result<> check_imu(ImuConfig config);

/// icm-20948 (Ouster OS0, OS1, OS2), bmi088 (Livox Avia and many robots), adis16470 (a better one, as robots
/// carry beside the LiDAR), perfect (no errors; under field conditions it is shaken). An unknown name fails
/// with the list. They sit where the default sits.
[[nodiscard]] Result<ImuConfig> imu_preset(const std::string& name);
/// The names that imu_preset() knows.
[[nodiscard]] std::vector<std::string> imu_presets();

/// With vibration of 0.5 m/s^2 and 1 degree/s at 1 m/s, chosen: of the order of the 0.44 to 0.82 m/s^2 that
/// the seats of eight haulage trucks pass on (A. Smets et al., "Whole-body vibration experienced by haulage
/// truck operators in surface mining operations", Applied Ergonomics 2010).
[[nodiscard]] ImuConfig field_imu(ImuConfig config);

/// The stated mount. It is turned by roll, then pitch, then yaw about the fixed axes of the lidar frame.
[[nodiscard]] Pose T_lidar_imu(const ImuConfig& config);

/// Of one sample, as the density of the noise says.
[[nodiscard]] ImuCovariance covariance_of(const ImuConfig& config);

/// The samples of an IMU at T_base_imu from the begin of `truth` (T_world_base, z up, two poses or more)
/// until they cover its end. `config` passes check_imu. Vibration is felt but does not move the robot: at 50
/// Hz, 1 m/s^2 is a hundredth of a millimetre.
[[nodiscard]] std::vector<ImuSample> imu_samples(const Trajectory& truth, const Pose& T_base_imu,
                                                 const ImuConfig& config, std::uint64_t seed);

/// The faults of the configuration.
[[nodiscard]] std::vector<SensorFault> imu_faults(const ImuConfig& config, Stamp start);

}  // namespace adit
