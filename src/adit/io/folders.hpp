// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "adit/core/result.hpp"

namespace adit {

/// Makes the folder and those above it, as far as they are missing. Fails, naming it, where that is not
/// possible: a file of that name, no permission, a full disk.
Result<> make_folder(const std::filesystem::path& path);

}  // namespace adit
