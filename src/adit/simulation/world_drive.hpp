// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Level lines, and the routes of robots along them. World frame, metres.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adit/simulation/route.hpp"
#include "adit/simulation/world_solids.hpp"

namespace adit {

/// Metres, along slopes too.
[[nodiscard]] double length_of(std::span<const Vector3> line);
/// The line moved to its left by `left` metres.
[[nodiscard]] Polyline offset_line(std::span<const Vector3> line, double left);
/// The same line from its end to its beginning.
[[nodiscard]] Polyline reversed_line(Polyline line);
/// The line with its first and last segments `by` metres longer.
[[nodiscard]] Polyline extended(Polyline line, double by);
/// The point and the unit direction `distance` along the line; beyond an end, those of that end.
struct LinePoint {
  Vector3 position;   ///< Metres.
  Vector3 direction;  ///< That of the segment there.
};
/// The line has two points or more; `distance` in metres from its first one.
[[nodiscard]] LinePoint point_at(std::span<const Vector3> line, double distance);
/// From `begin` to `end` along the line, both clamped to it; begin < end.
[[nodiscard]] Polyline part_of(std::span<const Vector3> line, double begin, double end);

/// One line from lines that follow one another: the robot turns over `corner` metres before and after each
/// place where two meet.
[[nodiscard]] Polyline rounded(const std::vector<Polyline>& parts, double corner);

/// The drive of one robot: `legs` are lines that cross (or touch) one after another, each followed from its
/// crossing with the one before to that with the one after; the last one to where `length` is used up, or to
/// its end where that comes a little earlier.
struct Drive {
  std::string name;            ///< As Route::name.
  double speed_mps = 1.87;     ///< As Route::speed_mps.
  double length = 400.0;       ///< Metres to drive.
  double start = 5.0;          ///< Metres from the beginning of the first leg.
  double corner = 3.2;         ///< Metres before and after a crossing over which the robot turns.
  std::vector<Polyline> legs;  ///< One or more.
};

/// Rounds the corners and puts a waypoint about every metre. Throws ContractViolation when two legs do not
/// meet or the legs are a tenth or more too short for the length: both are faults of a preset, not of its
/// input.
[[nodiscard]] Route route_of(const Drive& drive);

}  // namespace adit
