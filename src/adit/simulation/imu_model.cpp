// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/imu_model.hpp"

#include <array>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/faults.hpp"
#include "adit/simulation/smooth_motion.hpp"

namespace adit {
namespace {

constexpr std::string_view kSilent = "silent";
constexpr std::array kImuFaults{FaultKind{kSilent}};

// Figures of data sheets: densities of noise as they stand there; what they call initial or typical tolerance
// (of bias and scale) counts as three standard deviations. Sheets say little of how biases walk: where they
// give an in-run stability the walk over 100 s is that large, and of the ICM-20948 it is that of a sensor
// which warms up by a degree in that time.

// TDK InvenSense DS-000189 v1.3, tables 1 and 2: 0.015 dps/sqrt(Hz), +-5 dps, 1.5 %, 0.05 dps/K; 230
// ug/sqrt(Hz), +-50 mg on a board, 0.5 %, 0.8 mg/K. Rate and ranges as Ouster sets them.
ImuConfig icm20948() { return {}; }

// Bosch BST-BMI088-DS001: 0.014 dps/sqrt(Hz), +-1 dps, 1 %; 175 ug/sqrt(Hz), +-20 mg, 0.5 %. In-run: 6.5
// deg/h measured by J. Pieper (jpieper.com, Allan variance of a BMI088), 40 ug.
ImuConfig bmi088() {
  ImuConfig c;
  c.name = "bmi088";
  c.rate_hz = 200.0;
  c.gyro_noise_deg = 0.014;
  c.gyro_bias_deg = 0.33;
  c.gyro_walk_deg = 1.8e-4;
  c.gyro_scale_sigma = 0.0033;
  c.gyro_max_deg = 2000.0;
  c.accel_noise = 1.7e-3;
  c.accel_bias = 0.065;
  c.accel_walk = 4e-5;
  c.accel_max = 6.0 * kStandardGravity;
  return c;
}

// Analog Devices ADIS16470 rev. C: 0.008 dps/sqrt(Hz), 0.2 dps, 8 deg/h in run; 100 ug/sqrt(Hz), 1.4 mg, 13
// ug in run; calibrated in the factory to 0.5 %.
ImuConfig adis16470() {
  ImuConfig c;
  c.name = "adis16470";
  c.rate_hz = 200.0;
  c.gyro_noise_deg = 0.008;
  c.gyro_bias_deg = 0.07;
  c.gyro_walk_deg = 2.2e-4;
  c.gyro_scale_sigma = 0.0017;
  c.gyro_max_deg = 2000.0;
  c.accel_noise = 9.8e-4;
  c.accel_bias = 0.0046;
  c.accel_walk = 1.3e-5;
  c.accel_max = 40.0 * kStandardGravity;
  return c;
}

ImuConfig perfect_imu() {
  ImuConfig c;
  c.name = "perfect";
  c.rate_hz = 200.0;
  c.gyro_noise_deg = c.gyro_bias_deg = c.gyro_walk_deg = c.gyro_scale_sigma = 0.0;
  c.accel_noise = c.accel_bias = c.accel_walk = c.accel_scale_sigma = 0.0;
  c.gyro_max_deg = 2000.0;
  c.accel_max = 40.0 * kStandardGravity;
  return c;
}

std::vector<ImuConfig> all_presets() { return {icm20948(), bmi088(), adis16470(), perfect_imu()}; }

Vector3 draw(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

// One sensor with three axes.
class Triad {
 public:
  struct Errors {
    double noise;  // per sample
    double bias;
    double walk;  // per sample
    double scale;
    double limit;
    double vibration;  // per metre per second
  };
  Triad(const Errors& errors, Rng& rng)
      : errors_(errors), bias_(errors.bias * draw(rng)), scale_(errors.scale * draw(rng)) {}

  Vector3 measure(const Vector3& truth, double speed, Rng& rng) {
    const double sigma = std::hypot(errors_.noise, errors_.vibration * speed);
    const Vector3 value = truth + scale_.cwiseProduct(truth) + bias_ + sigma * draw(rng);
    bias_ += errors_.walk * draw(rng);
    return value.cwiseMin(errors_.limit).cwiseMax(-errors_.limit);
  }

 private:
  Errors errors_;
  Vector3 bias_;
  Vector3 scale_;
};

Triad::Errors gyro_errors(const ImuConfig& c) {
  const double root_rate = std::sqrt(c.rate_hz);
  return {c.gyro_noise_deg * kDegree * root_rate,
          c.gyro_bias_deg * kDegree,
          c.gyro_walk_deg * kDegree / root_rate,
          c.gyro_scale_sigma,
          c.gyro_max_deg * kDegree,
          c.vibration_deg * kDegree};
}

Triad::Errors accel_errors(const ImuConfig& c) {
  const double root_rate = std::sqrt(c.rate_hz);
  return {c.accel_noise * root_rate, c.accel_bias, c.accel_walk / root_rate,
          c.accel_scale_sigma,       c.accel_max,  c.vibration};
}

}  // namespace

Fields fields_of(ImuConfig& c) {
  return {
      {"on", &c.on, "", 0, 0, "whether there is an IMU"},
      {"name", &c.name, "", 0, 0, "the sensor's name, noted in recordings"},
      {"rate_hz", &c.rate_hz, "Hz", 10, 2000, "samples per second"},
      {"gyro_noise_deg", &c.gyro_noise_deg, "deg/s/sqrt(Hz)", 0, 10, "density of the white noise of rates"},
      {"gyro_bias_deg", &c.gyro_bias_deg, "deg/s", 0, 100,
       "bias of rates when turned on, standard deviation"},
      {"gyro_walk_deg", &c.gyro_walk_deg, "deg/s/sqrt(s)", 0, 10, "random walk of that bias"},
      {"gyro_scale_sigma", &c.gyro_scale_sigma, "", 0, 0.2, "relative error of rates, constant per axis"},
      {"gyro_max_deg", &c.gyro_max_deg, "deg/s", 10, 10000, "largest rate; higher ones are cut off"},
      {"accel_noise", &c.accel_noise, "m/s^2/sqrt(Hz)", 0, 10, "density of the white noise of acceleration"},
      {"accel_bias", &c.accel_bias, "m/s^2", 0, 10,
       "bias of acceleration when turned on, standard deviation"},
      {"accel_walk", &c.accel_walk, "m/s^2/sqrt(s)", 0, 10, "random walk of that bias"},
      {"accel_scale_sigma", &c.accel_scale_sigma, "", 0, 0.2,
       "relative error of acceleration, constant per axis"},
      {"accel_max", &c.accel_max, "m/s^2", 10, 10000, "largest acceleration; higher ones are cut off"},
      {"vibration", &c.vibration, "1/s", 0, 100, "acceleration by vibration per m/s of speed, m/s^2"},
      {"vibration_deg", &c.vibration_deg, "deg/m", 0, 1000, "turning by vibration per m/s of speed, deg/s"},
      {"mount_x", &c.mount_x, "m", -5, 5, "position in the LiDAR's frame, forward"},
      {"mount_y", &c.mount_y, "m", -5, 5, "to the left"},
      {"mount_z", &c.mount_z, "m", -5, 5, "up"},
      {"mount_roll_deg", &c.mount_roll_deg, "deg", -180, 180, "attitude in the LiDAR's frame"},
      {"mount_pitch_deg", &c.mount_pitch_deg, "deg", -90, 90, "attitude in the LiDAR's frame"},
      {"mount_yaw_deg", &c.mount_yaw_deg, "deg", -180, 180, "attitude in the LiDAR's frame"},
      {"faults", &c.faults, "", 0, 0, "stretches without samples: 'silent BEGIN:END, ...' in seconds"}};
}

Result<> check_imu(ImuConfig config) {
  if (Result<> fields = check_fields(fields_of(config)); !fields) return fail("imu", fields.error());
  const auto faults = parse_faults(config.faults, "imu", kImuFaults, Stamp{});
  if (!faults) return fail("imu", faults.error());
  return {};
}

std::vector<std::string> imu_presets() {
  std::vector<std::string> names;
  for (const ImuConfig& preset : all_presets()) names.push_back(preset.name);
  return names;
}

Result<ImuConfig> imu_preset(const std::string& name) {
  for (ImuConfig& preset : all_presets())
    if (preset.name == name) return preset;
  return fail(format("unknown IMU '{}'; known are {}", name, fmt::join(imu_presets(), ", ")));
}

ImuConfig field_imu(ImuConfig config) {
  config.vibration = 0.5;
  config.vibration_deg = 1.0;
  return config;
}

Pose T_lidar_imu(const ImuConfig& c) {
  const auto about = [](double degrees, const Vector3& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis));
  };
  return {about(c.mount_yaw_deg, Vector3::UnitZ()) * about(c.mount_pitch_deg, Vector3::UnitY()) *
              about(c.mount_roll_deg, Vector3::UnitX()),
          Vector3(c.mount_x, c.mount_y, c.mount_z)};
}

