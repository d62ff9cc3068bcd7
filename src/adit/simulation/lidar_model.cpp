// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/beam.hpp"
#include "adit/simulation/range_errors.hpp"
#include "adit/simulation/scan_pattern.hpp"

namespace adit {
namespace {

constexpr std::size_t kColumnsPerPart = 64;  ///< Of a parallel loop.

// Directions of the beams at azimuth 0.
struct Fan {
  std::vector<float> forward;
  std::vector<float> left;
  std::vector<float> up;

  void add(double azimuth, double elevation) {
    forward.push_back(static_cast<float>(std::cos(elevation) * std::cos(azimuth)));
    left.push_back(static_cast<float>(std::cos(elevation) * std::sin(azimuth)));
    up.push_back(static_cast<float>(std::sin(elevation)));
  }
  /// In the lidar frame, when the sensor has turned to an azimuth.
  void turned(double azimuth, std::size_t first_beam, std::size_t num, RayBlock::Vectors& directions) const {
    const auto x = static_cast<float>(std::cos(azimuth));
    const auto y = static_cast<float>(std::sin(azimuth));
    for (std::size_t i = 0; i < num; ++i) {
      directions.x[i] = forward[first_beam + i] * x - left[first_beam + i] * y;
      directions.y[i] = forward[first_beam + i] * y + left[first_beam + i] * x;
      directions.z[i] = up[first_beam + i];
    }
  }
};

// All that is the same for every ray of one scan, in the units of the inner loop.
class Sensor {
 public:
  Sensor(const LidarConfig& c, const LidarUnit& unit, const Sweep& sweep)
      : config_(c),
        looks_elsewhere_(!unit.ring_azimuth.empty() || !unit.ring_elevation.empty()),
        returns_(c, unit, sweep.dust) {
    beam_.divergence = unit.divergence_factor * c.divergence_deg * kDegree;
    const auto of_ring = [](const std::vector<double>& errors, std::size_t ring) {
      return errors.empty() ? 0.0 : errors[ring];
    };
    const double step = c.beams > 1 ? (c.elevation_max_deg - c.elevation_min_deg) / (c.beams - 1) : 0.0;
    const double bias = unit.bias_at(sweep.end - Stamp{});
    for (std::size_t beam = 0; beam < static_cast<std::size_t>(c.beams); ++beam) {
      const double elevation = (c.elevation_max_deg - step * static_cast<double>(beam)) * kDegree;
      reported_.add(0.0, elevation);
      true_.add(of_ring(unit.ring_azimuth, beam), elevation + of_ring(unit.ring_elevation, beam));
      biases_.push_back(static_cast<float>(bias + of_ring(unit.ring_range, beam)));
    }
  }

  [[nodiscard]] std::size_t num_beams() const { return biases_.size(); }
  [[nodiscard]] const ReturnModel& returns() const { return returns_; }
  [[nodiscard]] const Beam& beam() const { return beam_; }
  [[nodiscard]] float reach() const { return static_cast<float>(config_.reach); }
  /// Of ranges, in the order of the beams.
  void biases(std::size_t first_beam, std::size_t num, RayBlock::Numbers& out) const {
    std::copy_n(biases_.begin() + static_cast<std::ptrdiff_t>(first_beam), num, out.begin());
  }

  /// The directions of shots from `first` on, `step` apart, of a pattern that does not repeat.
  void look(Stamp first, Duration step, std::size_t num, RayBlock::Vectors& directions) const {
    for (std::size_t i = 0; i < num; ++i) {
      const Vector3 direction = pattern_direction(config_, first + static_cast<std::int64_t>(i) * step);
      directions.x[i] = static_cast<float>(direction.x());
      directions.y[i] = static_cast<float>(direction.y());
      directions.z[i] = static_cast<float>(direction.z());
    }
  }

  /// The directions that beams report at an azimuth, and those in which they look.
  void look(double azimuth, std::size_t first_beam, std::size_t num, RayBlock::Vectors& reported,
            RayBlock::Vectors& really) const {
    reported_.turned(azimuth, first_beam, num, reported);
    if (looks_elsewhere_) {
      true_.turned(azimuth, first_beam, num, really);
    } else {
      really = reported;
    }
  }

