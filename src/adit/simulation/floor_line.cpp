// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/floor_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/core/format.hpp"

namespace adit {
namespace {

// Metres.
constexpr double kPointSpacing = 1.0;  ///< Of the points on the floor between two waypoints.
constexpr double kWallHeight = 0.5;    ///< Above the floor, where walls are looked for: over kerbs and rails.
constexpr double kShortestRoute = 0.1;  ///< On a shorter one the robot would stand.
constexpr double kCrack = 1e-3;         ///< Width of a gap that is still floor: coordinates in millimetres.
constexpr double kPastSurface = 1e-3;   ///< From a surface that was met to where the search goes on.

std::string waypoint_text(const Route& route, std::size_t i) {
  const Vector3& p = route.waypoints[i];
  return format("{}: waypoint {} at ({:.2f}, {:.2f}, {:.2f})", route.name, i, p.x(), p.y(), p.z());
}

Result<> check_route(const Route& route) {
  for (std::size_t i = 0; i < route.waypoints.size(); ++i) {
    if (!route.waypoints[i].allFinite()) return fail(waypoint_text(route, i) + " is not finite");
  }
  if (!(std::isfinite(route.speed_mps) && route.speed_mps > 0.0)) {
    return fail(format("{}: a speed of {} m/s is not above 0", route.name, route.speed_mps));
  }
  if (route.waypoints.size() >= 2 && length_of(route) >= kShortestRoute) return {};
  return fail(format("{}: the route has {} waypoints over {:.2f} m; it needs two that are {} m apart or more",
                     route.name, route.waypoints.size(), length_of(route), kShortestRoute));
}

Result<std::vector<Vector3>> snapped_waypoints(const Raycaster& raycaster, const Route& route) {
  std::vector<Vector3> snapped = route.waypoints;
  for (std::size_t i = 0; i < snapped.size(); ++i) {
    const std::optional<double> height = floor_height(raycaster, snapped[i]);
    if (!height) {
      return fail(
          format("{} has no floor from {} m above to {} m below it; do routes and world belong together?",
                 waypoint_text(route, i), kFloorAbove, kFloorBelow));
    }
    snapped[i].z() = *height;
  }
  return snapped;
}

bool wall_between(const Raycaster& raycaster, const Vector3& a, const Vector3& b) {
  // Each ray begins a little before its segment: a wall that stands exactly on a point is then inside one of
  // the rays.
  constexpr double kOverlap = 0.02;
  const Vector3 step = b - a;
  if (step.norm() < 1e-3) return false;
  const Vector3 eye = a + Vector3(0.0, 0.0, kWallHeight) - kOverlap * step.normalized();
  return raycaster
      .cast({eye.cast<float>(), step.normalized().cast<float>()}, static_cast<float>(step.norm() + kOverlap))
      .hit();
}

// From a to b (not included) on the floor. A hole in the mesh is crossed on the straight line.
std::vector<Vector3> between(const Raycaster& raycaster, const Vector3& a, const Vector3& b) {
  std::vector<Vector3> points{a};
  const auto parts = static_cast<int>(std::ceil((b - a).norm() / kPointSpacing));
  for (int part = 1; part < parts; ++part) {
    Vector3 p = a + (static_cast<double>(part) / parts) * (b - a);
    p.z() = floor_height(raycaster, p).value_or(p.z());
    points.push_back(p);
  }
  return points;
}

// The surface nearest to p.z that is met exactly above or below p.
std::optional<double> surface_at(const Raycaster& raycaster, const Vector3& p) {
  const double lowest = p.z() - kFloorBelow;
  std::optional<double> nearest;
  for (double z = p.z() + kFloorAbove; z > lowest;) {
    const Ray down{Vector3(p.x(), p.y(), z).cast<float>(), -Eigen::Vector3f::UnitZ()};
    const RayHit hit = raycaster.cast(down, static_cast<float>(z - lowest));
    if (!hit.hit()) break;
    const double surface = static_cast<double>(down.origin.z()) - static_cast<double>(hit.distance);
    const bool is_farther = nearest && std::abs(surface - p.z()) >= std::abs(*nearest - p.z());
    if (is_farther) break;  // and so are all below it
    nearest = surface;
    z = std::min(surface, z) - kPastSurface;
  }
  return nearest;
}

}  // namespace

std::optional<double> floor_height(const Raycaster& raycaster, const Vector3& p) {
  if (const std::optional<double> surface = surface_at(raycaster, p)) return surface;
  for (const auto& [x, y] : {std::pair(kCrack, 0.0), {-kCrack, 0.0}, {0.0, kCrack}, {0.0, -kCrack}}) {
    if (const std::optional<double> beside = surface_at(raycaster, p + Vector3(x, y, 0.0))) return beside;
  }
  return std::nullopt;
}

Result<std::vector<Vector3>> floor_line(const Raycaster& raycaster, const Route& route) {
  if (const Result<> checked = check_route(route); !checked) return tl::unexpected(checked.error());
  Result<std::vector<Vector3>> snapped = snapped_waypoints(raycaster, route);
  if (!snapped) return snapped;
  std::vector<Vector3> line;
  for (std::size_t i = 0; i + 1 < snapped->size(); ++i) {
    std::vector<Vector3> points = between(raycaster, (*snapped)[i], (*snapped)[i + 1]);
    points.push_back((*snapped)[i + 1]);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      if (wall_between(raycaster, points[k], points[k + 1])) {
        return fail(format("{} and the next one have a wall between them", waypoint_text(route, i)));
      }
      line.push_back(points[k]);
    }
  }
  line.push_back(snapped->back());
  return line;
}

}  // namespace adit
