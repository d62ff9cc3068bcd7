// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/repeated_robots.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"

namespace adit {
namespace {

bool is_same_pose(const Pose& one, const Pose& other) {
  return one.translation() == other.translation() && one.rotation().coeffs() == other.rotation().coeffs();
}

bool is_same_stamped_pose(const StampedPose& one, const StampedPose& other) {
  return one.stamp == other.stamp && is_same_pose(one.T_world_body, other.T_world_body);
}

bool is_same_keyframe(const Keyframe& one, const Keyframe& other) {
  return one.stamp == other.stamp && is_same_pose(one.T_odom_base, other.T_odom_base) &&
         one.cloud->points == other.cloud->points && one.cloud->intensities == other.cloud->intensities;
}

/// "robot_0 of team_b"
std::string name_in(const SavedFleet& fleet, const std::string& name) {
  return format("{} of {}", name, fleet.read_from.empty() ? "an earlier session" : fleet.read_from.string());
}

}  // namespace

bool is_same_drive(const RobotMap& one, const RobotMap& other) {
  return !one.keyframes.empty() && std::ranges::equal(one.odometry, other.odometry, is_same_stamped_pose) &&
         std::ranges::equal(one.keyframes, other.keyframes, is_same_keyframe);
}

std::vector<TakenOut> take_out_repeated(std::vector<SavedFleet>& saved) {
  std::vector<TakenOut> taken;
  std::vector<std::pair<std::shared_ptr<const RobotMap>, std::string>> stay;  // and what to call each
  for (std::size_t s = 0; s < saved.size(); ++s) {
    SavedFleet& fleet = saved[s];
    const std::vector<std::shared_ptr<RobotMap>> robots = fleet.maps;  // the fleet's own list gets shorter
    for (const std::shared_ptr<RobotMap>& map : robots) {
      const auto same =
          std::ranges::find_if(stay, [&](const auto& other) { return is_same_drive(*other.first, *map); });
      if (same == stay.end()) {
        stay.emplace_back(map, name_in(fleet, map->name));
        continue;
      }
      const std::string sentence = format(
          "{} and {} have the same map, to the bit: it is one recording, which counts once; what was found "
          "or ruled about the former is left out, and its pairs are tested anew",
          name_in(fleet, map->name), same->second);
      const auto mapping = std::ranges::find_if(
          fleet.provenance.robots, [&](const RobotProvenance& robot) { return robot.is_of_map(map->name); });
      if (mapping != fleet.provenance.robots.end()) mapping->failure = sentence;
      taken.push_back({s, map->name, same->first, sentence});
      take_out(fleet, map->id);
    }
  }
  return taken;
}

std::vector<RepeatedRobot> leave_out_repeated(const std::vector<std::shared_ptr<const RobotMap>>& maps,
                                              std::vector<MappedRobot>& mapped) {
  std::vector<std::shared_ptr<const RobotMap>> stay = maps;
  std::vector<RepeatedRobot> repeated;
  std::vector<MappedRobot> left;
  for (MappedRobot& robot : mapped) {
    const std::string& name = robot.map->name;
    const auto same =
        std::ranges::find_if(stay, [&](const auto& other) { return is_same_drive(*other, *robot.map); });
    if (same != stay.end()) {
      repeated.push_back({name, (*same)->name, false,
                          format("{} is left out: it has the same map as {}, to the bit, so that both are of "
                                 "one recording, which counts once",
                                 name, (*same)->name)});
      continue;
    }
    stay.push_back(robot.map);
    left.push_back(std::move(robot));
  }
  mapped = std::move(left);
  return repeated;
}

}  // namespace adit
