// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/floor_line.hpp"

namespace adit {
namespace {

constexpr std::uint64_t kSwayStream = 0x73776179;
constexpr int kSamplesPerCorner = 64;  ///< Path points per DriveConfig::corner_length: centimetres apart.
constexpr double kHighestStep =
    0.3;  ///< Metres: largest height of a wheel above or below the floor midway between all four.

// A sample of the path. They are dense enough (centimetres) to be interpolated linearly.
struct PathPoint {
  Vector3 position = Vector3::Zero();
  double yaw = 0.0;          // radians, continuous: not wrapped
  double curvature = 0.0;    // 1/m
  double slope_ahead = 0.0;  // rise of the floor along x and along y of the base frame
  double slope_left = 0.0;
  double distance = 0.0;  // metres along the path
  double speed = 0.0;
  double time = 0.0;
};
using Path = std::vector<PathPoint>;

double polyline_length(const std::vector<Vector3>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

// Points on the polyline at equal distances of about `spacing`, both ends included, four or more.
std::vector<Vector3> resampled(const std::vector<Vector3>& line, double spacing) {
  const double length = polyline_length(line);
  const double parts = std::max(3.0, std::round(length / spacing));
  std::vector<Vector3> points{line.front()};
  double passed = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double piece = (line[i] - line[i - 1]).norm();
    while (static_cast<double>(points.size()) < parts) {
      const double beyond = length * static_cast<double>(points.size()) / parts - passed;
      if (beyond > piece) break;
      points.emplace_back(line[i - 1] + (beyond / piece) * (line[i] - line[i - 1]));
    }
    passed += piece;
  }
  points.push_back(line.back());
  return points;
}

struct Bend {
  Vector3 position;
  Vector3 first;  // derivatives by u
  Vector3 second;
};

// Uniform cubic B-spline between the middle two of four control points, u in [0, 1]. It rounds corners, its
// curvature is continuous, and it stays inside the hull of the points, so it does not swing out into walls.
Bend b_spline(const std::array<Vector3, 4>& c, double u) {
  const double w = 1.0 - u;
  const double u2 = u * u;
  Bend bend;
  bend.position = (w * w * w * c[0] + (3.0 * u2 * u - 6.0 * u2 + 4.0) * c[1] +
                   (-3.0 * u2 * u + 3.0 * u2 + 3.0 * u + 1.0) * c[2] + u2 * u * c[3]) /
                  6.0;
  bend.first =
      0.5 * (-w * w * c[0] + (3.0 * u2 - 4.0 * u) * c[1] + (-3.0 * u2 + 2.0 * u + 1.0) * c[2] + u2 * c[3]);
  bend.second = w * c[0] + (3.0 * u - 2.0) * c[1] + (1.0 - 3.0 * u) * c[2] + u * c[3];
  return bend;
}

PathPoint path_point(const Bend& bend) {
  PathPoint point;
  point.position = bend.position;
  point.yaw = std::atan2(bend.first.y(), bend.first.x());
  const double speed = std::max(bend.first.head<2>().norm(), 1e-9);
  point.curvature =
      (bend.first.x() * bend.second.y() - bend.first.y() * bend.second.x()) / (speed * speed * speed);
  return point;
}

Path smoothed(const std::vector<Vector3>& line, double corner_length) {
  std::vector<Vector3> control = resampled(line, corner_length);
  // Mirrored end points: the curve then starts and ends on the line's ends, straight.
  const std::size_t n = control.size();
  control.insert(control.begin(), 2.0 * control[0] - control[1]);
  control.push_back(2.0 * control[n] - control[n - 1]);
  Path path;
  for (std::size_t i = 1; i + 2 < control.size(); ++i) {
    const std::array<Vector3, 4> four{control[i - 1], control[i], control[i + 1], control[i + 2]};
    for (int k = 0; k < kSamplesPerCorner; ++k)
      path.push_back(path_point(b_spline(four, double(k) / kSamplesPerCorner)));
    if (i + 3 == control.size()) path.push_back(path_point(b_spline(four, 1.0)));
  }
  return path;
}

Result<> unwrap_yaw(Path& path, const std::string& robot) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double turn = wrap_angle(path[i].yaw - path[i - 1].yaw);
    if (std::abs(turn) > std::numbers::pi / 4.0) {
      const Vector3& p = path[i].position;
      return fail(
          format("{}: the route reverses its direction at ({:.2f}, {:.2f}, {:.2f}); add waypoints on a curve",
                 robot, p.x(), p.y(), p.z()));
    }
    path[i].yaw = path[i - 1].yaw + turn;
  }
  return {};
}

