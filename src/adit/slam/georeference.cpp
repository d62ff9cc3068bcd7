// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/georeference.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/io/crs.hpp"
#include "adit/io/tum.hpp"
#include "adit/registration/control_fit.hpp"
#include "adit/robot/full_rate.hpp"

namespace adit {
namespace {

using Matrix36 = Eigen::Matrix<double, 3, 6>;
using Eigen::Index;

/// A control point with its mark bound to a keyframe.
struct BoundControl {
  ControlPoint point;
  Place place;

  [[nodiscard]] std::size_t shared_map(const PlacedSession& session) const {
    return session.robots[place.robot].shared_map;
  }
  [[nodiscard]] Vector3 in_map(const PlacedSession& session) const {
    return place.T_map_keyframe(session) * point.mark.position;
  }
};

Result<std::size_t> robot_called(const PlacedSession& session, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < session.robots.size(); ++i) {
    if (session.robots[i].map->name == name) return i;
    names.push_back(session.robots[i].map->name);
  }
  return fail(format("no robot is called '{}'; there are {}", name, fmt::join(names, ", ")));
}

BoundControl bound_to(const PlacedSession& session, ControlPoint point, const Place& place,
                      const Vector3& in_keyframe) {
  const RobotMap& map = *session.robots[place.robot].map;
  point.mark.robot = map.name;
  point.mark.stamp = map.keyframes[place.keyframe].stamp;
  point.mark.position = in_keyframe;
  point.mark.is_in_lidar_frame = false;
  return {std::move(point), place};
}

/// Where a mark in a scan is in the base frame of its robot.
Result<Vector3> in_base_frame(const PlacedSession& session, const ControlMark& mark) {
  if (!mark.is_in_lidar_frame) return mark.position;
  const std::vector<RobotProvenance>& mapped = session.saved.provenance.robots;
  const auto of_map =
      std::ranges::find_if(mapped, [&](const RobotProvenance& robot) { return robot.is_of_map(mark.robot); });
  if (of_map != mapped.end() && of_map->T_base_lidar) return *of_map->T_base_lidar * mark.position;
  return fail(format(
      "its mark is in the LiDAR's frame, and the session does not say where the LiDAR of {} sits: it moves "
      "on the robot, the clouds were in another frame, or adit study or an earlier version mapped it; give "
      "the mark in the base frame, or map the recording again",
      mark.robot));
}

/// A mark in a scan: bound to the keyframe nearest in time.
Result<BoundControl> bind_in_scan(const PlacedSession& session, const ControlPoint& point,
                                  std::size_t robot) {
  const PlacedRobot& placed = session.robots[robot];
  const Result<Pose> T_map_base =
      pose_at(at_every_scan(*placed.map, placed.T_world_keyframe), *point.mark.stamp);
  if (!T_map_base) return fail(placed.map->name, T_map_base.error());
  const Result<Vector3> in_base = in_base_frame(session, point.mark);
  if (!in_base) return tl::unexpected(in_base.error());
  const auto nearest = std::ranges::min_element(placed.map->keyframes, {}, [&](const Keyframe& keyframe) {
    return std::chrono::abs(keyframe.stamp - *point.mark.stamp);
  });
  const Place place{robot, static_cast<std::size_t>(nearest - placed.map->keyframes.begin())};
  return bound_to(session, point, place, place.T_map_keyframe(session).inverse() * (*T_map_base * *in_base));
}

/// A mark picked in a map: bound to the keyframe nearest to it.
Result<BoundControl> bind_in_map(const PlacedSession& session, const ControlPoint& point,
                                 std::size_t shared_map) {
  constexpr double kFarthest = 300.0;  // metres
  Place nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < session.robots.size(); ++r) {
    if (session.robots[r].shared_map != shared_map) continue;
    for (std::size_t k = 0; k < session.robots[r].T_world_keyframe.size(); ++k) {
      const double distance =
          (session.robots[r].T_world_keyframe[k].translation() - point.mark.position).norm();
      if (distance >= least) continue;
      least = distance;
      nearest = {r, k};
    }
  }
  if (!(least < kFarthest))
    return fail(format(
        "its mark is {:.0f} m from where any robot was; mark_x, mark_y and mark_z are picked in map.ply of "
        "the session, before any transform",
        least));
  return bound_to(session, point, nearest, nearest.T_map_keyframe(session).inverse() * point.mark.position);
}

Result<BoundControl> bind(const PlacedSession& session, const ControlPoint& point) {
  if (point.mark.robot.empty()) return bind_in_map(session, point, 0);
  const Result<std::size_t> robot = robot_called(session, point.mark.robot);
  if (!robot) return tl::unexpected(robot.error());
  return point.mark.stamp ? bind_in_scan(session, point, *robot)
                          : bind_in_map(session, point, session.robots[*robot].shared_map);
}

