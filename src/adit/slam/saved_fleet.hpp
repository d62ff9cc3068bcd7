// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a session keeps so that it can go on: each robot's own map (ROBOT/map.adit) and what the fleet found
/// (fleet.adit). With it robots can be added and sessions joined without driving, registering or comparing
/// again.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "adit/fleet/sync/protocol.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// The robots of one saved session and what they found.
struct SavedFleet {
  Provenance provenance;                        ///< Of the session that it was read from.
  std::vector<std::shared_ptr<RobotMap>> maps;  ///< In id order.
  std::vector<MessageBody> findings;            ///< Loops and merge checks of these robots (Agent::findings).
  std::vector<Georeference> georeferences;      ///< Of the maps that have one.
  std::vector<std::string> notes;               ///< What could not be taken over, one line each.
  std::filesystem::path read_from = {};         ///< The session directory, as given; "" of a fleet in memory.
};

/// Writes both kinds of files into the session directory `dir`. A robot without keyframes has no folder and
/// is left out.
Result<> write_fleet(const std::filesystem::path& dir,
                     const std::vector<std::shared_ptr<const RobotMap>>& maps,
                     const std::vector<MessageBody>& findings);

/// Reads a session directory. Findings that are damaged, of other maps or of a protocol that is not read
/// are left out, with a note: the pairs are then tested anew. Fails, naming the file, where a map is missing
/// (older sessions have none) or damaged.
[[nodiscard]] Result<SavedFleet> read_fleet(const std::filesystem::path& dir);

/// Gives the robots new ids. `ids` has all of them, in the same order as before: of two robots the one with
/// the smaller id has searched.
void renumber(SavedFleet& fleet, const std::map<RobotId, RobotId>& ids);

/// Takes a robot out, with what was found about it. The other robots stay, with their ids and what was found
/// about them alone.
void take_out(SavedFleet& fleet, RobotId robot);

}  // namespace adit
