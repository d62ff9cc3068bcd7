// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The worlds of a list that a study runs over.
#pragma once

#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/study/merge_study.hpp"
#include "command_line.hpp"

namespace adit::app {

struct ListedWorldsOptions {
  std::string list;
  WorldChoice choice{{"tuning", "check"}, {}};
};
/// --worlds, which it returns, --groups and --only; without --groups where `choice` has none.
Option add_listed_worlds_options(const Command& command, ListedWorldsOptions& options);

struct ListedWorlds {
  std::vector<ListedWorld> all;
  std::vector<ListedWorld> chosen;
};
/// Fails as read_world_list and chosen_worlds do; prints which worlds are left out.
[[nodiscard]] Result<ListedWorlds> listed_worlds(const ListedWorldsOptions& options,
                                                 const std::string& command);

}  // namespace adit::app
