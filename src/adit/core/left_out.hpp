// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a recording says that cannot be used: one damaged message must not cost the recording.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// Counts what is left out of one topic, and remembers why.
class LeftOut {
 public:
  /// `things`: what is counted, in the plural, as "messages".
  explicit LeftOut(std::string_view things) : things_(things) {}

  /// One that can be used.
  void take() { ++num_all_; }
  /// One that cannot be used, for that reason.
  void leave(const Error& reason);
  /// How many cannot be used.
  [[nodiscard]] std::size_t num() const { return num_; }
  /// "3 of 100 messages are left out; the first, 4: REASON"; none where nothing is.
  [[nodiscard]] std::optional<std::string> sentence() const;
  /// The sentence as an error, where nothing at all could be used though there was something.
  [[nodiscard]] Result<> unless_all() const;

 private:
  std::string things_;
  std::size_t num_all_ = 0;
  std::size_t num_ = 0;
  std::string first_;
};

}  // namespace adit
