// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The progress that the program shows, and the signals that end it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "adit/core/progress.hpp"
#include "adit/report/progress_line.hpp"

namespace adit::app {

/// From now on SIGINT (Ctrl-C), SIGTERM and SIGHUP set a flag instead of ending the process; a second one
/// ends it at once. A signal that the parent had ignored stays so (nohup, jobs in the background of a
/// script).
void catch_signals();
/// The first signal caught; 0 if none was.
[[nodiscard]] int caught_signal();

/// Observer of a command: cancels it once a signal came. Where stderr is a terminal it draws one line with
/// the phase that runs, a bar and the time left, from half a second on, so that short phases do not flicker.
class TerminalProgress : public ProgressObserver {
 public:
  TerminalProgress();
  ~TerminalProgress() override;

  PhaseId begin(std::string_view name, std::size_t total, PhaseId parent) override;
  void advance(PhaseId phase, std::size_t steps) override;
  void end(PhaseId phase) noexcept override;
  [[nodiscard]] bool cancelled() const noexcept override { return caught_signal() != 0; }

 private:
  void keep_drawing(const std::stop_token& stop);
  void draw();
  void clear();
  [[nodiscard]] static PhaseTree::Seconds now();

  std::mutex mutex_;  ///< Of all below.
  PhaseTree phases_;
  bool is_drawn_ = false;
  std::condition_variable_any wake_;
  std::jthread painter_;  ///< None where stderr is no terminal.
};

}  // namespace adit::app
