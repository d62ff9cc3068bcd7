// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/scan_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "adit/core/angles.hpp"
#include "adit/core/parallel.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

using Flags = std::vector<std::uint8_t>;

struct Dusty {
  PointCloud cloud;
  Flags is_dust;
};

std::size_t count(const Flags& flags, int value) {
  return static_cast<std::size_t>(std::ranges::count(flags, value));
}

/// OS2-32 at 1024 columns, VLP-16 at 1800.
test::Lidar os2_32() {
  test::Lidar lidar{32, 1024, 11.25 * kDegree, 100.0, 0.02};
  return lidar;
}
test::Lidar vlp_16() { return {16, 1800, 16.0 * kDegree, 100.0, 0.03}; }

PointCloud scan_at(const test::Scene& scene, const test::Lidar& lidar, const Pose& T_world_base) {
  return test::sweep(scene, lidar, Pose(), Stamp{}, [&](Duration) { return T_world_base; }).cloud;
}

/// So many of the rays end within 5 m of the sensor, most of them close to it.
Dusty with_dust(PointCloud cloud, double share) {
  Rng rng(11);
  Dusty dusty{std::move(cloud), {}};
  for (Eigen::Vector3f& p : dusty.cloud.points) {
    const double u = rng.uniform();
    const auto range = static_cast<float>(0.5 + 4.5 * u * u);
    const bool hits = rng.uniform() < share && range < 0.95F * p.norm();
    if (hits) p *= range / p.norm();
    dusty.is_dust.push_back(hits ? 1 : 0);
  }
  return dusty;
}

Flags confirmed(const PointCloud& cloud, const ConfirmConfig& config = {}) {
  return ScanView(cloud.points, Vector3::Zero(), config).confirmed_by_neighbours();
}

struct Shares {
  double dust_removed;
  double surface_kept;
};
Shares shares_of(const Dusty& dusty) {
  const Flags kept = confirmed(dusty.cloud);
  std::size_t dust_removed = 0;
  std::size_t surface_kept = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    dust_removed += dusty.is_dust[i] == 1 && kept[i] == 0 ? 1 : 0;
    surface_kept += dusty.is_dust[i] == 0 && kept[i] == 1 ? 1 : 0;
  }
  return {static_cast<double>(dust_removed) / static_cast<double>(count(dusty.is_dust, 1)),
          static_cast<double>(surface_kept) / static_cast<double>(count(dusty.is_dust, 0))};
}

TEST(ScanView, DustLeavesAndSurfacesStay) {
  for (const test::Lidar& lidar : {os2_32(), vlp_16()})
    for (const test::Scene& scene : {test::smooth_tube(), test::furnished_room()})
      for (const double share : {0.01, 0.05, 0.1}) {
        SCOPED_TRACE(testing::Message() << lidar.rows << " rings, dust " << share);
        const Shares shares = shares_of(with_dust(scan_at(scene, lidar, Pose()), share));
        EXPECT_GT(shares.dust_removed, 0.95);
        EXPECT_GT(shares.surface_kept, 0.99);
      }
}

TEST(ScanView, ACleanScanStays) {
  for (const test::Lidar& lidar : {os2_32(), vlp_16()})
    for (const test::Scene& scene : {test::smooth_tube(), test::furnished_room()}) {
      const PointCloud cloud = scan_at(scene, lidar, Pose());
      EXPECT_GT(static_cast<double>(count(confirmed(cloud), 1)), 0.995 * static_cast<double>(cloud.size()));
    }
}

struct Oracle {
  int others = -1;
  int similar = -1;
};

struct Angles {
  double azimuth, elevation, range;
};
Angles angles_of(const Eigen::Vector3f& p) {
  return {std::atan2(p.y(), p.x()), std::atan2(p.z(), p.head<2>().norm()), p.norm()};
}

