// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace adit::app {
namespace {

constexpr std::chrono::milliseconds kRedraw{200};
constexpr PhaseTree::Seconds kTooShortToShow{0.5};

// The program's, not the library's: a signal is sent to the process.
std::atomic<int> first_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch lock-free atomics only");

void on_signal(int signal) {
  int none = 0;
  if (first_signal.compare_exchange_strong(none, signal)) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::size_t terminal_width() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return is_known ? size.ws_col - 1U : kUsual - 1;  // a full last column would wrap
}

}  // namespace

void catch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

int caught_signal() { return first_signal; }

TerminalProgress::TerminalProgress() {
  if (isatty(STDERR_FILENO) != 1) return;
  painter_ = std::jthread([this](const std::stop_token& stop) { keep_drawing(stop); });
}

TerminalProgress::~TerminalProgress() {
  painter_ = {};
  clear();
}

PhaseId TerminalProgress::begin(std::string_view name, std::size_t total, PhaseId parent) {
  const std::lock_guard lock(mutex_);
  return phases_.begin(name, total, parent, now());
}

void TerminalProgress::advance(PhaseId phase, std::size_t steps) {
  const std::lock_guard lock(mutex_);
  phases_.advance(phase, steps);
}

void TerminalProgress::end(PhaseId phase) noexcept {
  const std::lock_guard lock(mutex_);
  phases_.end(phase);
  if (phases_.chain().empty()) clear();  // before anybody prints a result
}

void TerminalProgress::keep_drawing(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    draw();
    wake_.wait_for(lock, stop, kRedraw, [] { return false; });
  }
}

void TerminalProgress::draw() {
  const std::vector<PhaseTree::Running> chain = phases_.chain();
  if (chain.empty() || now() - chain.front().begin < kTooShortToShow) return;
  std::fprintf(stderr, "\r%s\033[K", progress_line(chain, now(), terminal_width()).c_str());
  std::fflush(stderr);
  is_drawn_ = true;
}

void TerminalProgress::clear() {
  if (!is_drawn_) return;
  std::fprintf(stderr, "\r\033[K");
  std::fflush(stderr);
  is_drawn_ = false;
}

PhaseTree::Seconds TerminalProgress::now() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace adit::app
