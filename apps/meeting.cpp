// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "meeting.hpp"

#include "progress.hpp"

namespace adit::app {
namespace {

/// Two rounds: in the first every pair finds its loops, in the second the news of the first reaches
/// everybody.
constexpr int kRounds = 2;

Result<> all_meet(const std::vector<Agent>& agents, LoopbackBus& bus) {
  for (std::size_t a = 0; a < agents.size(); ++a) {
    for (std::size_t b = a + 1; b < agents.size(); ++b) {
      if (interrupted()) return fail("interrupted");
      if (const Result<> met = bus.meet(agents[a].id(), agents[b].id()); !met) return met;
    }
  }
  return {};
}

}  // namespace

Result<Meeting> hold_meeting(std::vector<std::shared_ptr<const RobotMap>> maps, const RunConfig& config) {
  Meeting meeting;
  meeting.maps = std::move(maps);
  LoopbackBus bus(config.bus);
  meeting.agents.reserve(meeting.maps.size());  // the bus keeps addresses
  for (const auto& map : meeting.maps) {
    meeting.agents.emplace_back(map, config.loops);
    meeting.agents.back().find_revisits();
    bus.join(meeting.agents.back());
  }
  for (int round = 0; round < kRounds; ++round) {
    if (const Result<> met = all_meet(meeting.agents, bus); !met) return tl::unexpected(met.error());
  }
  for (const Agent& agent : meeting.agents) meeting.bytes_sent.push_back(bus.bytes_sent(agent.id()));
  return meeting;
}

}  // namespace adit::app
