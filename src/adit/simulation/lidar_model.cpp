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
#include "adit/core/simd.hpp"
#include "adit/simulation/beam.hpp"
#include "adit/simulation/scan_pattern.hpp"

namespace adit {
namespace {

constexpr std::size_t kColumnsPerPart = 64;       ///< Of a parallel loop.
constexpr float kDustReach = 5.0F;                ///< Metres: beyond, dust returns too little.
constexpr double kWalkStatedAt = 80.0 * kDegree;  ///< Incidence, of LidarErrorConfig::incidence_walk.

// For 0 <= x <= 1, to 1e-6 (Abramowitz and Stegun, 4.4.46). The C library's is not vectorized.
float arc_cosine(float x) {
  constexpr std::array<float, 8> kCoefficients = {1.5707963050F,  -0.2145988016F, 0.0889789874F,
                                                  -0.0501743046F, 0.0308918810F,  -0.0170881256F,
                                                  0.0066700901F,  -0.0012624911F};
  float sum = kCoefficients[7];
  for (std::size_t k = 7; k-- > 0;) sum = sum * x + kCoefficients[k];
  return std::sqrt(1.0F - x) * sum;
}

// Range noise and drop-out of each ray of a block. They depend on the seed of the column and the number of
// the beam alone.
struct Chance {
  // Near normal with mean 0 and standard deviation 1: the sum of four 16-bit uniform numbers (Irwin and
  // Hall). No logarithm, so every machine draws the same; and bounded by 3.5, as no sensor errs by metres.
  RayBlock::Numbers noise;
  RayBlock::Numbers dropout;  // uniform in [0, 1), as the others below
  RayBlock::Numbers falseness;
  RayBlock::Numbers share;  // of the range, where it is false

  Chance(std::uint64_t column_seed, std::size_t first_beam, std::size_t num) {
    std::array<std::int32_t, RayBlock::kCapacity> sums;
    std::array<std::int32_t, RayBlock::kCapacity> draws;
    std::array<std::int32_t, RayBlock::kCapacity> more_draws;
    for (std::size_t i = 0; i < num; ++i) {
      const std::uint64_t ray_seed = mix64(column_seed ^ (first_beam + i));
      const std::uint64_t bits = mix64(ray_seed);
      const std::uint64_t pairs = (bits & 0xffff0000ffffU) + ((bits >> 16U) & 0xffff0000ffffU);
      sums[i] = static_cast<std::int32_t>((pairs >> 32U) + (pairs & 0xffffffffU));
      const std::uint64_t others = mix64(~ray_seed);
      draws[i] = static_cast<std::int32_t>(others >> 40U);
      more_draws[i] = static_cast<std::int32_t>(others & 0x7fffffffU);
    }
    constexpr double kMean = 2.0 * 0xffff;
    for (std::size_t i = 0; i < num; ++i) {
      noise[i] = static_cast<float>((sums[i] - kMean) * (std::numbers::sqrt3 / 0x10000));
      dropout[i] = static_cast<float>(draws[i]) * 0x1p-24F;
      falseness[i] = static_cast<float>(more_draws[i] & 0xfffff) * 0x1p-20F;
      share[i] = static_cast<float>(more_draws[i] >> 20) * 0x1p-11F;
    }
  }
};

// How true ranges are reported, and which are lost.
struct Returns {
  float range_min;
  float range_max;
  float noise_near;
  float noise_slope;
  float cos_dropout_start;
  float dropout_start;
  float dropout_width;
  float walk;  ///< Per squared (1 - cosine).
  float intensity_walk;
  float false_returns;
  float false_or_dust;

