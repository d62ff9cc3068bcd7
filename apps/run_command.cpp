// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "run_command.hpp"

#include <cstdio>
#include <filesystem>
#include <new>

#include "adit/core/format.hpp"
#include "progress.hpp"

namespace adit::app {
namespace {

/// The result of the body; exceptions of the system (an unreadable folder, no memory left) become errors.
Result<> outcome_of(const std::function<Result<>()>& body) {
  TerminalProgress progress;
  const ObserverScope scope(progress);
  try {
    return body();
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(format("{}: {}", error.path1().string(), error.code().message()));
  } catch (const std::bad_alloc&) {
    return fail("not enough memory; fewer --threads need less");
  }
}

}  // namespace

int run_command(const std::string& name, const std::function<Result<>()>& body) {
  catch_signals();
  try {
    const Result<> done = outcome_of(body);
    if (done) return 0;
    std::fprintf(stderr, "adit %s: %s\n", name.c_str(), done.error().message.c_str());
    return 1;
  } catch (const Cancelled&) {
    std::fprintf(stderr, "adit %s: interrupted; unfinished output was removed\n", name.c_str());
    return 128 + caught_signal();
  }
}

}  // namespace adit::app
