// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_pass.hpp"

#include "adit/core/progress.hpp"

namespace adit {

void BagPass::add(const std::vector<std::size_t>& topics, const Visit& visit) {
  for (const std::size_t topic : topics) visits_.at(topic).push_back(visit);
}

void BagPass::run(const Bag& bag) const {
  for (const BagMessage& message : bag.messages) {
    if (visits_[message.topic].empty()) continue;
    throw_if_cancelled();
    for (const Visit& visit : visits_[message.topic]) visit(message);
  }
}

}  // namespace adit
