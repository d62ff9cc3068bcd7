// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace adit {

/// How many threads all parallel loops of the process may use, 1 or more. Results never depend on it.
void set_num_threads(int num_threads);
/// The limit that holds: at most the processors that the process may use, however many were set.
[[nodiscard]] int num_threads();

/// Calls `body(begin, end)` for consecutive parts of [0, n) of `grain` items each (the last one shorter), on
/// several threads in any order. The parts depend on n and grain only, never on the number of threads.
/// The parts report to the caller's observer (core/progress.hpp); before each it is polled: may throw
/// `Cancelled`.
void parallel_for(std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// Calls `body(i)` for every i in [0, n).
template <class Body>
void parallel_for_each(std::size_t n, const Body& body, std::size_t grain = 1) {
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Sums `body(begin, end)` over the parts of [0, n), always in the order of the parts: the same bytes with
/// any number of threads. T needs a copy and `+=`.
template <class T, class Body>
[[nodiscard]] T parallel_sum(std::size_t n, std::size_t grain, const T& zero, const Body& body) {
  const std::size_t num_parts = (n + grain - 1) / grain;
  std::vector<T> parts(num_parts, zero);
  parallel_for(n, grain,
               [&](std::size_t begin, std::size_t end) { parts[begin / grain] = body(begin, end); });
  T total = zero;
  for (const T& part : parts) total += part;
  return total;
}

}  // namespace adit
