// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Breaks work off in the middle, for tests of what it leaves behind.
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <string_view>

#include "adit/core/progress.hpp"

namespace adit::test {

/// Lets work ask so many times whether it is to stop, then stops it; by default only counts.
class CancelAfter : public ProgressObserver {
 public:
  explicit CancelAfter(std::size_t num_polls = std::numeric_limits<std::size_t>::max())
      : num_polls_(num_polls) {}
  PhaseId begin(std::string_view /*name*/, std::size_t /*total*/, PhaseId /*parent*/) override { return 1; }
  void advance(PhaseId /*phase*/, std::size_t /*steps*/) override {}
  void end(PhaseId /*phase*/) noexcept override {}
  [[nodiscard]] bool cancelled() const noexcept override { return polled_++ >= num_polls_; }
  [[nodiscard]] std::size_t num_polled() const { return polled_; }

 private:
  std::size_t num_polls_;
  mutable std::atomic<std::size_t> polled_ = 0;
};

}  // namespace adit::test
