// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/mapping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "adit/slam/merge_pictures.hpp"
#include "adit/slam/naming.hpp"
#include "adit/slam/session_pages.hpp"
#include "adit/slam/slam.hpp"
#include "support/files.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

constexpr std::size_t kNumScans = 6;

/// What a LiDAR one metre above `x` on the floor sees of a hall with two pillars.
Scan seen_from(double x, Stamp stamp) {
  test::Scene hall;
  hall.rooms = {{Vector3(-10, -5, 0), Vector3(30, 5, 5)}};
  hall.boxes = {{Vector3(6, 2, 0), Vector3(7, 3, 5)}, {Vector3(12, -4, 0), Vector3(13, -2, 5)}};
  return test::sweep(hall, test::Lidar{}, Pose::translation_of(0, 0, 1), stamp,
                     [x](Duration) { return Pose::translation_of(x, 0, 0); });
}

/// A robot without wheels that drives along the hall in steps of half a metre, from `start` metres on.
Recording drive(const std::string& name, double start = 0.0) {
  Recording recording;
  recording.name = name;
  recording.T_base_lidar = Pose::translation_of(0, 0, 1);
  for (std::size_t i = 0; i < kNumScans; ++i)
    recording.scan_stamps.push_back(Stamp{static_cast<std::int64_t>(i + 1) * 100'000'000});
  recording.read_scan = [start, stamps = recording.scan_stamps](std::size_t i) -> Result<Scan> {
    return seen_from(start + 0.5 * static_cast<double>(i), stamps.at(i));
  };
  return recording;
}

Recording broken(const std::string& name) {
  Recording recording = drive(name);
  recording.read_scan = [](std::size_t) -> Result<Scan> { return fail("scan 3 is damaged"); };
  return recording;
}

TEST(Mapping, ARobotThatCannotBeMappedStopsNoOther) {
  const Result<Mapping> mapping = map_robots({drive("ada"), broken("bo"), drive("cy")}, SlamConfig{});
  ASSERT_TRUE(mapping.has_value()) << mapping.error().message;
  ASSERT_EQ(mapping->robots.size(), 2U);
  EXPECT_EQ(mapping->robots[0].map->name, "ada");
  EXPECT_EQ(mapping->robots[1].map->name, "cy");
  EXPECT_EQ(mapping->robots[1].map->id, (RobotId{2}));
  ASSERT_EQ(mapping->failed.size(), 1U);
  EXPECT_EQ(mapping->failed[0].name, "bo");
  EXPECT_EQ(mapping->failed[0].reason, "bo: 6 of 6 scans are left out; the first, 0: scan 3 is damaged");
}

TEST(Mapping, ADamagedScanCostsItself) {
  Recording recording = drive("ada");
  recording.read_scan = [read = recording.read_scan](std::size_t i) -> Result<Scan> {
    if (i == 3) return fail("a byte has flipped");
    return read(i);
  };
  const Result<Mapping> mapping = map_robots({recording}, SlamConfig{});
  ASSERT_TRUE(mapping) << mapping.error().message;
  EXPECT_EQ(
      std::ranges::count(mapping->notes, "ada: 1 of 6 scans are left out; the first, 3: a byte has flipped"),
      1);
  EXPECT_EQ(mapping->robots.at(0).map->odometry.size(), kNumScans);
}

TEST(Mapping, ASensorThatWouldSpoilTheMapIsNotedUnlessChecksAreOff) {
  Recording recording = drive("ada");
  recording.imu_covariance = {Matrix3::Identity() * 1e-6, Matrix3::Identity() * 1e-3};
  for (int i = 0; i <= 100; ++i)  // in no unit
    recording.imu.push_back({Stamp{i * 10'000'000LL}, Vector3::Zero(), Vector3(0, 0, 1000)});
  SlamConfig config;
  const Result<Mapping> checked = map_robots({recording}, config);
  ASSERT_TRUE(checked) << checked.error().message;
  ASSERT_FALSE(checked->notes.empty());
  EXPECT_TRUE(checked->notes.front().starts_with("ada: imu: it is left out, as its acceleration is 1000"))
      << checked->notes.front();
  config.check_sensors = false;
  const Result<Mapping> unchecked = map_robots({recording}, config);
  ASSERT_TRUE(unchecked) << unchecked.error().message;
  for (const std::string& note : unchecked->notes) EXPECT_EQ(note.find("imu"), std::string::npos) << note;
}

