// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "adit/simulation/world.hpp"

namespace adit {

/// The world that routes are driven in: the mesh `world_file`, or where that is empty the one that the routes
/// name. Called after its file, or after its folder where the file is called "world". Fails on files that
/// cannot be read and on routes that name no mesh where none is given.
[[nodiscard]] Result<World> load_world(const std::filesystem::path& world_file,
                                       const std::filesystem::path& routes_file);

}  // namespace adit
