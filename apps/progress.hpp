// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>

namespace adit::app {

/// A progress bar on stderr where that is a terminal, nothing elsewhere. `advance` may be called from any
/// thread.
class Progress {
 public:
  Progress(std::string title, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::size_t steps = 1);

 private:
  void draw(std::size_t done);

  std::string title_;
  std::size_t total_;
  bool on_terminal_;
  std::atomic<std::size_t> done_ = 0;
  std::mutex drawing_;
  std::size_t drawn_percent_ = 101;
};

/// From now on Ctrl-C (SIGINT) and SIGTERM set a flag instead of ending the process; a second one ends it at
/// once.
void catch_interrupts();
/// Whether one came. Long loops ask after each step and stop with an error, so that partial output is
/// removed.
[[nodiscard]] bool interrupted();

}  // namespace adit::app
