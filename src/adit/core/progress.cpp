// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/progress.hpp"

#include <utility>

namespace adit {
namespace {

// Not state of the library but of the call stack: set by a scope and put back at its end, so that no
// parameter has to pass through every function between a command and the loop that takes long (decision
// 0022).
thread_local ProgressContext context_of_this_thread;

ProgressContext begun(std::string_view name, std::size_t total) {
  const ProgressContext around = context_of_this_thread;
  if (around.observer == nullptr) return around;
  return {around.observer, around.observer->begin(name, total, around.phase)};
}

void throw_if_cancelled(const ProgressContext& context) {
  if (context.observer != nullptr && context.observer->cancelled()) throw Cancelled{};
}

}  // namespace

void throw_if_cancelled() { throw_if_cancelled(context_of_this_thread); }

ProgressContext progress_context() { return context_of_this_thread; }

ProgressScope::ProgressScope(const ProgressContext& context)
    : before_(std::exchange(context_of_this_thread, context)) {}

ProgressScope::~ProgressScope() { context_of_this_thread = before_; }

Phase::Phase(std::string_view name, std::size_t total) : own_(begun(name, total)), scope_(own_) {}

Phase::~Phase() {
  if (own_.observer != nullptr) own_.observer->end(own_.phase);
}

void Phase::advance(std::size_t steps) const {
  if (own_.observer == nullptr) return;
  own_.observer->advance(own_.phase, steps);
  throw_if_cancelled(own_);
}

}  // namespace adit