 private:
  LidarConfig config_;
  Fan reported_;
  Fan true_;
  bool looks_elsewhere_;
  std::vector<float> biases_;
  ReturnModel returns_;
  Beam beam_;
};

// One turn: where the sensor is and looks at each column.
struct Turn {
  const LidarConfig& config;
  const Sweep& sweep;
  Vector6 twist = (sweep.T_world_lidar_start.inverse() * sweep.T_world_lidar_end).log();

  [[nodiscard]] Pose T_world_lidar(int column) const {
    const double share = double(column + 1) / config.columns;
    const std::vector<Pose>& between = sweep.T_world_lidar_between;
    if (between.empty()) return sweep.T_world_lidar_start * Pose::exp(twist * share);
    const double place = share * static_cast<double>(between.size() + 1);
    const auto piece = std::min(static_cast<std::size_t>(place), between.size());
    const Pose& from = piece == 0 ? sweep.T_world_lidar_start : between[piece - 1];
    const Pose& to = piece == between.size() ? sweep.T_world_lidar_end : between[piece];
    return interpolate(from, to, place - static_cast<double>(piece));
  }
  /// What moves, where it is when that column is fired.
  [[nodiscard]] const std::optional<Raycaster>& movers(int column) const {
    static const std::optional<Raycaster> kNothing;
    const auto num = static_cast<int>(sweep.movers.size());
    return num == 0 ? kNothing : sweep.movers[static_cast<std::size_t>(column * num / config.columns)];
  }
  [[nodiscard]] double azimuth(int column) const {
    return std::numbers::pi - 2.0 * std::numbers::pi * column / config.columns;
  }
  [[nodiscard]] bool is_dark(int column) const {
    const bool sees_all = config.azimuth_min_deg <= -180.0 && config.azimuth_max_deg >= 180.0;
    if (config.pattern != LidarPattern::spinning || sees_all) return false;
    return azimuth(column) < config.azimuth_min_deg * kDegree ||
           azimuth(column) > config.azimuth_max_deg * kDegree;
  }
  /// From shot to shot of a pattern that does not repeat.
  [[nodiscard]] Duration shot_time() const {
    return sweep_time(config) / (static_cast<std::int64_t>(config.columns) * config.beams);
  }
  /// Of the first shot of a column, where shots follow one another.
  [[nodiscard]] Stamp first_shot(int column) const {
    return sweep.end - sweep_time(config) + sweep_time(config) * column / config.columns;
  }
  [[nodiscard]] std::int32_t offset_ns(int column) const {
    return static_cast<std::int32_t>(-sweep_time(config).count() * (config.columns - 1 - column) /
                                     config.columns);
  }
};

// Rays of `directions` in the lidar frame, seen from the world.
void aim(const Pose& T_world_lidar, const RayBlock::Vectors& directions, RayBlock& rays) {
  const Eigen::Matrix3f R = T_world_lidar.rotation_matrix().cast<float>();
  const Eigen::Vector3f origin = T_world_lidar.translation().cast<float>();
  const auto& [x, y, z] = directions;
  for (std::size_t i = 0; i < rays.size; ++i) {
    rays.origins.x[i] = origin.x();
    rays.origins.y[i] = origin.y();
    rays.origins.z[i] = origin.z();
    rays.directions.x[i] = R(0, 0) * x[i] + (R(0, 1) * y[i] + R(0, 2) * z[i]);
    rays.directions.y[i] = R(1, 0) * x[i] + (R(1, 1) * y[i] + R(1, 2) * z[i]);
    rays.directions.z[i] = R(2, 0) * x[i] + (R(2, 1) * y[i] + R(2, 2) * z[i]);
  }
}

// What a sensor reports of a block of rays.
struct Report {
  RayBlock::Vectors directions;
  RayBlock::Numbers ranges;
  RayBlock::Numbers intensities;
  bool has_intensities = false;
};

void append_returns(const Report& report, std::size_t num, std::int32_t offset_ns, PointCloud& cloud) {
  const auto& [directions, ranges, intensities, has_intensities] = report;
  const std::size_t before = cloud.size();
  std::size_t size = before;
  cloud.points.resize(size + num);
  for (std::size_t i = 0; i < num; ++i) {  // a miss is written too, and then overwritten
    cloud.points[size] = ranges[i] * Eigen::Vector3f(directions.x[i], directions.y[i], directions.z[i]);
    size += ranges[i] < RayHit::kMiss ? 1 : 0;
  }
  cloud.points.resize(size);
  cloud.time_offsets_ns.resize(size, offset_ns);
  for (std::size_t i = 0; has_intensities && i < num; ++i)
    if (ranges[i] < RayHit::kMiss) cloud.intensities.push_back(intensities[i]);
}

// What happens to light between the sensor and the surfaces, and how exact it leaves ranges. `seed` is the
// block's.
void measure_light(const Sensor& sensor, const Sweep& sweep, const RayDraws& chance, std::uint64_t seed,
                   RayBlock& rays, RangeErrors& errors, Report& report) {
  constexpr std::uint64_t kWeakStream = 1;
  constexpr std::uint64_t kAirStream = 2;
  RayBlock::Numbers reflectivities;
  RayBlock::Numbers signals;
  sweep.surfaces.reflectivities(rays, reflectivities);
  add_signals(rays, reflectivities, sensor.reach(), signals);
  if (!sweep.air.is_clear()) look_through(sweep.air, sensor.reach(), mix64(seed, kAirStream), rays, signals);
  drop_weak(signals, mix64(seed, kWeakStream), rays);
  report.has_intensities = !sweep.surfaces.are_alike();
  if (!report.has_intensities) return;
  add_noise_by_signal(sensor.returns(), signals, rays.size, errors);
  add_intensities(sensor.returns(), rays, signals, sensor.reach(), chance, report.intensities);
}

/// The rays of one column as they were cast, a block after the other, and in which directions they are
/// reported.
struct Column {
  std::vector<RayBlock> rays;
  std::vector<RayBlock::Vectors> reported;
  bool meets_movers = false;
};

/// Casts the columns of one sweep.
class ColumnCaster {
 public:
  ColumnCaster(const Raycaster& raycaster, const Sensor& sensor, const Turn& turn)
      : raycaster_(raycaster),
        sensor_(sensor),
        turn_(turn),
        has_neighbours_(turn.config.pattern == LidarPattern::spinning && sensor.beam().divergence > 0.0) {}

