// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_worlds.hpp"

#include <gtest/gtest.h>

#include <set>

#include "adit/io/tum.hpp"
#include "support/files.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

using test::get_file;
using test::put_file;
using test::quick_config;

Result<std::vector<ListedWorld>> worlds_of(const test::TemporaryFolder& folder, const std::string& toml) {
  put_file(folder / "list.toml", toml);
  return read_world_list(folder / "list.toml");
}

TEST(WorldList, KeepsTheOrderOfTheFileAndFillsInDefaults) {
  const test::TemporaryFolder folder;
  const auto worlds = worlds_of(folder,
                                "[[world]]\nname = 'z'\ngroup = 'limit'\nnoise_seed = 5\n"
                                "world = {preset = 'mine', seed = 3, arrangement = 'twins'}\n"
                                "[[world]]\nname = 'a'\n");
  ASSERT_TRUE(worlds) << worlds.error().message;
  ASSERT_EQ(worlds->size(), 2U);
  const ListedWorld& z = worlds->at(0);
  EXPECT_EQ(z.name, "z");
  EXPECT_EQ(z.group, "limit");
  EXPECT_EQ(z.noise_seed, 5U);
  EXPECT_EQ(z.generated.preset, "mine");
  EXPECT_EQ(z.generated.seed, 3U);
  EXPECT_EQ(z.generated.arrangement, "twins");
  const ListedWorld& a = worlds->at(1);
  EXPECT_EQ(a.name, "a");
  EXPECT_EQ(a.group, "tuning");
  EXPECT_EQ(a.noise_seed, 1U);
  EXPECT_EQ(a.routes_file, "");
  EXPECT_EQ(a.generated.preset, WorldConfig{}.preset) << "nothing of the entry before";
}

TEST(WorldList, RoutesLieBesideTheList) {
  const test::TemporaryFolder folder;
  const auto worlds = worlds_of(folder,
                                "[[world]]\nname = 'a'\nroutes_file = 'sub/../routes.yaml'\n"
                                "[[world]]\nname = 'b'\nroutes_file = '/else/routes.yaml'\n");
  ASSERT_TRUE(worlds) << worlds.error().message;
  EXPECT_EQ(worlds->at(0).routes_file, (folder / "routes.yaml").string());
  EXPECT_EQ(worlds->at(1).routes_file, "/else/routes.yaml");
}

TEST(WorldList, ErrorsNameTheFileAndTheRemedy) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(worlds_of(folder, "[[world]]\ngroup = 'check'\n"),
               "list.toml: an entry has no name; add name");
  EXPECT_ERROR(worlds_of(folder, "[[world]]\nname = 'a'\n[[world]]\nname = 'a'\n"),
               "list.toml: two worlds are called 'a'; rename one");
  EXPECT_ERROR(worlds_of(folder, "[[world]]\nname = 'a'\ngroup = 'most'\n"),
               "tuning, check, field, meshes, limit");
  EXPECT_ERROR(worlds_of(folder, "[[world]]\nname = 'a'\nnoise_sed = 1\n"), "noise_seed");
  EXPECT_ERROR(worlds_of(folder, "[[world]]\nname = 'a'\nlidars = 'os2-32,os3'\n"), "world 'a': ");
  EXPECT_ERROR(worlds_of(folder, "[[world]]\nname = 'a'\nconditions = 'wet'\n"), "ideal, field");
  EXPECT_ERROR(worlds_of(folder, "[[graph]]\nname = 'a'\n"), "list.toml: line 1");
  EXPECT_ERROR(read_world_list(folder / "away.toml"), "away.toml");
}

TEST(WorldList, AWorldIsAvailableWhereItsRoutesAreOrWhereItIsGenerated) {
  const test::TemporaryFolder folder;
  ListedWorld world;
  EXPECT_TRUE(is_available(world));
  world.routes_file = (folder / "routes.yaml").string();
  EXPECT_FALSE(is_available(world));
  put_file(world.routes_file, "");
  EXPECT_TRUE(is_available(world));
}

TEST(WorldList, AWorldMayHaveSensorsAndConditionsOfItsOwn) {
  const test::TemporaryFolder folder;
  const auto worlds = worlds_of(folder,
                                "[[world]]\nname = 'a'\ngroup = 'field'\nlidars = 'os2-32, os1-64'\n"
                                "conditions = 'field'\nnoise_seed = 7\n[[world]]\nname = 'b'\n");
  ASSERT_TRUE(worlds) << worlds.error().message;
  const ScenarioConfig study = quick_config().simulation;
  const ScenarioConfig a = scenario_of(worlds->at(0), study);
  EXPECT_EQ(a.seed, 7U);
  EXPECT_EQ(sensors_text(a), "os2-32, os1-64");
  EXPECT_EQ(conditions_text(a), "field");
  const ScenarioConfig b = scenario_of(worlds->at(1), study);
  EXPECT_EQ(sensors_text(b), "vlp-16");
  EXPECT_EQ(conditions_text(b), "ideal");
  ScenarioConfig biased = a;
  biased.lidar_errors.range_bias += 0.001;
  EXPECT_EQ(conditions_text(biased), "other");
}

