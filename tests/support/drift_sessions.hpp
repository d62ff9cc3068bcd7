// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Robots made of the finished map of a drift, for data of which no scans are left: each keyframe sees the
/// points of the map that are visible from where it stands.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_slam.hpp"

namespace adit::test {

/// How a robot drives through the map of a session, and what it knows of its way.
struct DriftDrive {
  std::vector<Eigen::Vector2d> way;  ///< Corners of the line that it follows, metres, session frame.
  double side_m = 0.0;               ///< Drives this far to the left of that line.
  double spacing_m = 0.5;            ///< Between keyframes.
  double eye_m = 1.2;                ///< Height of the sensor over the floor.
  double sight_m = 20.0;
  /// Keyframe k sees points k, k + layers, ... of the shuffled map alone: with one layer neighbouring
  /// keyframes see the very same points, as two scans never do.
  int layers = 1;
  bool remove_traces = true;                                   ///< See without_traces.
  PathNoise drift{.translation = 0.02, .rotation_deg = 0.05};  ///< Of its odometry, drawn by `seed`.
  std::uint64_t seed = 1;
};

/// A robot's map, and for evaluation where its keyframes stood.
struct DriftRobot {
  std::shared_ptr<const RobotMap> map;
  std::vector<Pose> T_session_base;
};

/// Those of a cloud's points that are chosen, with their intensities where it has them.
template <class IsChosen>
PointCloud chosen(const PointCloud& cloud, const IsChosen& is_chosen) {
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_chosen(i)) continue;
    out.points.push_back(cloud.points[i]);
    if (!cloud.intensities.empty()) out.intensities.push_back(cloud.intensities[i]);
  }
  return out;
}

/// Every n-th point of the shuffled map, starting with point `part`.
inline PointCloud part_of(const PointCloud& map, int part, int num_parts, std::uint64_t seed) {
  return chosen(map, [&](std::size_t i) {
    return mix64(seed, i) % static_cast<std::uint64_t>(num_parts) == static_cast<std::uint64_t>(part);
  });
}

/// Points of a map that are seen from `eye`: those that no other point hides, each being as wide as the
/// points of such maps lie apart.
inline std::vector<std::size_t> visible_from(const PointCloud& map, const Vector3& eye, double sight_m) {
  constexpr int kColumns = 720;  // half a degree
  constexpr int kRows = 360;
  constexpr double kPointRadius = 0.12;  // metres; 45 points on a square metre
  constexpr double kCell = 2.0 * std::numbers::pi / kColumns;
  struct Seen {
    std::size_t point;
    int column, row;
    double range;
  };
  std::vector<Seen> seen;
  std::vector<float> depth(std::size_t{kColumns} * kRows, std::numeric_limits<float>::infinity());
  const auto cell = [](int column, int row) {
    return static_cast<std::size_t>(row) * kColumns +
           static_cast<std::size_t>((column + kColumns) % kColumns);
  };
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Vector3 d = map.points[i].cast<double>() - eye;
    const double range = d.norm();
    if (!(range < sight_m) || range < 0.3) continue;
    const double elevation = std::asin(d.z() / range);
    const int row = std::clamp(static_cast<int>((elevation + std::numbers::pi / 2.0) / kCell), 0, kRows - 1);
    const int column =
        std::clamp(static_cast<int>((std::atan2(d.y(), d.x()) + std::numbers::pi) / kCell), 0, kColumns - 1);
    seen.push_back({i, column, row, range});
    const double half = std::atan(kPointRadius / range) / kCell;
    const int up = static_cast<int>(std::lround(half));
    const int across =
        std::min(kColumns / 8, static_cast<int>(std::lround(half / std::max(0.1, std::cos(elevation)))));
    for (int r = std::max(0, row - up); r <= std::min(kRows - 1, row + up); ++r)
      for (int c = column - across; c <= column + across; ++c)
        depth[cell(c, r)] = std::min(depth[cell(c, r)], static_cast<float>(range));
  }
  std::vector<std::size_t> out;
  for (const Seen& one : seen)  // a wall seen at a grazing angle fills a cell over metres
    if (one.range < depth[cell(one.column, one.row)] + 0.5 + 0.1 * one.range) out.push_back(one.point);
  return out;
}

