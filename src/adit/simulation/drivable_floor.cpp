// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/drivable_floor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/core/disjoint_sets.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/simulation/outlook.hpp"

namespace adit {
namespace {

constexpr std::size_t kFloorGrain = 256;
constexpr double kAboveFloor = 0.02;  ///< Metres: where rays start that look up.
constexpr double kRough = 0.1;        ///< Metres above what wheels climb that still is the floor's roughness.
/// A closed mesh has about as many roofs, seen from above, as grounds. Where grounds are so many times fewer,
/// the floor or the roof is missing.
constexpr std::size_t kFewGrounds = 3;
constexpr double kSmallestPart = 4.0;  ///< Square metres: smaller parts of the floor are not told of.
constexpr double kLargestFloor = 3e7;  ///< Samples of it.
constexpr float kFarAway = 1e6F;       ///< Metres: no mesh is as large.
constexpr double kLeaks = 0.15;  ///< A part of the floor is outside where more of its rays meet nothing.

/// A floor sample with free space above, and how it hangs together with those beside it.
struct Ground {
  FloorColumn column;
  Vector3 position = Vector3::Zero();
  std::array<std::uint32_t, 8> links{};
  bool at_drop = false;  ///< No floor follows in some direction, and no wall either.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double margin = 0.0;
  bool is_drivable = false;
};

/// Of all samples: what is above them.
struct Grounds {
  std::vector<Ground> list;
  std::vector<Vector3> open;  ///< Samples with nothing above at all.
  std::size_t num_low = 0;    ///< Those with less above than the robot needs.
  Vector3 highest_low = Vector3::Zero();
  double highest_m = 0.0;
};

Grounds with_headroom(const std::vector<FloorSample>& samples, const Raycaster& raycaster,
                      const RouteConfig& config) {
  std::vector<float> free(samples.size());
  const auto position = [&](const FloorSample& s) {
    return Vector3((s.column.x + 0.5) * config.cell_m, (s.column.y + 0.5) * config.cell_m, s.z);
  };
  parallel_for_each(
      samples.size(),
      [&](std::size_t i) {
        const Vector3 eye = position(samples[i]) + kAboveFloor * Vector3::UnitZ();
        free[i] = raycaster.cast({eye.cast<float>(), Eigen::Vector3f::UnitZ()}, kFarAway).distance;
      },
      kFloorGrain);
  Grounds grounds;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (free[i] == RayHit::kMiss) {
      grounds.open.push_back(position(samples[i]));
    } else if (const double headroom = static_cast<double>(free[i]) + kAboveFloor;
               headroom < config.height_m) {
      ++grounds.num_low;
      if (headroom <= grounds.highest_m) continue;
      grounds.highest_m = headroom;
      grounds.highest_low = position(samples[i]);
    } else {
      Ground& ground = grounds.list.emplace_back();
      ground.column = samples[i].column;
      ground.position = position(samples[i]);
      ground.links.fill(FloorCell::kNone);
    }
  }
  return grounds;
}

/// The ground beside `from` in that direction that is nearest in height and no steeper than the robot climbs.
std::uint32_t next_ground(const std::vector<Ground>& grounds, std::uint32_t from, std::size_t direction,
                          const RouteConfig& config) {
  const auto [dx, dy] = kNeighbours[direction];
  const Ground& ground = grounds[from];
  double nearest =
      std::hypot(dx, dy) * config.cell_m * std::tan(config.max_slope_deg * kDegree) + config.max_step_m;
  std::uint32_t best = FloorCell::kNone;
  for (const Ground& other : in_column(grounds, {ground.column.x + dx, ground.column.y + dy})) {
    const double rise = std::abs(other.position.z() - ground.position.z());
    if (rise > nearest) continue;
    nearest = rise;
    best = static_cast<std::uint32_t>(&other - grounds.data());
  }
  return best;
}

std::array<double, 3> looking_heights(const RouteConfig& config) {
  const double low = std::min(config.max_step_m + kRough, 0.5 * config.height_m);
  return {low, 0.5 * (low + config.height_m), config.height_m};
}

bool is_blocked(const Raycaster& raycaster, const Vector3& from, const Vector3& to,
                const RouteConfig& config) {
  const Vector3 way = to - from;
  return std::ranges::any_of(looking_heights(config), [&](double height) {
    const Vector3 eye = from + height * Vector3::UnitZ();
    return raycaster.cast({eye.cast<float>(), way.normalized().cast<float>()}, static_cast<float>(way.norm()))
        .hit();
  });
}

void link(std::vector<Ground>& grounds, const Raycaster& raycaster, const RouteConfig& config) {
  parallel_for_each(
      grounds.size(),
      [&](std::size_t i) {
        Ground& ground = grounds[i];
        for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
          const std::uint32_t next = next_ground(grounds, static_cast<std::uint32_t>(i), d, config);
          const Vector3 level(kNeighbours[d][0] * config.cell_m, kNeighbours[d][1] * config.cell_m, 0.0);
          const bool is_next = next != FloorCell::kNone;
          const Vector3 there = is_next ? grounds[next].position : Vector3(ground.position + level);
          const bool blocked = is_blocked(raycaster, ground.position, there, config);
          if (is_next && !blocked) ground.links[d] = next;
          if (!is_next && !blocked) ground.at_drop = true;
        }
      },
      kFloorGrain);
  // Both ends have to agree. What one of them sees in its way is in the way of both.
  std::vector<std::array<std::uint32_t, 8>> mutual(grounds.size());
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
      const std::uint32_t next = grounds[i].links[d];
      const bool agreed = next != FloorCell::kNone && grounds[next].links[(d + 4) % 8] == i;
      mutual[i][d] = agreed ? next : FloorCell::kNone;
    }
  }
  for (std::size_t i = 0; i < grounds.size(); ++i) grounds[i].links = mutual[i];
}