/// The names of the folders of maps.
std::set<std::string> kept(const std::filesystem::path& cache) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(cache))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(DrivenRobots, HaveTheNamesMapsAndTruthOfTheirRoutes) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cache");
  const ListedWorld world = test::put_short_drives(folder.path());
  const auto robots = driven_robots(world, quick_config(),
                                    {KeyframeSelection::adaptive, KeyframeSelection::all}, folder / "cache");
  ASSERT_TRUE(robots) << robots.error().message;
  ASSERT_EQ(robots->size(), 2U);
  EXPECT_EQ(robots->at(0).result.name, "ahead");
  EXPECT_EQ(robots->at(1).result.name, "behind");
  for (std::size_t r = 0; r < 2; ++r) {
    const RobotRun& robot = robots->at(r);
    EXPECT_EQ(robot.map->id.value, r);
    EXPECT_EQ(robot.paper_map->id.value, r);
    EXPECT_NEAR(robot.result.path_length_m, test::kShortDriveMetres, 0.5);
    EXPECT_GT(robot.result.keyframes, 2);
    // Each policy has the map of its own odometry, over the same scans.
    EXPECT_NE(tum_text(robot.map->odometry), tum_text(robot.paper_map->odometry));
    EXPECT_EQ(robot.map->odometry.size(), robot.paper_map->odometry.size());
  }
  EXPECT_EQ(kept(folder / "cache").size(), 2U) << "one folder per odometry";
}

TEST(DrivenRobots, AreNotDrivenAgainWhereTheCacheHasThem) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cache");
  ListedWorld world = test::put_short_drives(folder.path());
  const auto drive = [&](const std::vector<KeyframeSelection>& selections) {
    return driven_robots(world, quick_config(), selections, folder / "cache");
  };
  ASSERT_TRUE(drive({KeyframeSelection::all}));
  const std::set<std::string> first = kept(folder / "cache");
  ASSERT_EQ(first.size(), 1U);
  // A mark in the cache comes back: what is used is what the cache holds.
  const Trajectory mark{{Stamp{1}, Pose::translation_of(1, 2, 3)}, {Stamp{2}, Pose()}};
  ASSERT_TRUE(write_tum(folder / ("cache/" + *first.begin() + "/1_truth.tum"), mark));
  world.group = "check";  // changes nothing that is driven
  const auto again = drive({KeyframeSelection::tunnel_filter, KeyframeSelection::all});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(tum_text(again->at(1).truth), tum_text(mark));
  EXPECT_NE(tum_text(again->at(0).truth), tum_text(mark));
  EXPECT_EQ(again->at(0).map, again->at(0).paper_map);
  EXPECT_EQ(kept(folder / "cache"), first);

  world.noise_seed = 2;
  const auto other = drive({KeyframeSelection::all});
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_EQ(kept(folder / "cache").size(), 2U) << "other noise is another drive";
  EXPECT_NE(tum_text(other->at(0).map->odometry), tum_text(again->at(0).map->odometry));

  for (const std::string& changed : {world.routes_file, (folder / "hall.ply").string()}) {
    const std::size_t before = kept(folder / "cache").size();
    std::ofstream(changed, std::ios::app) << "\n";
    EXPECT_TRUE(drive({KeyframeSelection::all}));
    EXPECT_EQ(kept(folder / "cache").size(), before + 1) << changed;
  }
}

TEST(DrivenRobots, ADamagedCacheIsRefusedWithTheRemedy) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cache");
  const ListedWorld world = test::put_short_drives(folder.path());
  const auto drive = [&] {
    return driven_robots(world, quick_config(), {KeyframeSelection::all}, folder / "cache");
  };
  ASSERT_TRUE(drive());
  const std::filesystem::path kept_folder = folder / "cache" / *kept(folder / "cache").begin();
  const std::string remedy = "; remove " + (folder / "cache").string() + " and run again";
  std::filesystem::remove(kept_folder / "1_truth.tum");
  EXPECT_ERROR(drive(), remedy);
  put_file(kept_folder / "0.map", get_file(kept_folder / "0.map").substr(0, 1000));
  const auto damaged = drive();
  EXPECT_ERROR(damaged, "0.map");
  EXPECT_ERROR(damaged, remedy);
  std::filesystem::remove(kept_folder / "0.map");
  EXPECT_ERROR(drive(), "the maps of two robots are missing" + remedy);
}

TEST(DrivenRobots, OneRobotHasNobodyToMergeWith) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cache");
  const ListedWorld world = test::put_short_drives(folder.path(), {"alone"});
  EXPECT_ERROR(driven_robots(world, quick_config(), {KeyframeSelection::all}, folder / "cache"),
               "hall: merging needs at least two robots; add a route to ");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "cache")) << "the remedy would not help";
  test::put_short_drives(folder.path());
  EXPECT_TRUE(driven_robots(world, quick_config(), {KeyframeSelection::all}, folder / "cache"));
}

TEST(DrivenRobots, AFailedDriveLeavesNothingInTheCache) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cache");
  const ListedWorld world = test::put_short_drives(folder.path());
  put_file(folder / "hall.ply", "no mesh");
  const auto failed = driven_robots(world, quick_config(), {KeyframeSelection::all}, folder / "cache");
  EXPECT_ERROR(failed, "hall.ply");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "cache"));
}

}  // namespace
}  // namespace adit