TEST(Mapping, TheMountIsThatOfTheRecordedCloudsOrUnknown) {
  Recording on_a_mast = drive("bo", 0.1);
  on_a_mast.clouds_in_mount_frame = false;
  const Result<Mapping> mapping = map_robots({drive("ada"), on_a_mast}, SlamConfig{});
  ASSERT_TRUE(mapping) << mapping.error().message;
  ASSERT_TRUE(mapping->robots.at(0).T_base_lidar);
  EXPECT_EQ(mapping->robots[0].T_base_lidar->translation(), Vector3(0, 0, 1));
  EXPECT_FALSE(mapping->robots.at(1).T_base_lidar);
}

TEST(Mapping, WhereNoRobotIsLeftThereIsNoMap) {
  EXPECT_ERROR(map_robots({broken("bo")}, SlamConfig{}), "scan 3 is damaged");
  EXPECT_ERROR(map_robots({}, SlamConfig{}), "no recording");
}

TEST(Mapping, WithoutWheelsKissIcpRunsWithANote) {
  const Result<Mapping> mapping = map_robots({drive("ada")}, SlamConfig{});
  ASSERT_TRUE(mapping.has_value()) << mapping.error().message;
  EXPECT_EQ(mapping->robots[0].odometry, "kiss-icp");
  ASSERT_EQ(mapping->notes.size(), 1U);
  EXPECT_NE(mapping->notes[0].find("ada: no wheel odometry"), std::string::npos) << mapping->notes[0];
  EXPECT_NE(mapping->notes[0].find("plane-icp"), std::string::npos) << mapping->notes[0];

  SlamConfig asked_for;
  ASSERT_TRUE(set_field(fields_of(asked_for), "robot.odometry.method", "kiss-icp"));
  EXPECT_TRUE(map_robots({drive("ada")}, asked_for)->notes.empty());
}

TEST(Mapping, WithAnImuPlaneIcpNeedsNoWheels) {
  Recording recording = drive("ada");
  recording.imu_covariance = {Matrix3::Identity() * 1e-6, Matrix3::Identity() * 1e-3};
  for (int i = 0; i <= 100; ++i)
    recording.imu.push_back({Stamp{i * 10'000'000LL}, Vector3::Zero(), Vector3(0, 0, 9.81)});
  SlamConfig config;
  config.check_sensors = false;
  const Result<Mapping> mapping = map_robots({recording}, config);
  ASSERT_TRUE(mapping.has_value()) << mapping.error().message;
  EXPECT_EQ(mapping->robots[0].odometry, "plane-icp");
  EXPECT_TRUE(mapping->notes.empty());
}

// As those of a mount that is wrong look, or of wheels of another size.
TEST(Mapping, WheelsThatSlipNearlyAllTheWayAreNoted) {
  const auto notes_with = [](double counted) {  // metres by the wheels in each step, of which 0.3 are driven
    Recording recording = drive("ada");
    recording.scan_stamps.clear();
    for (std::size_t i = 0; i < 40; ++i) {
      recording.scan_stamps.push_back(Stamp{static_cast<std::int64_t>(i + 1) * 100'000'000});
      const double steps = static_cast<double>(i);
      recording.wheel.push_back(
          {recording.scan_stamps.back(),
           Pose::translation_of(steps < 3.0 ? 0.3 * steps : 0.6 + counted * (steps - 2.0), 0, 0)});
    }
    recording.read_scan = [stamps = recording.scan_stamps](std::size_t i) -> Result<Scan> {
      return seen_from(0.3 * static_cast<double>(i), stamps.at(i));
    };
    SlamConfig config;
    config.check_sensors = false;  // which leaves such wheels out, where it sees them
    return map_robots({recording}, config).value().notes;
  };
  EXPECT_TRUE(notes_with(0.3).empty());
  const std::vector<std::string> notes = notes_with(0.9);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].starts_with("ada: by the scans the wheels slipped for ")) << notes[0];
  EXPECT_NE(notes[0].find("the mount of the LiDAR"), std::string::npos) << notes[0];
}

TEST(Mapping, MoreRobotsThanIdsAreRefused) {
  const std::vector<Recording> many(257, drive("ada"));
  EXPECT_ERROR(map_robots(many, SlamConfig{}), "at most 256 robots");
}

TEST(Naming, NamesBecomeFoldersOfTheirOwn) {
  std::vector<Recording> recordings = {drive("ada"), drive("ada"), drive("../etc"), drive("bo")};
  const std::vector<std::string> notes = name_robots(recordings);
  EXPECT_EQ(recordings[0].name, "ada");
  EXPECT_EQ(recordings[1].name, "ada_2");
  EXPECT_EQ(recordings[2].name, "___etc");
  EXPECT_EQ(recordings[3].name, "bo");
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[0].find("'ada'; here it is ada_2"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find("NAME=FILE"), std::string::npos) << notes[0];
}

