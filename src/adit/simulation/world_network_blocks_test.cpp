// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What networks are built of: parts of sweeps, rooms, ramps, sections.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "adit/simulation/world_network.hpp"
#include "adit/simulation/world_surface.hpp"

namespace adit {
namespace {

Polyline quarter_circle(double radius, double rise) {
  Polyline line;
  for (int k = 0; k <= 16; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / 16;
    line.emplace_back(radius * std::sin(angle), radius * (1.0 - std::cos(angle)), rise * k / 16.0);
  }
  return line;
}

Polyline level(Polyline line) {
  for (Vector3& p : line) p.z() = 0.0;
  return line;
}

TEST(NetworkBlocks, PartsOfASweepInTwoStoreysCloseToOneSurface) {
  const Polyline line = quarter_circle(20.0, 3.0);
  const Polyline flat = level(line);
  const Profile profile = arch_profile({5.0, 4.5, 2.0, 10});
  Floors lower;
  lower.add(std::span(line).first(13));
  Floors upper;
  upper.add(std::span(line).last(13));
  Relief relief{7, {{3.0, 0.2}}, 0.2, 0.0, 1.0};
  const auto mesh_of = [&](const LinePart& part, const Floors& floors) {
    const Solid solid = sweep_part(profile, flat, part);
    return surface_mesh(
        solid.faces, {0.7, false, [&](const Vector3& p) { return displaced(relief, p, floors.height(p)); }});
  };
  TriangleMesh mesh = mesh_of({0, 8, Ends::closed, Ends::open}, lower);
  append(mesh, mesh_of({8, 16, Ends::open, Ends::closed}, upper));
  std::map<std::array<float, 3>, int> index;
  std::vector<Eigen::Vector3f> vertices;
  for (Eigen::Vector3i& corners : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f v = mesh.vertices[static_cast<std::size_t>(corners[k])];
      const auto [at, is_new] = index.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(vertices.size()));
      if (is_new) vertices.push_back(v);
      corners[k] = at->second;
    }
  mesh.vertices = vertices;
  const EdgeStatistics edges = edge_statistics(mesh);
  EXPECT_EQ(edges.num_boundary, 0U);
  EXPECT_EQ(edges.num_over_shared, 0U);
  EXPECT_EQ(edges.num_inconsistent, 0U);
  const Eigen::AlignedBox3f box = bounding_box(mesh);
  EXPECT_GT(box.sizes().z(), 6.5F) << "the far end has been lifted";
}

TEST(NetworkBlocks, AnUprightPrismHoldsWhatIsBetweenItsSides) {
  const std::vector<Eigen::Vector2d> corners{{0.0, 0.0}, {6.0, 0.0}, {7.0, 5.0}, {0.0, 4.0}};
  const std::vector<Solid> room{upright_prism(corners, 3.0)};
  EXPECT_EQ(room[0].faces.size(), 6U);
  EXPECT_NEAR(depth_inside(room, {3.0, 2.0, 1.2}), 1.2, 1e-12);
  EXPECT_NEAR(depth_inside(room, {0.5, 2.0, 1.5}), 0.5, 1e-12);
  EXPECT_LT(depth_inside(room, {8.0, 2.0, 1.5}), 0.0);
  EXPECT_LT(depth_inside(room, {3.0, 2.0, 3.2}), 0.0);
}

TEST(NetworkBlocks, RampsRiseSmoothlyFromLevelToLevel) {
  EXPECT_EQ(ramp_rise(-0.5), 0.0);
  EXPECT_EQ(ramp_rise(0.0), 0.0);
  EXPECT_EQ(ramp_rise(1.0), 1.0);
  EXPECT_EQ(ramp_rise(2.0), 1.0);
  EXPECT_NEAR(ramp_rise(0.5), 0.5, 1e-12);
  constexpr double kStep = 1e-3;
  double grade = 0.0;
  for (double u = 0.0; u < 1.0; u += kStep) {
    const double next = (ramp_rise(u + kStep) - ramp_rise(u)) / kStep;
    EXPECT_GE(next, -1e-9);
    EXPECT_LE(next, 1.0 / 0.85 + 1e-9);
    EXPECT_NEAR(next, grade, 0.01) << "no jump in grade at " << u;
    grade = next;
  }
  const Polyline line = shaped_line({0.0, 0.0, 1.0}, {80.0, 0.0, 5.0}, {0.0, 1, 12.0});
  for (const Vector3& p : line) {
    if (p.x() > 12.0) break;
    EXPECT_EQ(p.z(), 1.0);
  }
  EXPECT_NEAR(steepest_grade(line), 4.0 / (80.0 - 24.0) / 0.85, 1e-3);
}

TEST(NetworkBlocks, SectionsAreConvexAsWideAndAsHighAsDrawn) {
  Rng rng(5);
  for (const SectionKind kind : {SectionKind::arch, SectionKind::box, SectionKind::irregular})
    for (int i = 0; i < 50; ++i) {
      const double width = rng.uniform(3.0, 10.0);
      const double height = rng.uniform(2.5, 8.0);
      const Section section = draw_section(kind, width, height, rng);
      double low = 0.0;
      double high = 0.0;
      double top = 0.0;
      const Profile& p = section.profile;
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Eigen::Vector2d a = p[(k + 1) % p.size()] - p[k];
        const Eigen::Vector2d b = p[(k + 2) % p.size()] - p[(k + 1) % p.size()];
        ASSERT_GE(a.x() * b.y() - a.y() * b.x(), -1e-9);
        ASSERT_GE(p[k].y(), 0.0);
        low = std::min(low, p[k].x());
        high = std::max(high, p[k].x());
        top = std::max(top, p[k].y());
      }
      EXPECT_NEAR(high - low, width, 1e-9);
      EXPECT_NEAR(top, height, 1e-9);
      const Section other = mirrored(section);
      for (const double above : {0.3, 1.0, 2.0})
        EXPECT_DOUBLE_EQ(half_width(section, above, 1.0), half_width(other, above, -1.0));
    }
}

TEST(NetworkBlocks, ALiftMovesRockAndLeavesALevelWorldAsItWas) {
  const Relief relief{3, {{4.0, 0.2}}, 0.1, 0.0, 1.0};
  Rng rng(2);
  double difference = 0.0;
  for (int i = 0; i < 50; ++i) {
    const double x = rng.uniform(-50.0, 50.0);
    const double y = rng.uniform(-50.0, 50.0);
    const Vector3 p(x, y, rng.uniform(0.0, 5.0));
    EXPECT_EQ(displaced(relief, p), displaced(relief, p, 0.0));
    const Vector3 lifted = displaced(relief, p, 12.0) - Vector3(0.0, 0.0, 12.0);
    EXPECT_LT((lifted - p).norm(), 0.4);
    difference = std::max(difference, (lifted - displaced(relief, p)).norm());
  }
  EXPECT_GT(difference, 0.05) << "levels above one another have rock of their own";
}

}  // namespace
}  // namespace adit