  Returns(const LidarConfig& c, const LidarUnit& unit, double dust)
      : range_min(static_cast<float>(c.range_min)),
        range_max(static_cast<float>(c.range_max)),
        noise_near(static_cast<float>(c.noise_near)),
        noise_slope(static_cast<float>((c.noise_far - c.noise_near) / (c.range_max - c.range_min))),
        cos_dropout_start(static_cast<float>(std::cos(c.dropout_start_deg * kDegree))),
        dropout_start(static_cast<float>(c.dropout_start_deg * kDegree)),
        dropout_width(static_cast<float>(c.dropout_end_deg * kDegree) - dropout_start),
        walk(static_cast<float>(unit.incidence_walk / std::pow(1.0 - std::cos(kWalkStatedAt), 2))),
        intensity_walk(static_cast<float>(unit.intensity_walk)),
        false_returns(static_cast<float>(unit.false_returns)),
        false_or_dust(static_cast<float>(unit.false_returns + dust)) {}
};

// Of each ray of a block.
struct Errors {
  RayBlock::Numbers sigmas;
  RayBlock::Numbers biases;
};

ADIT_WIDE_VECTORS void add_noise_by_range(const Returns& returns, const RayBlock& rays,
                                          RayBlock::Numbers& sigmas) {
  for (std::size_t i = 0; i < rays.size; ++i)
    sigmas[i] = returns.noise_near + returns.noise_slope * (rays.distances[i] - returns.range_min);
}

// As photons are counted: with the root of their number, from the nominal surface the same as by range.
ADIT_WIDE_VECTORS void add_noise_by_signal(const Returns& returns, const RayBlock::Numbers& signals,
                                           std::size_t num, Errors& errors) {
  constexpr float kMost = 1.5F;  // of the noise of a return that is just seen
  const float grows = returns.noise_slope * (returns.range_max - returns.range_min);
  for (std::size_t i = 0; i < num; ++i) {
    errors.sigmas[i] = returns.noise_near + grows * std::min(kMost, 1.0F / std::sqrt(signals[i]));
    errors.biases[i] += returns.intensity_walk * share_of_walk(signals[i]);
  }
}

// The ranges that are reported, or misses. Beyond the end of the drop-out, all of 0 to 1 is below the share
// that is lost.
ADIT_WIDE_VECTORS void measure(const Returns& returns, const Chance& chance, const RayBlock& rays,
                               const Errors& errors, RayBlock::Numbers& ranges) {
  const auto& distances = rays.distances;
  const float range_min = returns.range_min;
  const float range_max = returns.range_max;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float cosine = std::min(rays.cosines[i], 1.0F);
    const float off_normal = 1.0F - cosine;
    const float true_return = distances[i] + errors.sigmas[i] * chance.noise[i] +
                              (errors.biases[i] + returns.walk * off_normal * off_normal);
    const float in_dust = range_min + kDustReach * chance.share[i] * chance.share[i];
    const bool is_false = chance.falseness[i] < returns.false_returns;
    const bool is_dust = !is_false & (chance.falseness[i] < returns.false_or_dust);
    const float not_false = is_dust ? std::min(in_dust, true_return) : true_return;
    const float range = is_false ? chance.share[i] * true_return : not_false;
    const float share_lost = (arc_cosine(cosine) - returns.dropout_start) / returns.dropout_width;
    const bool lost = (cosine < returns.cos_dropout_start) & (chance.dropout[i] < share_lost);
    const bool kept = !lost & (distances[i] < RayHit::kMiss) & (range >= range_min) & (range <= range_max);
    ranges[i] = kept ? range : RayHit::kMiss;
  }
}

// Reflectivity times the cosine of the incidence, in percent, as far as the signal tells.
ADIT_WIDE_VECTORS void add_intensities(const RayBlock& rays, const RayBlock::Numbers& signals, float reach,
                                       const Chance& chance, RayBlock::Numbers& intensities) {
  constexpr float kSpread = 0.1F;  // of readings, evenly
  constexpr float kPercent = 100.0F * kNominalReflectivity;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const float share = rays.distances[i] / reach;
    const float reading = kPercent * signals[i] * share * share;
    intensities[i] = std::min(255.0F, reading * (1.0F + kSpread * (chance.share[i] - 0.5F)));
  }
}

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
  [[nodiscard]] const Returns& returns() const { return returns_; }
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
  Returns returns_;
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
void measure_light(const Sensor& sensor, const Sweep& sweep, const Chance& chance, std::uint64_t seed,
                   RayBlock& rays, Errors& errors, Report& report) {
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
  add_intensities(rays, signals, sensor.reach(), chance, report.intensities);
}

void cast_column(const Raycaster& raycaster, const Sensor& sensor, const Turn& turn, int column,
                 PointCloud& cloud) {
  if (turn.is_dark(column)) return;
  const Pose T_world_lidar = turn.T_world_lidar(column);
  const std::uint64_t column_seed = mix64(turn.sweep.noise_seed, static_cast<std::uint64_t>(column));
  const Sweep& sweep = turn.sweep;
  const bool is_plain = sweep.surfaces.are_alike() && sweep.air.is_clear();
  RayBlock rays;
  RayBlock::Vectors directions;
  Errors errors;
  Report report;
  for (std::size_t beam = 0; beam < sensor.num_beams(); beam += rays.size) {
    rays.size = std::min(RayBlock::kCapacity, sensor.num_beams() - beam);
    if (turn.config.pattern == LidarPattern::spinning) {
      sensor.look(turn.azimuth(column), beam, rays.size, report.directions, directions);
    } else {
      const Duration before = static_cast<std::int64_t>(beam) * turn.shot_time();
      sensor.look(turn.first_shot(column) + before, turn.shot_time(), rays.size, directions);
      report.directions = directions;
    }
    aim(T_world_lidar, directions, rays);
    const std::uint64_t block_seed = mix64(~column_seed, beam);
    cast_beams(raycaster, sweep.movers, sensor.beam(), sensor.returns().range_max, block_seed, rays);
    sweep.surfaces.mirror(raycaster, sensor.returns().range_max, ~block_seed, rays);
    const Chance chance(column_seed, beam, rays.size);
    sensor.biases(beam, rays.size, errors.biases);
    add_noise_by_range(sensor.returns(), rays, errors.sigmas);
    if (!is_plain) measure_light(sensor, sweep, chance, block_seed, rays, errors, report);
    measure(sensor.returns(), chance, rays, errors, report.ranges);
    append_returns(report, rays.size, turn.offset_ns(column), cloud);
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
  const auto columns = static_cast<std::size_t>(config.columns);
  std::vector<PointCloud> parts((columns + kColumnsPerPart - 1) / kColumnsPerPart);
  parallel_for(columns, kColumnsPerPart, [&](std::size_t begin, std::size_t end) {
    PointCloud& part = parts[begin / kColumnsPerPart];
    part.points.reserve((end - begin) * sensor.num_beams());
    part.time_offsets_ns.reserve((end - begin) * sensor.num_beams());
    for (std::size_t column = begin; column < end; ++column) {
      cast_column(raycaster, sensor, turn, static_cast<int>(column), part);
    }
  });
  return {sweep.end, joined(parts)};
}

}  // namespace adit