  /// Appends the returns of the columns from `begin` to before `end`.
  void cast(int begin, int end, PointCloud& cloud) const {
    // A beam with a width looks at what the columns beside its own have met.
    const int beside = has_neighbours_ ? 1 : 0;
    std::vector<Column> columns;
    for (int c = begin - beside; c < end + beside; ++c) columns.push_back(rays_of(c));
    for (int c = begin; c < end; ++c) {
      const auto k = static_cast<std::size_t>(c - begin) + static_cast<std::size_t>(beside);
      const Column none;
      append(c, columns[k], has_neighbours_ ? columns[k - 1] : none, has_neighbours_ ? columns[k + 1] : none,
             cloud);
    }
  }

 private:
  /// None where the sensor does not fire.
  [[nodiscard]] Column rays_of(int column) const {
    Column out;
    if (column < 0 || column >= turn_.config.columns || turn_.is_dark(column)) return out;
    const Pose T_world_lidar = turn_.T_world_lidar(column);
    for (std::size_t beam = 0; beam < sensor_.num_beams(); beam += RayBlock::kCapacity) {
      RayBlock& rays = out.rays.emplace_back();
      RayBlock::Vectors& reported = out.reported.emplace_back();
      rays.size = std::min(RayBlock::kCapacity, sensor_.num_beams() - beam);
      RayBlock::Vectors directions;
      if (turn_.config.pattern == LidarPattern::spinning) {
        sensor_.look(turn_.azimuth(column), beam, rays.size, reported, directions);
      } else {
        const Duration before = static_cast<std::int64_t>(beam) * turn_.shot_time();
        sensor_.look(turn_.first_shot(column) + before, turn_.shot_time(), rays.size, directions);
        reported = directions;
      }
      aim(T_world_lidar, directions, rays);
      const bool meets = cast_rays(raycaster_, turn_.movers(column), sensor_.returns().range_max, rays);
      out.meets_movers = out.meets_movers || meets;
    }
    return out;
  }

