// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/georeference.hpp"

#include <gtest/gtest.h>

#include "adit/core/format.hpp"
#include "adit/slam/slam.hpp"
#include "support/files.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

/// The hall in a grid whose coordinates are small, so that doubles leave room below 1e-9 m.
const Pose kT_grid_hall(so3::exp({0, 0, 2.2}), {403.4, 842.9, -312.6});

constexpr double kSpeed = 0.5;  // metres a second

Pose in_hall_at(double seconds) { return Pose::translation_of(kSpeed * seconds, 0, 0); }

/// A robot with wheels that drives along a hall with two pillars, its LiDAR turned and shifted on it
/// (test::kMount).
Recording drive_with_turned_lidar() {
  Recording recording;
  recording.name = "ada";
  recording.T_base_lidar = test::kMount;
  for (std::int64_t i = 0; i < 8; ++i) recording.scan_stamps.push_back(Stamp{(i + 1) * 1'000'000'000});
  for (std::int64_t i = 0; i < 200; ++i) {  // from half a second before the first scan
    const Stamp stamp{500'000'000 + i * 50'000'000};
    recording.wheel.push_back({stamp, in_hall_at(stamp.seconds() - 1.0)});
  }
  recording.read_scan = [stamps = recording.scan_stamps](std::size_t i) -> Result<Scan> {
    test::Scene hall;
    hall.rooms = {{Vector3(-10, -5, 0), Vector3(30, 5, 5)}};
    hall.boxes = {{Vector3(6, 2, 0), Vector3(7, 3, 5)}, {Vector3(12, -4, 0), Vector3(13, -2, 5)}};
    return test::sweep(hall, test::Lidar{}, test::kMount, stamps.at(i), [i](Duration offset) {
      return in_hall_at(static_cast<double>(i) + to_seconds(offset));
    });
  };
  return recording;
}

/// Its session, with a keyframe at each scan.
void put_session(const std::filesystem::path& folder, const Recording& recording) {
  SlamConfig config;
  ASSERT_TRUE(set_field(fields_of(config), "robot.keyframes.distance_m", "0.3"));
  const Result<SlamRun> run = slam({recording}, config);
  ASSERT_TRUE(run) << run.error().message;
  ASSERT_TRUE(write_slam(folder, *run));
}

/// Points of the hall, each as seen in a scan: by the base, or by the LiDAR.
std::vector<ControlPoint> marks_in_scans(bool is_in_lidar_frame) {
  std::vector<ControlPoint> points;
  const auto add = [&](int scan, const Vector3& in_base) {
    ControlPoint& point = points.emplace_back();
    point.name = format("T{}", points.size());
    point.target = kT_grid_hall * (in_hall_at(scan) * in_base);
    point.sigma_xy = 0.01;
    point.sigma_z = 0.01;
    point.mark.robot = "ada";
    point.mark.stamp = Stamp{(scan + 1) * 1'000'000'000LL};
    point.mark.position = is_in_lidar_frame ? test::kMount.inverse() * in_base : in_base;
    point.mark.sigma = 0.2;  // how far a drive of 4 m drifts is no matter here
    point.mark.is_in_lidar_frame = is_in_lidar_frame;
  };
  add(0, {4, 3, 1});
  add(1, {-3, -4, 2});
  add(4, {5, -2, 0.5});
  add(6, {2, 4, 3});
  add(7, {6, -4, 1.5});
  return points;
}

TEST(Georeferenced, AMarkIsTheSameInTheFrameOfTheLidarAndOfTheBase) {
  const test::TemporaryFolder folder;
  put_session(folder.path(), drive_with_turned_lidar());
  const Result<Georeferencing> of_base = georeference(folder.path(), marks_in_scans(false), "");
  const Result<Georeferencing> of_lidar = georeference(folder.path(), marks_in_scans(true), "");
  ASSERT_TRUE(of_base) << of_base.error().message;
  ASSERT_TRUE(of_lidar) << of_lidar.error().message;
  const Georeference& one = of_base->maps.at(0);
  const Georeference& other = of_lidar->maps.at(0);
  const auto apart = [](const Pose& a, const Pose& b) { return (a.inverse() * b).log().norm(); };
  EXPECT_LT(apart(one.T_target_map, kT_grid_hall), 0.3);
  EXPECT_LT(apart(one.T_target_map, other.T_target_map), 1e-9);
  EXPECT_LT((one.covariance - other.covariance).norm(), 1e-9);
  ASSERT_EQ(one.points.size(), other.points.size());
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    const ControlMark& kept = other.points[i].point.mark;
    EXPECT_FALSE(kept.is_in_lidar_frame) << "what is kept moves with the map";
    EXPECT_LT((kept.position - one.points[i].point.mark.position).norm(), 1e-9);
    EXPECT_LT((other.points[i].residual - one.points[i].residual).norm(), 1e-9);
  }

  std::vector<ControlPoint> mistaken = marks_in_scans(true);
  for (ControlPoint& point : mistaken) point.mark.is_in_lidar_frame = false;
  const Result<Georeferencing> off = georeference(folder.path(), mistaken, "");
  ASSERT_TRUE(off) << off.error().message;
  EXPECT_GT(apart(one.T_target_map, off->maps.at(0).T_target_map), 0.3) << "by the mount";
}

TEST(Georeferenced, WhereTheMountIsUnknownAMarkInTheFrameOfTheLidarIsRefused) {
  const test::TemporaryFolder folder;
  put_session(folder.path(), drive_with_turned_lidar());
  std::string toml = test::get_file(folder / "session.toml");
  const std::size_t mount = toml.find("mount = ");
  ASSERT_NE(mount, std::string::npos) << toml;
  toml.insert(mount, "no_");  // as an earlier version of adit wrote it
  test::put_file(folder / "session.toml", toml);
  EXPECT_ERROR(georeference(folder.path(), marks_in_scans(true), ""),
               "control point 'T1': its mark is in the LiDAR's frame, and the session does not say where the "
               "LiDAR of ada sits");
  const Result<Georeferencing> of_base = georeference(folder.path(), marks_in_scans(false), "");
  EXPECT_TRUE(of_base) << of_base.error().message;
}

}  // namespace
}  // namespace adit
