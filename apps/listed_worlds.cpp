// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "listed_worlds.hpp"

#include "adit/study/merge_worlds.hpp"

namespace adit::app {

Option add_listed_worlds_options(const Command& command, ListedWorldsOptions& options) {
  const Option worlds =
      command.add_option("--worlds", options.list, "The list (TOML, as bench/merge/worlds.toml)");
  WorldChoice& choice = options.choice;
  const bool has_groups = !choice.groups.empty();
  if (has_groups)
    command
        .add_option("--groups", choice.groups, "Worlds of these groups: tuning, check, field, meshes, limit")
        .separated_by_commas()
        .one_of(world_groups())
        .default_shown();
  const Option only = command
                          .add_option("--only", choice.only,
                                      has_groups ? "Only the worlds with these names, whatever their group"
                                                 : "The worlds with these names")
                          .separated_by_commas();
  if (!choice.only.empty()) only.default_shown();
  return worlds;
}

Result<ListedWorlds> listed_worlds(const ListedWorldsOptions& options, const std::string& command) {
  const Result<std::vector<ListedWorld>> list = read_world_list(options.list);
  if (!list) return tl::unexpected(list.error());
  const Result<ChosenWorlds> chosen = chosen_worlds(options.list, *list, options.choice);
  if (!chosen) return tl::unexpected(chosen.error());
  print_notes(command, chosen->notes);
  return ListedWorlds{*list, chosen->worlds};
}

}  // namespace adit::app