/// The derivative of a point of a keyframe, in the map, by that keyframe's pose.
Matrix36 point_jacobian(const Pose& T_map_keyframe, const Vector3& in_keyframe) {
  Matrix36 J;
  J.leftCols<3>() = T_map_keyframe.rotation_matrix();
  J.rightCols<3>() = -J.leftCols<3>() * so3::hat(in_keyframe);
  return J;
}

/// The derivatives of all marks by their keyframes, one block each.
Eigen::MatrixXd mark_jacobian(const PlacedSession& session, const std::vector<BoundControl>& points) {
  const auto num = static_cast<Index>(points.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * num, 6 * num);
  for (Index i = 0; i < num; ++i) {
    const BoundControl& bound = points[static_cast<std::size_t>(i)];
    J.block<3, 6>(3 * i, 6 * i) =
        point_jacobian(bound.place.T_map_keyframe(session), bound.point.mark.position);
  }
  return J;
}

std::vector<Place> places_of(const std::vector<BoundControl>& points) {
  std::vector<Place> places;
  for (const BoundControl& bound : points) places.push_back(bound.place);
  return places;
}

ControlPairs pairs_of(const PlacedSession& session, const std::vector<BoundControl>& points,
                      const MapCovariance& covariance) {
  ControlPairs pairs;
  const Eigen::MatrixXd J = mark_jacobian(session, points);
  const std::vector<Place> places = places_of(points);
  const Eigen::MatrixXd of_marks = J * covariance.cross(places, places) * J.transpose();
  pairs.source_covariance = 0.5 * (of_marks + of_marks.transpose());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ControlPoint& point = points[i].point;
    pairs.names.push_back(point.name);
    pairs.target.push_back(point.target);
    pairs.target_sigma.emplace_back(point.sigma_xy, point.sigma_xy, point.sigma_z);
    pairs.source.push_back(points[i].in_map(session));
    pairs.is_check.push_back(point.is_check);
    pairs.source_covariance.diagonal().segment<3>(3 * static_cast<Index>(i)).array() +=
        point.mark.sigma * point.mark.sigma;
  }
  return pairs;
}

/// Some keyframes of each robot of a map, evenly, the last one among them.
std::vector<Place> sample_of(const PlacedSession& session, std::size_t shared_map) {
  constexpr std::size_t kOfARobot = 32;
  std::vector<Place> places;
  for (std::size_t r = 0; r < session.robots.size(); ++r) {
    const std::size_t num = session.robots[r].T_world_keyframe.size();
    if (session.robots[r].shared_map != shared_map) continue;
    const std::size_t taken = std::min(num, kOfARobot);
    for (std::size_t i = 0; i < taken; ++i)
      places.push_back({r, taken == 1 ? 0 : i * (num - 1) / (taken - 1)});
  }
  return places;
}

/// Of T_target_base at those places: the errors of the map there, those of the transform, and what they
/// share, as marks lie in the map.
std::vector<Matrix6> in_target(const PlacedSession& session, const std::vector<BoundControl>& points,
                               const MapCovariance& covariance, const ControlFit& fit,
                               const std::vector<Place>& places) {
  // The transform's error by that of the marks: a mark that is too far is target - T * mark that is too
  // short.
  Eigen::MatrixXd by_marks = fit.gain;
  for (Index i = 0; i < by_marks.cols(); i += 3)
    by_marks.middleCols<3>(i) = (-by_marks.middleCols<3>(i) * fit.T_target_source.rotation_matrix()).eval();
  const Eigen::MatrixXd with_transform = covariance.cross(places, places_of(points)) *
                                         mark_jacobian(session, points).transpose() * by_marks.transpose();
  std::vector<Matrix6> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Matrix6 by_transform = places[i].T_map_keyframe(session).inverse().adjoint();
    const Matrix6 both = with_transform.middleRows<6>(6 * static_cast<Index>(i)) * by_transform.transpose();
    out.emplace_back(covariance.at(places[i]) + carry_covariance(by_transform, fit.covariance) + both +
                     both.transpose());
  }
  return out;
}

/// Where the place is known worst once the map is in the target frame.
FarEnd far_end_of(const PlacedSession& session, const std::vector<BoundControl>& points,
                  const MapCovariance& covariance, const ControlFit& fit) {
  const std::vector<Place> sample = sample_of(session, points.front().shared_map(session));
  const std::vector<Matrix6> in_base = in_target(session, points, covariance, fit, sample);
  FarEnd worst;
  for (std::size_t s = 0; s < sample.size(); ++s) {
    const Matrix3 R = (fit.T_target_source * sample[s].T_map_keyframe(session)).rotation_matrix();
    const Matrix3 all = R * in_base[s].topLeftCorner<3, 3>() * R.transpose();
    const double xy = 0.5 * (all(0, 0) + all(1, 1)) + std::hypot(0.5 * (all(0, 0) - all(1, 1)), all(0, 1));
    const FarEnd here{session.robots[sample[s].robot].map->name,
                      session.robots[sample[s].robot].map->keyframes[sample[s].keyframe].stamp,
                      std::sqrt(std::max(0.0, xy)), std::sqrt(std::max(0.0, all(2, 2)))};
    if (worst.robot.empty() ||
        std::max(here.sigma_xy, here.sigma_z) > std::max(worst.sigma_xy, worst.sigma_z))
      worst = here;
  }
  return worst;
}

