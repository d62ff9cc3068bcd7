// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The control points that sessions kept, for a session that goes on from them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/io/georeference.hpp"

namespace adit {

/// Where the maps of one session lay when it was saved.
struct EarlierGeoreferences {
  std::filesystem::path session;   ///< Its directory, as given; "" of one in memory.
  std::vector<Georeference> maps;  ///< Those that have one, with their robots' names of now.
};

/// The points of sessions as those of one.
struct KeptControl {
  std::vector<ControlPoint> points;  ///< None where the sessions' systems may differ.
  std::string crs;                   ///< As given with --crs; "" where none was.
  std::vector<std::string> notes;    ///< What is not kept, and why, one line each.
};

/// A robot that two sessions hold has its points from the first of them that has some: counted twice, a
/// blunder would look as if it were confirmed. Systems differ where their names do, and may differ where two
/// sessions have none.
[[nodiscard]] KeptControl kept_control(const std::vector<EarlierGeoreferences>& earlier);

}  // namespace adit