/// One return against every other.
Oracle by_brute_force(const std::vector<Angles>& all, const Angles& at, double window,
                      const ConfirmConfig& c) {
  Oracle oracle;
  for (const Angles& other : all) {
    const double aside = std::abs(std::remainder(other.azimuth - at.azimuth, 2.0 * std::numbers::pi));
    if (aside * std::cos(at.elevation) > window || std::abs(other.elevation - at.elevation) > window)
      continue;
    ++oracle.others;
    oracle.similar +=
        other.range >= c.nearer * at.range && other.range <= (1.0 + c.farther) * at.range ? 1 : 0;
  }
  return oracle;
}

TEST(ScanView, NeighboursAreThoseOfABruteForceSearch) {
  Rng rng(3);
  std::vector<Eigen::Vector3f> points;
  std::vector<Angles> all;
  for (int i = 0; i < 2000; ++i) {  // all directions, poles and the seam too
    const double x = rng.normal();
    const double y = rng.normal();
    const Vector3 ray = Vector3(x, y, rng.normal()).normalized();
    points.emplace_back((rng.uniform(1.0, 3.0) * ray).cast<float>());
    all.push_back(angles_of(points.back()));
  }
  ConfirmConfig config;
  config.window_deg = 7.0;
  config.min_neighbours = 3;
  config.min_share = 0.3;
  const ScanView view(points, Vector3::Zero(), config);
  ASSERT_TRUE(view.is_dense());
  const Flags flags = view.confirmed_by_neighbours();
  std::size_t num_decided = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Angles are good to 2e-4 rad: where that decides, either answer is right.
    const double window = view.window_deg() * kDegree;
    const Oracle narrow = by_brute_force(all, all[i], window - 4e-4, config);
    const Oracle wide = by_brute_force(all, all[i], window + 4e-4, config);
    if (narrow.others != wide.others) continue;
    ++num_decided;
    const bool confirmed =
        wide.similar >= config.min_neighbours && wide.similar >= config.min_share * wide.others;
    EXPECT_EQ(flags[i] == 1, confirmed) << points[i].transpose();
  }
  EXPECT_GT(num_decided, 1500U);
  EXPECT_GT(count(flags, 1), 200U);
  EXPECT_GT(count(flags, 0), 200U);
}

test::Scene with_person(test::Scene scene, double x, double y) {
  scene.boxes.push_back({{x - 0.14, y - 0.25, -0.9}, {x + 0.14, y + 0.25, 0.8}});
  return scene;
}

bool is_of_person(const Eigen::Vector3f& p, double x, double y) {
  return std::abs(p.x() - x) < 0.3 && std::abs(p.y() - y) < 0.4 && p.z() > -0.6F;
}

// The robot drives half a metre from look to look, and a person walks ahead of it or behind.
TEST(ScanView, SomeoneWhoWalksAlongIsLookedThroughAndWallsAreNot) {
  for (const test::Lidar& lidar : {os2_32(), vlp_16()})
    for (const double ahead : {2.5, 5.0, -2.5, -5.0}) {
      SCOPED_TRACE(testing::Message() << lidar.rows << " rings, " << ahead << " m ahead");
      const test::Scene scene = test::furnished_room();
      std::vector<PointCloud> clouds;
      std::vector<ScanView> views;
      for (const double driven : {-0.5, 0.0, 0.5}) {
        const Pose T = Pose::translation_of(driven, 0.0, 0.0);
        clouds.push_back(scan_at(with_person(scene, driven + ahead, 0.8), lidar, T));
        views.emplace_back(clouds.back().points, Vector3::Zero(), ConfirmConfig{});
      }
      std::size_t person = 0, person_removed = 0, others_removed = 0;
      for (const Eigen::Vector3f& p : clouds[1].points) {
        const bool removed = views[0].looks_through(p + Eigen::Vector3f(0.5F, 0.0F, 0.0F)) ||
                             views[2].looks_through(p - Eigen::Vector3f(0.5F, 0.0F, 0.0F));
        const bool is_person = is_of_person(p, ahead, 0.8);
        person += is_person ? 1 : 0;
        person_removed += is_person && removed ? 1 : 0;
        others_removed += !is_person && removed ? 1 : 0;
      }
      ASSERT_GT(person, 50U);
      // What stays stands close to the floor or to the wall, within the window of rays that end there.
      EXPECT_GT(static_cast<double>(person_removed), 0.75 * static_cast<double>(person));
      EXPECT_LT(static_cast<double>(others_removed), 0.003 * static_cast<double>(clouds[1].size()));
    }
}

