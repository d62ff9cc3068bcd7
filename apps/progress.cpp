// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "progress.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

namespace adit::app {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

void on_interrupt(int signal) {
  interrupt_count = interrupt_count + 1;
  if (interrupt_count > 1) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() { return interrupt_count > 0; }

Progress::Progress(std::string title, std::size_t total)
    : title_(std::move(title)), total_(total), on_terminal_(isatty(STDERR_FILENO) == 1 && total > 0) {
  if (on_terminal_) draw(0);
}

Progress::~Progress() {
  if (on_terminal_) std::fprintf(stderr, "\r\033[K");
}

void Progress::advance(std::size_t steps) {
  const std::size_t done = done_ += steps;
  if (on_terminal_) draw(done);
}

void Progress::draw(std::size_t done) {
  constexpr int kWidth = 40;
  const std::lock_guard lock(drawing_);
  const std::size_t percent = 100 * done / total_;
  if (percent == drawn_percent_) return;
  drawn_percent_ = percent;
  const int filled = static_cast<int>(static_cast<std::size_t>(kWidth) * done / total_);
  std::fprintf(stderr, "\r%s [%.*s%*s] %zu%%", title_.c_str(), filled,
               "########################################", kWidth - filled, "", percent);
  std::fflush(stderr);
}

}  // namespace adit::app
