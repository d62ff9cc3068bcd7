// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/scan_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/robot/scan_motion.hpp"

namespace adit {
namespace {

constexpr double kPerRadian = 1.0 / kDegree;  // degrees

/// From scan to scan of these, so that the jitter of a robot that stands does not add up.
double moved_m(const Recording& recording, const std::vector<std::size_t>& scans) {
  double sum = 0.0;
  std::optional<Vector3> last;
  for (const std::size_t i : scans) {
    const Result<Pose> pose = pose_at(recording.wheel, recording.scan_stamps[i]);
    if (!pose) continue;
    if (last) sum += (pose->translation() - *last).norm();
    last = pose->translation();
  }
  return sum;
}

constexpr int kSectors = 72;  // of 5 degrees

int sector_of(const Vector3& p) {
  const double turn = std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi);
  return static_cast<int>((turn - std::floor(turn)) * kSectors) % kSectors;
}

// ---- floor ------------------------------------------------------------------------------------------------

struct Plane3 {
  Vector3 normal;  ///< Upwards.
  double height;   ///< Of the plane on the z axis.
};

std::optional<Plane3> plane_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  Vector3 normal = (b - a).cross(c - a);
  if (!(normal.norm() > 1e-6)) return {};
  normal.normalize();
  if (normal.z() < 0.0) normal = -normal;
  constexpr double kLeastUpright = 0.85;  // vertical part of the normal: a mount that is off by 30 degrees
  if (normal.z() < kLeastUpright) return {};
  return Plane3{normal, normal.dot(a) / normal.z()};
}

double off_plane(const Plane3& plane, const Vector3& p) {
  return plane.normal.dot(p) - plane.height * plane.normal.z();
}

/// The plane below the sensor on which most points near the robot lie (M. Fischler, R. Bolles, "Random sample
/// consensus", 1981), fitted to those. Nothing lies below a floor: points there count against it. `points`:
/// base frame.
std::optional<Plane3> floor_of(const std::vector<Vector3>& points, const Vector3& sensor) {
  constexpr double kNear = 15.0;       // metres: 11 degrees below the horizon reach the floor at 5 m
  constexpr double kBelow = 0.2;       // metres from the sensor down
  constexpr double kOff = 0.05;        // metres from the plane
  constexpr std::size_t kMost = 1500;  // points
  constexpr int kTrials = 150;
  constexpr double kBelowCounts = 2.0;
  constexpr double kLeastShare = 0.02;  // of the points near and below the sensor
  std::vector<Vector3> near;
  for (const Vector3& p : points)
    if ((p - sensor).head<2>().norm() < kNear && p.z() < sensor.z() - kBelow) near.push_back(p);
  std::vector<Vector3> some;
  for (const std::size_t i : spread_over(near.size(), kMost)) some.push_back(near[i]);
  if (some.size() < 30) return {};
  // Most points are of walls. The lowest one in each direction is of the floor, where it shows.
  std::map<int, Vector3> lowest;
  for (const Vector3& p : near) {
    const auto known = lowest.try_emplace(sector_of(p - sensor), p).first;
    if (p.z() < known->second.z()) known->second = p;
  }
  std::vector<Vector3> tried;
  for (const auto& [sector, p] : lowest) tried.push_back(p);
  Rng rng(1);
  const auto any = [&]() -> const Vector3& {
    return tried[static_cast<std::size_t>(rng.uniform() * static_cast<double>(tried.size()))];
  };
  std::vector<Vector3> best;
  double best_score = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::optional<Plane3> plane = plane_of(any(), any(), any());
    if (!plane) continue;
    std::vector<Vector3> on_it;
    double score = 0.0;
    for (const Vector3& p : some) {
      const double off = off_plane(*plane, p);
      if (std::abs(off) < kOff) on_it.push_back(p);
      if (off < -kOff) score -= kBelowCounts;
    }
    score += static_cast<double>(on_it.size());
    if (score <= best_score) continue;
    best_score = score;
    best = std::move(on_it);
  }
  if (static_cast<double>(best.size()) < kLeastShare * static_cast<double>(some.size())) return {};
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : best) mean += p / static_cast<double>(best.size());
  Matrix3 scatter = Matrix3::Zero();
  for (const Vector3& p : best) scatter += (p - mean) * (p - mean).transpose();
  const auto [values, vectors] = symmetric_eigen(scatter);
  Vector3 normal = vectors.col(0);
  if (normal.z() < 0.0) normal = -normal;
  return Plane3{normal, normal.dot(mean) / normal.z()};
}

std::optional<FloorSeen> floor_seen(const std::vector<std::optional<Plane3>>& floors) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> heights;
  for (const std::optional<Plane3>& floor : floors) {
    if (!floor) continue;
    x.push_back(floor->normal.x() / floor->normal.z());
    y.push_back(floor->normal.y() / floor->normal.z());
    heights.push_back(floor->height);
  }
  if (2 * heights.size() < floors.size()) return {};
  const Vector3 up(median(x), median(y), 1.0);
  std::vector<double> off;
  for (std::size_t i = 0; i < x.size(); ++i)
    off.push_back(kPerRadian * std::hypot(x[i] - up.x(), y[i] - up.y()));
  return FloorSeen{up.normalized(), median(heights), median(off)};
}

