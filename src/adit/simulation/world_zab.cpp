// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Zentrum am Berg as the paper's section 2.1 and the facility's own page describe it: two road and two rail
/// tubes side by side with cross passages. The four robots enter one tube each.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "adit/simulation/world_plan.hpp"

namespace adit {
namespace {

constexpr int kNumTubes = 4;
constexpr double kLength = 404.0;
constexpr std::array kLateral{0.0, 34.0, 66.0,
                              92.0};  ///< Of the tubes' lines, metres: two roads, two railways.
constexpr Arch kRoad{10.0, 7.0, 2.0, 40};
constexpr Arch kRail{7.0, 6.5, 3.0, 32};

/// A stretch of one side of a tube that nothing else may be built into.
struct Taken {
  double side;
  double begin;
  double end;
};

struct Tube {
  Polyline line;
  Arch arch;
  std::vector<Taken> taken;

  [[nodiscard]] bool is_road() const { return arch.width > 8.0; }
  [[nodiscard]] bool is_free(double side, double begin, double end) const {
    return begin > 12.0 && end < kLength - 12.0 && std::ranges::none_of(taken, [&](const Taken& t) {
             return t.side == side && t.begin < end && t.end > begin;
           });
  }
  [[nodiscard]] WallSite site(double side, double distance) const {
    return {point_at(line, distance), side, 0.5 * arch.width};
  }
};

enum class PassageKind { plain, chamber, winding };

struct Passage {
  std::size_t tube = 0;  ///< Leads from this tube to the next one.
  double from = 0.0;     ///< Distances along the two tubes.
  double to = 0.0;
  PassageKind kind = PassageKind::plain;
  Polyline line;
};

double side_of(Rng& rng) { return rng.uniform() < 0.5 ? 1.0 : -1.0; }

std::array<Tube, kNumTubes> draw_tubes(double curvature_factor, Rng& rng) {
  const double common_phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  std::array<Tube, kNumTubes> tubes;
  for (std::size_t i = 0; i < kNumTubes; ++i) {
    const double wavelength = rng.uniform(320.0, 420.0);
    const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
    tubes[i].arch = i < 2 ? kRoad : kRail;
    for (double x = 0.0; x <= kLength; x += 1.0) {
      // Curves of no less than 600 m in radius, as roads have; and each tube strays a little from its
      // neighbours.
      const double y = 12.0 * std::sin(2.0 * std::numbers::pi * x / 600.0 + common_phase) +
                       1.0 * std::sin(2.0 * std::numbers::pi * x / wavelength + phase);
      tubes[i].line.emplace_back(x, kLateral[i] + curvature_factor * y, 0.0);
    }
  }
  return tubes;
}

/// The passages that routes take come first, then the others at irregular distances.
std::vector<Passage> draw_passages(double spacing_factor, Rng& rng) {
  constexpr double kApart = 28.0;
  const auto near = [&](double distance) { return distance + rng.uniform(-7.0, 7.0); };
  std::vector<Passage> passages{{0, near(100.0), 0.0, PassageKind::plain, {}},
                                {1, near(162.0), 0.0, PassageKind::chamber, {}},
                                {1, near(255.0), 0.0, PassageKind::winding, {}},
                                {2, near(330.0), 0.0, PassageKind::plain, {}}};
  for (std::size_t tube = 0; tube + 1 < kNumTubes; ++tube)
    for (double at = rng.uniform(35.0, 70.0); at < kLength - 30.0;
         at += spacing_factor * rng.uniform(45.0, 110.0)) {
      const PassageKind kind = rng.uniform() < 0.75 ? PassageKind::plain : PassageKind::chamber;
      if (std::ranges::all_of(
              passages, [&](const Passage& p) { return p.tube != tube || std::abs(p.from - at) > kApart; }))
        passages.push_back({tube, at, 0.0, kind, {}});
    }
  for (Passage& passage : passages) passage.to = passage.from + rng.uniform(-10.0, 10.0);
  return passages;
}

Polyline passage_line(const Passage& passage, const std::array<Tube, kNumTubes>& tubes) {
  const Vector3 from = point_at(tubes[passage.tube].line, passage.from).position;
  const Vector3 to = point_at(tubes[passage.tube + 1].line, passage.to).position;
  if (passage.kind != PassageKind::winding) return {from, to};
  const Vector3 aside = Vector3::UnitZ().cross(to - from).normalized();
  Polyline line;
  constexpr int kSteps = 32;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = static_cast<double>(k) / kSteps;
    const double bump = std::sin(std::numbers::pi * t);
    line.emplace_back(from + t * (to - from) + 2.5 * bump * bump * aside);
  }
  return line;
}

void add_passage(WorldPlan& plan, Passage& passage, std::array<Tube, kNumTubes>& tubes, Rng& rng) {
  passage.line = passage_line(passage, tubes);
  // No two alike: built at different times for people, cables or vehicles.
  const double width = rng.uniform(3.4, 6.0);
  const Arch arch{width, rng.uniform(3.1, 4.6), rng.uniform(1.3, 2.0), 16};
  add_closed_tunnel(plan, arch_profile(arch), passage.line);
  if (passage.kind == PassageKind::chamber) {
    const double middle = 0.5 * length_of(passage.line) + rng.uniform(-2.0, 2.0);
    const double half_length = rng.uniform(2.5, 5.0);
    const Arch chamber{width + rng.uniform(1.5, 4.0), rng.uniform(4.8, 6.0), 2.4, 20};
    plan.spaces.push_back(sweep(arch_profile(chamber),
                                part_of(passage.line, middle - half_length, middle + half_length),
                                Ends::closed));
  }
  const double margin = 0.5 * width + 3.0;
  tubes[passage.tube].taken.push_back({1.0, passage.from - margin, passage.from + margin});
  tubes[passage.tube + 1].taken.push_back({-1.0, passage.to - margin, passage.to + margin});
}

/// A stretch of road tube that is wider on one side, with a machine in it.
void add_lay_by(WorldPlan& plan, Tube& tube, Rng& rng) {
  const double bay_length = rng.uniform(20.0, 40.0);
  constexpr int kAttempts = 40;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const double side = side_of(rng);
    const double begin = rng.uniform(20.0, kLength - 60.0);
    if (!tube.is_free(side, begin - 6.0, begin + bay_length + 6.0)) continue;
    plan.spaces.push_back(sweep(shifted(arch_profile({10.0, 6.5, 2.0, 40}), 3.0 * side),
                                part_of(tube.line, begin, begin + bay_length), Ends::closed));
    add_machine(plan, tube.site(side, begin + rng.uniform(8.0, bay_length - 8.0)), 6.2);
    tube.taken.push_back({side, begin - 6.0, begin + bay_length + 6.0});
    return;
  }
}

