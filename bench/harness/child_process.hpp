// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace adit::bench {

/// A program at the other end of two pipes: lines go to its standard input and come from its standard output.
class ChildProcess {
 public:
  /// Throws std::runtime_error when it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void write_line(const std::string& line);
  /// Nothing when the child has ended.
  [[nodiscard]] std::optional<std::string> read_line();
  /// Largest resident memory so far, in MB; 0 when the child has ended.
  [[nodiscard]] double peak_mb() const;

 private:
  pid_t pid_ = 0;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
};

}  // namespace adit::bench
