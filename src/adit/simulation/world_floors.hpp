// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "adit/core/pose.hpp"

namespace adit {

/// How high the floors of a storey lie, as a function of plan position. Every point takes the height of the
/// nearest point of the tunnels' centre lines, so floors are level across and follow their line along. World
/// frame, metres.
class Floors {
 public:
  /// `line` runs along the middle of a floor; its z is the height. At least two points.
  void add(std::span<const Vector3> line);
  /// Inclines the whole storey: metres of rise per metre along x and y, on top of the lines' heights.
  void set_tilt(const Eigen::Vector2d& tilt) { tilt_ = tilt; }
  /// z of `p` does not count. The tilt alone where there is no line at all.
  [[nodiscard]] double height(const Vector3& p) const;

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  struct Segment {
    Vector3 from;
    Vector3 to;
  };
  [[nodiscard]] static Cell cell_of(double x, double y);

  Eigen::Vector2d tilt_ = Eigen::Vector2d::Zero();
  std::vector<Segment> segments_;
  std::map<Cell, std::vector<std::size_t>> near_;  ///< Segments that may be nearest to a point of the cell.
};

}  // namespace adit
