// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/disk_sync.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <vector>

#include "adit/core/progress.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(const fs::path& path) : number_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

std::error_code last_error() { return {errno, std::generic_category()}; }

/// Writing back begins, nothing is waited for; what fails here shows in `sync_to_disk`.
void begin_write_back(const fs::path& file) {
  const Descriptor descriptor(file);
  if (descriptor.number() >= 0) sync_file_range(descriptor.number(), 0, 0, SYNC_FILE_RANGE_WRITE);
}

}  // namespace

Result<> sync_to_disk(const fs::path& path) {
  const Descriptor descriptor(path);
  // Folders on some network file systems cannot be synced; there is nothing to be done about them (EINVAL).
  const bool is_done = descriptor.number() >= 0 && (fsync(descriptor.number()) == 0 || errno == EINVAL);
  if (is_done) return {};
  return fail(path.string() + ": does not reach the disk: " + last_error().message());
}

Result<> sync_tree_to_disk(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  std::vector<fs::path> folders{folder};
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    (entry->is_directory(error) ? folders : files).push_back(entry->path());
  }
  if (error) return fail(folder.string() + ": cannot be read back: " + error.message());
  for (const fs::path& file : files) begin_write_back(file);
  for (const std::vector<fs::path>* paths : {&files, &folders}) {
    for (const fs::path& path : *paths) {
      throw_if_cancelled();
      if (Result<> synced = sync_to_disk(path); !synced) return synced;
    }
  }
  return {};
}

}  // namespace adit