/// Height of the floor at (x, y): of the lowest tenth of the points around it.
inline double floor_at(const PointCloud& map, const Eigen::Vector2d& at) {
  std::vector<float> heights;
  for (const Eigen::Vector3f& p : map.points)
    if ((p.head<2>().cast<double>() - at).squaredNorm() < 0.64) heights.push_back(p.z());
  if (heights.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto tenth = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 10);
  std::ranges::nth_element(heights, tenth);
  return *tenth;
}

/// A vehicle's poses along the way: on the floor, x along the way, uphill where the floor rises.
inline std::vector<Pose> stands_along(const PointCloud& map, const DriftDrive& drive) {
  std::vector<Vector3> line;
  double to_next = 0.0;
  for (std::size_t c = 1; c < drive.way.size(); ++c) {
    const Eigen::Vector2d step = drive.way[c] - drive.way[c - 1];
    const Eigen::Vector2d ahead = step.normalized();
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    for (; to_next < step.norm(); to_next += drive.spacing_m) {
      const Eigen::Vector2d at = drive.way[c - 1] + to_next * ahead + drive.side_m * left;
      line.emplace_back(at.x(), at.y(), 0.0);
    }
    to_next -= step.norm();
  }
  parallel_for_each(line.size(), [&](std::size_t i) { line[i].z() = floor_at(map, line[i].head<2>()); });
  const auto window = static_cast<std::ptrdiff_t>(std::lround(2.0 / drive.spacing_m));
  const auto num = static_cast<std::ptrdiff_t>(line.size());
  std::vector<Vector3> smooth;
  for (std::ptrdiff_t i = 0; i < num; ++i) {
    Vector3 sum = Vector3::Zero();
    int count = 0;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - window); j <= std::min(num - 1, i + window);
         ++j) {
      if (!std::isfinite(line[static_cast<std::size_t>(j)].z())) continue;
      sum += line[static_cast<std::size_t>(j)];
      ++count;
    }
    smooth.push_back(count > 0 ? Vector3(sum / count) : line[static_cast<std::size_t>(i)]);
  }
  std::vector<Pose> stands;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const Vector3 x = (smooth[std::min(i + 1, smooth.size() - 1)] - smooth[i > 0 ? i - 1 : 0]).normalized();
    const Vector3 y = Vector3::UnitZ().cross(x).normalized();
    Matrix3 R;
    R << x, y, x.cross(y);
    stands.emplace_back(Eigen::Quaterniond(R), smooth[i]);
  }
  return stands;
}

/// The map without what stands where the robot drives: traces of the people who walked along while a map was
/// made, which as things that never moved would hide the drift from every keyframe.
inline PointCloud without_traces(const PointCloud& map, const DriftDrive& drive) {
  if (!drive.remove_traces) return map;
  DriftDrive middle = drive;
  middle.side_m = 0.0;
  middle.spacing_m = 1.0;
  std::vector<Pose> T_base_session;
  for (const Pose& T : stands_along(map, middle)) T_base_session.push_back(T.inverse());
  std::vector<char> is_trace(map.size(), 0);
  parallel_for_each(map.size(), [&](std::size_t i) {
    const Vector3 p = map.points[i].cast<double>();
    is_trace[i] = std::ranges::any_of(T_base_session, [&](const Pose& T) {
      const Vector3 q = T * p;
      return std::abs(q.x()) < 0.6 && std::abs(q.y()) < 1.8 && q.z() > 0.4 && q.z() < 2.3;
    });
  });
  return chosen(map, [&](std::size_t i) { return !is_trace[i]; });
}

