// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/manoeuvres.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kReversalPace = 4.0;  ///< Its duration by the time of the way that it goes back.
constexpr double kTurnRate = 0.8;      ///< Radians per second at most.

double duration_of(const Manoeuvre& m) {
  if (m.kind == Manoeuvre::Kind::stop) return m.amount;
  if (m.kind == Manoeuvre::Kind::reversal) return kReversalPace * m.amount;
  return std::numbers::pi * std::abs(m.amount) / kTurnRate;
}

}  // namespace

Fields fields_of(ManoeuvreConfig& c) {
  return {
      {"stops_per_km", &c.stops_per_km, "1/km", 0, 100, "times that the robot stands on its way"},
      {"reversals_per_km", &c.reversals_per_km, "1/km", 0, 100, "times that it backs up and comes again"},
      {"turns_per_km", &c.turns_per_km, "1/km", 0, 100, "times that it turns on the spot and back"},
      {"stop_s", &c.stop_s, "s", 0, 600, "mean duration of a stop"},
      {"reversal_s", &c.reversal_s, "s", 0, 60, "mean way that it backs up, in seconds of the way it came"},
      {"turn_deg", &c.turn_deg, "deg", 0, 360, "mean angle that it turns on the spot"}};
}

ManoeuvreConfig field_manoeuvres() {
  ManoeuvreConfig c;
  c.stops_per_km = 4.0;
  c.reversals_per_km = 2.0;
  c.turns_per_km = 2.0;
  return c;
}

std::vector<Manoeuvre> draw_manoeuvres(const ManoeuvreConfig& config, double path_length,
                                       std::uint64_t seed) {
  constexpr double kEnds = 0.05;
  constexpr double kApart = 5.0;
  constexpr int kTries = 20;
  Rng rng(seed);
  std::vector<Manoeuvre> all;
  const auto has_room = [&](double share) {
    return std::ranges::none_of(
        all, [&](const Manoeuvre& other) { return std::abs(other.share - share) * path_length < kApart; });
  };
  const auto add = [&](Manoeuvre::Kind kind, double per_km, double mean) {
    const std::uint64_t num = rng.poisson(path_length / 1000.0 * per_km);
    for (std::uint64_t i = 0; i < num; ++i) {
      const double size = mean * rng.uniform(0.5, 1.5);
      const double side = rng.uniform() < 0.5 ? 1.0 : -1.0;
      const double amount = kind == Manoeuvre::Kind::turn ? side * size : size;
      for (int attempt = 0; attempt < kTries; ++attempt) {
        const double share = rng.uniform(kEnds, 1.0 - kEnds);
        if (!has_room(share)) continue;
        all.push_back({kind, share, amount});
        break;
      }
    }
  };
  add(Manoeuvre::Kind::stop, config.stops_per_km, config.stop_s);
  add(Manoeuvre::Kind::reversal, config.reversals_per_km, config.reversal_s);
  add(Manoeuvre::Kind::turn, config.turns_per_km, config.turn_deg * kDegree);
  std::ranges::sort(all, {}, &Manoeuvre::share);
  return all;
}

DriveClock::DriveClock(const std::vector<Manoeuvre>& manoeuvres, const std::vector<double>& halts) {
  ADIT_CHECK(manoeuvres.size() == halts.size(), "one driving time per manoeuvre");
  for (std::size_t i = 0; i < halts.size(); ++i) {
    Manoeuvre m = manoeuvres[i];
    if (m.kind == Manoeuvre::Kind::reversal) m.amount = std::min(m.amount, halts[i]);
    halts_.push_back({m, halts[i], duration_of(m)});
  }
}

double DriveClock::lost_time() const {
  double sum = 0.0;
  for (const Halt& halt : halts_) sum += halt.duration;
  return sum;
}

DriveClock::Reading DriveClock::at(double time) const {
  double lost = 0.0;
  for (const Halt& halt : halts_) {
    const double since = time - lost - halt.driving_time;
    if (since < 0.0) break;
    if (since < halt.duration) {
      const double wave = std::sin(std::numbers::pi * since / halt.duration);
      const double gone = halt.manoeuvre.amount * wave * wave;  // there and back, at rest at both ends
      if (halt.manoeuvre.kind == Manoeuvre::Kind::reversal) return {halt.driving_time - gone, 0.0};
      return {halt.driving_time, halt.manoeuvre.kind == Manoeuvre::Kind::turn ? gone : 0.0};
    }
    lost += halt.duration;
  }
  return {time - lost, 0.0};
}

}  // namespace adit
