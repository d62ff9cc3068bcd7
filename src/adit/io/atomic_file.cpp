// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <set>
#include <system_error>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/disk_sync.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 1U << 20U;  ///< Bytes written between two questions whether to go on.

/// Beside the target, so that the rename stays on one file system.
fs::path partial_beside(const fs::path& path) { return path.string() + format(".partial-{}", getpid()); }

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Inside an OutputDir that is not in its place yet: its `commit` syncs all of it at once.
bool is_in_partial_folder(const fs::path& path) {
  return folder_of(path).string().find(format(".partial-{}", getpid())) != std::string::npos;
}

fs::path without_trailing_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

Result<> check_parent(const fs::path& path) {
  const fs::path parent = folder_of(path);
  std::error_code ignored;
  if (fs::is_directory(parent, ignored)) return {};
  return fail(format("{}: the folder {} does not exist; make it first", path.string(), parent.string()));
}

bool is_own_output(const fs::path& directory, const std::string& kind) {
  std::error_code ignored;
  return fs::exists(directory / (".adit-" + kind), ignored) ||
         (kind == "session" && fs::exists(directory / "session.toml", ignored));
}

Result<> check_replaceable(const fs::path& path, const std::string& kind) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  if (!fs::is_directory(path, error))
    return fail(path.string() + ": is a file, a folder is needed; choose another name");
  if (fs::is_empty(path, error) || is_own_output(path, kind)) return {};
  return fail(
      format("{}: holds files that are not adit's own output ({}) and is left alone; choose another folder "
             "or empty it",
             path.string(), kind));
}

/// A name beside `path` that nothing has.
fs::path free_name_for_old(const fs::path& path) {
  fs::path name = path.string() + ".old";
  std::error_code ignored;
  for (int n = 2; fs::exists(fs::symlink_status(name, ignored)); ++n)
    name = path.string() + format(".old-{}", n);
  return name;
}

/// Puts `partial` in the place of `target`. Returns where what stood there lies now: under a name that no
/// later run takes for its own, so that nothing of the user's is lost if this one ends here.
Result<fs::path> swap_in(const fs::path& partial, const fs::path& target) {
  const fs::path old = free_name_for_old(target);
  std::error_code error;
  if (!fs::exists(target, error)) {
    fs::rename(partial, target, error);
  } else if (renameat2(AT_FDCWD, partial.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) {
    fs::rename(partial, old, error);
    return error ? partial : old;
  } else {
    // A file system that cannot exchange two names: for a moment the target has none.
    fs::rename(target, old, error);
    if (!error) fs::rename(partial, target, error);
    std::error_code ignored;
    if (error && !fs::exists(target, ignored)) fs::rename(old, target, ignored);
  }
  if (error) return fail(format("{}: cannot be put in place: {}", target.string(), error.message()));
  return old;
}

using Paths = std::set<std::string>;

/// All files below a folder, and folders that hold nothing, by their paths in it.
Result<Paths> paths_in(const fs::path& folder) {
  Paths paths;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    const bool is_folder = fs::is_directory(entry->symlink_status(ignored));
    if (is_folder && !fs::is_empty(entry->path(), ignored)) continue;
    paths.insert(entry->path().lexically_relative(folder).generic_string());
  }
  if (error) return fail(format("{}: cannot be listed: {}", folder.string(), error.message()));
  return paths;
}

/// What is there beside these later is the user's.
Result<> list_contents(const fs::path& folder, const fs::path& marker) {
  const Result<Paths> paths = paths_in(folder);
  if (!paths) return tl::unexpected(paths.error());
  std::string text;
  for (const std::string& path : *paths) text += path + '\n';
  return write_bytes(marker, text);
}

/// Empty where nothing was listed.
Paths listed_in(const fs::path& marker) {
  const Result<std::string> text = read_bytes(marker);
  if (!text || text->empty()) return {};
  const std::vector<std::string> lines = lines_of(*text);
  return {lines.begin(), lines.end()};
}

/// Whether the list does not say who wrote this: earlier versions kept none, or one of top-level names alone.
bool is_of_unknown_author(const std::string& path, const Paths& listed) {
  if (listed.empty()) return true;
  const std::size_t end = path.find('/');
  return end != std::string::npos && !listed.contains(path) && listed.contains(path.substr(0, end));
}

/// Replaces nothing. A folder that holds nothing is kept by one of that name.
bool move_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  const fs::file_status there = fs::symlink_status(to, error);
  if (fs::exists(there)) return fs::is_directory(there) && fs::is_directory(fs::symlink_status(from, error));
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::rename(from, to, error);
  return !error;
}

