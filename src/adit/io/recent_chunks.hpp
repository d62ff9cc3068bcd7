// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The expanded chunks of a bag that were used last.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "adit/core/result.hpp"

namespace adit {

/// Keeps a few, since the times of neighbouring chunks overlap and several threads read. May be used from any
/// thread.
class RecentChunks {
 public:
  /// Keeps so many bytes in all, or a single chunk of more.
  explicit RecentChunks(std::size_t most_bytes = std::size_t{256} << 20U) : most_bytes_(most_bytes) {}

  /// An expanded chunk; lives on with its users when others take its place here.
  using Records = std::shared_ptr<const std::string>;

  /// Those of `chunk`, which `read` (from nothing to Result<std::string>) gives where they are not at hand.
  template <class Read>
  Result<Records> get(std::size_t chunk, const Read& read) {
    if (Records known = find(chunk)) return known;
    return read().map([&](std::string&& records) {
      auto shared = std::make_shared<const std::string>(std::move(records));
      keep(chunk, shared);
      return Records(std::move(shared));
    });
  }

 private:
  static constexpr std::size_t kMost = 4;

  Records find(std::size_t chunk) {
    const std::scoped_lock lock(mutex_);
    const auto known = place_of(chunk);
    if (known == recent_.end()) return nullptr;
    std::rotate(known, known + 1, recent_.end());
    return recent_.back().second;
  }
  void keep(std::size_t chunk, Records records) {
    const std::scoped_lock lock(mutex_);
    if (place_of(chunk) != recent_.end()) return;  // another thread was faster
    num_bytes_ += records->size();
    recent_.emplace_back(chunk, std::move(records));
    while (recent_.size() > kMost || (recent_.size() > 1 && num_bytes_ > most_bytes_)) {
      num_bytes_ -= recent_.front().second->size();
      recent_.pop_front();
    }
  }

  std::deque<std::pair<std::size_t, Records>>::iterator place_of(std::size_t chunk) {
    return std::ranges::find(recent_, chunk, &std::pair<std::size_t, Records>::first);
  }

  std::size_t most_bytes_;
  std::mutex mutex_;
  std::size_t num_bytes_ = 0;                           ///< Of all in `recent_`.
  std::deque<std::pair<std::size_t, Records>> recent_;  ///< The one used last at the back.
};

}  // namespace adit
