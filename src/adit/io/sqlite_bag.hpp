// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"

namespace adit {

/// A file of rosbag2's sqlite storage: tables topics (id, name, type, serialization_format) and messages (id,
/// topic_id, timestamp in ns, data); schemas of all versions so far have these. A file that is damaged behind
/// its start is read up to there, which `warnings` says. Of a file in WAL mode the log beside it is read,
/// too, and nothing is written, neither into the file nor beside it. Source: rosbag2_storage_sqlite3.
[[nodiscard]] Result<Bag> open_sqlite_bag(const std::filesystem::path& path);

}  // namespace adit
