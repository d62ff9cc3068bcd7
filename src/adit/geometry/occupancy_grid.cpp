// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/occupancy_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/geometry/point_grid.hpp"

namespace adit {
namespace {

constexpr int kDirections = 720;
constexpr double kBaseCell = 5.0;  ///< Metres: edge of the cells of the grid of bases.

struct Looked {
  std::vector<std::size_t> free;
  std::vector<std::size_t> occupied;
};

/// What a scan saw of the plane, about the sensor: distances in metres, by direction of the world.
struct LookAround {
  std::array<double, kDirections> obstacle{};  ///< The nearest; infinite without one.
  std::array<double, kDirections> floor{};     ///< The farthest that was seen; 0 without.
  std::vector<Eigen::Vector2d> obstacles;
};

int direction_of(const Eigen::Vector2d& v) {
  const double turn = std::atan2(v.y(), v.x()) / (2.0 * std::numbers::pi);
  return static_cast<int>((turn - std::floor(turn)) * kDirections) % kDirections;
}

class Grid {
 public:
  Grid(const std::vector<PlacedScan>& scans, const OccupancyConfig& config) : config_(config) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low;
    std::vector<Eigen::Vector3f> bases;
    for (const PlacedScan& scan : scans) {
      const Vector3 sensor = scan.T_world_base * scan.viewpoint;
      low = low.cwiseMin(sensor.head<2>());
      high = high.cwiseMax(sensor.head<2>());
      bases.push_back(scan.T_world_base.translation().cast<float>());
      T_base_world_.push_back(scan.T_world_base.inverse());
    }
    bases_ = PointGrid(bases, kBaseCell);
    const double margin = config.reach_m + 2.0 * config.resolution_m;
    const auto cell = [&](double metres) { return std::floor(metres / config.resolution_m); };
    first_ = {cell(low.x() - margin), cell(low.y() - margin)};
    width_ = static_cast<std::size_t>(cell(high.x() + margin) - first_.x()) + 1;
    height_ = static_cast<std::size_t>(cell(high.y() + margin) - first_.y()) + 1;
  }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] Eigen::Vector2d origin() const { return config_.resolution_m * first_; }