/// Rise of the floor along x and y: of the plane through a ground and those within two links of it.
Eigen::Vector2d slope_at(const std::vector<Ground>& grounds, std::uint32_t i) {
  const Vector3& middle = grounds[i].position;
  Eigen::Matrix2d squares = 1e-6 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d products = Eigen::Vector2d::Zero();
  const auto add = [&](const Vector3& p) {
    const Vector3 way = p - middle;
    squares += way.head<2>() * way.head<2>().transpose();
    products += way.z() * way.head<2>();
  };
  for (const std::uint32_t first : grounds[i].links) {
    if (first == FloorCell::kNone) continue;
    add(grounds[first].position);
    for (const std::uint32_t second : grounds[first].links)
      if (second != FloorCell::kNone) add(grounds[second].position);
  }
  return squares.ldlt().solve(products);
}

/// Whether the floor is steeper than that over the length of a robot: as a whole, or two cells ahead.
bool is_steep(const std::vector<Ground>& grounds, std::uint32_t i, double steepest) {
  if (grounds[i].slope.norm() > steepest) return true;
  for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
    const std::uint32_t next = grounds[i].links[d];
    const std::uint32_t second = next == FloorCell::kNone ? next : grounds[next].links[d];
    if (second == FloorCell::kNone) continue;
    const Vector3 way = grounds[second].position - grounds[i].position;
    if (std::abs(way.z()) > steepest * way.head<2>().norm()) return true;
  }
  return false;
}

using Queued = std::pair<double, std::uint32_t>;  // distance, ground
using Queue = std::priority_queue<Queued, std::vector<Queued>, std::greater<>>;

/// Distance of each ground from the nearest drop along the floor, up to kFarthestMargin.
std::vector<double> drop_distances(const std::vector<Ground>& grounds, double cell) {
  std::vector<double> distance(grounds.size(), kFarthestMargin);
  Queue queue;
  const auto reach = [&](std::uint32_t i, double d) {
    if (d >= distance[i]) return;
    distance[i] = d;
    queue.emplace(d, i);
  };
  for (std::uint32_t i = 0; i < grounds.size(); ++i)
    if (grounds[i].at_drop) reach(i, 0.5 * cell);
  while (!queue.empty()) {
    const auto [d, i] = queue.top();
    queue.pop();
    if (d > distance[i]) continue;
    for (const std::uint32_t next : grounds[i].links)
      if (next != FloorCell::kNone) reach(next, d + (grounds[next].position - grounds[i].position).norm());
  }
  return distance;
}

