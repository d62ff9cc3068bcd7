// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What may be written where, checked before any work: output never takes the place of something else that
/// people need.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/result.hpp"

namespace adit::app {

/// What is wrong with the name of a trajectory (TUM), "" if nothing is: the ending of recordings, clouds,
/// maps or graphs, one of which it would replace or be taken for.
[[nodiscard]] std::string trajectory_name_fault(const std::string& path);

/// `out` with `more` before its extension: a further file of one output.
[[nodiscard]] std::filesystem::path path_beside(const std::filesystem::path& out, const std::string& more);

/// Ends the command, as wrong usage, where `out` is what `in` is read from, or an existing file in that
/// folder.
void refuse_to_replace_input(const std::string& in, const std::string& out);

/// Fails where `path` holds a session with the map of a robot that the new one will not have. `names` are
/// those of the robots to come, as recordings have them. The same robots again are replaced.
Result<> check_keeps_robots(const std::string& path, const std::vector<std::string>& names);

}  // namespace adit::app
