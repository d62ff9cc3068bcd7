// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace adit::bench {

/// How a program is started.
struct Launch {
  std::vector<std::string> command{};
  std::map<std::string, std::string> environment{};  ///< Added to that of this process.
  int num_processors = 0;  ///< It may run on the first so many of those that this process may; 0: on all.
};

/// Processors that this process may run on.
[[nodiscard]] int num_processors();

/// A program at the other end of two pipes: lines go to its standard input and come from its standard output.
class ChildProcess {
 public:
  /// Throws std::runtime_error when it cannot be started.
  explicit ChildProcess(const Launch& launch);
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
