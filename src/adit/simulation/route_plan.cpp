// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/route_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/simulation/drivable_floor.hpp"
#include "adit/simulation/floor_line.hpp"
#include "adit/simulation/route_walks.hpp"

namespace adit {
namespace {

// Metres.
constexpr double kPlaceSpacing = 6.0;
constexpr double kWaypointSpacing = 1.0;
constexpr double kShortestPlan = 20.0;
constexpr double kSpur = 15.0;  ///< A loop of the way that is shorter is cut off.
constexpr int kSmoothings = 40;

using Cells = std::vector<std::uint32_t>;

bool touch(const DrivableFloor& floor, std::uint32_t a, std::uint32_t b) {
  return a == b || std::ranges::count(floor.cells[a].links, b) > 0;
}

/// The walk's cells. Where the way leads to the middle of a place and back, it is cut short.
Cells cells_along(const DrivableFloor& floor, const RouteNetwork& network, const Walk& walk) {
  const auto recent = static_cast<std::size_t>(kSpur / floor.cell_m);
  Cells cells{network.places[walk.front()].cell};
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const auto& ways = network.places[walk[i - 1]].ways;
    for (const std::uint32_t cell : std::ranges::find(ways, walk[i], &RouteEdge::to)->cells) {
      const std::size_t begin = cells.size() > recent ? cells.size() - recent : 0;
      const auto met = std::find_if(cells.begin() + static_cast<std::ptrdiff_t>(begin), cells.end(),
                                    [&](std::uint32_t before) { return touch(floor, before, cell); });
      if (met != cells.end()) cells.erase(met + 1, cells.end());
      if (cells.back() != cell) cells.push_back(cell);
    }
  }
  return cells;
}

/// Pulls the corners of the grid straight, as far as points stay on drivable cells.
std::vector<Vector3> smoothed_way(const DrivableFloor& floor, std::vector<Vector3> way) {
  for (int round = 0; round < kSmoothings; ++round) {
    const std::vector<Vector3> before = way;
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
      const Vector3 moved = 0.5 * before[i] + 0.25 * (before[i - 1] + before[i + 1]);
      if (floor.cell_at(moved)) way[i] = moved;
    }
  }
  return way;
}

/// Points about a metre apart, both ends included.
std::vector<Vector3> at_equal_distances(const std::vector<Vector3>& way) {
  if (way.size() < 2) return way;
  std::vector<double> passed{0.0};
  for (std::size_t i = 1; i < way.size(); ++i) passed.push_back(passed.back() + (way[i] - way[i - 1]).norm());
  const double parts = std::max(1.0, std::round(passed.back() / kWaypointSpacing));
  std::vector<Vector3> points;
  for (double k = 0.0; k < parts; k += 1.0) {
    const double at = passed.back() * k / parts;
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(passed, at) - passed.begin());
    const double share = (at - passed[next - 1]) / (passed[next] - passed[next - 1]);
    points.emplace_back(way[next - 1] + share * (way[next] - way[next - 1]));
  }
  points.push_back(way.back());
  return points;
}

double steepness(const Vector3& a, const Vector3& b) {
  const double level = (b - a).head<2>().norm();
  return level > 1e-6 ? std::abs(b.z() - a.z()) / level : 0.0;
}

/// The drivable cell nearest to `p`, of the column of p and those around it.
std::optional<std::uint32_t> cell_near(const DrivableFloor& floor, const Vector3& p) {
  std::optional<std::uint32_t> nearest = floor.cell_at(p);
  if (nearest) return nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [dx, dy] : kNeighbours) {
    const auto cell = floor.cell_at(p + floor.cell_m * Vector3(dx, dy, 0.0));
    if (!cell || (floor.cells[*cell].position - p).norm() >= least) continue;
    least = (floor.cells[*cell].position - p).norm();
    nearest = cell;
  }
  return nearest;
}

double clearance_at(const DrivableFloor& floor, const Raycaster& raycaster, const Vector3& p,
                    const RouteConfig& config) {
  const auto cell = cell_near(floor, p);
  const Eigen::Vector2d slope = cell ? floor.cells[*cell].slope : Eigen::Vector2d::Zero();
  return wall_distance(raycaster, p, slope, config);
}

/// Puts waypoints on the floor; those that came too near to a wall go back to the middle of their cell.
std::vector<Vector3> settled(const DrivableFloor& floor, const Raycaster& raycaster,
                             std::vector<Vector3> points, const RouteConfig& config) {
  for (Vector3& point : points) {
    point.z() = floor_height(raycaster, point).value_or(point.z());
    const auto cell = cell_near(floor, point);
    const bool is_on_floor = floor.cell_at(point).has_value();
    if (cell && (!is_on_floor || clearance_at(floor, raycaster, point, config) < config.half_width_m()))
      point = floor.cells[*cell].position;
  }
  return points;
}

