// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/drawn_conditions.hpp"

#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// Draws of one site or visit, one after the other.
class Draws {
 public:
  Draws(double spread, std::uint64_t seed) : spread_(spread), rng_(seed) {}

  void rate(double& usual) { usual *= factor(); }
  void share(double& usual) {
    const double more = factor();
    usual = usual * more / (1.0 - usual + usual * more);
  }
  void number(int& usual) {
    if (spread_ > 0.0) usual = static_cast<int>(rng_.poisson(usual));
  }

 private:
  double factor() { return std::exp(spread_ * rng_.normal_within_two_sigma()); }

  double spread_;
  Rng rng_;
};

}  // namespace

VisitConfig drawn_site(VisitConfig site, double spread, std::uint64_t seed) {
  Draws draws(spread, seed);
  draws.rate(site.vehicles_per_km);
  draws.rate(site.pallets_per_km);
  draws.share(site.changed);
  draws.share(site.doors);
  draws.share(site.blocked_ends);
  draws.rate(site.walls_per_km);
  draws.share(site.pipes);
  return site;
}

DrawnVisit drawn_visit(const VisitConfig& usual, const AirConfig& air, double spread, std::uint64_t seed) {
  DrawnVisit visit{usual.people, usual.dust, air};
  Draws draws(spread, seed);
  draws.number(visit.people);
  draws.share(visit.dust);
  draws.rate(visit.air.fog);
  draws.rate(visit.air.clouds_per_km);
  draws.share(visit.air.drips);
  return visit;
}

}  // namespace adit
