// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The list of worlds over which merging is measured, and the robots' maps of each. Maps are made once and
/// kept, since driving and odometry cost far more than all that follows.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/run_config.hpp"
#include "adit/study/robot_run.hpp"

namespace adit {

/// What worlds of a list are for: tuned on, kept for the check, drawn after the policy was frozen, meshes of
/// other makers, or beyond what measurement can decide.
[[nodiscard]] std::vector<std::string> world_groups();

/// One entry [[world]] of the list: a preset of the generator, or routes through a mesh on disk.
struct ListedWorld {
  std::string name;              ///< What tables and caches call it; unique in the list.
  std::string group = "tuning";  ///< One of world_groups().
  std::uint64_t noise_seed = 1;  ///< Of all noise of sensors and wheels.
  std::string lidars;            ///< Of its robots in turn, separated by commas; "": as the study has them.
  std::string conditions;        ///< "ideal" or "field"; "": as the study has them.
  std::string routes_file;  ///< As read, relative to the working directory; "": the world is generated from
                            ///< `generated`.
  WorldConfig generated;    ///< Not read where there is a `routes_file`.
};

/// In the order of the file, paths made relative to the working directory. Fails on an entry without a name,
/// on two of one name and on an unknown LiDAR.
Result<std::vector<ListedWorld>> read_world_list(const std::filesystem::path& list);

/// Whether the files that the world needs are there; generated ones need none.
[[nodiscard]] bool is_available(const ListedWorld& world);

/// How the robots of that world are simulated where a study has `simulation`: with the world's own seed, and
/// with its sensors and conditions where it states them.
[[nodiscard]] ScenarioConfig scenario_of(const ListedWorld& world, ScenarioConfig simulation);
/// "ideal" or "field" where the fields that conditions set are theirs, else "other".
[[nodiscard]] std::string conditions_text(const ScenarioConfig& simulation);

/// Its mesh and routes: generated, or read from its files.
Result<World> world_of(const ListedWorld& world);

/// The robots' maps, by the odometries that those policies are studied under, and their ground truth. They
/// come from `cache`, a folder that exists, if the world was driven before with the same routes, mesh and
/// configuration of simulation and robots; otherwise they are simulated, stored there and read back. The key
/// does not cover the code: after a change of that, remove the cache. Fails on a world with fewer than two
/// robots.
Result<std::vector<RobotRun>> driven_robots(const ListedWorld& world, RunConfig config,
                                            const std::vector<KeyframeSelection>& selections,
                                            const std::filesystem::path& cache);

}  // namespace adit