  [[nodiscard]] Looked looked(const PlacedScan& scan) const {
    const Eigen::Vector2d sensor = (scan.T_world_base * scan.viewpoint).head<2>();
    const LookAround around = look_around(scan, sensor);
    Looked out;
    for (int d = 0; d < kDirections; ++d) {
      const auto i = static_cast<std::size_t>(d);
      const bool is_blocked = std::isfinite(around.obstacle[i]);
      add_ray(sensor, d, is_blocked ? around.obstacle[i] - config_.resolution_m : around.floor[i], out.free);
    }
    for (const Eigen::Vector2d& p : around.obstacles) out.occupied.push_back(index_of(p));
    for (std::vector<std::size_t>* cells : {&out.free, &out.occupied}) {
      std::ranges::sort(*cells);
      cells->erase(std::unique(cells->begin(), cells->end()), cells->end());
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t index_of(const Eigen::Vector2d& p) const {
    const auto column = static_cast<std::size_t>(std::floor(p.x() / config_.resolution_m) - first_.x());
    const auto row = static_cast<std::size_t>(std::floor(p.y() / config_.resolution_m) - first_.y());
    return row * width_ + column;
  }
  /// Above the floor on which the base nearest to the point stood.
  [[nodiscard]] double height_of(const Vector3& p) const {
    const auto nearest = bases_.nearest(p.cast<float>());
    ADIT_CHECK(nearest.has_value(), "there are scans");
    return (T_base_world_[nearest->index] * p).z();
  }
  [[nodiscard]] LookAround look_around(const PlacedScan& scan, const Eigen::Vector2d& sensor) const {
    LookAround around;
    around.obstacle.fill(std::numeric_limits<double>::infinity());
    for (const Eigen::Vector3f& point : scan.cloud_base->points) {
      const Vector3 p = scan.T_world_base * Vector3(point.cast<double>());
      const Eigen::Vector2d off = p.head<2>() - sensor;
      const double metres = off.norm();
      if (!(metres < config_.reach_m)) continue;
      const double height = height_of(p);
      const auto direction = static_cast<std::size_t>(direction_of(off));
      if (height > config_.lowest_m && height < config_.highest_m) {
        around.obstacle[direction] = std::min(around.obstacle[direction], metres);
        around.obstacles.emplace_back(p.head<2>());
      } else if (std::abs(height) <= config_.lowest_m) {
        around.floor[direction] = std::max(around.floor[direction], metres);
      }
    }
    return around;
  }
  void add_ray(const Eigen::Vector2d& sensor, int direction, double metres,
               std::vector<std::size_t>& cells) const {
    const double angle = 2.0 * std::numbers::pi * (direction + 0.5) / kDirections;
    const Eigen::Vector2d step =
        0.5 * config_.resolution_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const auto num = static_cast<int>(metres / (0.5 * config_.resolution_m));
    for (int i = 0; i <= num; ++i) cells.push_back(index_of(sensor + i * step));
  }

  OccupancyConfig config_;
  Eigen::Vector2d first_;  ///< Of the cells, in cells from the world's origin.
  std::size_t width_ = 0;
  std::size_t height_ = 0;
  PointGrid bases_;
  std::vector<Pose> T_base_world_;
};

}  // namespace

CellState OccupancyGrid::at(double x, double y) const {
  // Cells begin at multiples of their edge, here as where they were filled.
  const double column = std::floor(x / resolution_m) - std::round(origin.x() / resolution_m);
  const double row = std::floor(y / resolution_m) - std::round(origin.y() / resolution_m);
  if (!(column >= 0.0 && row >= 0.0)) return CellState::unknown;
  if (column >= static_cast<double>(width) || row >= static_cast<double>(height)) return CellState::unknown;
  return cells[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)];
}

Result<OccupancyGrid> occupancy_of(const std::vector<PlacedScan>& scans, const OccupancyConfig& config) {
  constexpr std::size_t kMostCells = 400'000'000;
  if (scans.empty()) return fail("there are no scans to make a grid of");
  if (!(config.lowest_m < config.highest_m))
    return fail(
        format("grid.lowest_m ({}) has to be less than grid.highest_m ({}): nothing would be an obstacle",
               config.lowest_m, config.highest_m));
  const Grid grid(scans, config);
  OccupancyGrid out{config.resolution_m, grid.origin(), grid.width(), grid.height(), {}};
  if (out.width > kMostCells / out.height)
    return fail(format("a grid of {} by {} cells is too large; choose a resolution of more than {} m",
                       out.width, out.height, config.resolution_m));
  struct Seen {
    std::uint16_t free = 0;
    std::uint16_t occupied = 0;
  };
  std::vector<Seen> seen(out.width * out.height);
  const auto count = [](std::uint16_t& number) {
    if (number < std::numeric_limits<std::uint16_t>::max()) ++number;
  };
  constexpr std::size_t kAtOnce = 64;  // scans
  for (std::size_t first = 0; first < scans.size(); first += kAtOnce) {
    std::vector<Looked> looked(std::min(kAtOnce, scans.size() - first));
    parallel_for_each(looked.size(), [&](std::size_t i) { looked[i] = grid.looked(scans[first + i]); });
    for (const Looked& one : looked) {
      for (const std::size_t cell : one.free) count(seen[cell].free);
      for (const std::size_t cell : one.occupied) count(seen[cell].occupied);
    }
  }
  constexpr int kFreeOverOccupied = 3;  // a wall is looked past now and then, where a cell is larger than it
  for (const Seen& cell : seen)
    out.cells.push_back(cell.free == 0 && cell.occupied == 0            ? CellState::unknown
                        : cell.free > kFreeOverOccupied * cell.occupied ? CellState::free
                                                                        : CellState::occupied);
  return out;
}

}  // namespace adit
