// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_study.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

std::vector<std::string> names_of(const std::vector<ListedWorld>& worlds) {
  std::vector<std::string> names;
  for (const ListedWorld& world : worlds) names.push_back(world.name);
  return names;
}

ListedWorld world_of(const std::string& name, const std::string& group, const std::string& routes_file = "") {
  ListedWorld world;
  world.name = name;
  world.group = group;
  world.routes_file = routes_file;
  return world;
}

MergeRun run_of(const std::string& world, const std::string& keyframes) {
  MergeRun run;
  run.world = world;
  run.keyframes = keyframes;
  return run;
}

const std::vector<ListedWorld> kList = {world_of("d", "tuning"), world_of("c", "check"),
                                        world_of("b", "tuning", "nowhere.yaml"), world_of("a", "limit"),
                                        world_of("e", "tuning")};

TEST(ChosenWorlds, AreThoseOfTheGroupsInTheOrderOfTheList) {
  const auto chosen = chosen_worlds("list.toml", kList, {{"check", "tuning"}, {}});
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(names_of(chosen->worlds), (std::vector<std::string>{"d", "c", "e"}));
  EXPECT_EQ(chosen->notes, std::vector<std::string>{"b is left out: nowhere.yaml is absent"});
  EXPECT_TRUE(chosen_worlds("list.toml", kList, {})->worlds.empty());
}

TEST(ChosenWorlds, NamesCountWhateverTheirGroup) {
  const auto chosen = chosen_worlds("list.toml", kList, {{"tuning"}, {"a", "d"}});
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(names_of(chosen->worlds), (std::vector<std::string>{"d", "a"}));
  EXPECT_TRUE(chosen->notes.empty()) << "b was not asked for";
  EXPECT_ERROR(chosen_worlds("list.toml", kList, {{}, {"a", "x"}}), "list.toml: there is no world 'x'; ");
}

TEST(SortByList, KeepsPoliciesInTheirOrderAndDropsWorldsThatAreGone) {
  std::vector<MergeRun> runs;
  for (const auto& [world, keyframes] :
       {std::pair("e", "all"), std::pair("gone", "all"), std::pair("a", "tunnel_filter"),
        std::pair("e", "adaptive"), std::pair("d", "all"), std::pair("a", "all")})
    runs.push_back(run_of(world, keyframes));
  sort_by_list(runs, kList);
  std::vector<std::string> order;
  for (const MergeRun& run : runs) order.push_back(run.world + " " + run.keyframes);
  EXPECT_EQ(order, (std::vector<std::string>{"d all", "a tunnel_filter", "a all", "e all", "e adaptive"}));
}

/// A pair that shares 30 m 25 of them distinctive, or without both.
MergePair pair_of(bool is_mergeable, MergeOutcome outcome) {
  MergePair pair;
  pair.shared_m = is_mergeable ? 30.0 : 0.0;
  pair.distinctive_m = is_mergeable ? 25.0 : 0.0;
  pair.outcome = outcome;
  return pair;
}

TEST(SummaryLine, CountsPairsByWhatBecameOfThem) {
  MergeRun run = run_of("zab", "all");
  run.registrations = 42;
  run.time_s = 1.25;
  run.joint.maps = {{"0", "1"}, {"2"}};
  run.joint.possible_maps = {{"0", "1", "2"}};
  for (const MergeOutcome outcome : {MergeOutcome::success, MergeOutcome::success, MergeOutcome::bent,
                                     MergeOutcome::refused, MergeOutcome::wrong})
    run.pairs.push_back(pair_of(true, outcome));
  run.pairs.push_back(pair_of(false, MergeOutcome::refused));
  run.pairs.push_back(pair_of(false, MergeOutcome::wrong));
  const std::string line = summary_line(run);
  EXPECT_NE(line.find("5 mergeable: 2 well, 1 bent, 1 refused; 1 of 2 others kept apart; 2 WRONG"),
            std::string::npos)
      << line;
  EXPECT_NE(line.find("parts; 42 registrations, 1.2 s"), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  run.joint.maps = run.joint.possible_maps;
  EXPECT_NE(summary_line(run).find(" whole;"), std::string::npos) << summary_line(run);
  run.joint.wrong = true;
  EXPECT_NE(summary_line(run).find(" WRONG; 42"), std::string::npos) << summary_line(run);
}

MergeStudy study_in(const test::TemporaryFolder& folder, std::vector<KeyframeSelection> policies) {
  std::filesystem::create_directories(folder / "maps");
  MergeStudy study;
  study.config = test::quick_config();
  study.policies = std::move(policies);
  study.folder = folder.path();
  return study;
}

TEST(RunWorld, EachPolicyTakesItsPlaceAndReachesTheDisk) {
  const test::TemporaryFolder folder;
  ListedWorld world = test::put_short_drives(folder.path());
  world.group = "check";
  MergeStudy study = study_in(folder, {KeyframeSelection::tunnel_filter_keep, KeyframeSelection::all});
  std::vector<std::string> reported;
  study.on_run = [&](const MergeRun& run) { reported.push_back(run.world + " " + run.keyframes); };
  // An earlier run under the same conditions.
  std::vector<MergeRun> runs = {run_of("other", "all"), run_of("hall", "all")};
  runs[1].sensors = "vlp-16";
  runs[1].conditions = "ideal";
  const Result<> done = run_world(study, world, runs);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(reported, (std::vector<std::string>{"hall tunnel_filter_keep", "hall all"}));
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[0].world, "other");
  EXPECT_EQ(runs[1].keyframes, "all") << "in the place of the earlier run";
  EXPECT_EQ(runs[2].keyframes, "tunnel_filter_keep");
  for (const std::size_t r : {1U, 2U}) {
    EXPECT_EQ(runs[r].group, "check");
    EXPECT_EQ(runs[r].sensors, "vlp-16");
    EXPECT_EQ(runs[r].conditions, "ideal");
    ASSERT_EQ(runs[r].pairs.size(), 1U);
    EXPECT_EQ(runs[r].pairs[0].robots, (std::array<std::string, 2>{"ahead", "behind"}));
    EXPECT_EQ(runs[r].pairs[0].distinctive_m, 0.0) << "five metres are too short";
    // Five metres each, of which the first three of `ahead` lie before it and within reach: all is shared.
    EXPECT_NEAR(runs[r].pairs[0].shared_m, test::kShortDriveMetres, 1.0);
  }
  const Result<std::vector<MergeRun>> kept = read_merge_runs(folder / "results.json");
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->size(), 3U);
}

TEST(RunWorld, AVariantStandsBesideTheUsualResults) {
  const test::TemporaryFolder folder;
  const ListedWorld world = test::put_short_drives(folder.path());
  MergeStudy study = study_in(folder, {KeyframeSelection::all});
  std::vector<MergeRun> runs;
  ASSERT_TRUE(run_world(study, world, runs));
  study.variant = "coarse";
  ASSERT_TRUE(run_world(study, world, runs));
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].keyframes, "all");
  EXPECT_EQ(runs[1].keyframes, "all coarse");
}

TEST(RunWorld, AWorldThatCannotBeDrivenChangesNoResults) {
  const test::TemporaryFolder folder;
  const ListedWorld world = test::put_short_drives(folder.path(), {"alone"});
  std::vector<MergeRun> runs = {run_of("other", "all")};
  EXPECT_ERROR(run_world(study_in(folder, {KeyframeSelection::all}), world, runs),
               "hall: merging needs at least two robots");
  EXPECT_EQ(runs.size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(folder / "results.json"));
}

}  // namespace
}  // namespace adit
