// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/naming.hpp"

#include "adit/core/format.hpp"
#include "adit/core/robot_name.hpp"

namespace adit {

std::vector<std::string> name_robots(std::vector<Recording>& recordings) {
  std::vector<std::string> notes;
  std::vector<std::string> names;
  for (const Recording& recording : recordings) names.push_back(robot_name(recording.name));
  names = distinct_names(names);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (names[i] == recordings[i].name) continue;
    notes.push_back(
        format("recording {} of {} calls its robot '{}'; here it is {} (NAME=FILE chooses another name)",
               i + 1, recordings.size(), printable(recordings[i].name), names[i]));
    recordings[i].name = names[i];
  }
  return notes;
}

}  // namespace adit