TEST(Slam, ASessionStaysInItsFolderWhateverRobotsAreCalled) {
  const Result<SlamRun> run = slam({drive(".."), broken("a,\"b\"\n"), drive("..", 0.1)});
  ASSERT_TRUE(run.has_value()) << run.error().message;
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "out");
  ASSERT_TRUE(write_slam(folder / "out", *run).has_value());
  EXPECT_EQ(test::num_entries(folder.path()), 1U);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/robot/trajectory.tum"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/robot_2/trajectory.tum"));

  const Result<SavedSession> saved = read_session(folder / "out");
  ASSERT_TRUE(saved.has_value()) << saved.error().message;
  EXPECT_EQ(saved->robots, (std::vector<std::string>{"robot", "robot_2"}));
  ASSERT_EQ(saved->provenance.robots.size(), 3U);
  EXPECT_EQ(saved->provenance.robots[0].odometry, "kiss-icp");
  EXPECT_EQ(saved->provenance.robots[0].scans, kNumScans);
  EXPECT_EQ(saved->provenance.robots[2].name, "a__b__");
  EXPECT_EQ(saved->provenance.robots[2].failure,
            "a__b__: 6 of 6 scans are left out; the first, 0: scan 3 is damaged");
  const std::string metrics = test::get_file(folder / "out/metrics.json");
  EXPECT_NE(metrics.find("\"odometry\": \"kiss-icp\""), std::string::npos) << metrics;
  EXPECT_NE(test::get_file(folder / "out/report.html").find("odometry kiss-icp"), std::string::npos);
}

TEST(Slam, WhatMessagesCouldNotBringStopsNoRun) {
  SlamConfig config;
  config.bus.loss = 0.95;
  const Result<SlamRun> run = slam({drive("ada"), drive("bo", 0.1)}, config);
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(std::ranges::count_if(run->notes,
                                  [](const std::string& note) {
                                    return note.starts_with("bo: of ") && note.find(" ada did not hear") < 99;
                                  }),
            1);
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_slam(folder.path(), *run));
  const Result<SavedFleet> saved = read_fleet(folder.path());
  ASSERT_TRUE(saved) << saved.error().message;
  ASSERT_EQ(saved->maps.size(), 2U);
  for (const auto& map : run->session.maps) {
    EXPECT_FALSE(map->keyframes.empty());
    EXPECT_EQ(run->session.solution.T_world_keyframe.at(map->id).size(), map->keyframes.size()) << map->name;
  }
}

/// The odometry of each robot, by name.
std::map<std::string, std::string> odometries_in(const SlamRun& run) {
  std::map<std::string, std::string> odometries;
  const nlohmann::json metrics = nlohmann::json::parse(session_metrics(run));
  for (const auto& robot : metrics["robots"]) odometries[robot["name"]] = robot["odometry"];
  return odometries;
}

TEST(Slam, EveryRobotHasItsOwnOdometryHoweverOthersOfItsNameEnded) {
  const std::map<std::string, std::string> both = {{"ada", "kiss-icp"}, {"cy", "kiss-icp"}};
  const Result<SlamRun> first = slam({drive("ada"), broken("cy")});
  ASSERT_TRUE(first) << first.error().message;
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_slam(folder.path(), *first));
  SavedFleet saved = read_fleet(folder.path()).value();
  const Result<SlamRun> grown = slam_on({saved}, {drive("cy", 0.1)}, {});
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_EQ(odometries_in(*grown), both);
  ASSERT_EQ(grown->session.provenance.robots.size(), 3U) << "that it failed is not forgotten";

  saved.provenance.robots.back() = {"cy", "another", "", 3, ""};  // a robot without keyframes
  EXPECT_EQ(odometries_in(slam_on({saved}, {drive("cy", 0.1)}, {}).value()), both);
  saved.provenance.robots.clear();  // as where an earlier version saved it
  EXPECT_EQ(odometries_in(slam_on({saved}, {}, {}).value()).at("ada"), "");
}

/// A session of these recordings, saved and read again.
SavedFleet saved_session(const std::filesystem::path& folder, const std::vector<Recording>& recordings) {
  std::filesystem::create_directories(folder);
  const Result<SlamRun> run = slam(recordings);
  EXPECT_TRUE(run && write_slam(folder, *run));
  return read_fleet(folder).value();
}

std::vector<std::string> names_in(const SlamRun& run) {
  std::vector<std::string> names;
  for (const auto& map : run.session.maps) names.push_back(map->name);
  return names;
}

