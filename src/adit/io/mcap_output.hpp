// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Writing recordings as MCAP files; mcap.hpp describes them.
#pragma once

#include <filesystem>
#include <ostream>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Whether an MCAP file can hold the recording: two scans or more, stamps ascending and within ROS's range.
Result<> check_fits_mcap(const Recording& recording);

/// Writes all of a recording; scans are read one after the other, a step of a phase each. The file appears
/// whole or not at all. Fails when a scan cannot be read or there is no scan.
Result<> write_recording(const std::filesystem::path& path, const Recording& recording);
/// The same to a stream, which on failure holds part of it. Errors name no file.
Result<> write_recording(std::ostream& out, const Recording& recording);

}  // namespace adit