PlannedRoute planned(const DrivableFloor& floor, const RouteNetwork& network, const Walk& walk,
                     const Raycaster& raycaster, const RouteConfig& config, std::size_t robot) {
  std::vector<Vector3> way;
  for (const std::uint32_t cell : cells_along(floor, network, walk))
    way.push_back(floor.cells[cell].position);
  PlannedRoute out;
  out.route.name = format("robot_{}", robot);
  out.route.speed_mps = config.speed_mps;
  out.route.waypoints =
      settled(floor, raycaster, at_equal_distances(smoothed_way(floor, std::move(way))), config);
  const std::vector<Vector3>& points = out.route.waypoints;
  out.clearance_m = kFarthestMargin;
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.clearance_m = std::min(out.clearance_m, clearance_at(floor, raycaster, points[i], config));
    if (i > 0)
      out.slope_deg = std::max(out.slope_deg, std::atan(steepness(points[i - 1], points[i])) / kDegree);
  }
  return out;
}

double longest_way(const RouteNetwork& network) {
  const auto farthest = [](const std::vector<double>& distances) {
    return static_cast<std::uint32_t>(std::ranges::max_element(distances) - distances.begin());
  };
  return std::ranges::max(distances_from(network, farthest(distances_from(network, 0))));
}

std::string other_parts_text(const DrivableFloor& floor) {
  if (floor.other_parts.empty()) return "";
  return format(
      "{} other parts of the floor cannot be reached from it, the largest at {}; passages between them may "
      "be too narrow, low or steep for routes.width_m, clearance_m, height_m or max_slope_deg",
      floor.other_parts.size(), place_text(floor.other_parts.front()));
}

Result<> check_extent(const DrivableFloor& floor, const RouteNetwork& network) {
  const double longest = longest_way(network);
  if (network.places.size() > 1 && longest >= kShortestPlan) return {};
  const std::string others = other_parts_text(floor);
  return fail(
      format("too small: the robot can drive on {:.0f} m² around {}, {:.0f} m from end to end, and a route "
             "needs {} m{}{}",
             floor.area_m2(), place_text(network.places.front().position), longest, kShortestPlan,
             others.empty() ? "; are its units metres?" : "; ", others));
}

std::vector<std::string> notes_of(const DrivableFloor& floor) {
  std::vector<std::string> notes;
  if (const std::string others = other_parts_text(floor); !others.empty()) notes.push_back(others);
  if (!floor.openings.empty())
    notes.push_back(
        format("the mesh is open at {} of the places that were looked at, for example at {}: portals, or "
               "holes; {:.1f} % of the rays from the floor meet nothing",
               floor.openings.size(), place_text(floor.openings.front()), 100.0 * floor.escaping_rays));
  return notes;
}

double covered_share(const RouteNetwork& network, const std::vector<Walk>& walks) {
  std::vector<std::uint32_t> passed;
  for (const Walk& walk : walks) passed.insert(passed.end(), walk.begin(), walk.end());
  std::ranges::sort(passed);
  const auto num_passed = std::unique(passed.begin(), passed.end()) - passed.begin();
  return static_cast<double>(num_passed) / static_cast<double>(network.places.size());
}

}  // namespace

Result<RoutePlan> plan_routes(const TriangleMesh& mesh, std::size_t num_robots, const RouteConfig& config) {
  ADIT_CHECK(num_robots > 0, "routes are of robots");
  RouteConfig checked = config;
  if (const Result<> ok = check_fields(fields_of(checked)); !ok) return tl::unexpected(ok.error());
  const Result<Raycaster> raycaster = Raycaster::build(mesh, EdgeRule::watertight);
  if (!raycaster) return tl::unexpected(raycaster.error());
  const Result<DrivableFloor> floor = drivable_floor(mesh, *raycaster, config);
  if (!floor) return tl::unexpected(floor.error());
  const RouteNetwork network = route_network(*floor, config, kPlaceSpacing);
  if (const Result<> large = check_extent(*floor, network); !large) return tl::unexpected(large.error());
  const std::vector<Walk> walks = choose_walks(network, num_robots, config);
  RoutePlan plan{std::vector<PlannedRoute>(num_robots), floor->area_m2(), covered_share(network, walks),
                 notes_of(*floor)};
  parallel_for_each(num_robots, [&](std::size_t robot) {
    plan.robots[robot] = planned(*floor, network, walks[robot], *raycaster, config, robot);
  });
  for (const PlannedRoute& robot : plan.robots)
    if (const auto line = floor_line(*raycaster, robot.route); !line) return tl::unexpected(line.error());
  return plan;
}

}  // namespace adit