std::ptrdiff_t num_with(const std::vector<std::string>& notes, std::string_view text) {
  return std::ranges::count_if(notes,
                               [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST(Slam, ARobotThatIsThereTwiceCountsOnce) {
  const test::TemporaryFolder folder;
  const auto team_a = [&] { return saved_session(folder / "a", {drive("ada"), drive("bo", 0.1)}); };
  const SavedFleet team_b = saved_session(folder / "b", {drive("ada"), drive("cy", 0.2)});
  const Result<SlamRun> joined = slam_on({team_a(), team_b}, {}, {});
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_EQ(names_in(*joined), (std::vector<std::string>{"ada", "bo", "cy"}));
  EXPECT_EQ(num_with(joined->notes, (folder / "b").string() + " and ada of "), 1);
  EXPECT_EQ(num_with(joined->notes, "is called"), 0);
  EXPECT_EQ(joined->session.solution.pairs.size(), 3U);
  ASSERT_EQ(joined->session.provenance.robots.size(), 4U);
  EXPECT_NE(joined->session.provenance.robots[2].failure.find("have the same map"), std::string::npos);
  EXPECT_EQ(odometries_in(*joined).at("ada"), "kiss-icp");

  const Result<SlamRun> again = slam_on({team_a()}, {drive("ada")}, {});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(names_in(*again), (std::vector<std::string>{"ada", "bo"}));
  EXPECT_EQ(num_with(again->notes, "ada_2 is left out: it has the same map as ada"), 1);
  EXPECT_EQ(num_with(again->notes, "is called"), 0) << "its name is of no interest";
  EXPECT_TRUE(again->failed.empty());

  const Result<SlamRun> twice = slam({drive("ada"), drive("bo")});
  ASSERT_TRUE(twice) << twice.error().message;
  EXPECT_EQ(names_in(*twice), std::vector<std::string>{"ada"});
  EXPECT_EQ(num_with(twice->notes, "bo is left out: it has the same map as ada"), 1);
}

TEST(MarkSlips, MarksThePathFromTheKeyframeBeforeToTheOneAfter) {
  LoopMap drawn;
  drawn.robots = {{"b", 0, {}}, {"a", 0, {}}};
  const auto map = std::make_shared<RobotMap>();
  map->name = "a";
  for (int k = 0; k < 5; ++k) {
    map->keyframes.push_back({{{0}, static_cast<std::uint32_t>(k)}, Stamp{10LL * k}, Pose(), nullptr});
    drawn.robots[1].path.emplace_back(k, 0.0, 0.0);
  }
  map->slips = {{Stamp{12}, Stamp{28}, 1.0},
                {Stamp{41}, Stamp{45}, 1.0}};  // the second: after the last keyframe
  mark_slips(drawn, {map});
  EXPECT_TRUE(drawn.robots[0].slips.empty());
  ASSERT_EQ(drawn.robots[1].slips.size(), 2U);
  EXPECT_EQ(drawn.robots[1].slips[0].size(), 3U);  // keyframes 1, 2, 3
  EXPECT_EQ(drawn.robots[1].slips[0].front().x(), 1.0);
  EXPECT_EQ(drawn.robots[1].slips[1].size(), 1U);
}

TEST(MergePictures, LoopsWhoseGraphHasNotComeAreNotDrawn) {
  FleetGraph fleet;
  fleet.robots[{0}] = {"ada", std::vector<GraphNode>(3)};
  fleet.robots[{1}] = {"bo", std::vector<GraphNode>(3)};
  MergeCheck& check = fleet.checks[{{0}, {1}}];
  check.b = {1};
  for (const auto& [from, to] :
       std::vector<std::pair<std::uint32_t, std::uint32_t>>{{1, 2}, {1, 7}, {7, 1}}) {
    LoopClosure loop;
    loop.from = {{0}, from};
    loop.to = {{1}, to};
    fleet.loops[{loop.from, loop.to}] = loop;
    check.loops.emplace_back(from, to);
  }
  check.hypotheses = {{HypothesisOutcome::unsure, 1.0, 4, 4, 0.0, check.loops}};
  FleetSolution solution;
  solution.pairs.emplace_back().b = {1};
  const std::vector<MergePicture> pictures = merge_pictures(fleet, solution);
  ASSERT_EQ(pictures.size(), 1U);
  ASSERT_EQ(pictures[0].hypotheses.size(), 1U);
  EXPECT_EQ(pictures[0].hypotheses[0].loops.size(), 1U);
}

}  // namespace
}  // namespace adit