ImuCovariance covariance_of(const ImuConfig& config) {
  const double rate = gyro_errors(config).noise;
  const double force = accel_errors(config).noise;
  return {Matrix3::Identity() * rate * rate, Matrix3::Identity() * force * force};
}

std::vector<SensorFault> imu_faults(const ImuConfig& config, Stamp start) {
  Result<std::vector<SensorFault>> faults = parse_faults(config.faults, "imu", kImuFaults, start);
  ADIT_CHECK(faults.has_value(), "the IMU's configuration passes check_imu");
  return std::move(*faults);
}

std::vector<ImuSample> imu_samples(const Trajectory& truth, const Pose& T_base_imu, const ImuConfig& config,
                                   std::uint64_t seed) {
  const SmoothMotion motion(truth, T_base_imu);
  const Stamp start = truth.front().stamp;
  const std::vector<SensorFault> faults = imu_faults(config, start);
  Rng rng(seed);
  Triad gyro(gyro_errors(config), rng);
  Triad accelerometer(accel_errors(config), rng);
  std::vector<ImuSample> samples;
  Stamp stamp = start;
  for (std::int64_t i = 1;; ++i) {
    const Kinematics now = motion.at(stamp);
    const Vector3 against_gravity = now.acceleration + kStandardGravity * Vector3::UnitZ();
    const Vector3 force = now.T_world_body.rotation().conjugate() * against_gravity;
    const double speed = now.velocity.norm();
    const Vector3 rate = gyro.measure(now.angular_velocity, speed, rng);
    const ImuSample sample{stamp, rate, accelerometer.measure(force, speed, rng)};
    if (!is_faulty(faults, kSilent, stamp)) samples.push_back(sample);
    if (stamp >= truth.back().stamp) return samples;
    stamp = start + from_seconds(static_cast<double>(i) / config.rate_hz);
  }
}

}  // namespace adit
