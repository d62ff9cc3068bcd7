// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two robots map on their own, meet, find out where they have both been, and share one map.
/// Usage: 03_two_robots_meet [RECORDING RECORDING]
#include <cstdio>
#include <memory>

#include "adit/fleet/agent.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/transport/loopback_bus.hpp"
#include "simulated.hpp"

namespace {

using Maps = std::vector<std::shared_ptr<const adit::RobotMap>>;

adit::Result<std::vector<adit::Recording>> input(int argc, char** argv) {
  if (argc < 3) return example::two_robots_of_zab();
  std::vector<adit::Recording> recordings;
  for (const char* path : {argv[1], argv[2]}) {
    auto recording = adit::open_recording(path);
    if (!recording) return tl::unexpected(recording.error());
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

adit::Result<Maps> map_each(const std::vector<adit::Recording>& recordings) {
  Maps maps;
  for (const adit::Recording& recording : recordings) {
    adit::RobotSlamConfig config;
    if (recording.wheel.empty()) config.odometry.method = adit::OdometryMethod::kiss_icp;
    const adit::RobotId id{static_cast<std::uint8_t>(maps.size())};
    auto map = adit::map_recording(recording, id, config);
    if (!map) return tl::unexpected(map.error());
    maps.push_back(std::make_shared<const adit::RobotMap>(std::move(*map)));
  }
  return maps;
}

adit::Agent agent_of(const std::shared_ptr<const adit::RobotMap>& map) {
  const adit::AgentConfig config;
  return {map, config};
}

int failed(const adit::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recordings = input(argc, argv);
  if (!recordings) return failed(recordings.error());
  const auto maps = map_each(*recordings);
  if (!maps) return failed(maps.error());
  adit::Agent first = agent_of((*maps)[0]);
  adit::Agent second = agent_of((*maps)[1]);

  adit::LoopbackBus bus;  // carries bytes between agents of one process; other transports do the same
  bus.join(first);
  bus.join(second);
  if (const auto met = bus.meet(first.id(), second.id()); !met) return failed(met.error());

  const adit::FleetSolution solution = first.solve({});
  const adit::PairOutcome& pair = solution.pairs.front();
  if (!pair.merged) {
    std::printf("two maps, because %s\n", pair.refused_reason.c_str());
    return 0;
  }
  const adit::Vector3 start = solution.T_world_keyframe.at(second.id()).front().translation();
  std::printf("%s and %s share one map, because %zu of %zu loops agree with each other\n",
              (*maps)[0]->name.c_str(), (*maps)[1]->name.c_str(), pair.clique, pair.num_loops);
  std::printf("%s started at (%.1f, %.1f, %.1f) as %s sees it\n", (*maps)[1]->name.c_str(), start.x(),
              start.y(), start.z(), (*maps)[0]->name.c_str());
}
