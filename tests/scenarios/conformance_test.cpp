// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Small files that others' descriptions of the formats made, and what adit has to find in them
// (tests/conformance/README.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/rpe.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/tum.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

const fs::path kCases = ADIT_CONFORMANCE;

TEST(Conformance, EveryFileIsUnderstoodAsItsCaseSays) {
  int num_cases = 0;
  for (const auto& entry : fs::directory_iterator(kCases)) {
    if (entry.path().extension() != ".json") continue;
    const std::string file = (kCases / entry.path().stem()).string();
    const test::ProgramRun run = test::run_adit("--json info " + file);
    ASSERT_EQ(run.exit_code, 0) << file << ": " << run.err;
    std::string said = run.out;
    const std::string folder = kCases.string() + "/";  // in the command to type next
    for (std::size_t at = 0; (at = said.find(folder, at)) != std::string::npos;)
      said.erase(at, folder.size());
    EXPECT_EQ(nlohmann::json::parse(said), nlohmann::json::parse(test::get_file(entry.path()))) << file;
    ++num_cases;
  }
  EXPECT_EQ(num_cases, 19);
}

// The formula of make_recordings.py.
TEST(Conformance, ThePointsOfOneTubeComeOutOfEveryStorage) {
  constexpr std::size_t kNumPoints = 48;
  for (const std::string file : {"tube.mcap", "tube_lz4.mcap", "tube_zstd.mcap", "tube_split", "tube.db3",
                                 "tube.bag", "tube_bz2.bag", "tube_lz4.bag", "tube_pcd", "tube_kitti"}) {
    const bool kitti = file == "tube_kitti";  // which has neither times of points nor wheels
    const Result<Recording> recording = open_recording((kCases / file).string());
    ASSERT_TRUE(recording) << recording.error().message;
    ASSERT_EQ(recording->num_scans(), 3U);
    for (std::size_t s = 0; s < 3; ++s) {
      const Result<Scan> scan = recording->read_scan(s);
      ASSERT_TRUE(scan) << scan.error().message;
      ASSERT_EQ(scan->cloud.size(), kNumPoints) << file;
      ASSERT_EQ(scan->cloud.intensities.size(), kNumPoints) << file;
      ASSERT_EQ(scan->cloud.has_times(), !kitti) << file;
      for (std::size_t i = 0; i < kNumPoints; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kNumPoints;
        const Vector3 p(4.0 * static_cast<double>(i % 3) - 0.5 * static_cast<double>(s),
                        2.0 * std::cos(angle), 2.0 * std::sin(angle));
        EXPECT_LT((scan->cloud.points[i].cast<double>() - p).norm(), 1e-6) << file << " " << i;
        EXPECT_EQ(scan->cloud.intensities[i], static_cast<float>(i)) << file;
        if (kitti) continue;
        EXPECT_NEAR(static_cast<double>(scan->cloud.time_offsets_ns[i]),
                    1e8 * static_cast<double>(i) / kNumPoints, 10.0)
            << file;
      }
    }
    if (kitti) {
      ASSERT_EQ(recording->truth.size(), 3U);
      const Pose T_0_2 = recording->truth[0].T_world_body.inverse() * recording->truth[2].T_world_body;
      EXPECT_NEAR((T_0_2.translation() - Vector3(1.0, 0.0, 0.0)).norm(), 0.0, 1e-12);
      continue;
    }
    ASSERT_EQ(recording->wheel.size(), 7U) << file;
    for (std::size_t i = 0; i < recording->wheel.size(); ++i)
      EXPECT_NEAR(recording->wheel[i].T_world_body.translation().x(), 0.25 * static_cast<double>(i), 1e-12);
  }
}

// Its 48 points a scan are too few to be registered, and wheels alone make no map.
TEST(Conformance, OfTheTubeSlamAndOdometryMapNothing) {
  const test::TemporaryFolder folder;
  const std::string tube = (kCases / "tube.mcap").string();
  const std::string out = " --out " + (folder / "x.tum").string();
  test::expect_refused("slam " + tube + " --out " + (folder / "session").string(), 1,
                       "none of 3 scans could be mapped");
  test::expect_refused("odometry " + tube + out, 1, "none of 3 scans could be mapped");
  const std::string without = test::run_adit("odometry " + tube + " --wheel none" + out).err;
  EXPECT_NE(without.find("so kiss-icp (LiDAR alone) instead of plane-icp"), std::string::npos) << without;
  const std::string found = test::run_adit("doctor " + tube).out;
  EXPECT_NE(found.find("PROBLEM  mapping: nothing can be mapped"), std::string::npos) << found;
  EXPECT_NE(found.find("?        wheels and IMU: too little motion"), std::string::npos) << found;
  const std::string folder_found = test::run_adit("doctor " + (kCases / "tube_kitti").string()).out;
  EXPECT_NE(folder_found.find("-> put odometry.tum"), std::string::npos) << folder_found;
  EXPECT_EQ(folder_found.find("TOPIC"), std::string::npos) << folder_found;
}

