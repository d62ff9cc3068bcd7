// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/transport/loopback_bus.hpp"

#include <exception>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/transport/wire.hpp"

namespace adit {

void LoopbackBus::send(const std::vector<Message>& messages) {
  for (const Message& message : messages) {
    std::vector<std::byte> bytes = encode(message);
    bytes_sent_[message.from] += bytes.size();
    // Drawn from the message's number, so that the same meeting loses the same messages on every run.
    if (Rng(mix64(config_.seed, num_sent_++)).uniform() < config_.loss) {
      ++num_lost_;
      continue;
    }
    queue_.emplace_back(message.to, std::move(bytes));
  }
}

Result<> LoopbackBus::meet(RobotId a, RobotId b) {
  for (const RobotId robot : {a, b}) {
    if (!agents_.contains(robot)) return fail(format("robot {} is not on the bus", robot.value));
  }
  send(agents_[a]->meet(b));
  while (!queue_.empty()) {
    const auto [receiver, bytes] = std::move(queue_.front());
    queue_.pop_front();
    const Result<Message> message = decode(bytes);
    const auto agent = agents_.find(receiver);
    const auto note_failure = [this, to = receiver.value](const std::string& why) {
      ++num_lost_;
      failures_.push_back(format("message to robot {}: {}", to, why));
    };
    if (!message) {
      note_failure(message.error().message);
    } else if (agent == agents_.end()) {
      note_failure("not on the bus");
    } else {
      try {
        send(agent->second->on(*message));
      } catch (const std::exception& failure) {  // one robot's failure stops no other
        note_failure(failure.what());
      }
    }
  }
  return {};
}

std::uint64_t LoopbackBus::bytes_sent(RobotId robot) const {
  const auto sent = bytes_sent_.find(robot);
  return sent == bytes_sent_.end() ? 0 : sent->second;
}

}  // namespace adit