/// The robot that drove so. Its odometry is the way itself with drift of the stated size.
inline DriftRobot drive_through(const PointCloud& whole, const DriftDrive& drive, RobotId id,
                                const std::string& name) {
  const PointCloud map = without_traces(whole, drive);
  DriftRobot robot{nullptr, stands_along(map, drive)};
  const RobotSlamConfig config;
  const std::size_t num = robot.T_session_base.size();
  std::vector<std::shared_ptr<const PointCloud>> clouds(num);
  parallel_for_each(num, [&](std::size_t k) {
    const Pose& T = robot.T_session_base[k];
    std::vector<char> is_seen(map.size(), 0);
    for (const std::size_t i : visible_from(map, T * Vector3(0.0, 0.0, drive.eye_m), drive.sight_m))
      is_seen[i] = mix64(drive.seed, i) % static_cast<std::uint64_t>(drive.layers) ==
                   k % static_cast<std::size_t>(drive.layers);
    PointCloud cloud = chosen(map, [&](std::size_t i) { return is_seen[i]; });
    clouds[k] = std::make_shared<const PointCloud>(
        voxel_downsample(transformed(T.inverse(), std::move(cloud)), config.cloud_voxel));
  });
  Rng rng(drive.seed);
  RobotMap out;
  out.id = id;
  out.name = name;
  out.viewpoint = Vector3(0.0, 0.0, drive.eye_m);
  out.scan_context = config.scan_context;
  Pose T_odom_base;
  for (std::size_t k = 0; k < num; ++k) {
    Matrix6 covariance = Matrix6::Zero();
    if (k > 0) {
      const Pose step = robot.T_session_base[k - 1].inverse() * robot.T_session_base[k];
      covariance = random_walk(drive.drift, step.translation().norm());
      Vector6 noise;
      for (int i = 0; i < 6; ++i) noise[i] = std::sqrt(covariance(i, i)) * rng.normal();
      T_odom_base = T_odom_base * step * Pose::exp(noise);
    }
    const Stamp stamp{static_cast<std::int64_t>(k) * 1'000'000'000};
    out.places.push_back(describe(*clouds[k], out.scan_context));
    out.searchable.push_back(true);
    out.unconfirmed.emplace_back();
    out.step_covariances.push_back(covariance);
    out.pose_noise.push_back(Matrix6::Identity() * 1e-6);
    out.odometry.push_back({stamp, T_odom_base});
    out.keyframes.push_back({{id, static_cast<std::uint32_t>(k)}, stamp, T_odom_base, clouds[k]});
  }
  robot.map = std::make_shared<const RobotMap>(std::move(out));
  return robot;
}

/// By how much a solution misplaces keyframes of one robot in the nearest keyframes of the other.
struct MergeError {
  double median_m = 0.0;
  double largest_m = 0.0;
  double median_deg = 0.0;
  double largest_deg = 0.0;
  std::size_t num_keyframes = 0;  ///< Of `a`, that have one of `b` within 4 m.
};
inline std::optional<MergeError> merge_error(const FleetSolution& solution, const DriftRobot& a,
                                             const DriftRobot& b, const Pose& T_a_b) {
  std::vector<double> metres;
  std::vector<double> degrees;
  for (std::size_t i = 0; i < a.T_session_base.size(); ++i) {
    std::optional<std::size_t> nearest;
    double best = 4.0;
    for (std::size_t j = 0; j < b.T_session_base.size(); ++j) {
      const double apart =
          (a.T_session_base[i].translation() - T_a_b * b.T_session_base[j].translation()).norm();
      if (apart >= best) continue;
      best = apart;
      nearest = j;
    }
    if (!nearest) continue;
    const Pose truth = a.T_session_base[i].inverse() * T_a_b * b.T_session_base[*nearest];
    const Pose found = solution.T_world_keyframe.at(a.map->id)[i].inverse() *
                       solution.T_world_keyframe.at(b.map->id)[*nearest];
    const Pose error = truth.inverse() * found;
    metres.push_back(error.translation().norm());
    degrees.push_back(error.angle() / kDegree);
  }
  if (metres.empty()) return std::nullopt;
  std::ranges::sort(metres);
  std::ranges::sort(degrees);
  return MergeError{metres[metres.size() / 2], metres.back(), degrees[degrees.size() / 2], degrees.back(),
                    metres.size()};
}

}  // namespace adit::test
