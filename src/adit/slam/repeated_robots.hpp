// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Robots that are there twice, as where two teams hold the same one, or a recording is given again. Merged
/// with itself such a robot would have every evidence and tell nothing, so that it counts once.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "adit/slam/mapping.hpp"
#include "adit/slam/saved_fleet.hpp"

namespace adit {

/// A robot that is left out, as another one has its map.
struct RepeatedRobot {
  std::string name;        ///< As its session or its recording calls it.
  std::string same_as;     ///< The robot that stays, by its name in the run.
  bool was_saved = false;  ///< In an earlier session; else of a recording.
  std::string sentence;    ///< What to say of it, one line that names both.
};

/// Whether two maps were made of one recording in one way: the same odometry and the same keyframes with the
/// same clouds, to the bit, whatever the robots are called. Maps without keyframes are none.
[[nodiscard]] bool is_same_drive(const RobotMap& one, const RobotMap& other);

/// A robot that was taken out of a session.
struct TakenOut {
  std::size_t session = 0;               ///< Which of the saved ones it was in.
  std::string name;                      ///< As it was called there.
  std::shared_ptr<const RobotMap> same;  ///< The map that stays, of that session or one before.
  std::string sentence;                  ///< As in RepeatedRobot.
};

/// Takes out of the saved sessions, with what was found about them, the robots whose drive a robot before
/// them has. Their provenance says why they are no part of the run.
[[nodiscard]] std::vector<TakenOut> take_out_repeated(std::vector<SavedFleet>& saved);

/// Takes out of `mapped` the robots whose drive another one has, one of `maps` or one mapped before.
/// @returns what was taken out, in that order.
[[nodiscard]] std::vector<RepeatedRobot> leave_out_repeated(
    const std::vector<std::shared_ptr<const RobotMap>>& maps, std::vector<MappedRobot>& mapped);

}  // namespace adit