// ---- the view
// -----------------------------------------------------------------------------------------------

/// Runs of sectors without returns, around the circle.
std::vector<std::pair<double, double>> blind_sectors(const std::array<bool, kSectors>& seen) {
  constexpr double kWidth = 360.0 / kSectors;
  const auto first_seen = std::ranges::find(seen, true);
  if (first_seen == seen.end()) return {{0.0, 360.0}};
  const auto begin = static_cast<int>(first_seen - seen.begin());
  std::vector<std::pair<double, double>> out;
  int run = 0;
  for (int i = 1; i <= kSectors; ++i) {
    if (!seen[static_cast<std::size_t>((begin + i) % kSectors)]) {
      ++run;
      continue;
    }
    if (run > 0)
      out.emplace_back(std::fmod(kWidth * (begin + i - run), 360.0), std::fmod(kWidth * (begin + i), 360.0));
    run = 0;
  }
  return out;
}

/// A direction and a distance, 3 degrees by 3 degrees by 10 cm.
using Cell = std::array<int, 3>;
constexpr double kCellDeg = 3.0;
constexpr double kCellMetres = 0.1;
constexpr double kSelfReach = 1.2;  // metres: no wall is nearer for long

struct OfScan {
  std::vector<double> ranges;
  std::vector<Vector3> some_directions;
  std::array<bool, kSectors> seen{};
  std::map<Cell, int> near;  ///< Returns off the floor within kSelfReach.
  std::optional<Plane3> floor;
  bool has_times = false;
  double sweep_s = 0.0;
};

OfScan look_at(const Scan& scan, const Pose& T_base_lidar) {
  constexpr std::size_t kEvery = 16;  // points
  OfScan out;
  const Matrix3 R_base_lidar = T_base_lidar.rotation_matrix();
  std::vector<Vector3> points;  // from the LiDAR, in the axes of the base
  std::vector<Vector3> in_base;
  for (const Eigen::Vector3f& point : scan.cloud.points) {
    if (point.isZero()) continue;  // a pixel without a return
    const Vector3& p = points.emplace_back(R_base_lidar * point.cast<double>());
    out.ranges.push_back(p.norm());
    if (out.ranges.size() % kEvery == 0 && out.ranges.back() > 0.0)
      out.some_directions.push_back(p / out.ranges.back());
    out.seen[static_cast<std::size_t>(sector_of(p))] = true;
    in_base.push_back(T_base_lidar.translation() + p);
  }
  out.floor = floor_of(in_base, T_base_lidar.translation());
  constexpr double kFloorMargin = 0.15;  // metres
  for (std::size_t i = 0; i < in_base.size(); ++i) {
    if (out.ranges[i] > kSelfReach) continue;
    if (out.floor && std::abs(off_plane(*out.floor, in_base[i])) < kFloorMargin) continue;
    const Vector3& p = points[i];
    ++out.near[{static_cast<int>(std::floor(kPerRadian * std::atan2(p.y(), p.x()) / kCellDeg)),
                static_cast<int>(std::floor(kPerRadian * std::atan2(p.z(), p.head<2>().norm()) / kCellDeg)),
                static_cast<int>(out.ranges[i] / kCellMetres)}];
  }
  out.has_times = scan.cloud.has_times();
  if (out.has_times && !scan.cloud.empty()) {
    const auto [first, last] = std::ranges::minmax(scan.cloud.time_offsets_ns);
    out.sweep_s = 1e-9 * (static_cast<double>(last) - static_cast<double>(first));
  }
  return out;
}

/// About the mean direction.
double cone_of(const std::vector<OfScan>& scans) {
  Vector3 mean = Vector3::Zero();
  for (const OfScan& scan : scans)
    for (const Vector3& direction : scan.some_directions) mean += direction;
  if (!(mean.norm() > 0.0)) return 180.0;
  std::vector<double> angles;
  for (const OfScan& scan : scans)
    for (const Vector3& direction : scan.some_directions)
      angles.push_back(kPerRadian * std::acos(std::clamp(direction.dot(mean.normalized()), -1.0, 1.0)));
  return percentile(angles, 99.0);
}

std::optional<SelfHits> self_hits_in(const std::vector<OfScan>& scans, std::size_t num_returns) {
  constexpr double kOften = 0.8;              // share of the scans
  std::map<Cell, std::pair<int, int>> cells;  // scans, returns
  for (const OfScan& scan : scans)
    for (const auto& [cell, num] : scan.near) {
      ++cells[cell].first;
      cells[cell].second += num;
    }
  SelfHits hits{0.0, std::numeric_limits<double>::infinity(), 0.0, 0.0};
  Vector3 middle = Vector3::Zero();
  double num = 0.0;
  for (const auto& [cell, counts] : cells) {
    if (counts.first < kOften * static_cast<double>(scans.size())) continue;
    const double azimuth = kCellDeg * (cell[0] + 0.5) / kPerRadian;
    num += counts.second;
    middle += counts.second * Vector3(std::cos(azimuth), std::sin(azimuth), 0.0);
    hits.nearest_m = std::min(hits.nearest_m, kCellMetres * cell[2]);
    hits.farthest_m = std::max(hits.farthest_m, kCellMetres * (cell[2] + 1));
  }
  if (num == 0.0) return {};
  hits.share = num / static_cast<double>(num_returns);
  hits.azimuth_deg = kPerRadian * std::atan2(middle.y(), middle.x());
  return hits;
}

}  // namespace

