// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What commands take as a recording.
#pragma once

#include <string>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/mount.hpp"

namespace adit {

/// Opens
///  - FILE.mcap, FILE.db3, FILE.bag, FOLDER of a bag: see bag_recording.hpp;
///  - FOLDER: a folder of clouds, see scan_folder.hpp;
///  - `FOLDER@even`, `FOLDER@odd`, `FOLDER@FIRST:STEP`: part of the scans, so that one drive can serve as two
///  robots.
///    The recording's name then ends in the part: "nclt_even".
/// Anything else is an error that lists these; of a session it names the commands that take sessions.
/// `config` overrides what the input says of itself; of a folder of clouds it may name no topics, which it
/// has none of.
Result<Recording> open_recording(const std::string& input, const RecordingConfig& config = {});

}  // namespace adit
