// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/air.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/rng.hpp"
#include "adit/simulation/surface_signal.hpp"
#include "adit/simulation/things.hpp"

namespace adit {
namespace {

constexpr float kEchoPulse = 0.3F;  ///< Metres: scattered light from within it adds up to one return.
constexpr float kAlbedo = 0.1F;
constexpr float kNearestEcho = 0.3F;
constexpr float kDropReach = 8.0F;  ///< Metres: beyond, a drop returns too little.
constexpr double kDrippingPlace = 10.0;

float uniform_of(std::uint64_t bits) { return static_cast<float>(bits >> 40U) * 0x1p-24F; }

/// One ray in the air.
struct Line {
  const Air& air;
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;

  /// Optical depth up to a distance.
  [[nodiscard]] float depth(float distance) const {
    float sum = air.fog * distance;
    for (const Air::Ball& ball : air.balls) {
      const Eigen::Vector3f to_centre = ball.centre - origin;
      const float middle = to_centre.dot(direction);
      const float beside = to_centre.squaredNorm() - middle * middle;
      if (beside >= ball.radius * ball.radius) continue;
      const float half = std::sqrt(ball.radius * ball.radius - beside);
      const float inside = std::min(distance, middle + half) - std::max(0.0F, middle - half);
      sum += ball.density * std::max(0.0F, inside);
    }
    return sum;
  }
  [[nodiscard]] float extinction(float distance) const {
    const Eigen::Vector3f p = origin + distance * direction;
    float sum = air.fog;
    for (const Air::Ball& ball : air.balls)
      if ((p - ball.centre).squaredNorm() < ball.radius * ball.radius) sum += ball.density;
    return sum;
  }
  /// The distance up to `far` at which that depth is reached.
  [[nodiscard]] float at_depth(float wanted, float far) const {
    float near = 0.0F;
    for (int halving = 0; halving < 20; ++halving) {
      const float middle = 0.5F * (near + far);
      (depth(middle) < wanted ? near : far) = middle;
    }
    return far;
  }
};

struct Scattered {
  float distance;
  float signal;
};

Scattered scattered_at(const Line& line, float depth, float far, float reach) {
  const float distance = std::max(line.at_depth(depth, far), kNearestEcho);
  const float reflectivity = kAlbedo * -std::expm1(-2.0F * kEchoPulse * line.extinction(distance));
  const float share = reach / distance;
  return {distance, reflectivity / kNominalReflectivity * share * share * std::exp(-2.0F * depth)};
}

}  // namespace

Fields fields_of(AirConfig& c) {
  return {{"fog", &c.fog, "1/m", 0, 1, "extinction of fog or haze everywhere; visibility is 3.9 / fog"},
          {"clouds_per_km", &c.clouds_per_km, "1/km", 0, 100, "clouds of dust on each robot's path"},
          {"cloud_density", &c.cloud_density, "1/m", 0, 100, "extinction in them, drawn from 1/4 to 4 of it"},
          {"cloud_radius", &c.cloud_radius, "m", 0.1, 100, "their size, drawn from 1/2 to 3/2 of it"},
          {"drips", &c.drips, "", 0, 0.5, "share of rays that meet a drop, in three places of ten"}};
}

AirConfig field_air() { return {0.002, 2.0, 0.2, 4.0, 5e-4}; }

std::vector<DustCloud> draw_clouds(const Trajectory& truth, const AirConfig& config, std::uint64_t seed) {
  constexpr double kOffPath = 3.0;
  constexpr double kDrift = 0.5;  // metres per second: ventilation
  Rng rng(seed);
  const ByLength along(truth);
  std::vector<DustCloud> clouds;
  const std::uint64_t num = rng.poisson(along.length() / 1000.0 * config.clouds_per_km);
  for (std::uint64_t i = 0; i < num; ++i) {
    const StampedPose& met = along.at(rng.uniform());
    const double ahead = rng.uniform(-kOffPath, kOffPath);
    const double left = rng.uniform(-kOffPath, kOffPath);
    const double drift = rng.uniform(-kDrift, kDrift);
    const double radius = config.cloud_radius * rng.uniform(0.5, 1.5);
    const double density = config.cloud_density * std::exp2(rng.uniform(-2.0, 2.0));
    clouds.push_back({met.stamp, met.T_world_body * Vector3(ahead, left, 1.0),
                      met.T_world_body.rotation() * Vector3(drift, 0.0, 0.0), radius, density});
  }
  return clouds;
}

Air air_at(Stamp stamp, const Vector3& sensor, const AirConfig& config, const std::vector<DustCloud>& clouds,
           std::uint64_t seed) {
  constexpr double kHalfLife = 45.0;  // seconds that a cloud is there before and after its middle
  constexpr double kDrippingShare = 0.3;
  Air air{static_cast<float>(config.fog)};
  if (config.drips > 0.0) {
    const Vector3 place = (sensor / kDrippingPlace).array().floor();
    const auto number = [&](int axis) { return static_cast<std::uint64_t>(std::int64_t(place[axis])); };
    const std::uint64_t bits = mix64(mix64(seed, number(0)), mix64(number(1), number(2)));
    if (static_cast<double>(uniform_of(bits)) < kDrippingShare) air.drips = static_cast<float>(config.drips);
  }
  for (const DustCloud& cloud : clouds) {
    const double since = to_seconds(stamp - cloud.middle);
    if (std::abs(since) > kHalfLife) continue;
    air.balls.push_back({(cloud.centre + since * cloud.velocity).cast<float>(),
                         static_cast<float>(cloud.radius), static_cast<float>(cloud.density)});
  }
  return air;
}

void look_through(const Air& air, float reach, std::uint64_t seed, RayBlock& rays,
                  RayBlock::Numbers& signals) {
  constexpr float kThin = 0.03F;  // optical depth up to which the exponential needs two terms
  constexpr float kFarthest = 1e3F;
  for (std::size_t i = 0; i < rays.size; ++i) {
    const Line line{air,
                    {rays.origins.x[i], rays.origins.y[i], rays.origins.z[i]},
                    {rays.directions.x[i], rays.directions.y[i], rays.directions.z[i]}};
    const float far = std::min(rays.distances[i], kFarthest);
    const float whole = line.depth(far);
    signals[i] *= whole < kThin ? 1.0F - 2.0F * whole + 2.0F * whole * whole : std::exp(-2.0F * whole);
    const std::uint64_t bits = mix64(seed, i);
    const float draw = uniform_of(bits);
    const float strongest = rays.distances[i] < RayHit::kMiss ? signals[i] : 0.0F;
    if (draw < whole && -std::log1p(-draw) < whole) {
      Scattered back = scattered_at(line, -std::log1p(-draw), far, reach);
      back.signal *= -std::log1p(-uniform_of(mix64(bits)));  // speckle
      if (back.signal > std::max(strongest, 1.0F)) {
        rays.distances[i] = back.distance;
        rays.cosines[i] = 1.0F;
        signals[i] = back.signal;
      }
    } else if (air.drips > 0.0F && draw > 1.0F - air.drips) {
      const float at = kNearestEcho + kDropReach * uniform_of(mix64(bits));
      if (at < rays.distances[i]) {
        rays.distances[i] = at;
        rays.cosines[i] = 1.0F;
        signals[i] = std::max(signals[i], 1.5F);
      }
    }
  }
}

}  // namespace adit