/// Moves what the user put into `old` to where it was, now in `target`, and removes `old`: unless that would
/// delete what was not moved and may be the user's.
Result<> keep_users_files(const fs::path& old, const fs::path& target, const Paths& listed) {
  const std::string written_later = "georeference.toml";
  const Result<Paths> paths = paths_in(old);
  if (!paths) return {};  // there was nothing, or it cannot be told what there is
  bool are_all_known = true;
  std::vector<std::string> left;
  for (const std::string& path : *paths) {
    if (is_of_unknown_author(path, listed))
      are_all_known = false;
    else if (!listed.contains(path) && path != written_later && !move_to(old / path, target / path))
      left.push_back(path);
  }
  if (!left.empty())
    return fail(format(
        "{}: is written; {} of the files that you had put there could not stay beside its own and lie in {} "
        "now, the first: {}; move them to another place",
        target.string(), left.size(), old.string(), left.front()));
  std::error_code ignored;
  if (are_all_known) fs::remove_all(old, ignored);
  return {};
}

}  // namespace

Result<std::string> read_bytes(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return fail(path.string() + ": no such file");
  if (fs::is_directory(status)) return fail(path.string() + ": is a folder, a file is needed");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fail(path.string() + ": cannot be opened for reading; check its permissions");
  std::string bytes;
  std::array<char, 1U << 16U> block{};
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
    throw_if_cancelled();
    bytes.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return fail(format("{}: reading failed at byte {}", path.string(), bytes.size()));
  return bytes;
}

Result<> write_bytes(const fs::path& path, std::string_view bytes) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  for (std::size_t begin = 0; begin < bytes.size(); begin += kBlock) {
    throw_if_cancelled();
    const std::string_view block = bytes.substr(begin, kBlock);
    file->stream().write(block.data(), static_cast<std::streamsize>(block.size()));
  }
  return file->commit();
}

Result<AtomicFile> AtomicFile::create(const fs::path& path) {
  std::error_code ignored;
  if (!path.has_filename() || fs::is_directory(path, ignored)) {
    return fail(path.string() + ": is a folder, a file name is needed");
  }
  if (Result<> parent = check_parent(path); !parent) return tl::unexpected(parent.error());
  AtomicFile file(path);
  if (!file.stream_) return fail(path.string() + ": cannot be written; check the permissions of its folder");
  return file;
}

AtomicFile::AtomicFile(const fs::path& path)
    : path_(path), partial_(partial_beside(path)), stream_(partial_, std::ios::binary | std::ios::trunc) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      partial_(std::exchange(other.partial_, {})),
      stream_(std::move(other.stream_)) {}

AtomicFile::~AtomicFile() {
  if (partial_.empty()) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(partial_, ignored);
}

Result<> AtomicFile::commit() {
  stream_.close();
  if (!stream_) return fail(path_.string() + ": writing failed; is the disk full?");
  const bool syncs = !is_in_partial_folder(path_);
  if (syncs) {
    if (Result<> synced = sync_to_disk(partial_); !synced) return fail(path_.string(), synced.error());
  }
  std::error_code error;
  fs::rename(partial_, path_, error);
  if (error) return fail(format("{}: cannot be put in place: {}", path_.string(), error.message()));
  partial_.clear();
  return syncs ? sync_to_disk(folder_of(path_)) : Result<>();
}

Result<OutputDir> OutputDir::create(const fs::path& path, const std::string& kind) {
  const fs::path target = without_trailing_slash(path);
  if (target.empty()) return fail("an output folder needs a name");
  if (Result<> parent = check_parent(target); !parent) return tl::unexpected(parent.error());
  if (Result<> free = check_replaceable(target, kind); !free) return tl::unexpected(free.error());
  OutputDir output(target, partial_beside(target));
  std::error_code error;
  fs::remove_all(output.partial_, error);
  fs::create_directory(output.partial_, error);
  if (error) return fail(format("{}: cannot be made: {}", target.string(), error.message()));
  output.marker_ = ".adit-" + kind;
  return write_bytes(output.partial_ / output.marker_, "").map([&] { return std::move(output); });
}

OutputDir::OutputDir(OutputDir&& other) noexcept
    : target_(std::move(other.target_)),
      partial_(std::move(other.partial_)),
      marker_(std::move(other.marker_)),
      committed_(std::exchange(other.committed_, true)) {}

OutputDir::~OutputDir() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

Result<> OutputDir::commit() {
  if (Result<> listed = list_contents(partial_, partial_ / marker_); !listed) return listed;
  if (Result<> synced = sync_tree_to_disk(partial_); !synced) return synced;
  const Paths written_earlier = listed_in(target_ / marker_);
  const Result<fs::path> old = swap_in(partial_, target_);
  if (!old) return tl::unexpected(old.error());
  committed_ = true;
  partial_ = target_;
  Result<> synced = sync_to_disk(folder_of(target_));
  if (!synced) return synced;
  return keep_users_files(*old, target_, written_earlier);  // not before the new name is on the disk
}

}  // namespace adit
