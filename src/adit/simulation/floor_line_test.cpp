// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/floor_line.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/meshes.hpp"

namespace adit {
namespace {

using Height = std::function<double(double, double)>;

constexpr double kCell = 0.25;  ///< Metres, as meshes from marching cubes have them.
const Eigen::AlignedBox2d kArea(Eigen::Vector2d(-2, -2), Eigen::Vector2d(2, 2));

double flat(double, double) { return 0.0; }
double ramp(double x, double y) { return 0.2 * x - 0.07 * y; }

Raycaster watertight(const TriangleMesh& mesh) {
  return Raycaster::build(mesh, EdgeRule::watertight).value();
}

TriangleMesh grid(const Height& height) { return test::floor_of(kArea, kCell, height); }

/// Where triangles meet, away from the rim: the corners of the cells, the middles of their sides and of their
/// diagonals, and a point on each that single precision does not represent.
std::vector<Eigen::Vector2d> points_between_triangles() {
  std::vector<Eigen::Vector2d> points;
  for (double x = -1.5; x < 1.5; x += kCell) {
    for (double y = -1.5; y < 1.5; y += kCell) {
      for (const double share : {0.0, 0.5, 1.0 / 3.0}) {
        points.emplace_back(x + share * kCell, y);
        points.emplace_back(x, y + share * kCell);
        points.emplace_back(x + share * kCell, y + share * kCell);
      }
    }
  }
  return points;
}

TEST(FloorHeight, HasNoGapsBetweenTriangles) {
  for (const Height& height : {Height(flat), Height(ramp)}) {
    const Raycaster raycaster = watertight(grid(height));
    for (const Eigen::Vector2d& p : points_between_triangles()) {
      const double floor = height(p.x(), p.y());
      for (const double above : {0.0, 0.05, -0.001, -0.05, 1.0}) {
        const std::optional<double> found = floor_height(raycaster, {p.x(), p.y(), floor + above});
        ASSERT_TRUE(found) << p.transpose() << ", " << above << " m above the floor";
        EXPECT_NEAR(*found, floor, 1e-6) << p.transpose();
      }
    }
  }
}

TEST(FloorHeight, ClosesCracksAsWideAsRoundingLeavesThem) {
  // Two plates whose sides are half a millimetre apart, as when vertices were written with three decimals.
  TriangleMesh mesh;
  test::add_quad(mesh, {-2, -2, 0}, {-0.00025, -2, 0}, {-0.00025, 2, 0}, {-2, 2, 0});
  test::add_quad(mesh, {0.00025, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0.00025, 2, 0});
  const Raycaster raycaster = watertight(mesh);
  EXPECT_NEAR(floor_height(raycaster, {0, 0.3, 0}).value(), 0.0, 1e-6);
  EXPECT_NEAR(floor_height(raycaster, {0, 0.3, -0.001}).value(), 0.0, 1e-6);
  EXPECT_FALSE(floor_height(raycaster, {2.01, 0.3, 0}));  // the rim is not a crack
}

TEST(FloorHeight, KeepsToTheLevelOfTheWaypoint) {
  // Two galleries of 2 m with a metre of rock between them: floors at 0 and 3 m, ceilings at 2 and 5 m.
  TriangleMesh mesh;
  for (const double z : {0.0, 2.0, 3.0, 5.0}) append(mesh, grid([&](double, double) { return z; }));
  const Raycaster raycaster = watertight(mesh);
  for (const Eigen::Vector2d& p : points_between_triangles()) {
    for (const double above : {0.0, 0.05, -0.001, 0.9}) {
      EXPECT_NEAR(floor_height(raycaster, {p.x(), p.y(), 0.0 + above}).value(), 0.0, 1e-6);
      EXPECT_NEAR(floor_height(raycaster, {p.x(), p.y(), 3.0 + above}).value(), 3.0, 1e-6);
    }
  }
}

TEST(FloorLine, RunsOverTheVerticesOfAGrid) {
  const Raycaster raycaster = watertight(grid(ramp));
  for (const double above : {0.0, -0.001, 0.05}) {
    Route route{"robot_0", 1.0, {}};
    for (double x = -1.5; x <= 1.5; x += 0.5) route.waypoints.emplace_back(x, 0.0, ramp(x, 0.0) + above);
    const Result<std::vector<Vector3>> line = floor_line(raycaster, route);
    ASSERT_TRUE(line) << line.error().message;
    ASSERT_EQ(line->size(), route.waypoints.size());
    for (const Vector3& p : *line) EXPECT_NEAR(p.z(), ramp(p.x(), p.y()), 1e-6);
  }
}

TEST(FloorLine, AWaypointInTheVoidHasNoFloor) {
  const Raycaster raycaster = watertight(grid(flat));
  for (const Vector3& p : {Vector3(5, 0, 0), Vector3(0, 0, 3.2), Vector3(0, 0, -1.6)}) {
    const Result<std::vector<Vector3>> line = floor_line(raycaster, {"robot_0", 1.0, {{0, 1, 0}, p}});
    ASSERT_FALSE(line) << p.transpose();
    EXPECT_NE(line.error().message.find("robot_0: waypoint 1 at"), std::string::npos);
    EXPECT_NE(line.error().message.find("no floor from 1.5 m above to 3 m below"), std::string::npos)
        << line.error().message;
  }
}

}  // namespace
}  // namespace adit
