// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_study.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"

namespace adit {
namespace {

/// Metres of distinctive stretches that each pair shares.
Result<DistinctiveMetres> distinctive_of(const ListedWorld& listed, const std::vector<RobotRun>& robots) {
  const Result<World> world = world_of(listed);
  if (!world) return tl::unexpected(world.error());
  const Result<Raycaster> surfaces = Raycaster::build(world->mesh, EdgeRule::watertight);
  if (!surfaces) return fail(listed.name, surfaces.error());
  std::vector<Trajectory> truths;
  for (const RobotRun& robot : robots) truths.push_back(robot.truth);
  return distinctive_stretches(*surfaces, truths);
}

const char* joint_outcome(const MergeCounts& counts) {
  if (counts.joint_wrong > 0) return "WRONG";
  return counts.joint_whole > 0 ? "whole" : "parts";
}

}  // namespace

Result<ChosenWorlds> chosen_worlds(const std::filesystem::path& list, const std::vector<ListedWorld>& worlds,
                                   const WorldChoice& choice) {
  for (const std::string& name : choice.only)
    if (std::ranges::find(worlds, name, &ListedWorld::name) == worlds.end())
      return fail(
          format("{}: there is no world '{}'; give the name of one of its [[world]]", list.string(), name));
  ChosenWorlds chosen;
  for (const ListedWorld& world : worlds) {
    const bool is_wanted = choice.only.empty() ? std::ranges::count(choice.groups, world.group) > 0
                                               : std::ranges::count(choice.only, world.name) > 0;
    if (!is_wanted) continue;
    if (is_available(world))
      chosen.worlds.push_back(world);
    else
      chosen.notes.push_back(format("{} is left out: {} is absent", world.name, world.routes_file));
  }
  return chosen;
}

Result<> run_world(const MergeStudy& study, const ListedWorld& world, std::vector<MergeRun>& runs) {
  const Result<std::vector<RobotRun>> robots =
      driven_robots(world, study.config, study.policies, study.folder / "maps");
  if (!robots) return tl::unexpected(robots.error());
  const ScenarioConfig scenario = scenario_of(world, study.config.simulation);
  const Result<DistinctiveMetres> distinctive = distinctive_of(world, *robots);
  if (!distinctive) return tl::unexpected(distinctive.error());
  for (const KeyframeSelection policy : study.policies) {
    throw_if_cancelled();
    const Result<MergeTruth> truth = merge_truth(*robots, policy, *distinctive);
    if (!truth) return fail(world.name, truth.error());
    Result<MergeRun> run = run_merges(*robots, *truth, with_policy(policy, study.config).slam);
    if (!run) return fail(world.name, run.error());
    run->world = world.name;
    run->group = world.group;
    run->sensors = sensors_text(scenario);
    run->conditions = conditions_text(scenario);
    if (!study.variant.empty()) run->keyframes += " " + study.variant;
    if (study.on_run) study.on_run(*run);
    put_run(runs, std::move(*run));
  }
  return write_merge_runs(study.folder / "results.json", runs);
}

void sort_by_list(std::vector<MergeRun>& runs, const std::vector<ListedWorld>& list) {
  const auto place = [&](const MergeRun& run) {
    return std::ranges::find(list, run.world, &ListedWorld::name) - list.begin();
  };
  std::erase_if(runs,
                [&](const MergeRun& run) { return place(run) == static_cast<std::ptrdiff_t>(list.size()); });
  std::ranges::stable_sort(runs, {}, place);
}

std::string summary_line(const MergeRun& run) {
  MergeCounts counts;
  counts.add(run);
  return format(
      "{:28} {:18} {}, {}: {} mergeable: {} well, {} bent, {} refused; {} of {} others kept apart; {} WRONG, "
      "{} "
      "wrong loops; joint {} wrong loops, {}; {} registrations, {:.1f} s",
      run.world, run.keyframes, run.sensors, run.conditions, counts.mergeable, counts.success, counts.bent,
      counts.refused, counts.kept_apart, counts.others, counts.wrong, counts.wrong_loops,
      counts.joint_wrong_loops, joint_outcome(counts), run.registrations, run.time_s);
}

}  // namespace adit
