// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/folders.hpp"

namespace adit {

Result<> make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return fail(path.string() + ": cannot make this folder: " + error.message());
  return {};
}

}  // namespace adit