// Height of the bumps at a place, standard deviation 1: smooth between random numbers at the corners of
// cells.
double bump_at(double x, double y) {
  constexpr double kCell = 0.7;                                 // metres: longer than a wheel's footprint
  constexpr double kToUnit = 2.0 * std::numbers::sqrt3 * 1.35;  // of numbers in [0, 1), smoothed
  const auto corner = [](double i, double j) {
    const auto number = [](double k) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(k)); };
    return static_cast<double>(mix64(number(i), number(j)) >> 11U) * 0x1.0p-53 - 0.5;
  };
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double i = std::floor(x / kCell);
  const double j = std::floor(y / kCell);
  const double u = smooth(x / kCell - i);
  const double v = smooth(y / kCell - j);
  const double near = std::lerp(corner(i, j), corner(i + 1.0, j), u);
  const double far = std::lerp(corner(i, j + 1.0), corner(i + 1.0, j + 1.0), u);
  return kToUnit * std::lerp(near, far, v);
}

// The heights under the four wheels give the plane that the robot stands on.
void stand_on_floor(const Raycaster& raycaster, const DriveConfig& config, PathPoint& point) {
  point.position.z() = floor_height(raycaster, point.position).value_or(point.position.z());
  const Eigen::Vector2d ahead =
      0.5 * config.wheelbase * Eigen::Vector2d(std::cos(point.yaw), std::sin(point.yaw));
  const Eigen::Vector2d left =
      0.5 * config.track * Eigen::Vector2d(-std::sin(point.yaw), std::cos(point.yaw));
  const auto height = [&](double along, double across) {
    Vector3 wheel = point.position;
    wheel.head<2>() += along * ahead + across * left;
    const double z = floor_height(raycaster, wheel).value_or(wheel.z());
    const double floor = std::abs(z - wheel.z()) <= kHighestStep ? z : wheel.z();
    return config.bump_height == 0.0 ? floor : floor + config.bump_height * bump_at(wheel.x(), wheel.y());
  };
  const double front_left = height(1.0, 1.0);
  const double front_right = height(1.0, -1.0);
  const double rear_left = height(-1.0, 1.0);
  const double rear_right = height(-1.0, -1.0);
  point.slope_ahead = 0.5 * (front_left + front_right - rear_left - rear_right) / config.wheelbase;
  point.slope_left = 0.5 * (front_left + rear_left - front_right - rear_right) / config.track;
  point.position.z() = 0.25 * (front_left + front_right + rear_left + rear_right);
}

std::vector<double> moving_average(const std::vector<double>& values, std::size_t half_width) {
  std::vector<double> sums{0.0};
  for (const double value : values) sums.push_back(sums.back() + value);
  std::vector<double> means;
  means.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    // Symmetric up to the ends, where the window shrinks: a slope then keeps its value.
    const std::size_t half = std::min({half_width, i, values.size() - 1 - i});
    means.push_back((sums[i + half + 1] - sums[i - half]) / static_cast<double>(2 * half + 1));
  }
  return means;
}

// Stands for tyres and springs: a mean over a wheelbase, twice, so that speeds stay continuous.
template <class Member>
void spring(Path& path, std::size_t half_width, Member member) {
  std::vector<double> values;
  values.reserve(path.size());
  for (PathPoint& point : path) values.push_back(member(point));
  values = moving_average(moving_average(values, half_width), half_width);
  for (std::size_t i = 0; i < path.size(); ++i) member(path[i]) = values[i];
}

