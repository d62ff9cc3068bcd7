// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/meeting.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/fleet/sync/own_map_parts.hpp"

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

/// One robot's failure stops no other.
void attempt(const Agent& agent, std::vector<std::string>& failures, const auto& work) {
  try {
    work();
  } catch (const std::exception& failure) {
    failures.push_back(format("{}: {}", agent.known().robots.at(agent.id()).name, failure.what()));
  }
}

/// Whether the test of these two was concluded.
bool were_checked(RobotId one, RobotId other, const std::vector<MessageBody>& findings) {
  return std::ranges::any_of(findings, [&](const MessageBody& finding) {
    const auto* part = std::get_if<MergeChecks>(&finding);
    return part != nullptr && std::ranges::any_of(part->checks, [&](const MergeCheck& check) {
             return check.a == std::min(one, other) && check.b == std::max(one, other);
           });
  });
}

/// What the agent's robot knew when it was saved, if it was.
void restore(Agent& agent, Meeting& meeting, const std::vector<MetBefore>& met_before) {
  for (const MetBefore& group : met_before) {
    const auto was_there = [&](RobotId robot) {
      return std::ranges::find(group.robots, robot) != group.robots.end();
    };
    if (!was_there(agent.id())) continue;
    std::map<RobotId, std::uint32_t> met;
    for (const auto& map : meeting.maps)
      if (was_there(map->id) && map->id != agent.id() && were_checked(agent.id(), map->id, group.findings))
        met[map->id] = static_cast<std::uint32_t>(searchable_keyframes(*map).size());
    if (!agent.restore(group.findings, met))
      meeting.failures.push_back("a part of what had been found before makes no sense");
  }
}

Result<> all_meet(Meeting& meeting, const BackEndConfig& back_end, LoopbackBus& bus, const Phase& phase) {
  std::vector<Agent>& agents = meeting.agents;
  for (std::size_t a = 0; a < agents.size(); ++a) {
    for (std::size_t b = a + 1; b < agents.size(); ++b) {
      if (const Result<> met = bus.meet(agents[a].id(), agents[b].id()); !met) return met;
      if (a == 0) attempt(agents[a], meeting.failures, [&] { agents[a].update_estimate(back_end); });
      phase.advance();
    }
    agents[a].forget_cached();  // it has searched all that it searches
  }
  return {};
}

}  // namespace

Result<Meeting> hold_meeting(std::vector<std::shared_ptr<const RobotMap>> maps, const SlamConfig& config,
                             const std::vector<MetBefore>& met_before) {
  Meeting meeting;
  meeting.maps = std::move(maps);
  const std::size_t num_robots = meeting.maps.size();
  const Phase phase("merging", num_robots + kRounds * num_robots * (num_robots - 1) / 2);
  LoopbackBus bus(config.bus);
  const AgentConfig agent_config = config.agent();
  meeting.agents.reserve(num_robots);  // the bus keeps addresses
  for (const auto& map : meeting.maps) {
    meeting.agents.emplace_back(map, agent_config);
    Agent& agent = meeting.agents.back();
    restore(agent, meeting, met_before);
    attempt(agent, meeting.failures, [&] { agent.find_revisits(); });
    limit_cached(meeting.agents, meeting.agents.size() - 1);
    bus.join(agent);
    phase.advance();
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    if (const Result<> met = all_meet(meeting, config.back_end, bus, phase); !met)
      return tl::unexpected(met.error());
  }
  for (const Agent& agent : meeting.agents) {
    meeting.bytes_sent.push_back(bus.bytes_sent(agent.id()));
    if (agent.num_left_out() > 0)
      meeting.failures.push_back(format(
          "{}: {} parts of messages were not taken: others before them were lost, or they made no sense",
          agent.known().robots.at(agent.id()).name, agent.num_left_out()));
  }
  for (const std::string& failure : bus.failures())
    meeting.failures.push_back("a message was left out: " + failure);
  return meeting;
}

}  // namespace adit
