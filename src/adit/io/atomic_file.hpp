// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Output that appears whole or not at all. Everything is built beside its final place under a name that
/// holds
/// ".partial-", synced to the disk, and renamed at the end. When the process fails or is interrupted before,
/// what stood there is untouched and the destructor removes the partial output; after a power cut the old or
/// the new output is there, whole. Every file that adit writes is written by this module.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// The whole file as bytes; a missing or unreadable file or a folder is an error that names it.
Result<std::string> read_bytes(const std::filesystem::path& path);

/// Writes all of `bytes`; replaces an existing file only at the end.
Result<> write_bytes(const std::filesystem::path& path, std::string_view bytes);

/// A file written piece by piece. Without `commit` nothing appears at `path`.
class AtomicFile {
 public:
  /// Fails where the folder is missing or cannot be written to, or `path` is a folder.
  static Result<AtomicFile> create(const std::filesystem::path& path);
  /// Leaves `other` with nothing to commit or to remove.
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) = delete;
  ~AtomicFile();

  /// Takes bytes as they are. What fails here, `commit` reports.
  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// Flushes, syncs and renames. Fails if any write before it failed (disk full); the old file is then
  /// untouched.
  Result<> commit();

 private:
  explicit AtomicFile(const std::filesystem::path& path);

  std::filesystem::path path_;
  std::filesystem::path partial_;  ///< Empty once committed or moved from.
  std::ofstream stream_;
};

/// A directory of output. It is built in DIR.partial-PID and takes the place of DIR at `commit`.
///
/// An existing DIR is only ever replaced when it is empty or is adit's own output of the same kind, which
/// carries the file `.adit-KIND` (a directory with session.toml also counts as kind "session"). That file
/// lists what adit wrote. Anything else is refused by `create`, before any work is done: it may be the
/// user's. Where an earlier version kept no full list, what was there stays as DIR.old.
class OutputDir {
 public:
  /// Fails where the parent folder is missing, `path` is a file, or what is there may not be replaced.
  static Result<OutputDir> create(const std::filesystem::path& path, const std::string& kind = "session");
  /// Leaves `other` with nothing to commit or to remove.
  OutputDir(OutputDir&& other) noexcept;
  OutputDir& operator=(OutputDir&& other) = delete;
  ~OutputDir();

  /// Where to write until `commit`; sub-folders are the caller's business.
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  /// Syncs all files to the disk and puts the directory in its place, with what the user had added to the one
  /// that stood there. After it, `path()` is the final path. Fails, with the directory in place, where what
  /// the user had added has the name of something that adit writes now: it is kept in DIR.old.
  Result<> commit();

 private:
  OutputDir(std::filesystem::path target, std::filesystem::path partial)
      : target_(std::move(target)), partial_(std::move(partial)) {}

  std::filesystem::path target_;
  std::filesystem::path partial_;
  std::string marker_;  ///< The name of the file that says what kind of output it is.
  bool committed_ = false;
};

}  // namespace adit