void find_drivable(std::vector<Ground>& grounds, const Raycaster& raycaster, const RouteConfig& config) {
  const std::vector<double> drops = drop_distances(grounds, config.cell_m);
  const double steepest = std::tan(config.max_slope_deg * kDegree);
  parallel_for_each(
      grounds.size(),
      [&](std::size_t i) {
        Ground& ground = grounds[i];
        ground.slope = slope_at(grounds, static_cast<std::uint32_t>(i));
        ground.margin = std::min(drops[i], wall_distance(raycaster, ground.position, ground.slope, config));
        ground.is_drivable = ground.margin >= config.half_width_m() &&
                             !is_steep(grounds, static_cast<std::uint32_t>(i), steepest);
      },
      kFloorGrain);
}

/// Connected drivable grounds, the largest part first.
std::vector<std::vector<std::uint32_t>> parts_of(const std::vector<Ground>& grounds) {
  DisjointSets sets(grounds.size());
  for (std::uint32_t i = 0; i < grounds.size(); ++i)
    for (const std::uint32_t next : grounds[i].links)
      if (next != FloorCell::kNone && grounds[i].is_drivable && grounds[next].is_drivable) sets.join(i, next);
  std::vector<std::vector<std::uint32_t>> by_root(grounds.size());
  for (std::uint32_t i = 0; i < grounds.size(); ++i)
    if (grounds[i].is_drivable) by_root[sets.find(i)].push_back(i);
  std::erase_if(by_root, [](const auto& part) { return part.empty(); });
  std::ranges::stable_sort(by_root, std::greater<>(), [](const auto& part) { return part.size(); });
  return by_root;
}

std::vector<Vector3> positions_of(const std::vector<Ground>& grounds,
                                  const std::vector<std::uint32_t>& part) {
  std::vector<Vector3> positions;
  for (const std::uint32_t i : part) positions.push_back(grounds[i].position);
  return positions;
}

/// A part of the floor inside of the mesh.
struct InsidePart {
  std::vector<std::uint32_t> grounds;
  Outlook around;
};

/// The floor's surface has two sides, and so has a roof: parts in the rock are left out. Rays from there
/// escape, or where the rock is closed, too, they meet the back of what faces the tunnels.
Result<std::vector<InsidePart>> inside_parts(const std::vector<Ground>& grounds,
                                             std::vector<std::vector<std::uint32_t>> parts,
                                             const Raycaster& raycaster, const RouteConfig& config) {
  std::vector<InsidePart> inside;
  std::optional<Outlook> leaking;
  const double cell_area = config.cell_m * config.cell_m;
  for (std::vector<std::uint32_t>& part : parts) {
    if (!inside.empty() && static_cast<double>(part.size()) * cell_area < kSmallestPart) break;
    const Outlook around = look_around(positions_of(grounds, part), 0.5 * config.height_m, raycaster);
    if (around.escaping <= kLeaks)
      inside.push_back({std::move(part), around});
    else if (!leaking)
      leaking = around;
  }
  if (inside.empty())
    return fail(
        format("the mesh is not closed: of the rays from its floor {:.0f} % meet nothing, most of them at "
               "{}; it needs a roof and walls without large holes",
               100.0 * leaking->escaping, place_text(leaking->widest_open)));
  const bool front_exists = std::ranges::any_of(inside, [](const auto& p) { return p.around.facing > 0.7; });
  if (front_exists) std::erase_if(inside, [](const InsidePart& p) { return p.around.facing < 0.3; });
  return inside;
}

