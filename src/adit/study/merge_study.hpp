// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Measures merging over a list of worlds: which pairs of robots are merged, refused or merged wrongly under
/// each keyframe policy.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adit/study/merge_run.hpp"
#include "adit/study/merge_worlds.hpp"

namespace adit {

/// Which worlds of a list are run.
struct WorldChoice {
  std::vector<std::string> groups;  ///< Worlds of these groups,
  std::vector<std::string> only;    ///< or if not empty those of these names.
};

/// The worlds of a list that are run, and which are left out.
struct ChosenWorlds {
  std::vector<ListedWorld> worlds;  ///< In the order of the list.
  std::vector<std::string> notes;   ///< One line per world that is left out because its files are absent.
};
/// Fails on a name that the list does not have.
[[nodiscard]] Result<ChosenWorlds> chosen_worlds(const std::filesystem::path& list,
                                                 const std::vector<ListedWorld>& worlds,
                                                 const WorldChoice& choice);

/// How robots are driven and merged, and where results go.
struct MergeStudy {
  RunConfig config;  ///< As each world (`scenario_of`) and each policy (`with_policy`) then change it.
  std::vector<KeyframeSelection> policies;  ///< Those that run on each world, in this order.
  std::string variant;  ///< Added to the policies' names, so that results stand beside the usual ones.
  std::filesystem::path folder;  ///< Keeps the robots' maps (maps/, which exists) and results.json.
  std::function<void(const MergeRun&)> on_run;  ///< Called after each policy; may be empty.
};

/// Runs every policy on one world. Puts the results into `runs` (`put_run`) and writes them to disk at the
/// end.
Result<> run_world(const MergeStudy& study, const ListedWorld& world, std::vector<MergeRun>& runs);

/// Sorts by the order of the list, and within a world by the order in which its policies were first given.
/// Drops runs of worlds that the list no longer names.
void sort_by_list(std::vector<MergeRun>& runs, const std::vector<ListedWorld>& list);

/// One run in one line of text.
[[nodiscard]] std::string summary_line(const MergeRun& run);

}  // namespace adit