ControlUse use_of(bool is_check, bool is_used, const std::optional<double>& misfit) {
  const bool agrees = !misfit || *misfit <= kControlBound;
  if (is_check) return agrees ? ControlUse::check : ControlUse::failed_check;
  return is_used ? ControlUse::used : ControlUse::rejected;
}

Georeference georeference_by(const PlacedSession& session, const std::vector<BoundControl>& points,
                             const ControlFit& fit, const FarEnd& far_end) {
  Georeference out;
  for (const PlacedRobot& robot : session.robots)
    if (robot.shared_map == points.front().shared_map(session)) out.robots.push_back(robot.map->name);
  out.T_target_map = fit.T_target_source;
  out.covariance = fit.covariance;
  for (std::size_t i = 0; i < points.size(); ++i)
    out.points.push_back({points[i].point, use_of(points[i].point.is_check, fit.used[i], fit.misfits[i]),
                          fit.residuals[i], fit.misfits[i]});
  out.chi2 = fit.chi2;
  out.redundancy = fit.redundancy;
  out.scale_ppm = 1e6 * (fit.scale - 1.0);
  out.scale_sigma_ppm = 1e6 * fit.scale_sigma;
  out.far_end = far_end;
  return out;
}

std::vector<std::string> notes_of(const Georeference& map) {
  std::vector<std::string> notes;
  const auto num_used = std::ranges::count(map.points, ControlUse::used, &JudgedControl::use);
  if (num_used == 3)
    notes.push_back(
        "three control points leave a blunder among them unseen where it keeps their distances; measure a "
        "fourth");
  if (std::abs(map.scale_ppm) > 3.0 * map.scale_sigma_ppm)
    notes.push_back(format(
        "the control points are {:+.0f} ppm larger than the map (standard deviation {:.0f}); is the grid "
        "to scale (UTM is up to 400 ppm smaller), and are all coordinates in metres?",
        map.scale_ppm, map.scale_sigma_ppm));
  return notes;
}

}  // namespace

Result<Georeferencing> georeference(const std::filesystem::path& session_path,
                                    const std::vector<ControlPoint>& points, const std::string& crs) {
  if (const Result<std::string> wkt = crs_wkt(crs); !wkt) return tl::unexpected(wkt.error());
  const Result<PlacedSession> session = read_placed_session(session_path);
  if (!session) return tl::unexpected(session.error());
  std::map<std::size_t, std::vector<BoundControl>> by_map;
  for (const ControlPoint& point : points) {
    Result<BoundControl> bound = bind(*session, point);
    if (!bound) return fail(format("control point '{}'", point.name), bound.error());
    by_map[bound->shared_map(*session)].push_back(std::move(*bound));
  }
  const Result<MapCovariance> covariance = MapCovariance::of(*session, session_path);
  if (!covariance) return tl::unexpected(covariance.error());
  Georeferencing out;
  for (const auto& [shared_map, of_map] : by_map) {
    const Result<ControlFit> fit = fit_control(pairs_of(*session, of_map, *covariance));
    if (!fit)
      return by_map.size() == 1 ? tl::unexpected(fit.error())
                                : fail("the map of " + of_map.front().point.mark.robot, fit.error());
    out.maps.push_back(
        georeference_by(*session, of_map, *fit, far_end_of(*session, of_map, *covariance, *fit)));
    out.maps.back().crs = crs;
    for (std::string& note : notes_of(out.maps.back())) out.notes.push_back(std::move(note));
  }
  for (const PlacedRobot& robot : session->robots)
    if (!by_map.contains(robot.shared_map))
      out.notes.push_back(robot.map->name + " is in a map without control points, which stays where it is");
  return out;
}

Result<std::vector<Matrix6>> target_covariances(const PlacedSession& session, const MapCovariance& covariance,
                                                const Georeference& map, const std::vector<Place>& places) {
  std::vector<BoundControl> points;
  for (const JudgedControl& judged : map.points) {
    Result<BoundControl> bound = bind(session, judged.point);
    if (!bound) return fail(format("control point '{}'", judged.point.name), bound.error());
    points.push_back(std::move(*bound));
  }
  const Result<ControlFit> fit = fit_control(pairs_of(session, points, covariance));
  if (!fit) return tl::unexpected(fit.error());
  constexpr double kSame = 1e-4;  // metres, radians
  if ((map.T_target_map.inverse() * fit->T_target_source).log().norm() > kSame)
    return fail(
        "the control points no longer place this map where georeference.toml has it; run adit georeference "
        "again");
  return in_target(session, points, covariance, *fit, places);
}

}  // namespace adit
