// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/sensor_origin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kSlopeLimit = 0.6F;      // tangent of 31 degrees, the reach of most sensors
constexpr std::size_t kPerCloud = 4000;  // points taken of each cloud
constexpr double kAcross = 1.5;          // metres searched to each side
constexpr double kUp = 3.0;              // metres searched up and down
constexpr double kAside = 0.2;           // metres: smears the beams of every sensor
constexpr float kNearest = 2.0F;         // metres: nearer points move too fast with the position
constexpr std::size_t kTooFew = 300;     // points in a histogram

/// Which points a histogram takes, and how finely.
struct Slopes {
  float limit = kSlopeLimit;
  float bin = 0.0005F;
  float nearest = kNearest;
};

/// About kPerCloud points of a cloud. The stride is odd and no multiple of 3 or 5, so that it does not fall
/// into step with beams or columns.
Points thinned(const PointCloud& cloud) {
  std::size_t stride = std::max<std::size_t>(1, cloud.size() / kPerCloud);
  while (std::gcd(stride, std::size_t{30}) != 1) ++stride;
  Points points;
  for (std::size_t i = 0; i < cloud.size(); i += stride) points.push_back(cloud.points[i]);
  return points;
}

/// How much the slopes seen from a position crowd into single bins, compared with the bins around: about 1
/// for anything smooth, the spacing of the beams in bins when they are sharp, at most 2 kAround + 1.
class Sharpness {
 public:
  explicit Sharpness(const Slopes& slopes)
      : slopes_(slopes), counts_(static_cast<std::size_t>(2.0F * slopes.limit / slopes.bin) + 1) {}

  double operator()(const Points& points, const Vector3& position) {
    std::ranges::fill(counts_, 0);
    const std::size_t total = count(points, position.cast<float>());
    return total < kTooFew ? 0.0 : crowding();
  }

 private:
  std::size_t count(const Points& points, const Eigen::Vector3f& position) {
    std::size_t total = 0;
    const float nearest2 = slopes_.nearest * slopes_.nearest;
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3f p = point - position;
      const float range2 = p.x() * p.x() + p.y() * p.y();
      const float slope = p.z() / std::sqrt(range2);
      if (!(range2 >= nearest2) || !(std::abs(slope) < slopes_.limit)) continue;
      ++counts_[static_cast<std::size_t>((slope + slopes_.limit) / slopes_.bin)];
      ++total;
    }
    return total;
  }

  [[nodiscard]] double crowding() const {
    // To each side: less than the spacing of 32 beams, more than that of 128.
    constexpr std::size_t kAround = 8;
    double same = 0.0;
    double around = 0.0;
    long window = std::accumulate(counts_.begin(), counts_.begin() + kAround, 0L);
    for (std::size_t k = 0; k < counts_.size(); ++k) {
      if (k + kAround < counts_.size()) window += counts_[k + kAround];
      if (k > kAround) window -= counts_[k - kAround - 1];
      same += static_cast<double>(counts_[k]) * (counts_[k] - 1);
      around += static_cast<double>(counts_[k]) * static_cast<double>(window - 1);
    }
    return around > 0.0 ? same / around * (2 * kAround + 1) : 0.0;
  }

  Slopes slopes_;
  std::vector<int> counts_;
};

struct Found {
  Vector3 position = Vector3::Zero();
  double sharpness = 0.0;

  void take(const Vector3& candidate, double candidate_sharpness) {
    if (candidate_sharpness > sharpness) *this = {candidate, candidate_sharpness};
  }
};

/// The three sharpest heights, 5 cm and more apart. Beams near the horizon move up and down with the
/// sensor's height but hardly when it moves across, so the height can be found alone.
std::array<double, 3> likely_heights(const Points& points) {
  Sharpness sharpness({0.03F, 0.001F, 5.0F});
  std::vector<Found> all;
  for (double z = -kUp; z <= kUp; z += 0.005) all.push_back({{0, 0, z}, sharpness(points, {0, 0, z})});
  std::array<double, 3> heights{};
  for (double& height : heights) {
    const Found best = *std::ranges::max_element(all, {}, &Found::sharpness);
    height = best.position.z();
    for (Found& f : all)
      if (std::abs(f.position.z() - height) < 0.05) f.sharpness = -1.0;
  }
  return heights;
}

Found sharpest_across(const Points& points, double height) {
  constexpr double kStep = 0.05;  // moves the slopes taken here by at most a bin
  Points few;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 4001);
  for (std::size_t i = 0; i < points.size(); i += stride) few.push_back(points[i]);
  Sharpness sharpness({0.15F, 0.001F, 5.0F});
  Found best;
  for (double x = -kAcross; x <= kAcross; x += kStep) {
    for (double y = -kAcross; y <= kAcross; y += kStep)
      best.take({x, y, height}, sharpness(few, {x, y, height}));
  }
  return best;
}

/// Climbs to the sharpest position nearby, down to steps of half a millimetre.
Found refined(const Points& points, const Vector3& start) {
  Sharpness sharpness({});
  Found best{start, sharpness(points, start)};
  for (double step = 0.02; step > 4e-4;) {
    const Found before = best;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Vector3 candidate = before.position + sign * step * Vector3::Unit(axis);
        best.take(candidate, sharpness(points, candidate));
      }
    }
    if (best.sharpness <= before.sharpness) step /= 2.0;
  }
  return best;
}

double contrast_at(const Points& points, const Vector3& position) {
  Sharpness sharpness({});
  double aside = 1.0;  // of no structure at all
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0})
      aside = std::max(aside, sharpness(points, position + sign * kAside * Vector3::Unit(axis)));
  }
  return sharpness(points, position) / aside;
}

}  // namespace

std::optional<SensorOrigin> find_sensor_origin(std::span<const PointCloud> clouds) {
  std::vector<Points> taken;
  Points all;
  for (const PointCloud& cloud : clouds) {
    const Points& points = taken.emplace_back(thinned(cloud));
    all.insert(all.end(), points.begin(), points.end());
  }
  if (all.size() < kTooFew) return std::nullopt;
  const auto clear_at = [&](const Vector3& start) -> std::optional<SensorOrigin> {
    SensorOrigin origin{refined(all, start).position, std::numeric_limits<double>::max()};
    for (const Points& points : taken) {
      origin.contrast = std::min(origin.contrast, contrast_at(points, origin.position));
      if (origin.contrast < kClearContrast) return std::nullopt;
    }
    return origin;
  };
  // The usual frames first: the sensor's own, and one straight below it.
  if (const auto origin = clear_at(Vector3::Zero())) return origin;
  const std::array<double, 3> heights = likely_heights(all);
  for (const double height : heights)
    if (const auto origin = clear_at({0, 0, height})) return origin;
  for (const double height : heights)
    if (const auto origin = clear_at(sharpest_across(all, height).position)) return origin;
  return std::nullopt;
}

}  // namespace adit