constexpr double kEqual = 1e-6;  // as many digits as the files of trajectories have, and some operations

void expect_rpe(const RpeResult& found, const nlohmann::json& expected) {
  const nlohmann::json& translation = expected["rpe_translation_m"];
  const nlohmann::json& rotation = expected["rpe_rotation_rad"];
  EXPECT_EQ(found.translation_errors_m.size(), translation["segments"]);
  EXPECT_NEAR(found.translation_rmse_m, translation["rmse"], kEqual);
  EXPECT_NEAR(found.translation_median_m, translation["median"], kEqual);
  EXPECT_NEAR(std::ranges::max(found.translation_errors_m), translation["max"], kEqual);
  EXPECT_NEAR(found.rotation_rmse_rad, rotation["rmse"], kEqual);
  EXPECT_NEAR(found.rotation_median_rad, rotation["median"], kEqual);
  EXPECT_NEAR(std::ranges::max(found.rotation_errors_rad), rotation["max"], kEqual);
}

TEST(Conformance, ErrorsOfTrajectoriesAreThoseOfEvo) {
  const Trajectory truth = read_tum(kCases / "evo/truth.tum").value();
  const Trajectory estimate = read_tum(kCases / "evo/estimate.tum").value();
  const nlohmann::json expected = nlohmann::json::parse(test::get_file(kCases / "evo/errors.json"));
  const AteResult absolute = ate(estimate, truth).value();
  const nlohmann::json& ape = expected["ape_translation_m"];
  EXPECT_NEAR(absolute.rmse_m, ape["rmse"], kEqual);
  EXPECT_NEAR(absolute.mean_m, ape["mean"], kEqual);
  EXPECT_NEAR(absolute.median_m, ape["median"], kEqual);
  EXPECT_NEAR(absolute.max_m, ape["max"], kEqual);
  expect_rpe(rpe(estimate, truth, 10.0, 0.05).value(), expected);
}

// Where a step is as long as a tenth of the segment, the pose nearest to its end is often before it.
TEST(Conformance, ErrorsOverIrregularStepsAreThoseOfEvosDefinition) {
  const Trajectory truth = read_tum(kCases / "evo/irregular_truth.tum").value();
  const Trajectory estimate = read_tum(kCases / "evo/irregular_estimate.tum").value();
  expect_rpe(rpe(estimate, truth).value(),
             nlohmann::json::parse(test::get_file(kCases / "evo/irregular_errors.json")));
}

TEST(Conformance, MapsOfAllLayoutsAreReadForEver) {
  for (const char* name : {"robot_map_7.adit", "robot_map_8.adit"}) {
    SCOPED_TRACE(name);
    const Result<RobotMap> map = read_robot_map(kCases / name);
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->id, (RobotId{2}));
    EXPECT_EQ(map->viewpoint, Vector3(0.1, 0.2, 0.9));
    ASSERT_EQ(map->slips.size(), 1U);
    EXPECT_EQ(map->slips.front().counted_m, 0.25);
    ASSERT_EQ(map->keyframes.size(), 2U);
    EXPECT_EQ(map->keyframes[1].id, (KeyframeId{{2}, 1}));
    EXPECT_EQ(map->keyframes[1].stamp.ns, 1'200'000'000);
    EXPECT_EQ(map->keyframes[1].cloud->points[1], Eigen::Vector3f(4.0F, 5.0F, 7.0F));
    EXPECT_EQ(map->step_covariances[1], 0.01 * Matrix6::Identity());
    EXPECT_TRUE(map->searchable[0]);
    EXPECT_EQ(map->unconfirmed[1], 0.125F);
    EXPECT_EQ(robot_map_bytes(*map), robot_map_bytes(read_robot_map(kCases / "robot_map_8.adit").value()));
  }
}

}  // namespace
}  // namespace adit
