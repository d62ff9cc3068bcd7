// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a file or folder holds, for people and scripts.
#pragma once

#include <string>

#include "adit/core/result.hpp"
#include "adit/io/recording_files.hpp"

namespace adit {

/// A JSON object with "kind" (recording, mcap, bag, cloud, mesh, trajectory, graph, robot map, routes or
/// session) and what that kind has: counts, stamps in seconds, lengths and boxes in metres. `path` is as for
/// `open_recording`, or any other file that adit reads, by its ending. Of a bag each topic with its
/// rate in hertz, longest gap, frame, fields and use, then what adit reads of it and the command to type
/// next, or why it is no recording.
Result<std::string> file_info(const std::string& path, const RecordingConfig& config);

}  // namespace adit
