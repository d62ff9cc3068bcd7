// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One pass through the messages of a bag, for several readers: read in order, each chunk is expanded once.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "adit/io/bag.hpp"

namespace adit {

/// Who is to see which messages.
class BagPass {
 public:
  /// Takes one message.
  using Visit = std::function<void(const BagMessage&)>;

  /// Only the number of topics is taken from `bag`.
  explicit BagPass(const Bag& bag) : visits_(bag.topics.size()) {}
  /// `visit` is called with the messages of these topics (indices into Bag::topics), in order.
  void add(const std::vector<std::size_t>& topics, const Visit& visit);
  /// Throws Cancelled.
  void run(const Bag& bag) const;

 private:
  std::vector<std::vector<Visit>> visits_;  ///< By topic.
};

}  // namespace adit
