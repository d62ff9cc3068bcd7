// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What was written reaches the disk before the name that stands for it changes, so that a power cut leaves
/// the old file or the new one, never an empty one.
#pragma once

#include <filesystem>

#include "adit/core/result.hpp"

namespace adit {

/// The bytes of a file that is closed, or the entries of a folder, are on the disk when this returns. Fails
/// with the system's reason: a disk that is full or broken may say so only now.
Result<> sync_to_disk(const std::filesystem::path& path);

/// The same for a folder with all that is in it. Files are handed to the disk together first, which costs a
/// folder of thousands about as much as one large file.
Result<> sync_tree_to_disk(const std::filesystem::path& folder);

}  // namespace adit
