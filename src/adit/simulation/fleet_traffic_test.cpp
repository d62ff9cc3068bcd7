// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/fleet_traffic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/simulation/things.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

/// Along a wide hall at 2 m/s, there or back.
Trajectory path(bool back, double y) {
  Trajectory out;
  for (int i = 0; i <= 800; ++i) {
    const double x = 0.5 * i;
    out.push_back(
        {Stamp{i * 250'000'000LL}, back ? Pose::planar(400.0 - x, y, 3.14159) : Pose::planar(x, y, 0.0)});
  }
  return out;
}

Raycaster hall(double half_width) {
  return Raycaster::build(test::room({-50, -half_width, 0}, {450, half_width, 5}), EdgeRule::watertight)
      .value();
}

Vector3 middle_of(const TriangleMesh& mesh) { return bounding_box(mesh).center().cast<double>(); }

TEST(Traffic, RobotsAreWhereTheyAreThen) {
  const std::vector<Trajectory> paths{path(false, 1.0), path(true, -1.0)};
  const Stamp stamp{50'000'000'000};  // at 100 and at 300
  EXPECT_TRUE(robots_around(0, stamp, 150.0, paths).empty());
  const Vector3 seen = middle_of(robots_around(0, stamp, 250.0, paths));
  EXPECT_NEAR(seen.x(), 300.0, 0.01);
  EXPECT_NEAR(seen.y(), -1.0, 0.01);
  EXPECT_NEAR(middle_of(robots_around(1, stamp, 250.0, paths)).x(), 100.0, 0.01);
  EXPECT_NEAR(middle_of(robots_around(0, Stamp{900'000'000'000}, 500.0, paths)).x(), 0.0, 0.01);
}

TEST(Traffic, NoRobotIsWithinAnother) {
  const std::vector<Trajectory> paths{path(false, 0.0), path(true, 0.2)};
  for (int i = 0; i < 800; ++i) {
    const Stamp stamp = paths[0][static_cast<std::size_t>(i)].stamp;
    for (const Eigen::Vector3f& p : robots_around(0, stamp, 1e3, paths).vertices)
      EXPECT_GT((p.cast<double>() - paths[0][static_cast<std::size_t>(i)].T_world_body.translation()).norm(),
                0.9);
  }
}

TEST(Traffic, VehiclesComeByWhereThereIsRoom) {
  const std::vector<Trajectory> paths{path(false, 0.0)};
  TrafficConfig config;
  config.vehicles_per_hour = 180.0;  // 10 in 200 s, on average
  const std::vector<DrivingVehicle> vehicles = draw_vehicles(hall(5.0), paths, config, 1);
  std::size_t num = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) num += draw_vehicles(hall(5.0), paths, config, seed).size();
  EXPECT_NEAR(static_cast<double>(num) / 40.0, 10.0, 1.5);
  EXPECT_TRUE(draw_vehicles(hall(1.2), paths, config, 1).empty());
  bool meets = false;
  bool overtakes = false;
  for (const DrivingVehicle& vehicle : vehicles) {
    (vehicle.pace < 0.0 ? meets : overtakes) = true;
    const std::vector one{vehicle};
    const Vector3 robot = pose_at(paths[0], vehicle.met)->translation();
    EXPECT_NEAR(middle_of(vehicles_around(0, vehicle.met, paths, one)).x(), robot.x(), 0.1);
    const Stamp later = vehicle.met + from_seconds(2.0);
    if (later > paths[0].back().stamp) continue;
    const TriangleMesh then = vehicles_around(0, later, paths, one);
    if (then.empty()) continue;  // it has left the path
    EXPECT_NEAR(middle_of(then).x(), robot.x() + vehicle.pace * 4.0, 0.1);
    EXPECT_TRUE(vehicles_around(0, vehicle.met + from_seconds(60.0), paths, one).empty());
  }
  EXPECT_TRUE(meets);
  EXPECT_TRUE(overtakes);
}

TEST(Traffic, VehiclesPassTheRobot) {
  const std::vector<Trajectory> paths{path(false, 0.0)};
  TrafficConfig config;
  config.vehicles_per_hour = 90.0;
  const std::vector<DrivingVehicle> vehicles = draw_vehicles(hall(5.0), paths, config, 2);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < paths[0].size(); i += 2) {
    const StampedPose& robot = paths[0][i];
    const TriangleMesh mesh = vehicles_around(0, robot.stamp, paths, vehicles);
    seen += mesh.vertices.size();
    for (const Eigen::Vector3f& p : mesh.vertices)
      EXPECT_GT((p.cast<double>() - robot.T_world_body.translation()).head<2>().cwiseAbs().maxCoeff(), 0.8);
  }
  EXPECT_GT(seen, 0U);
}

}  // namespace
}  // namespace adit
