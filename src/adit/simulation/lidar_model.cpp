// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kColumnsAPart = 64;

LidarConfig ouster(const std::string& name, int beams, double half_field_deg) {
  LidarConfig c;
  c.name = name;
  c.beams = beams;
  c.elevation_min_deg = -half_field_deg;
  c.elevation_max_deg = half_field_deg;
  return c;
}

LidarConfig with_columns(LidarConfig c, int columns) {
  c.columns = columns;
  return c;
}

LidarConfig with_range(LidarConfig c, double min, double max) {
  c.range_min = min;
  c.range_max = max;
  return c;
}

LidarConfig with_noise(LidarConfig c, double near, double far) {
  c.noise_near = near;
  c.noise_far = far;
  return c;
}

LidarConfig vlp16() {
  LidarConfig c = ouster("vlp-16", 16, 15.0);
  return with_noise(with_range(with_columns(c, 1800), 0.5, 100.0), 0.03, 0.03);
}

// Fields of view, ranges and range noise after the makers' data sheets.
std::vector<LidarConfig> presets() {
  return {ouster("os2-128", 128, 11.25),
          with_columns(ouster("os2-128-512", 128, 11.25), 512),
          with_columns(ouster("os2-128-2048", 128, 11.25), 2048),
          with_columns(ouster("os2-32", 32, 11.25), 512),
          with_noise(with_range(ouster("os1-64", 64, 22.5), 0.5, 120.0), 0.007, 0.05),
          with_noise(with_range(ouster("os1-128", 128, 22.5), 0.5, 120.0), 0.007, 0.05),
          with_noise(with_range(ouster("os0-128", 128, 45.0), 0.3, 50.0), 0.008, 0.04),
          vlp16()};
}

// Near normal with mean 0 and standard deviation 1: the sum of four 16-bit uniform numbers (Irwin and Hall).
// No logarithm, so every machine draws the same; and bounded by 3.5, as no sensor errs by metres.
float near_normal(std::uint64_t bits) {
  const std::uint64_t sum =
      (bits & 0xffffU) + ((bits >> 16U) & 0xffffU) + ((bits >> 32U) & 0xffffU) + (bits >> 48U);
  constexpr double kMean = 2.0 * 0xffff;
  return static_cast<float>((static_cast<double>(sum) - kMean) * (std::numbers::sqrt3 / 0x10000));
}

float uniform(std::uint64_t bits) { return static_cast<float>(bits >> 40U) * 0x1p-24F; }

// All that is the same for every scan of one sensor, in the units of the inner loop.
class Sensor {
 public:
  explicit Sensor(const LidarConfig& c)
      : range_min_(static_cast<float>(c.range_min)),
        range_max_(static_cast<float>(c.range_max)),
        noise_near_(static_cast<float>(c.noise_near)),
        noise_slope_(static_cast<float>((c.noise_far - c.noise_near) / (c.range_max - c.range_min))),
        cos_dropout_start_(static_cast<float>(std::cos(c.dropout_start_deg * kDegree))),
        dropout_start_(static_cast<float>(c.dropout_start_deg * kDegree)),
        dropout_end_(static_cast<float>(c.dropout_end_deg * kDegree)) {
    const double step = c.beams > 1 ? (c.elevation_max_deg - c.elevation_min_deg) / (c.beams - 1) : 0.0;
    for (int beam = 0; beam < c.beams; ++beam) {
      const double elevation = (c.elevation_max_deg - step * beam) * kDegree;
      beams_.emplace_back(static_cast<float>(std::cos(elevation)), static_cast<float>(std::sin(elevation)));
    }
  }

  [[nodiscard]] float range_max() const { return range_max_; }

  /// The directions of all beams, in the lidar frame, at an azimuth.
  [[nodiscard]] std::vector<Eigen::Vector3f> directions(double azimuth) const {
    const Eigen::Vector2d heading(std::cos(azimuth), std::sin(azimuth));
    std::vector<Eigen::Vector3f> out;
    out.reserve(beams_.size());
    for (const Eigen::Vector2f& beam : beams_) {
      const Eigen::Vector2f flat = beam.x() * heading.cast<float>();
      out.emplace_back(flat.x(), flat.y(), beam.y());
    }
    return out;
  }

  /// The range that is reported, or a miss.
  [[nodiscard]] float measure(const RayHit& hit, const Eigen::Vector3f& direction,
                              std::uint64_t ray_seed) const {
    if (!hit.hit() || is_lost(std::abs(hit.normal.dot(direction)), ray_seed)) return RayHit::kMiss;
    const float sigma = noise_near_ + noise_slope_ * (hit.distance - range_min_);
    const float range = hit.distance + sigma * near_normal(mix64(ray_seed));
    return range >= range_min_ && range <= range_max_ ? range : RayHit::kMiss;
  }

 private:
  [[nodiscard]] bool is_lost(float cos_incidence, std::uint64_t ray_seed) const {
    if (cos_incidence >= cos_dropout_start_) return false;
    const float incidence = std::acos(cos_incidence);
    if (incidence >= dropout_end_) return true;
    const float share_lost = (incidence - dropout_start_) / (dropout_end_ - dropout_start_);
    return uniform(mix64(~ray_seed)) < share_lost;
  }

