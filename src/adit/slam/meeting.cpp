// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/meeting.hpp"

#include "adit/core/progress.hpp"

namespace adit {
namespace {

/// In the first round every pair finds its loops; in the second each pair passes on what it heard in the
/// first.
constexpr std::size_t kRounds = 2;

/// All agents together keep at most so many bytes of features and surfaces, beside those of the one at work.
constexpr std::size_t kMaxCachedBytes = 512'000'000;

/// The first agents search next, so that the last ones forget first.
void limit_cached(std::vector<Agent>& agents, std::size_t at_work) {
  std::size_t num_bytes = 0;
  for (std::size_t a = 0; a < agents.size(); ++a) {
    if (a == at_work) continue;
    num_bytes += agents[a].num_cached_bytes();
    if (num_bytes <= kMaxCachedBytes) continue;
    num_bytes -= agents[a].num_cached_bytes();
    agents[a].forget_cached();
  }
}

Result<> all_meet(std::vector<Agent>& agents, const BackEndConfig& back_end, LoopbackBus& bus,
                  const Phase& phase) {
  for (std::size_t a = 0; a < agents.size(); ++a) {
    for (std::size_t b = a + 1; b < agents.size(); ++b) {
      if (const Result<> met = bus.meet(agents[a].id(), agents[b].id()); !met) return met;
      if (a == 0) agents[a].update_estimate(back_end);
      phase.advance();
    }
    agents[a].forget_cached();  // it has searched all that it searches
  }
  return {};
}

}  // namespace

Result<Meeting> hold_meeting(std::vector<std::shared_ptr<const RobotMap>> maps, const SlamConfig& config) {
  Meeting meeting;
  meeting.maps = std::move(maps);
  const std::size_t num_robots = meeting.maps.size();
  const Phase phase("merging", num_robots + kRounds * num_robots * (num_robots - 1) / 2);
  LoopbackBus bus(config.bus);
  const AgentConfig agent_config = config.agent();
  meeting.agents.reserve(num_robots);  // the bus keeps addresses
  for (const auto& map : meeting.maps) {
    meeting.agents.emplace_back(map, agent_config);
    meeting.agents.back().find_revisits();
    limit_cached(meeting.agents, meeting.agents.size() - 1);
    bus.join(meeting.agents.back());
    phase.advance();
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    if (const Result<> met = all_meet(meeting.agents, config.back_end, bus, phase); !met)
      return tl::unexpected(met.error());
  }
  for (const Agent& agent : meeting.agents) meeting.bytes_sent.push_back(bus.bytes_sent(agent.id()));
  meeting.failures = bus.failures();
  return meeting;
}

}  // namespace adit