void follow_floor(const Raycaster& raycaster, const DriveConfig& config, Path& path) {
  for (PathPoint& point : path) {
    throw_if_cancelled();
    stand_on_floor(raycaster, config, point);
  }
  const double sample_length = config.corner_length / kSamplesPerCorner;
  const auto half_width = static_cast<std::size_t>(std::ceil(0.5 * config.wheelbase / sample_length));
  spring(path, half_width, [](PathPoint& p) -> double& { return p.position.z(); });
  spring(path, half_width, [](PathPoint& p) -> double& { return p.slope_ahead; });
  spring(path, half_width, [](PathPoint& p) -> double& { return p.slope_left; });
  for (std::size_t i = 1; i < path.size(); ++i) {
    path[i].distance = path[i - 1].distance + (path[i].position - path[i - 1].position).norm();
  }
}

// The fastest drive within the limits (forward and backward pass over v^2 = v0^2 + 2 a s), then all speeds
// times one factor, which keeps the shape and makes the mean exact.
void set_speeds(const DriveConfig& config, double mean_speed, const std::vector<std::size_t>& halts,
                Path& path) {
  const double two_a = 2.0 * config.acceleration;
  const auto limit = [&](PathPoint& point, const PathPoint& neighbour) {
    const double gap = std::abs(point.distance - neighbour.distance);
    point.speed = std::min(point.speed, std::sqrt(neighbour.speed * neighbour.speed + two_a * gap));
  };
  for (PathPoint& point : path) {
    point.speed = std::min(
        mean_speed, std::sqrt(config.lateral_acceleration / std::max(std::abs(point.curvature), 1e-9)));
  }
  path.front().speed = path.back().speed = 0.0;
  for (const std::size_t halt : halts) path[halt].speed = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) limit(path[i], path[i - 1]);
  for (std::size_t i = path.size() - 1; i-- > 0;) limit(path[i], path[i + 1]);
  for (std::size_t i = 1; i < path.size(); ++i) {
    path[i].time = path[i - 1].time +
                   2.0 * (path[i].distance - path[i - 1].distance) / (path[i].speed + path[i - 1].speed);
  }
  const double factor = mean_speed * path.back().time / path.back().distance;
  for (PathPoint& point : path) {
    point.speed *= factor;
    point.time /= factor;
  }
}

Pose T_world_base(const PathPoint& a, const PathPoint& b, double share) {
  const auto mix = [&](double from, double to) { return from + share * (to - from); };
  const double yaw = mix(a.yaw, b.yaw);
  const Vector3 ahead(std::cos(yaw), std::sin(yaw), mix(a.slope_ahead, b.slope_ahead));
  const Vector3 left(-std::sin(yaw), std::cos(yaw), mix(a.slope_left, b.slope_left));
  Matrix3 R;
  R.col(0) = ahead.normalized();
  R.col(2) = ahead.cross(left).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {R, a.position + share * (b.position - a.position)};
}

Pose pose_after(const Path& path, double driving_time) {
  const double time = std::clamp(driving_time, 0.0, path.back().time);
  const auto after = std::ranges::lower_bound(path.begin() + 1, path.end() - 1, time, {}, &PathPoint::time);
  const PathPoint& a = *(after - 1);
  const PathPoint& b = *after;
  const double t = time - a.time;
  const double acceleration = (b.speed - a.speed) / (b.time - a.time);
  const double share = (a.speed + 0.5 * acceleration * t) * t / (b.distance - a.distance);
  return T_world_base(a, b, std::clamp(share, 0.0, 1.0));
}

// How the body moves on its suspension or its legs: two robots of one kind neither in step nor equally fast.
class Sway {
 public:
  Sway(const DriveConfig& config, std::uint64_t seed) : config_(config) {
    constexpr double kSpread = 0.1;  // of the frequency, either way
    Rng rng(seed);
    hz_ = config.sway_hz * (1.0 + kSpread * (2.0 * rng.uniform() - 1.0));
    for (double* phase : {&roll_phase_, &pitch_phase_, &height_phase_})
      *phase = 2.0 * std::numbers::pi * rng.uniform();
  }
  // T_base_swaying, against the smooth line, at a share of the full speed.
  [[nodiscard]] Pose at(double time, double share) const {
    const double phase = 2.0 * std::numbers::pi * hz_ * time;
    const double roll = share * config_.sway_roll_deg * kDegree * std::sin(phase + roll_phase_);
    const double pitch = share * config_.sway_pitch_deg * kDegree * std::sin(2.0 * phase + pitch_phase_);
    const double height = share * config_.sway_height * 0.5 * (1.0 - std::cos(2.0 * phase + height_phase_));
    return {so3::exp(Vector3(roll, pitch, 0.0)), Vector3(0.0, 0.0, height)};
  }

