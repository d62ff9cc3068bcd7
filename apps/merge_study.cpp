// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/report/text_tables.hpp"
#include "distinctive_places.hpp"
#include "inputs.hpp"
#include "merge_run.hpp"
#include "merge_worlds.hpp"
#include "page_tables.hpp"
#include "progress.hpp"

namespace adit::app {
namespace {

constexpr const char* kSection = "merging";

struct Options {
  std::string worlds;
  std::string out;
  std::string page;
  std::string lidar = "os2-32";
  std::vector<std::string> keyframes = {"all", "tunnel_filter", "adaptive"};
  std::vector<std::string> groups = {"tuning", "check"};
  std::vector<std::string> only;
  std::string variant;
  bool json = false;
};

/// Those named, or else those of the groups; without the ones whose files are absent.
Result<std::vector<ListedWorld>> chosen_worlds(const Options& options) {
  Result<std::vector<ListedWorld>> all = read_world_list(options.worlds);
  if (!all) return all;
  for (const std::string& name : options.only)
    if (std::ranges::find(*all, name, &ListedWorld::name) == all->end())
      return fail(format("{}: there is no world '{}'", options.worlds, name));
  std::erase_if(*all, [&](const ListedWorld& world) {
    return options.only.empty() ? std::ranges::count(options.groups, world.group) == 0
                                : std::ranges::count(options.only, world.name) == 0;
  });
  std::erase_if(*all, [](const ListedWorld& world) {
    if (is_available(world)) return false;
    std::fprintf(stderr, "%s is left out: %s is absent\n", world.name.c_str(), world.routes_file.c_str());
    return true;
  });
  return all;
}

/// Goes where it does not mix with JSON.
void print_line(const MergeRun& run, std::FILE* to) {
  MergeCounts counts;
  counts.add(run);
  std::fprintf(
      to,
      "%-28s %-18s %d mergeable: %d well, %d bent, %d refused; %d of %d others kept apart; %d WRONG, %d "
      "wrong "
      "loops; joint %d wrong loops, %s; %d registrations, %.1f s\n",
      run.world.c_str(), run.keyframes.c_str(), counts.mergeable, counts.success, counts.bent, counts.refused,
      counts.kept_apart, counts.others, counts.wrong, counts.wrong_loops, counts.joint_wrong_loops,
      counts.joint_wrong > 0   ? "WRONG"
      : counts.joint_whole > 0 ? "whole"
                               : "parts",
      run.registrations, run.time_s);
  std::fflush(to);
}

/// As an earlier run measured them, or else measured now: that takes longer than a policy.
Result<DistinctivePlaces> places_of(const ListedWorld& world, const std::vector<RobotRun>& robots,
                                    const RunConfig& config, const std::vector<MergeRun>& runs) {
  const auto earlier = std::ranges::find(runs, world.name, &MergeRun::world);
  if (earlier == runs.end())
    return distinctive_places(robots, studied_under(KeyframeSelection::adaptive, config));
  DistinctivePlaces places(robots.size(), std::vector<int>(robots.size(), 0));
  auto pair = earlier->pairs.begin();
  for (std::size_t a = 0; a < robots.size(); ++a)
    for (std::size_t b = a + 1; b < robots.size() && pair != earlier->pairs.end(); ++b, ++pair)
      places[a][b] = places[b][a] = pair->distinctive_places;
  return places;
}

/// Runs every policy on one world; results reach the disk world by world, so that a stop loses one at most.
Result<> run_world(const ListedWorld& world, const std::vector<KeyframeSelection>& selections,
                   const RunConfig& config, const Options& options, std::vector<MergeRun>& runs) {
  const Result<std::vector<RobotRun>> robots =
      driven_robots(world, config, selections, std::filesystem::path(options.out) / "maps");
  if (!robots) return tl::unexpected(robots.error());
  const Result<DistinctivePlaces> places = places_of(world, *robots, config, runs);
  if (!places) return fail(world.name, places.error());
  for (const KeyframeSelection selection : selections) {
    if (interrupted()) return fail("interrupted");
    const Result<MergeTruth> truth = merge_truth(*robots, selection, *places);
    if (!truth) return fail(world.name, truth.error());
    Result<MergeRun> run = run_merges(*robots, *truth, selection, studied_under(selection, config));
    if (!run) return fail(world.name, run.error());
    run->world = world.name;
    run->group = world.group;
    if (!options.variant.empty()) run->keyframes += " " + options.variant;
    print_line(*run, options.json ? stderr : stdout);
    put_run(runs, std::move(*run));
  }
  return write_merge_runs(std::filesystem::path(options.out) / "results.json", runs);
}

/// In the order of the list, policies as they were given when the world was first run; worlds that the list
/// no longer names are dropped.
void sort_by_list(std::vector<MergeRun>& runs, const std::vector<ListedWorld>& list) {
  const auto place = [&](const MergeRun& run) {
    return std::ranges::find(list, run.world, &ListedWorld::name) - list.begin();
  };
  std::erase_if(runs,
                [&](const MergeRun& run) { return place(run) == static_cast<std::ptrdiff_t>(list.size()); });
  std::ranges::stable_sort(runs, {}, place);
}

Result<> merge_study(Options options, const Common& common) {
  options.json = common.json;
  RunConfig config = study_config();
  if (const Result<> known = choose_lidar(options.lidar, config.simulation); !known)
    usage_error(known.error().message);
  const Result<std::vector<KeyframeSelection>> selections = selections_of(options.keyframes);
  if (!selections) usage_error(selections.error().message);
  if (const Result<> configured = configure(fields_of(config), common); !configured) return configured;
  const Result<std::vector<ListedWorld>> list = read_world_list(options.worlds);
  if (!list) return tl::unexpected(list.error());
  const Result<std::vector<ListedWorld>> worlds = chosen_worlds(options);
  if (!worlds) return tl::unexpected(worlds.error());
  const std::filesystem::path out = options.out;
  std::filesystem::create_directories(out / "maps");
  Result<std::vector<MergeRun>> runs = read_merge_runs(out / "results.json");
  if (!runs) return tl::unexpected(runs.error());

  catch_interrupts();
  for (const ListedWorld& world : *worlds)
    if (const Result<> done = run_world(world, *selections, config, options, *runs); !done) return done;
  sort_by_list(*runs, *list);
  const std::vector<Table> tables = merge_tables(*runs);
  Result<> done = write_merge_runs(out / "results.json", *runs);
  if (done) done = write_merge_csv(out / "results.csv", *runs);
  if (done && !options.page.empty()) done = write_tables(options.page, kSection, tables);
  if (done && common.json) {
    const Result<std::string> json = read_bytes(out / "results.json");
    if (!json) return tl::unexpected(json.error());
    std::printf("%s", json->c_str());
  } else if (done) {
    std::printf("\n");
    for (const Table& table : tables) std::printf("%s\n", text_of(table).c_str());
  }
  return done;
}

}  // namespace

void add_merge_study(Program& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = program.add_command(
      "merge-study", "Which robots' maps are merged, refused or merged wrongly, over a list of worlds",
      [options](const Common& common) { return merge_study(*options, common); });
  command->add_option("--worlds", options->worlds, "The list (TOML, as bench/merge/worlds.toml)")->required();
  command->add_option("--out", options->out, "Folder that keeps the robots' maps and the results of all runs")
      ->required();
  command->add_option("--keyframes", options->keyframes, "Keyframe policies, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--groups", options->groups, "Worlds of these groups: tuning, check, limit")
      ->delimiter(',')
      ->check(CLI::IsMember({"tuning", "check", "limit"}))
      ->capture_default_str();
  command->add_option("--only", options->only, "Only the worlds of these names, whatever their group")
      ->delimiter(',');
  command->add_option("--variant", options->variant,
                      "Added to the policies' names, so that a run with other settings (--set) stands beside "
                      "the usual one instead of replacing it");
  command->add_option("--lidar", options->lidar, "Simulated LiDAR")->capture_default_str();
  command->add_option("--page", options->page,
                      "Markdown file whose section between 'merging' marks takes the tables of all runs");
}

}  // namespace adit::app
