// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_worlds.hpp"

#include <algorithm>
#include <deque>
#include <set>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/tum.hpp"
#include "adit/io/world_files.hpp"
#include "adit/slam/mapping.hpp"
#include "adit/slam/robot_facts.hpp"

namespace adit {
namespace {

Fields fields_of(ListedWorld& c) {
  Fields fields = {
      {"name", &c.name, "", 0, 0, "what tables and caches call the world"},
      {"group", &c.group, "", 0, 0,
       "tuned on, kept for the check, drawn after the policy was frozen, meshes of other makers, or beyond "
       "what measurement can decide",
       world_groups()},
      {"noise_seed", &c.noise_seed, "", 0, 1e15, "seed of all noise of sensors and wheels"},
      {"lidars", &c.lidars, "", 0, 0, "LiDARs of the robots in turn; empty: as the study has them"},
      {"conditions",
       &c.conditions,
       "",
       0,
       0,
       "conditions of the simulation; empty: as the study has them",
       {"", "ideal", "field"}},
      {"routes_file", &c.routes_file, "", 0, 0, "routes.yaml of a mesh on disk"}};
  append(fields, "world", adit::fields_of(c.generated));
  return fields;
}

Result<> check(const std::deque<ListedWorld>& worlds) {
  std::set<std::string> names;
  for (const ListedWorld& world : worlds) {
    if (world.name.empty()) return fail("an entry has no name; add name = \"...\"");
    if (!names.insert(world.name).second)
      return fail("two worlds are called '" + world.name + "'; rename one");
    if (const auto lidars = lidars_of(scenario_of(world, {})); !lidars)
      return fail("world '" + world.name + "'", lidars.error());
  }
  return {};
}

/// CRC-32 of the routes file and of the mesh that it names; 0 for a world that is generated.
Result<std::uint32_t> checksum_of_files(const ListedWorld& world) {
  if (world.routes_file.empty()) return 0U;
  const Result<RoutesFile> routes = read_routes(world.routes_file);
  if (!routes) return tl::unexpected(routes.error());
  std::uint32_t checksum = 0;
  for (const std::filesystem::path& file : {std::filesystem::path(world.routes_file), routes->world}) {
    if (file.empty()) continue;  // routes without a mesh are refused where the world is loaded
    const Result<std::string> bytes = read_bytes(file);
    if (!bytes) return tl::unexpected(bytes.error());
    checksum = crc32(*bytes, checksum);
  }
  return checksum;
}

/// Everything that decides what the robots record; a world may change its group.
std::string key_of(ListedWorld world, std::uint32_t files, ScenarioConfig simulation, RobotSlamConfig robot) {
  world.group = ListedWorld{}.group;
  Fields fields = fields_of(world);
  append(fields, "simulation", adit::fields_of(simulation));
  append(fields, "robot", adit::fields_of(robot));
  return format("{:08x}", crc32(std::string(version()) + to_toml(fields), files));
}

std::filesystem::path map_file(const std::filesystem::path& folder, std::size_t robot) {
  return folder / format("{}.map", robot);
}

std::filesystem::path truth_file(const std::filesystem::path& folder, std::size_t robot) {
  return folder / format("{}_truth.tum", robot);
}

/// The maps of one odometry in a world, and the folder that keeps them.
struct Drives {
  RobotSlamConfig config;
  std::filesystem::path folder;
};

/// Maps one recording under each configuration and writes the result into its folder.
Result<> record(const Recording& recording, std::size_t robot, const std::vector<RobotSlamConfig>& configs,
                const std::vector<OutputDir>& folders, const Phase& phase) {
  const auto observer = [&](std::size_t) {
    phase.advance();
    return true;
  };
  const Result<std::vector<RobotMap>> maps =
      map_recording(recording, {static_cast<std::uint8_t>(robot)}, configs, observer);
  if (!maps) return tl::unexpected(maps.error());
  Result<> done;
  for (std::size_t i = 0; done && i < maps->size(); ++i) {
    done = write_robot_map(map_file(folders[i].path(), robot), (*maps)[i]).and_then([&] {
      return write_tum(truth_file(folders[i].path(), robot), recording.truth);
    });
  }
  return done;
}

/// Drives all robots of the world; each folder appears whole or not at all.
Result<> record_all(const ListedWorld& listed, const ScenarioConfig& simulation,
                    const std::vector<Drives>& wanted) {
  const Result<World> world = world_of(listed);
  if (!world) return tl::unexpected(world.error());
  const Result<std::vector<Recording>> recordings = simulate(*world, simulation);
  if (!recordings) return tl::unexpected(recordings.error());
  if (recordings->size() < 2)
    return fail(listed.name + ": merging needs at least two robots; add a route to " + listed.routes_file);
  std::vector<RobotSlamConfig> configs;
  std::vector<OutputDir> folders;
  for (const Drives& drives : wanted) {
    Result<OutputDir> out = OutputDir::create(drives.folder, "maps");
    if (!out) return tl::unexpected(out.error());
    configs.push_back(drives.config);
    folders.push_back(std::move(*out));
  }
  const Phase phase("mapping " + listed.name, num_scans(*recordings));
  std::vector<Result<>> done(recordings->size());
  parallel_for_each(recordings->size(),
                    [&](std::size_t i) { done[i] = record((*recordings)[i], i, configs, folders, phase); });
  const auto failed = std::ranges::find_if(done, [](const Result<>& result) { return !result; });
  if (failed != done.end()) return *failed;
  for (OutputDir& folder : folders)
    if (const Result<> committed = folder.commit(); !committed) return committed;
  return {};
}

Result<std::shared_ptr<const RobotMap>> read_map(const std::filesystem::path& folder, std::size_t robot) {
  return read_robot_map(map_file(folder, robot)).map([](RobotMap&& map) {
    return std::make_shared<const RobotMap>(std::move(map));
  });
}

/// The first folder holds the maps of the configured odometry, the last those of the paper's.
Result<RobotRun> read_robot(const std::vector<Drives>& drives, std::size_t robot) {
  Result<std::shared_ptr<const RobotMap>> map = read_map(drives.front().folder, robot);
  if (!map) return tl::unexpected(map.error());
  Result<std::shared_ptr<const RobotMap>> paper_map =
      drives.size() == 1 ? map : read_map(drives.back().folder, robot);
  if (!paper_map) return tl::unexpected(paper_map.error());
  Result<Trajectory> truth = read_tum(truth_file(drives.front().folder, robot));
  if (!truth) return tl::unexpected(truth.error());
  RobotRun run{*map, *paper_map, {}, std::move(*truth), {}};
  run.result = robot_facts(*run.map, run.truth);
  return run;
}

}  // namespace

std::vector<std::string> world_groups() { return {"tuning", "check", "field", "meshes", "limit"}; }

Result<std::vector<ListedWorld>> read_world_list(const std::filesystem::path& list) {
  std::deque<ListedWorld> worlds;  // Entries stay where they are while others are added.
  const Result<> loaded =
      load_entries(list, "world", [&] { return fields_of(worlds.emplace_back()); }).and_then([&] {
        return check(worlds).map_error(
            [&](const Error& error) { return Error{list.string() + ": " + error.message}; });
      });
  if (!loaded) return tl::unexpected(loaded.error());
  for (ListedWorld& world : worlds)
    if (!world.routes_file.empty())
      world.routes_file = (list.parent_path() / world.routes_file).lexically_normal().string();
  return std::vector<ListedWorld>(worlds.begin(), worlds.end());
}

ScenarioConfig scenario_of(const ListedWorld& world, ScenarioConfig simulation) {
  simulation.seed = world.noise_seed;
  if (!world.lidars.empty()) simulation.lidars = world.lidars;
  for (const Conditions conditions : kConditions)
    if (world.conditions == to_string(conditions)) set_conditions(conditions, simulation);
  return simulation;
}

std::string conditions_text(const ScenarioConfig& simulation) {
  const auto text_of = [](ScenarioConfig config) { return to_toml(adit::fields_of(config)); };
  for (const Conditions conditions : kConditions) {
    ScenarioConfig preset = simulation;
    set_conditions(conditions, preset);
    if (text_of(preset) == text_of(simulation)) return std::string(to_string(conditions));
  }
  return "other";
}

Result<World> world_of(const ListedWorld& world) {
  return world.routes_file.empty() ? make_world(world.generated) : load_world({}, world.routes_file);
}

bool is_available(const ListedWorld& world) {
  return world.routes_file.empty() || std::filesystem::exists(world.routes_file);
}

Result<std::vector<RobotRun>> driven_robots(const ListedWorld& world, RunConfig config,
                                            const std::vector<KeyframeSelection>& selections,
                                            const std::filesystem::path& cache) {
  config.simulation = scenario_of(world, config.simulation);
  const Result<std::uint32_t> files = checksum_of_files(world);
  if (!files) return tl::unexpected(files.error());
  std::vector<Drives> drives;
  std::vector<Drives> missing;
  for (const bool papers : {false, true}) {
    const auto selection = std::ranges::find_if(
        selections, [&](KeyframeSelection s) { return (s != KeyframeSelection::adaptive) == papers; });
    if (selection == selections.end()) continue;
    const RobotSlamConfig robot = with_policy(*selection, config).slam.robot;
    if (!drives.empty() && drives.front().config.odometry.method == robot.odometry.method) continue;
    const std::string key = key_of(world, *files, config.simulation, robot);
    drives.push_back({robot, cache / format("{}-{}", world.name, key)});
    if (!std::filesystem::exists(drives.back().folder)) missing.push_back(drives.back());
  }
  if (!missing.empty()) {
    if (const Result<> recorded = record_all(world, config.simulation, missing); !recorded)
      return tl::unexpected(recorded.error());
  }
  std::vector<RobotRun> runs;
  for (std::size_t robot = 0; std::filesystem::exists(map_file(drives.front().folder, robot)); ++robot) {
    Result<RobotRun> run = read_robot(drives, robot);
    if (!run) return fail(run.error().message + "; remove " + cache.string() + " and run again");
    runs.push_back(std::move(*run));
  }
  if (runs.size() < 2)
    return fail(format("{}: the maps of two robots are missing; remove {} and run again",
                       drives.front().folder.string(), cache.string()));
  return runs;
}

}  // namespace adit
