// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What interrupts a drive: the robot stands, backs up and comes again, or turns around on the spot.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"

namespace adit {

/// None by default. Each halts the robot; of durations and angles, half to one and a half is drawn.
struct ManoeuvreConfig {
  double stops_per_km = 0.0;
  double reversals_per_km = 0.0;
  double turns_per_km = 0.0;
  double stop_s = 4.0;
  double reversal_s = 2.0;  ///< Of the way it came.
  double turn_deg = 90.0;   ///< To one side and back, drawn which.
};
/// The keys are the names of the members; in the configuration of a run they begin with
/// "simulation.drive.manoeuvres.".
[[nodiscard]] Fields fields_of(ManoeuvreConfig& config);

/// Now and then, as a driver who is in no hurry: chosen, not measured.
[[nodiscard]] ManoeuvreConfig field_manoeuvres();

/// One halt of a robot, and what it does there.
struct Manoeuvre {
  /// Standing; backing up and coming again; turning to one side and back.
  enum class Kind { stop, reversal, turn };
  Kind kind = Kind::stop;  ///< Decides the unit of `amount`.
  double share = 0.5;      ///< Of the path's length, where the robot halts.
  double amount = 0.0;     ///< Seconds, or radians (turn; positive: to the left).
};

/// Those of one drive, by place; none in the first and last twentieth of the path, nor 5 m from another.
[[nodiscard]] std::vector<Manoeuvre> draw_manoeuvres(const ManoeuvreConfig& config, double path_length,
                                                     std::uint64_t seed);

/// When a robot is where: a clock that goes along the path, and stands or runs back where it halts.
class DriveClock {
 public:
  /// Where the robot is on its drive, and where it looks.
  struct Reading {
    double driving_time = 0.0;  ///< Of the drive without manoeuvres, seconds.
    double turned = 0.0;        ///< Radians to the left of the path.
  };

  /// `halts`: the driving time of each manoeuvre, ascending.
  DriveClock(const std::vector<Manoeuvre>& manoeuvres, const std::vector<double>& halts);

  /// By which the drive is longer.
  [[nodiscard]] double lost_time() const;
  /// Continuous, and its speed too where the robot halts.
  [[nodiscard]] Reading at(double time) const;

 private:
  struct Halt {
    Manoeuvre manoeuvre;
    double driving_time;
    double duration;
  };
  std::vector<Halt> halts_;
};

}  // namespace adit
