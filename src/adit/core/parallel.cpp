// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

#include "adit/core/check.hpp"
#include "adit/core/progress.hpp"

#if defined(__SANITIZE_THREAD__)
#include <exception>
#include <thread>
#include <vector>
#endif

namespace adit {
namespace {

// The limit is a property of the process and of TBB's worker pool, not of any robot; no result depends on it.
std::mutex limit_mutex;
std::unique_ptr<tbb::global_control> limit;

#if defined(__SANITIZE_THREAD__)
// Distributions build TBB without the thread sanitizer, which then takes every part that TBB hands over for a
// race. Threads that the sanitizer knows take the parts instead, so that what it reports are races of the
// parts.
template <typename RunPart>
void run_concurrently(std::size_t num_parts, const RunPart& run_part) {
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t part = next++; part < num_parts; part = next++) run_part(part);
    } catch (...) {
      next = num_parts;
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads(); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}
#else
template <typename RunPart>
void run_concurrently(std::size_t num_parts, const RunPart& run_part) {
  tbb::parallel_for(std::size_t{0}, num_parts, run_part, tbb::simple_partitioner{});
}
#endif

}  // namespace

void set_num_threads(int num_threads) {
  ADIT_CHECK(num_threads >= 1, "at least one thread");
  const std::lock_guard lock(limit_mutex);
  limit.reset();
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(num_threads));
}

int num_threads() {
  return static_cast<int>(
      std::min<std::size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                            static_cast<std::size_t>(tbb::info::default_concurrency())));
}

void parallel_for(std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  ADIT_CHECK(grain >= 1, "a part holds at least one item");
  const std::size_t num_parts = (n + grain - 1) / grain;
  const auto run_part = [&](std::size_t part) {
    throw_if_cancelled();
    body(part * grain, std::min(n, (part + 1) * grain));
  };
  if (num_parts <= 1 || num_threads() == 1) {
    for (std::size_t part = 0; part < num_parts; ++part) run_part(part);
    return;
  }
  run_concurrently(num_parts, [&, context = progress_context()](std::size_t part) {
    const ProgressScope scope(context);
    run_part(part);
  });
}

}  // namespace adit
