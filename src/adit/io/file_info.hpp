// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a file or folder holds, for people and scripts.
#pragma once

#include <string>

#include "adit/core/result.hpp"
#include "adit/io/recording_files.hpp"

namespace adit {

/// A JSON object with "kind" (recording, cloud, mesh, trajectory, graph, robot map, routes, session or what
/// its fleet.adit holds) and what that kind has: counts, stamps in seconds, lengths and boxes in metres.
/// `path` is as for `open_recording`, or any other file that adit reads, by its ending. A bag is a recording,
/// whether or not it can be mapped: each topic with its rate in hertz, longest gap, frame, fields and use,
/// then what adit reads of it, or why it cannot be mapped (`cannot_be_mapped`), and the command to type next.
/// Fails on a setting with which no recording can be read, and on a topic that is named and not there.
Result<std::string> file_info(const std::string& path, const RecordingConfig& config);

}  // namespace adit
