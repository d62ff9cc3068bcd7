// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>

#include "adit/io/mesh_files.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/tum.hpp"
#include "adit/simulation/scenario.hpp"
#include "harness/bench_case.hpp"
#include "odometry_scenes.hpp"

namespace adit::bench {
namespace {

constexpr int kTubeScans = 60;
constexpr int kSimulatedScans = 150;
constexpr int kRealScans = 300;

template <class T>
T needed(Result<T> result) {
  if (!result) throw Skipped{result.error().message};
  return *std::move(result);
}

// The first `count` scans, with wheels and truth where the recording has them.
RecordedDrive first_scans(const Recording& recording, const Trajectory& truth, int count) {
  RecordedDrive out{recording.T_base_lidar, {}, {}, {}};
  const std::size_t n = std::min(recording.num_scans(), static_cast<std::size_t>(count));
  const Pose T_world_first = needed(pose_at(truth, recording.scan_stamps.front()));
  for (std::size_t i = 0; i < n; ++i) {
    const Stamp stamp = recording.scan_stamps[i];
    out.scans.push_back(needed(recording.read_scan(i)));
    out.truth.push_back((T_world_first.inverse() * needed(pose_at(truth, stamp))).translation());
    if (recording.wheel.empty()) continue;
    out.wheels.push_back(i == 0 ? WheelDelta{}
                                : needed(wheel_delta(recording.wheel, recording.scan_stamps[i - 1], stamp)));
  }
  return out;
}

RecordedDrive simulated(const World& world) {
  const std::vector<Recording> recordings = needed(simulate(world, ScenarioConfig{}));
  return first_scans(recordings.front(), recordings.front().truth, kSimulatedScans);
}

RecordedDrive simulated_mesh(const std::string& name) {
  World world;
  world.name = name;
  world.mesh = needed(read_mesh(shared_data("worlds/" + name + "/world.ply")));
  world.routes = needed(read_routes(shared_data("worlds/" + name + "/routes.yaml"))).routes;
  return simulated(world);
}

RecordedDrive tube() {
  const TubeDrive tube(128, 1024);
  RecordedDrive out;
  for (int i = 0; i < kTubeScans; ++i) {
    out.scans.push_back(tube.scan(i));
    out.wheels.push_back(tube.wheels(i));
    out.truth.push_back((tube.truth(0).inverse() * tube.truth(i)).translation());
  }
  return out;
}

RecordedDrive nclt() {
  const auto folder = shared_data("scans/nclt");
  return first_scans(needed(open_recording(folder.string())), needed(read_tum(folder / "groundtruth.tum")),
                     kRealScans);
}

test::Scene tube_with_boxes() {
  test::Scene scene = test::smooth_tube();
  for (int i = 0; i < 12; ++i) {
    const double x = 8.0 + 11.0 * i + 2.0 * (i % 3);
    const double y = i % 2 == 0 ? -3.4 : 2.6;
    scene.boxes.push_back({{x, y, -2.0}, {x + 0.8, y + 0.8, -0.5}});
  }
  return scene;
}

}  // namespace

TubeDrive::TubeDrive(int rings, int columns)
    : scene(tube_with_boxes()),
      lidar{rings, columns, 0.196, 120.0, 0.02},
      drive{Pose(), (Vector6() << 1.87, 0, 0, 0, 0, 0.02).finished()} {}
Scan TubeDrive::scan(int i) const { return test::scan_of(scene, lidar, Pose(), drive, i); }
WheelDelta TubeDrive::wheels(int i) const { return test::wheels_of(lidar, drive, i, 1.02); }
Pose TubeDrive::truth(int i) const { return drive.at(i * to_seconds(lidar.period)); }

const std::vector<OdometryScene>& odometry_scenes() {
  static const std::vector<OdometryScene> scenes = {
      {"tube", "smooth straight tube with boxes, 128 rings of 1,024 points, scans 1 to 60", kTubeScans, true,
       tube},
      {"zab", "world zab, seed 1, simulated OS2-128, scans 1 to 150", kSimulatedScans, true,
       [] { return simulated(needed(make_world({}))); }},
      {"cave", "darpa_cave_01, simulated OS2-128, scans 1 to 150", kSimulatedScans, true,
       [] { return simulated_mesh("darpa_cave_01"); }},
      {"mine", "pittsburgh_mine, simulated OS2-128, scans 1 to 150", kSimulatedScans, true,
       [] { return simulated_mesh("pittsburgh_mine"); }},
      {"nclt", "NCLT, 300 real scans of a campus, without times and wheels", kRealScans, false, nclt}};
  return scenes;
}

const OdometryScene& odometry_scene(const std::string& name) {
  return *std::ranges::find(odometry_scenes(), name, &OdometryScene::name);
}

}  // namespace adit::bench
