// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/agent.hpp"

namespace adit {

/// What goes wrong with the messages.
struct LoopbackConfig {
  double loss = 0.0;  ///< Share of messages that never arrive.
  std::uint64_t seed = 1;
};
/// Keys without a prefix. They point into `c`, which must outlive them.
inline Fields fields_of(LoopbackConfig& c) {
  return {{"loss", &c.loss, "", 0.0, 0.95, "share of messages that the loopback bus loses"},
          {"seed", &c.seed, "", 0.0, 1.8e19, "seed of the losses"}};
}

/// Carries messages between agents of one process. Each is encoded and decoded, so that nothing but bytes
/// passes.
class LoopbackBus {
 public:
  /// Without agents: they `join`.
  explicit LoopbackBus(const LoopbackConfig& config = {}) : config_(config) {}

  /// The agent must outlive the bus.
  void join(Agent& agent) { agents_[agent.id()] = &agent; }

  /// The two come into range: delivers until both have nothing more to say. A message that cannot be decoded,
  /// or on which an agent fails, is dropped and noted in `failures`; nobody else is affected.
  Result<> meet(RobotId a, RobotId b);

  /// Of all messages of a robot, encoded, those that were lost included.
  [[nodiscard]] std::uint64_t bytes_sent(RobotId robot) const;
  /// Messages that were lost on purpose, could not be decoded or made an agent fail.
  [[nodiscard]] int num_lost() const { return num_lost_; }
  /// What made messages fail, one sentence per message that was not lost on purpose.
  [[nodiscard]] const std::vector<std::string>& failures() const { return failures_; }

 private:
  void send(const std::vector<Message>& messages);

  LoopbackConfig config_;
  std::map<RobotId, Agent*> agents_;
  std::map<RobotId, std::uint64_t> bytes_sent_;
  std::deque<std::pair<RobotId, std::vector<std::byte>>> queue_;
  std::uint64_t num_sent_ = 0;
  int num_lost_ = 0;
  std::vector<std::string> failures_;
};

}  // namespace adit
