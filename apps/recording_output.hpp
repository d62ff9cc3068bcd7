// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "adit/core/records.hpp"
#include "adit/io/cloud_files.hpp"
#include "progress.hpp"

namespace adit::app {

/// Writes an .mcap file, or a folder of `clouds` where `path` has another ending. One step of `progress` per
/// scan. After Ctrl-C the next scan is an error, so that nothing appears at `path`.
Result<> write_recording_to(const std::filesystem::path& path, Recording recording, Progress& progress,
                            CloudFormat clouds = CloudFormat::pcd);

}  // namespace adit::app