 private:
  const DriveConfig& config_;
  double hz_ = 0.0;
  double roll_phase_ = 0.0;
  double pitch_phase_ = 0.0;
  double height_phase_ = 0.0;
};

Trajectory with_sway(Trajectory trajectory, const DriveConfig& config, double full_speed,
                     std::uint64_t seed) {
  if (config.sway_hz == 0.0) return trajectory;
  const Sway sway(config, seed);
  const Trajectory smooth = trajectory;
  for (std::size_t i = 1; i + 1 < smooth.size(); ++i) {
    const double moved =
        (smooth[i + 1].T_world_body.translation() - smooth[i - 1].T_world_body.translation()).norm();
    const double seconds = to_seconds(smooth[i + 1].stamp - smooth[i - 1].stamp);
    const double time = to_seconds(smooth[i].stamp - smooth.front().stamp);
    trajectory[i].T_world_body =
        smooth[i].T_world_body * sway.at(time, std::min(1.0, moved / seconds / full_speed));
  }
  return trajectory;
}

Trajectory sampled(const Path& path, const DriveConfig& config, const DriveClock& clock, Stamp start) {
  Trajectory trajectory;
  const double duration = config.stand_time + path.back().time + clock.lost_time();
  const auto last = static_cast<std::int64_t>(std::ceil(duration * config.sample_rate_hz));
  for (std::int64_t i = 0; i <= last; ++i) {
    const double time = static_cast<double>(i) / config.sample_rate_hz;
    const DriveClock::Reading now = clock.at(time - config.stand_time);
    Pose T_world_robot = pose_after(path, now.driving_time);
    if (now.turned != 0.0) T_world_robot = T_world_robot * Pose::planar(0.0, 0.0, now.turned);
    trajectory.push_back({start + from_seconds(time), T_world_robot});
  }
  return trajectory;
}

// The points of the path at which manoeuvres halt it.
std::vector<std::size_t> halts_on(const Path& path, const std::vector<Manoeuvre>& manoeuvres) {
  std::vector<std::size_t> halts;
  for (const Manoeuvre& m : manoeuvres) {
    const auto found =
        std::ranges::lower_bound(path, m.share * path.back().distance, {}, &PathPoint::distance);
    halts.push_back(
        static_cast<std::size_t>(std::clamp(found - path.begin(), std::ptrdiff_t{1}, std::ssize(path) - 2)));
  }
  return halts;
}

}  // namespace

Result<Trajectory> drive(const Raycaster& raycaster, const Route& route, const DriveConfig& config,
                         Stamp start, std::uint64_t seed) {
  const Result<std::vector<Vector3>> line = floor_line(raycaster, route);
  if (!line) return tl::unexpected(line.error());
  Path path = smoothed(*line, config.corner_length);
  if (const Result<> turns = unwrap_yaw(path, route.name); !turns) return tl::unexpected(turns.error());
  follow_floor(raycaster, config, path);
  const std::vector<Manoeuvre> manoeuvres = draw_manoeuvres(config.manoeuvres, path.back().distance, seed);
  const std::vector<std::size_t> halts = halts_on(path, manoeuvres);
  set_speeds(config, route.speed_mps, halts, path);
  std::vector<double> halt_times;
  for (const std::size_t halt : halts) halt_times.push_back(path[halt].time);
  const DriveClock clock(manoeuvres, halt_times);
  return with_sway(sampled(path, config, clock, start), config, route.speed_mps, mix64(seed, kSwayStream));
}

DriveConfig field_drive(DriveConfig config) {
  config.sway_hz = 1.3;
  config.sway_roll_deg = 0.5;
  config.sway_pitch_deg = 0.3;
  config.sway_height = 0.005;
  config.bump_height = 0.01;
  config.manoeuvres = field_manoeuvres();
  return config;
}

DriveConfig ideal_drive(DriveConfig config) {
  config.sway_hz = 0.0;
  config.bump_height = 0.0;
  config.manoeuvres = {};
  return config;
}

bool is_unsteady(const DriveConfig& config) { return config.sway_hz > 0.0 || config.bump_height > 0.0; }

}  // namespace adit
