// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/simulation/floor_samples.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/route_config.hpp"

namespace adit {

/// A place on the floor where the robot can stand, turned in any direction.
struct FloorCell {
  static constexpr std::uint32_t kNone = ~0U;       ///< In `links`: no cell.
  FloorColumn column;                               ///< In the grid of DrivableFloor::cell_m.
  Vector3 position;                                 ///< On the floor, metres.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< Rise of the floor along x and y, over about a metre.
  double margin = 0.0;  ///< From walls and drops, metres; more than `kFarthestMargin` is not told apart.
  std::array<std::uint32_t, 8>
      links;  ///< Cells beside it to which the robot can drive, as kNeighbours; or kNone.
};
/// Columns beside a column. Opposite directions are four apart.
inline constexpr std::array<std::array<int, 2>, 8> kNeighbours{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
inline constexpr double kFarthestMargin = 3.0;  ///< Metres: as far as walls and drops are looked for.

/// The largest part of a mesh's floor on which a robot can get everywhere.
struct DrivableFloor {
  double cell_m = 0.0;                    ///< Width of a column of the grid, metres.
  std::vector<FloorCell> cells;           ///< By column and height.
  std::vector<Vector3> other_parts = {};  ///< A place in each other part of 4 m² or more.
  double escaping_rays =
      0.0;  ///< Share of the rays from the floor that meet nothing: they leave through portals.
  std::vector<Vector3> openings = {};  ///< Places from which many of them do.

  /// In plan, square metres.
  [[nodiscard]] double area_m2() const { return static_cast<double>(cells.size()) * cell_m * cell_m; }
  /// The cell of the column of `p` that is nearest in height, at most 1 m away.
  [[nodiscard]] std::optional<std::uint32_t> cell_at(const Vector3& p) const;
};

/// Looks for floor: a surface with the robot's height of free space above, no steeper than it can climb,
/// walls and drops as far away as it needs (RouteConfig), reached from its neighbours without a wall in
/// between. `raycaster` is that of `mesh`, watertight. Fails, naming a place and the remedy, where there is
/// no floor or none wide enough, and on a mesh that does not enclose it: rays from the floor of a mine meet a
/// wall.
[[nodiscard]] Result<DrivableFloor> drivable_floor(const TriangleMesh& mesh, const Raycaster& raycaster,
                                                   const RouteConfig& config);

/// "(1.0, 2.0, 3.0)", as messages write a position, metres.
[[nodiscard]] std::string place_text(const Vector3& p);

/// How far the nearest wall is from a robot at `p` (on the floor, which rises by `slope` along x and y),
/// metres, at three heights from what it can climb up to its own; at most `kFarthestMargin`.
[[nodiscard]] double wall_distance(const Raycaster& raycaster, const Vector3& p, const Eigen::Vector2d& slope,
                                   const RouteConfig& config);

}  // namespace adit