  std::vector<Eigen::Vector2f> beams_;  // cosine and sine of each elevation
  float range_min_;
  float range_max_;
  float noise_near_;
  float noise_slope_;
  float cos_dropout_start_;
  float dropout_start_;
  float dropout_end_;
};

// One turn: where the sensor is and looks at each column.
struct Turn {
  const LidarConfig& config;
  const Sweep& sweep;
  Vector6 twist = (sweep.T_world_lidar_start.inverse() * sweep.T_world_lidar_end).log();

  [[nodiscard]] Pose T_world_lidar(int column) const {
    return sweep.T_world_lidar_start * Pose::exp(twist * (double(column + 1) / config.columns));
  }
  [[nodiscard]] double azimuth(int column) const {
    return std::numbers::pi - 2.0 * std::numbers::pi * column / config.columns;
  }
  [[nodiscard]] std::int32_t offset_ns(int column) const {
    return static_cast<std::int32_t>(-sweep_time(config).count() * (config.columns - 1 - column) /
                                     config.columns);
  }
};

void cast_column(const Raycaster& raycaster, const Sensor& sensor, const Turn& turn, int column,
                 PointCloud& cloud) {
  const std::vector<Eigen::Vector3f> directions = sensor.directions(turn.azimuth(column));
  const Pose T_world_lidar = turn.T_world_lidar(column);
  const Eigen::Matrix3f R = T_world_lidar.rotation_matrix().cast<float>();
  const Eigen::Vector3f origin = T_world_lidar.translation().cast<float>();
  std::vector<Ray> rays;
  rays.reserve(directions.size());
  for (const Eigen::Vector3f& direction : directions) rays.push_back({origin, R * direction});
  const std::vector<RayHit> hits = raycaster.cast(rays, sensor.range_max());
  const std::uint64_t column_seed = mix64(turn.sweep.noise_seed, static_cast<std::uint64_t>(column));
  for (std::size_t beam = 0; beam < hits.size(); ++beam) {
    const float range = sensor.measure(hits[beam], rays[beam].direction, mix64(column_seed ^ beam));
    if (range == RayHit::kMiss) continue;
    cloud.points.emplace_back(range * directions[beam]);
    cloud.time_offsets_ns.push_back(turn.offset_ns(column));
  }
}

PointCloud joined(const std::vector<PointCloud>& parts) {
  std::size_t size = 0;
  for (const PointCloud& part : parts) size += part.size();
  PointCloud cloud;
  cloud.points.reserve(size);
  cloud.time_offsets_ns.reserve(size);
  for (const PointCloud& part : parts) {
    cloud.points.insert(cloud.points.end(), part.points.begin(), part.points.end());
    cloud.time_offsets_ns.insert(cloud.time_offsets_ns.end(), part.time_offsets_ns.begin(),
                                 part.time_offsets_ns.end());
  }
  return cloud;
}

Result<> check_ascending(const std::string& what, double low, double high) {
  if (low < high) return {};
  return fail(format("lidar {}: the lower limit {} must be below the upper limit {}", what, low, high));
}

}  // namespace

Result<> check_lidar(LidarConfig config) {
  if (Result<> fields = check_fields(fields_of(config)); !fields) return fail("lidar", fields.error());
  if (config.beams > 1) {
    Result<> field = check_ascending("elevation", config.elevation_min_deg, config.elevation_max_deg);
    if (!field) return field;
  }
  if (Result<> range = check_ascending("range", config.range_min, config.range_max); !range) return range;
  return check_ascending("drop-out", config.dropout_start_deg, config.dropout_end_deg);
}

std::vector<std::string> lidar_presets() {
  std::vector<std::string> names;
  for (const LidarConfig& preset : presets()) names.push_back(preset.name);
  return names;
}

Result<LidarConfig> lidar_preset(const std::string& name) {
  for (LidarConfig& preset : presets()) {
    if (preset.name == name) return preset;
  }
  std::string known;
  for (const std::string& preset : lidar_presets()) known += (known.empty() ? "" : ", ") + preset;
  return fail("no lidar is called '" + name + "'; there are " + known);
}

Scan cast_scan(const Raycaster& raycaster, const LidarConfig& config, const Sweep& sweep) {
  ADIT_CHECK(check_lidar(config).has_value(), "the lidar's configuration passes check_lidar");
  const Sensor sensor(config);
  const Turn turn{config, sweep};
  const auto columns = static_cast<std::size_t>(config.columns);
  std::vector<PointCloud> parts((columns + kColumnsAPart - 1) / kColumnsAPart);
  parallel_for(columns, kColumnsAPart, [&](std::size_t begin, std::size_t end) {
    for (std::size_t column = begin; column < end; ++column) {
      cast_column(raycaster, sensor, turn, static_cast<int>(column), parts[begin / kColumnsAPart]);
    }
  });
  return {sweep.end, joined(parts)};
}

}  // namespace adit
