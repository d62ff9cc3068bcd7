// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/changed_walls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/meshes.hpp"

namespace adit {
namespace {

constexpr double kLength = 100.0;
constexpr double kHalf = 3.0;
constexpr double kHeight = 4.0;

/// A tunnel along x whose floor, walls and roof have vertices every half metre; their corners are not shared.
TriangleMesh tunnel() {
  TriangleMesh mesh;
  constexpr double kStep = 0.5;
  for (double x = -10.0; x < kLength + 10.0; x += kStep) {
    for (double y = -kHalf; y < kHalf; y += kStep) {
      test::add_quad(mesh, {x, y, 0}, {x + kStep, y, 0}, {x + kStep, y + kStep, 0}, {x, y + kStep, 0});
      test::add_quad(mesh, {x, y, kHeight}, {x, y + kStep, kHeight}, {x + kStep, y + kStep, kHeight},
                     {x + kStep, y, kHeight});
    }
    for (double z = 0.0; z < kHeight; z += kStep) {
      test::add_quad(mesh, {x, -kHalf, z}, {x, -kHalf, z + kStep}, {x + kStep, -kHalf, z + kStep},
                     {x + kStep, -kHalf, z});
      test::add_quad(mesh, {x, kHalf, z}, {x + kStep, kHalf, z}, {x + kStep, kHalf, z + kStep},
                     {x, kHalf, z + kStep});
    }
  }
  return mesh;
}

Trajectory along_tunnel(double y = 0.0) {
  Trajectory path;
  for (int i = 0; i <= static_cast<int>(kLength) * 4; ++i)
    path.push_back({Stamp{i * 100'000'000LL}, Pose::planar(0.25 * i, y, 0.0)});
  return path;
}

constexpr ChangedWalls kSeldom{0.1, 0.3};  // one stretch in one of a hundred tunnels, and two in none

TEST(ChangedWalls, MoveByWhatIsToldOverTwentyMetres) {
  const TriangleMesh before = tunnel();
  int num_changed = 0;
  int num_narrower = 0;
  constexpr int kSeeds = 1000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TriangleMesh after = with_changed_walls(before, along_tunnel(), kSeldom, seed);
    ASSERT_EQ(after.vertices.size(), before.vertices.size());
    if (after.vertices == before.vertices) continue;
    ++num_changed;
    float most = 0.0F;
    bool is_narrower = false;
    Eigen::AlignedBox3f moved;
    for (std::size_t i = 0; i < before.vertices.size(); ++i) {
      const float by = (after.vertices[i] - before.vertices[i]).norm();
      if (by == 0.0F) continue;
      most = std::max(most, by);
      moved.extend(before.vertices[i]);
      EXPECT_GT(before.vertices[i].z(), 0.3F);  // no floor
      is_narrower = std::abs(after.vertices[i].y()) < std::abs(before.vertices[i].y()) ||
                    after.vertices[i].z() < before.vertices[i].z();
    }
    EXPECT_GE(most, 0.049F);
    EXPECT_LE(most, 0.301F);
    num_narrower += is_narrower ? 1 : 0;
    EXPECT_GT(moved.sizes().x(), 12.0F);
    EXPECT_LE(moved.sizes().x(), 21.0F);
  }
  EXPECT_GT(num_narrower, 0);
  EXPECT_LT(num_narrower, num_changed);
  EXPECT_NEAR(num_changed, 10, 6);
}

TEST(ChangedWalls, OpenNoCracks) {
  const TriangleMesh before = tunnel();
  const TriangleMesh after = with_changed_walls(before, along_tunnel(), {50.0, 0.3}, 1);
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> pairs;
  for (std::size_t i = 0; i < before.vertices.size(); ++i)
    pairs.emplace_back(before.vertices[i], after.vertices[i]);
  std::ranges::sort(pairs, [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.first.begin(), a.first.end(), b.first.begin(), b.first.end());
  });
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (pairs[i].first == pairs[i - 1].first) {
      EXPECT_EQ(pairs[i].second, pairs[i - 1].second);
    }
  }
}

TEST(ChangedWalls, LeaveRoomForTheRobot) {
  const TriangleMesh before = tunnel();
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const TriangleMesh after = with_changed_walls(before, along_tunnel(kHalf - 1.3), {100.0, 1.0}, seed);
    for (const Eigen::Vector3f& p : after.vertices) {
      const double beside = std::abs(static_cast<double>(p.y()) - (kHalf - 1.3));
      if (p.z() > 0.5F && p.z() < 2.0F) {
        EXPECT_GT(beside, 1.1);
      }
    }
  }
}

TEST(ChangedWalls, NoneMeansNone) {
  const TriangleMesh before = tunnel();
  EXPECT_EQ(with_changed_walls(before, along_tunnel(), {0.0, 0.3}, 1).vertices, before.vertices);
}

}  // namespace
}  // namespace adit
