// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/drawn_conditions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace adit {
namespace {

constexpr double kSpread = 0.7;
constexpr int kSites = 400;

/// Of one number of all sites: ascending.
template <class Number>
std::vector<double> of_sites(const Number& number) {
  std::vector<double> all;
  for (std::uint64_t seed = 0; seed < kSites; ++seed) all.push_back(number(seed));
  std::ranges::sort(all);
  return all;
}

TEST(DrawnConditions, WithoutSpreadAllIsAsUsual) {
  const VisitConfig usual = field_visits();
  const VisitConfig site = drawn_site(usual, 0.0, 1);
  EXPECT_EQ(site.vehicles_per_km, usual.vehicles_per_km);
  EXPECT_EQ(site.changed, usual.changed);
  EXPECT_EQ(site.walls_per_km, usual.walls_per_km);
  const DrawnVisit visit = drawn_visit(usual, field_air(), 0.0, 1);
  EXPECT_EQ(visit.people, usual.people);
  EXPECT_EQ(visit.dust, usual.dust);
  EXPECT_EQ(visit.air.fog, field_air().fog);
}

TEST(DrawnConditions, RatesOfSitesLieAboutTheUsualOne) {
  const std::vector<double> rates =
      of_sites([](std::uint64_t seed) { return drawn_site(field_visits(), kSpread, seed).vehicles_per_km; });
  const double usual = field_visits().vehicles_per_km;
  EXPECT_NEAR(rates[kSites / 2], usual, 0.15 * usual);
  EXPECT_GE(rates.front(), usual * std::exp(-2.0 * kSpread));
  EXPECT_LE(rates.back(), usual * std::exp(2.0 * kSpread));
  EXPECT_LT(rates[kSites / 10], 0.55 * usual);
  EXPECT_GT(rates[9 * kSites / 10], 1.8 * usual);
}

TEST(DrawnConditions, SharesStaySharesAndThoseOfNoneAndAllStayThem) {
  const std::vector<double> shares =
      of_sites([](std::uint64_t seed) { return drawn_site(field_visits(), kSpread, seed).changed; });
  EXPECT_NEAR(shares[kSites / 2], 0.5, 0.05);
  EXPECT_NEAR(shares.front(), 0.2, 0.02);
  EXPECT_NEAR(shares.back(), 0.8, 0.02);
  for (const double share : {0.0, 1.0}) {
    VisitConfig usual;
    usual.changed = share;
    EXPECT_EQ(drawn_site(usual, kSpread, 3).changed, share);
  }
}

TEST(DrawnConditions, VisitsDifferInTheirPeopleAndTheirAir) {
  double people = 0.0;
  std::set<double> fogs;
  for (std::uint64_t robot = 0; robot < kSites; ++robot) {
    const DrawnVisit visit = drawn_visit(field_visits(), field_air(), kSpread, robot);
    people += visit.people;
    fogs.insert(visit.air.fog);
    EXPECT_EQ(visit.air.cloud_density, field_air().cloud_density);
  }
  EXPECT_NEAR(people / kSites, field_visits().people, 0.2);
  EXPECT_EQ(fogs.size(), static_cast<std::size_t>(kSites));
}

}  // namespace
}  // namespace adit