DrivableFloor floor_of(const std::vector<Ground>& grounds, std::vector<InsidePart> parts, double cell) {
  DrivableFloor floor;
  floor.cell_m = cell;
  const InsidePart& largest = parts.front();
  std::vector<std::uint32_t> number(grounds.size(), FloorCell::kNone);
  for (std::uint32_t k = 0; k < largest.grounds.size(); ++k) number[largest.grounds[k]] = k;
  for (const std::uint32_t i : largest.grounds) {
    FloorCell& floor_cell = floor.cells.emplace_back();
    floor_cell.column = grounds[i].column;
    floor_cell.position = grounds[i].position;
    floor_cell.slope = grounds[i].slope;
    floor_cell.margin = grounds[i].margin;
    for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
      const std::uint32_t next = grounds[i].links[d];
      floor_cell.links[d] = next == FloorCell::kNone ? FloorCell::kNone : number[next];
    }
  }
  for (std::size_t p = 1; p < parts.size(); ++p)
    floor.other_parts.push_back(grounds[parts[p].grounds.front()].position);
  floor.escaping_rays = largest.around.escaping;
  floor.openings = largest.around.openings;
  return floor;
}

Result<> check_size(const TriangleMesh& mesh, const RouteConfig& config) {
  double plan_area = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) {
      return mesh.vertices[static_cast<std::size_t>(t[i])].head<2>().cast<double>();
    };
    const Eigen::Vector2d u = corner(1) - corner(0);
    const Eigen::Vector2d v = corner(2) - corner(0);
    plan_area += 0.5 * std::abs(u.x() * v.y() - u.y() * v.x());
  }
  const double largest = kLargestFloor * config.cell_m * config.cell_m;
  const double extent = static_cast<double>(
      bounding_box(mesh).max().cwiseAbs().cwiseMax(bounding_box(mesh).min().cwiseAbs()).maxCoeff());
  if (extent > 1e5)
    return fail(
        format("a coordinate is {:.0f} m, where single precision tells no centimetres apart; move the mesh "
               "to the origin",
               extent));
  if (plan_area <= largest) return {};
  return fail(
      format("seen from above its triangles cover {:.3g} m²; is the unit metres? If it is, set "
             "routes.cell_m to {:.1f} or more",
             plan_area, std::sqrt(plan_area / kLargestFloor)));
}

/// Whether surfaces that nothing is above are the roof of passages whose floor is missing: walls go down from
/// them, where from the floor of a pit they go up.
bool are_roofs(const std::vector<Vector3>& open, const Raycaster& raycaster, const RouteConfig& config) {
  constexpr std::size_t kSamples = 1000;
  const std::size_t stride = (open.size() + kSamples - 1) / kSamples;
  int above = 0;
  int below = 0;
  for (std::size_t i = 0; i < open.size(); i += stride) {
    for (const auto& [dx, dy] : kNeighbours) {
      const Eigen::Vector3f ahead =
          Eigen::Vector3f(static_cast<float>(dx), static_cast<float>(dy), 0).normalized();
      const auto meets_wall = [&](double height) {
        const Eigen::Vector3f eye = (open[i] + height * Vector3::UnitZ()).cast<float>();
        return raycaster.cast({eye, ahead}, kFarAway).hit();
      };
      above += meets_wall(0.5 * config.height_m) ? 1 : 0;
      below += meets_wall(-0.5 * config.height_m) ? 1 : 0;
    }
  }
  return below > above;
}

Error no_floor(const TriangleMesh& mesh, const Raycaster& raycaster, const Grounds& grounds,
               const RouteConfig& config) {
  const Eigen::Vector3f size = bounding_box(mesh).sizes();
  if (grounds.num_low > 0 && grounds.num_low >= grounds.open.size())
    return {format(
        "no floor is high enough: the robot needs {} m, and there are {:.2f} m at {}; see routes.height_m; "
        "are the units of the mesh metres?",
        config.height_m, grounds.highest_m, place_text(grounds.highest_low))};
  if (!grounds.open.empty() && are_roofs(grounds.open, raycaster, config))
    return {format(
        "no floor: what is level are roofs with nothing below them, for example at {}; the mesh has to hold "
        "the floor that the robot drives on",
        place_text(grounds.open.front()))};
  if (!grounds.open.empty())
    return {format(
        "no roof: nothing is above the floor, for example at {}; the mesh has to be closed, so that rays "
        "from the sensor meet something",
        place_text(grounds.open.front()))};
  return {format(
      "no floor: all surfaces are steeper than 60 degrees or smaller than the grid of routes.cell_m; the "
      "mesh is {:.1f} x {:.1f} x {:.1f} m: is z upwards, and are its units metres?",
      size.x(), size.y(), size.z())};
}