TEST(ScanView, WhatHidesAPlaceDoesNotLookThroughIt) {
  const PointCloud cloud = scan_at(test::smooth_tube(), os2_32(), Pose());
  const ScanView view(cloud.points, Vector3::Zero(), {});
  EXPECT_TRUE(view.looks_through({2.0F, 0.5F, 0.1F}));
  EXPECT_FALSE(view.looks_through({0.0F, 4.0F, 0.1F}));  // the wall
  EXPECT_FALSE(view.looks_through({0.0F, 6.0F, 0.1F}));  // behind it
  EXPECT_FALSE(view.looks_through({0.0F, 0.1F, 1.5F}));  // above all rays
  EXPECT_FALSE(view.looks_through({0.0F, 0.0F, 0.0F}));  // the sensor itself
  ScanView nothing = view;
  nothing.keep(Flags(cloud.size(), 0));
  EXPECT_FALSE(nothing.looks_through({2.0F, 0.5F, 0.1F}));
}

TEST(ScanView, TellsNothingOfCloudsThatAreTooThin) {
  const PointCloud none;
  EXPECT_TRUE(confirmed(none).empty());
  EXPECT_FALSE(ScanView(none.points, Vector3::Zero(), {}).looks_through({1.0F, 0.0F, 0.0F}));
  const PointCloud thin = scan_at(test::furnished_room(), {6, 40, 0.35, 100.0, 0.01}, Pose());
  EXPECT_EQ(count(confirmed(with_dust(thin, 0.1).cloud), 0), 0U);
  const PointCloud ring = scan_at(test::furnished_room(), {1, 1024, 0.01, 100.0, 0.01}, Pose());
  const Shares shares = shares_of(with_dust(ring, 0.05));
  EXPECT_GT(shares.dust_removed, 0.9);
  EXPECT_GT(shares.surface_kept, 0.99);
}

TEST(ScanView, PointsThatAreNowhereAreNotConfirmed) {
  PointCloud cloud = scan_at(test::furnished_room(), os2_32(), Pose());
  cloud.points[5].x() = std::numeric_limits<float>::quiet_NaN();
  cloud.points[6].setConstant(std::numeric_limits<float>::infinity());
  cloud.points[7].setZero();
  const Flags flags = confirmed(cloud);
  EXPECT_EQ(flags[5] + flags[6] + flags[7], 0);
  EXPECT_EQ(flags[4], 1);
  EXPECT_FALSE(ScanView(cloud.points, Vector3::Zero(), {}).looks_through(cloud.points[5]));
}

TEST(ScanView, TheNumberOfThreadsChangesNothing) {
  const PointCloud cloud = with_dust(scan_at(test::furnished_room(), os2_32(), Pose()), 0.05).cloud;
  const int before = num_threads();
  set_num_threads(1);
  const Flags one = confirmed(cloud);
  set_num_threads(4);
  EXPECT_EQ(confirmed(cloud), one);
  set_num_threads(before);
}

TEST(ScanView, KeptPointsHaveWhatBelongsToThem) {
  PointCloud cloud;
  for (int i = 0; i < 4; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    cloud.intensities.push_back(static_cast<float>(i));
    cloud.time_offsets_ns.push_back(i);
  }
  const PointCloud kept = only(cloud, Flags{0, 1, 0, 1});
  EXPECT_EQ(kept.intensities, (std::vector<float>{1.0F, 3.0F}));
  EXPECT_EQ(kept.time_offsets_ns, (std::vector<std::int32_t>{1, 3}));
  EXPECT_EQ(kept.points[1].x(), 3.0F);
}

}  // namespace
}  // namespace adit