void add_furniture(WorldPlan& plan, Tube& tube, double spacing, Rng& rng) {
  for (double at = rng.uniform(0.3, 1.0) * spacing; at < kLength; at += spacing * rng.uniform(0.5, 1.5)) {
    const double side = side_of(rng);
    const double draw = rng.uniform();
    const bool machine = tube.is_road() && draw < 0.15;
    const double room = machine ? 14.0 : 3.0;
    if (!tube.is_free(side, at - room, at + room)) continue;
    const WallSite site = tube.site(side, at);
    if (machine)
      add_machine(plan, site, 3.6);
    else if (draw < 0.6)
      add_cabinet(plan, site);
    else
      add_niche(plan, site);
    tube.taken.push_back({side, at - room, at + room});
  }
}

/// Robots keep to the right.
Polyline lane(const Tube& tube, double heading) {
  const double aside = tube.is_road() ? 0.9 : 0.4;
  const Polyline line = offset_line(tube.line, -heading * aside);
  return heading > 0.0 ? line : reversed_line(line);
}

/// Lengths and speeds of the paper's table of trajectories. Every pair shares a stretch around the passages
/// between the second and the third tube, most of them in opposite directions.
std::vector<Drive> meeting_drives(const std::array<Tube, kNumTubes>& tubes,
                                  const std::vector<Passage>& passages) {
  const auto east = [&](std::size_t i) { return lane(tubes[i], 1.0); };
  const auto west = [&](std::size_t i) { return lane(tubes[i], -1.0); };
  // A lane may lie beyond the tube's middle, where the passage's line ends.
  const auto through = [&](std::size_t i) { return extended(passages[i].line, 2.0); };
  return {
      {"robot_0", 1.89, 453.3, 4.0, 3.2, {east(0), through(0), east(1), through(2), east(2)}},
      {"robot_1", 1.84, 405.3, 4.0, 3.2, {west(1), through(2), west(2), through(1), east(1)}},
      {"robot_2", 1.87, 416.5, 4.0, 3.2, {east(2), through(2), west(1)}},
      {"robot_3", 1.85, 390.7, 4.0, 3.2, {west(3), through(3), west(2), through(1), west(1)}},
  };
}

/// Each robot stays in its own tube: all they have in common are the two mouths of each passage.
std::vector<Drive> parallel_drives(const std::array<Tube, kNumTubes>& tubes) {
  return {
      {"robot_0", 1.89, 392.0, 4.0, 3.2, {lane(tubes[0], 1.0)}},
      {"robot_1", 1.84, 392.0, 4.0, 3.2, {lane(tubes[1], -1.0)}},
      {"robot_2", 1.87, 392.0, 4.0, 3.2, {lane(tubes[2], 1.0)}},
      {"robot_3", 1.85, 392.0, 4.0, 3.2, {lane(tubes[3], -1.0)}},
  };
}

}  // namespace

WorldPlan plan_zab(const WorldConfig& config) {
  Rng rng(mix64(config.seed, 1));
  WorldPlan plan;
  // Concrete cast in formwork: waves of a centimetre and a rough skin of millimetres.
  plan.relief = {mix64(furniture_seed(config), 2), {{7.0, 0.010}, {1.7, 0.004}}, 0.0, 0.0, 1.0};
  for (ReliefOctave& octave : plan.relief.octaves) octave.amplitude *= config.relief_factor;
  plan.max_edge = 1.0 * config.facet_factor;

  std::array<Tube, kNumTubes> tubes = draw_tubes(config.curvature_factor, rng);
  for (const Tube& tube : tubes) add_tunnel(plan, arch_profile(tube.arch), tube.line);
  std::vector<Passage> passages = draw_passages(config.passage_spacing_factor, rng);
  for (Passage& passage : passages) add_passage(plan, passage, tubes, rng);
  for (Tube& tube : tubes)
    if (tube.is_road())
      for (int i = 0; i < 2; ++i) add_lay_by(plan, tube, rng);
  Rng furniture = furniture_rng(config, rng);
  for (Tube& tube : tubes) add_furniture(plan, tube, 45.0 * config.furniture_spacing_factor, furniture);
  plan.drives = config.routes == "meeting" ? meeting_drives(tubes, passages) : parallel_drives(tubes);
  return plan;
}

}  // namespace adit
