// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/mount.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace adit::test {

/// A disk of 3 MB, mounted at a folder until the end of the scope. Only root may mount: ask `is_mounted`.
class SmallDisk {
 public:
  explicit SmallDisk(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directories(folder);
    is_mounted_ = mount("adit_test", folder.c_str(), "tmpfs", 0, "size=3m") == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }

  [[nodiscard]] bool is_mounted() const { return is_mounted_; }

  /// Not a byte more fits on it. Returns the file to remove for more room.
  [[nodiscard]] std::filesystem::path fill() const {
    const std::filesystem::path filler = folder_ / "filler";
    std::ofstream stream(filler, std::ios::binary);
    const std::string page(4096, '#');
    while (stream.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) {
    }
    return filler;
  }

  [[nodiscard]] bool make_read_only() const {
    return mount("adit_test", folder_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "size=3m") == 0;
  }

 private:
  std::filesystem::path folder_;
  bool is_mounted_ = false;
};

}  // namespace adit::test
