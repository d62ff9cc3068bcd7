// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// An underground railway: two running tubes with identical stations and identical cross passages at equal
/// distances. Only the distance to the portals distinguishes places.
#include <array>
#include <cmath>
#include <numbers>

#include "adit/simulation/world_plan.hpp"

namespace adit {
namespace {

constexpr double kPitch = 43.0;  ///< Metres between cross passages.
constexpr int kNumPitches = 12;
constexpr double kLength = kPitch * kNumPitches;
constexpr int kStationEvery = 3;  ///< Pitches.
constexpr double kStationLength = 60.0;
constexpr double kHalfApart = 10.0;  ///< Metres from the middle to each tube's line.
constexpr Arch kTube{5.6, 5.4, 2.6, 32};
constexpr Arch kHall{11.0, 6.4, 3.0, 40};
constexpr double kHallShift = 2.3;  ///< Towards the outside, where the platform is.

struct Tube {
  Polyline line;
  double outside = 1.0;  ///< The side away from the other tube.
};

std::array<Tube, 2> draw_tubes(double curvature_factor, Rng& rng) {
  const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  Polyline middle;
  for (double x = 0.0; x <= kLength; x += 1.0)
    middle.emplace_back(x, curvature_factor * 10.0 * std::sin(2.0 * std::numbers::pi * x / 700.0 + phase),
                        0.0);
  return {Tube{offset_line(middle, -kHalfApart), -1.0}, Tube{offset_line(middle, kHalfApart), 1.0}};
}

/// Distances are measured as shares of each tube's own length, so that passages stay square to both.
double along(const Tube& tube, double distance) { return distance / kLength * length_of(tube.line); }

void add_station(WorldPlan& plan, const Tube& tube, double middle) {
  const double at = along(tube, middle);
  const Polyline hall = part_of(tube.line, at - 0.5 * kStationLength, at + 0.5 * kStationLength);
  plan.spaces.push_back(sweep(shifted(arch_profile(kHall), tube.outside * kHallShift), hall, Ends::closed));
  const Profile platform = shifted(box_profile(5.4, -0.05, 1.0), tube.outside * 5.4);
  plan.obstacles.push_back(turned_out(sweep(platform, hall, Ends::closed)));
}

Polyline passage_line(const std::array<Tube, 2>& tubes, int index) {
  const double distance = kPitch * index;
  return {point_at(tubes[0].line, along(tubes[0], distance)).position,
          point_at(tubes[1].line, along(tubes[1], distance)).position};
}

void add_cabinets(WorldPlan& plan, const Tube& tube, double spacing) {
  for (double at = 0.5 * spacing; at < kLength; at += spacing) {
    const double station = kPitch * kStationEvery;
    const double from_station = std::abs(at - station * std::round(at / station));
    if (from_station > 0.5 * kStationLength + 2.0)
      add_cabinet(plan, {point_at(tube.line, along(tube, at)), tube.outside, 0.5 * kTube.width});
  }
}

std::vector<Drive> draw_drives(const std::array<Tube, 2>& tubes, const WorldConfig& config) {
  const auto east = [&](std::size_t i) { return tubes[i].line; };
  const auto west = [&](std::size_t i) { return reversed_line(tubes[i].line); };
  const auto through = [&](int index) { return passage_line(tubes, index); };
  // Two trains' worth in each tube: what the tubes share is their looks.
  if (config.routes == "apart")
    return {
        {"robot_0", 1.88, 441.0, 5.0, 2.6, {east(0)}},
        {"robot_1", 1.84, 412.0, 5.0, 2.6, {west(0)}},
        {"robot_2", 1.86, 405.0, 5.0, 2.6, {east(1)}},
        {"robot_3", 1.82, 420.0, 5.0, 2.6, {west(1)}},
    };
  return {
      {"robot_0", 1.88, 441.0, 5.0, 2.6, {east(0), through(5), east(1)}},
      {"robot_1", 1.84, 412.0, 5.0, 2.6, {east(1), through(7), east(0)}},
      {"robot_2", 1.86, 405.0, 5.0, 2.6, {west(0), through(7), west(1)}},
      {"robot_3", 1.82, 420.0, 5.0, 2.6, {west(1), through(6), west(0)}},
  };
}

}  // namespace

WorldPlan plan_metro(const WorldConfig& config) {
  Rng rng(mix64(config.seed, 1));
  WorldPlan plan = concrete_plan(config);
  const std::array<Tube, 2> tubes = draw_tubes(config.curvature_factor, rng);
  for (const Tube& tube : tubes) add_tunnel(plan, arch_profile(kTube), tube.line);
  for (const Tube& tube : tubes)
    for (int i = kStationEvery; i < kNumPitches; i += kStationEvery) add_station(plan, tube, kPitch * i);
  for (int i = 1; i < kNumPitches; ++i)
    add_closed_tunnel(plan, arch_profile({3.2, 3.0, 1.6, 16}), passage_line(tubes, i));
  for (const Tube& tube : tubes) add_cabinets(plan, tube, kPitch * config.furniture_spacing_factor);
  plan.drives = draw_drives(tubes, config);
  return plan;
}

}  // namespace adit