  void append(int number, const Column& column, const Column& before, const Column& after,
              PointCloud& cloud) const {
    const Sweep& sweep = turn_.sweep;
    const float range_max = sensor_.returns().range_max;
    const std::uint64_t column_seed = mix64(sweep.noise_seed, static_cast<std::uint64_t>(number));
    const bool is_plain = sweep.surfaces.are_alike() && sweep.air.is_clear();
    // Where no ray meets a mover, none is looked for in footprints: most columns see none.
    const bool may_meet = column.meets_movers || before.meets_movers || after.meets_movers;
    const std::optional<Raycaster> movers = may_meet ? turn_.movers(number) : std::nullopt;
    for (std::size_t b = 0; b < column.rays.size(); ++b) {
      const std::size_t beam = b * RayBlock::kCapacity;
      const auto ranges_of = [&](const Column& c) { return c.rays.empty() ? nullptr : &c.rays[b].distances; };
      RayBlock rays = column.rays[b];
      const std::uint64_t block_seed = mix64(~column_seed, beam);
      widen_rays(raycaster_, movers, sensor_.beam(), {ranges_of(before), ranges_of(after)}, range_max,
                 block_seed, rays);
      sweep.surfaces.mirror(raycaster_, range_max, ~block_seed, rays);
      const RayDraws chance(column_seed, beam, rays.size);
      RangeErrors errors;
      Report report;
      report.directions = column.reported[b];
      sensor_.biases(beam, rays.size, errors.biases);
      add_noise_by_range(sensor_.returns(), rays, errors.sigmas);
      if (!is_plain) measure_light(sensor_, sweep, chance, block_seed, rays, errors, report);
      report_ranges(sensor_.returns(), chance, rays, errors, report.ranges);
      append_returns(report, rays.size, turn_.offset_ns(number), cloud);
    }
  }

  const Raycaster& raycaster_;
  const Sensor& sensor_;
  const Turn& turn_;
  bool has_neighbours_;
};

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
    cloud.intensities.insert(cloud.intensities.end(), part.intensities.begin(), part.intensities.end());
  }
  return cloud;
}

Result<> check_ascending(const std::string& what, double low, double high) {
  if (low < high) return {};
  return fail(format("lidar {}: the lower limit {} must be below the upper limit {}", what, low, high));
}

}  // namespace

std::string_view to_string(LidarPattern pattern) {
  switch (pattern) {
    case LidarPattern::spinning:
      return "spinning";
    case LidarPattern::rosette:
      return "rosette";
    case LidarPattern::wave:
      return "wave";
  }
  return "unknown";
}

Result<> check_lidar(LidarConfig config) {
  if (Result<> fields = check_fields(fields_of(config)); !fields) return fail("lidar", fields.error());
  if (config.beams > 1) {
    Result<> field = check_ascending("elevation", config.elevation_min_deg, config.elevation_max_deg);
    if (!field) return field;
  }
  Result<> azimuth = check_ascending("azimuth", config.azimuth_min_deg, config.azimuth_max_deg);
  if (!azimuth) return azimuth;
  if (Result<> range = check_ascending("range", config.range_min, config.range_max); !range) return range;
  return check_ascending("drop-out", config.dropout_start_deg, config.dropout_end_deg);
}

std::size_t num_rings(const LidarConfig& config) {
  return config.pattern == LidarPattern::spinning ? static_cast<std::size_t>(config.beams) : 0;
}

Scan cast_scan(const Raycaster& raycaster, const LidarConfig& config, const Sweep& sweep,
               const LidarUnit& unit) {
  ADIT_CHECK(check_lidar(config).has_value(), "the lidar's configuration passes check_lidar");
  const Sensor sensor(config, unit, sweep);
  const Turn turn{config, sweep};
  const ColumnCaster caster(raycaster, sensor, turn);
  const auto columns = static_cast<std::size_t>(config.columns);
  std::vector<PointCloud> parts((columns + kColumnsPerPart - 1) / kColumnsPerPart);
  parallel_for(columns, kColumnsPerPart, [&](std::size_t begin, std::size_t end) {
    PointCloud& part = parts[begin / kColumnsPerPart];
    part.points.reserve((end - begin) * sensor.num_beams());
    part.time_offsets_ns.reserve((end - begin) * sensor.num_beams());
    caster.cast(static_cast<int>(begin), static_cast<int>(end), part);
  });
  return {sweep.end, joined(parts)};
}

}  // namespace adit