ScanTiming timing_of(const std::vector<Stamp>& stamps) {
  ScanTiming timing;
  if (stamps.size() < 2) return timing;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(to_seconds(stamps[i] - stamps[i - 1]));
  timing.interval_s = median(intervals);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i] > timing.longest_gap_s) {
      timing.longest_gap_s = intervals[i];
      timing.longest_gap_at_s = to_seconds(stamps[i] - stamps.front());
    }
    constexpr double kGap = 1.5;  // intervals
    if (intervals[i] > kGap * timing.interval_s)
      timing.num_missing += static_cast<std::size_t>(std::round(intervals[i] / timing.interval_s)) - 1;
  }
  return timing;
}

namespace {

bool has_failed(const std::optional<Error>& failure) { return failure.has_value(); }

/// A sentence on the scans that could not be read; none where there are none.
std::optional<std::string> damaged_of(const std::vector<std::size_t>& chosen,
                                      const std::vector<std::optional<Error>>& failures) {
  const auto first = std::ranges::find_if(failures, has_failed);
  if (first == failures.end()) return std::nullopt;
  return format("{} of {} scans looked at cannot be read; the first is scan {}: {}",
                std::ranges::count_if(failures, has_failed), chosen.size(),
                chosen[static_cast<std::size_t>(first - failures.begin())], (*first)->message);
}

}  // namespace

Result<ScansSeen> look_at_scans(const Recording& recording, std::size_t num) {
  const std::vector<std::size_t> chosen = spread_over(recording.num_scans(), num);
  std::vector<OfScan> scans(chosen.size());
  std::vector<std::optional<Error>> failures(chosen.size());
  parallel_for_each(chosen.size(), [&](std::size_t i) {
    const Result<Scan> scan = recording.read_scan(chosen[i]);
    if (scan)
      scans[i] = look_at(*scan, recording.T_base_lidar);
    else
      failures[i] = scan.error();
  });
  const std::optional<std::string> damaged = damaged_of(chosen, failures);
  if (damaged && std::ranges::all_of(failures, has_failed))
    return fail(format("{}: {}", recording.name, *damaged));
  std::erase_if(scans, [](const OfScan& scan) { return scan.ranges.empty(); });  // nothing was in view
  ScansSeen seen;
  seen.num_scans = scans.size();
  seen.damaged = damaged;
  std::vector<double> ranges;
  std::vector<double> points;
  std::vector<double> sweeps;
  std::vector<std::optional<Plane3>> floors;
  std::array<int, kSectors> num_seen{};
  seen.has_times = true;
  for (const OfScan& scan : scans) {
    ranges.insert(ranges.end(), scan.ranges.begin(), scan.ranges.end());
    points.push_back(static_cast<double>(scan.ranges.size()));
    sweeps.push_back(scan.sweep_s);
    floors.push_back(scan.floor);
    seen.has_times = seen.has_times && scan.has_times;
    for (std::size_t i = 0; i < scan.seen.size(); ++i) num_seen[i] += scan.seen[i] ? 1 : 0;
  }
  if (ranges.empty()) return fail(recording.name + ": the scans have no points");
  seen.points = median(points);
  seen.sweep_s = median(sweeps);
  seen.nearest_m = percentile(ranges, 1.0);
  seen.median_m = percentile(ranges, 50.0);
  seen.farthest_m = *std::ranges::max_element(ranges);
  const auto at_the_end = std::ranges::count_if(ranges, [&](double r) { return r > 0.97 * seen.farthest_m; });
  seen.share_at_the_end = static_cast<double>(at_the_end) / static_cast<double>(ranges.size());
  constexpr double kSeldom = 0.1;  // share of the scans
  std::array<bool, kSectors> is_seen{};
  for (std::size_t i = 0; i < is_seen.size(); ++i)
    is_seen[i] = num_seen[i] >= kSeldom * static_cast<double>(scans.size());
  seen.field_of_view_deg = 360.0 / kSectors * static_cast<double>(std::ranges::count(is_seen, true));
  seen.blind_deg = blind_sectors(is_seen);
  seen.cone_deg = cone_of(scans);
  seen.floor = floor_seen(floors);
  constexpr double kMoved = 5.0;  // metres
  seen.has_moved = moved_m(recording, chosen) > kMoved;
  if (seen.has_moved) seen.self_hits = self_hits_in(scans, ranges.size());
  return seen;
}

}  // namespace adit
