// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>

#include "adit/core/format.hpp"

namespace adit {
namespace {

/// Owns a file descriptor.
struct OpenFile {
  explicit OpenFile(int opened) : descriptor(opened) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(descriptor); }
  int descriptor;
};

Result<> check_bounds(std::uint64_t offset, std::uint64_t size, std::uint64_t available) {
  if (offset <= available && size <= available - offset) return {};
  return fail(format("{} bytes at byte {} reach past the end at byte {}; the file is truncated", size, offset,
                     available));
}

Result<std::string> read_at(const OpenFile& file, std::uint64_t offset, std::uint64_t size) {
  std::string bytes(size, '\0');
  for (std::size_t done = 0; done < size;) {
    const ssize_t got =
        pread(file.descriptor, bytes.data() + done, size - done, static_cast<off_t>(offset + done));
    if (got <= 0) return fail(format("reading failed at byte {}", offset + done));
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace

Result<ByteSource> open_source(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return fail(path.string() + ": no such file, or no permission to read it");
  const auto file = std::make_shared<const OpenFile>(descriptor);
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return fail(path.string() + ": is not a regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  return ByteSource{
      size, [file, size](std::uint64_t offset, std::uint64_t count) -> Result<std::string> {
        return check_bounds(offset, count, size).and_then([&] { return read_at(*file, offset, count); });
      }};
}

ByteSource memory_source(std::string bytes) {
  return memory_source(std::make_shared<const std::string>(std::move(bytes)));
}

ByteSource memory_source(std::shared_ptr<const std::string> bytes) {
  const std::uint64_t size = bytes->size();
  return {
      size, [bytes = std::move(bytes)](std::uint64_t offset, std::uint64_t count) -> Result<std::string> {
        return check_bounds(offset, count, bytes->size()).map([&] { return bytes->substr(offset, count); });
      }};
}

}  // namespace adit
