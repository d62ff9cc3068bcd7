// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/doors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/simulation/things.hpp"
#include "adit/simulation/wall_lines.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

/// A tunnel along x from -5 to 85, 6 m wide and 4 m high, with a side passage 3 m wide to the left at 40.
TriangleMesh with_passage() {
  TriangleMesh mesh;
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    test::add_quad(mesh, {x0, y0, 0}, {x1, y1, 0}, {x1, y1, 4}, {x0, y0, 4});
  };
  wall(-5, -3, 85, -3);
  wall(85, -3, 85, 3);
  wall(85, 3, 41.5, 3);
  wall(41.5, 3, 41.5, 23);
  wall(41.5, 23, 38.5, 23);
  wall(38.5, 23, 38.5, 3);
  wall(38.5, 3, -5, 3);
  wall(-5, 3, -5, -3);
  test::add_quad(mesh, {-5, -3, 0}, {85, -3, 0}, {85, 23, 0}, {-5, 23, 0});
  test::add_quad(mesh, {-5, -3, 4}, {-5, 23, 4}, {85, 23, 4}, {85, -3, 4});
  return mesh;
}

Trajectory straight(double end, double y = 0.0) {
  Trajectory path;
  for (int i = 0; i <= static_cast<int>(4.0 * end); ++i)
    path.push_back({Stamp{i * 100'000'000LL}, Pose::planar(0.25 * i, y, 0.0)});
  return path;
}

Raycaster solid_world(const TriangleMesh& mesh) {
  return Raycaster::build(mesh, EdgeRule::watertight).value();
}

TEST(Doors, CloseAPassageForOneRobot) {
  const Raycaster world = solid_world(with_passage());
  const TriangleMesh door = closed_doors(world, straight(75.0), 1.0, 1);
  ASSERT_EQ(door.vertices.size(), 8U);
  TriangleMesh closed = with_passage();
  append(closed, door);
  const Raycaster met = solid_world(closed);
  for (double x = 38.6; x < 41.5; x += 0.4) {
    for (const double z : {0.1, 1.5, 3.9}) {
      const Ray ray{Eigen::Vector3d(x, 0.0, z).cast<float>(), Eigen::Vector3f::UnitY()};
      EXPECT_NEAR(world.cast(ray, 50.0F).distance, 23.0F, 1e-3F);
      EXPECT_NEAR(met.cast(ray, 50.0F).distance, 3.0F, 0.2F);
    }
  }
}

TEST(Doors, NoneWithoutOpeningsOrChance) {
  const Raycaster world = solid_world(with_passage());
  EXPECT_TRUE(closed_doors(world, straight(75.0), 0.0, 1).empty());
  EXPECT_TRUE(closed_doors(world, straight(30.0), 1.0, 1).empty());
  Trajectory into = straight(40.0);  // turns into the passage: its door must be open
  for (int i = 1; i < 40; ++i)
    into.push_back({Stamp{(200 + i) * 100'000'000LL}, Pose::planar(40.0, 0.25 * i, std::acos(0.0))});
  EXPECT_TRUE(closed_doors(world, into, 1.0, 1).empty());
}

TEST(Doors, AMachineBlocksTheWayOn) {
  const Raycaster world = solid_world(with_passage());
  const TriangleMesh machine = blocked_end(world, straight(60.0));
  ASSERT_FALSE(machine.empty());
  TriangleMesh blocked = with_passage();
  append(blocked, machine);
  const Ray on{{60, 0.5, 1.2F}, Eigen::Vector3f::UnitX()};
  EXPECT_NEAR(solid_world(blocked).cast(on, 50.0F).distance, 4.0F, 1e-3F);
  for (const Eigen::Vector3f& p : machine.vertices) EXPECT_LE(std::abs(p.y()), 2.71F);
  EXPECT_TRUE(blocked_end(world, straight(80.0)).empty());  // the tunnel ends there anyway
}

TEST(WallLines, HangOnTheWallAndOnce) {
  const Raycaster world = solid_world(with_passage());
  const TriangleMesh lines = wall_lines(world, std::vector<Trajectory>{straight(75.0)}, 1.0, 1);
  ASSERT_GT(lines.vertices.size(), 8U * 3U * 50U);
  for (const Eigen::Vector3f& p : lines.vertices) {
    EXPECT_GT(std::abs(p.y()), 2.75F);
    EXPECT_LT(std::abs(p.y()), 3.0F);
    EXPECT_GT(p.z(), 1.7F);
    EXPECT_LT(p.z(), 2.4F);
  }
  const TriangleMesh of_two =
      wall_lines(world, std::vector<Trajectory>{straight(75.0), straight(70.0, 0.3)}, 1.0, 1);
  EXPECT_EQ(of_two.vertices, lines.vertices);
  EXPECT_TRUE(wall_lines(world, std::vector<Trajectory>{straight(75.0)}, 0.0, 1).empty());
}

TEST(WallLines, EndBeforeAPassage) {
  const Raycaster world = solid_world(with_passage());
  bool is_left = false;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    for (const Eigen::Vector3f& p :
         wall_lines(world, std::vector<Trajectory>{straight(75.0)}, 1.0, seed).vertices) {
      is_left = is_left || p.y() > 0.0F;
      if (p.y() > 0.0F) {
        EXPECT_GT(std::abs(p.x() - 40.0F), 0.9F);
      }
    }
  }
  EXPECT_TRUE(is_left);
}

}  // namespace
}  // namespace adit