/// Whether no part, if there is any, is large enough to be told of.
bool are_all_small(const std::vector<std::vector<std::uint32_t>>& parts, double cell) {
  return std::ranges::all_of(parts, [&](const auto& part) {
    return static_cast<double>(part.size()) * cell * cell < kSmallestPart;
  });
}

Error too_narrow(const std::vector<Ground>& grounds, const RouteConfig& config) {
  const Ground& widest = *std::ranges::max_element(grounds, {}, &Ground::margin);
  return {format(
      "no floor is wide enough: the robot needs {:.2f} m to each side and a slope below {} degrees; the "
      "widest place, at {}, has {:.2f} m and a slope of {:.0f} degrees; see routes.width_m, "
      "routes.clearance_m, routes.max_slope_deg and, for passages narrower than three cells, "
      "routes.cell_m",
      config.half_width_m(), config.max_slope_deg, place_text(widest.position), widest.margin,
      std::atan(widest.slope.norm()) / kDegree)};
}

}  // namespace

std::string place_text(const Vector3& p) { return format("({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z()); }

std::optional<std::uint32_t> DrivableFloor::cell_at(const Vector3& p) const {
  std::optional<std::uint32_t> best;
  double nearest = 1.0;
  for (const FloorCell& cell : in_column(cells, column_of(p, cell_m))) {
    const double rise = std::abs(cell.position.z() - p.z());
    if (rise > nearest) continue;
    nearest = rise;
    best = static_cast<std::uint32_t>(&cell - cells.data());
  }
  return best;
}

double wall_distance(const Raycaster& raycaster, const Vector3& p, const Eigen::Vector2d& slope,
                     const RouteConfig& config) {
  constexpr int kDirections = 16;
  double nearest = kFarthestMargin;
  for (const double height : looking_heights(config)) {
    const Eigen::Vector3f eye = (p + height * Vector3::UnitZ()).cast<float>();
    for (int k = 0; k < kDirections; ++k) {
      const double yaw = 2.0 * std::numbers::pi * k / kDirections;
      const Eigen::Vector2d ahead(std::cos(yaw), std::sin(yaw));
      const Vector3 direction(ahead.x(), ahead.y(), slope.dot(ahead));
      const double stretch = direction.norm();
      const RayHit hit =
          raycaster.cast({eye, (direction / stretch).cast<float>()}, static_cast<float>(nearest * stretch));
      if (hit.hit()) nearest = std::min(nearest, static_cast<double>(hit.distance) / stretch);
    }
  }
  return nearest;
}

Result<DrivableFloor> drivable_floor(const TriangleMesh& mesh, const Raycaster& raycaster,
                                     const RouteConfig& config) {
  if (const Result<> checked = check_size(mesh, config); !checked) return tl::unexpected(checked.error());
  const Phase phase("looking for floor", 4);
  Grounds grounds = with_headroom(floor_samples(mesh, config.cell_m), raycaster, config);
  phase.advance();
  if (grounds.list.empty()) return tl::unexpected(no_floor(mesh, raycaster, grounds, config));
  link(grounds.list, raycaster, config);
  phase.advance();
  find_drivable(grounds.list, raycaster, config);
  phase.advance();
  std::vector<std::vector<std::uint32_t>> parts = parts_of(grounds.list);
  if (are_all_small(parts, config.cell_m)) {
    // Ledges and the like are left where the floor or the roof is missing.
    if (grounds.list.size() * kFewGrounds < grounds.open.size())
      return tl::unexpected(no_floor(mesh, raycaster, grounds, config));
    if (parts.empty()) return tl::unexpected(too_narrow(grounds.list, config));
  }
  return inside_parts(grounds.list, std::move(parts), raycaster, config)
      .map([&](std::vector<InsidePart> inside) {
        return floor_of(grounds.list, std::move(inside), config.cell_m);
      });
}

}  // namespace adit
