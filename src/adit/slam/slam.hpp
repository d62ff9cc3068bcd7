// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Multi-robot SLAM in one call: recordings in, one session out.
///
///     std::vector<adit::Recording> recordings = ...;          // adit::open_recording(path), one per robot
///     const adit::Result<adit::SlamRun> run = adit::slam(recordings, adit::SlamConfig{});
///     if (!run) return report(run.error().message);
///     for (const adit::PairOutcome& pair : run->session.solution.pairs)
///       ...                                                   // merged, or refused with a reason
///     adit::write_slam("session", *run);                      // maps, trajectories, graphs, report.html
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/io/session_dir.hpp"
#include "adit/slam/kept_control.hpp"
#include "adit/slam/mapping.hpp"
#include "adit/slam/repeated_robots.hpp"
#include "adit/slam/saved_fleet.hpp"

namespace adit {

/// A session and what it took.
struct SlamRun {
  Session session;  ///< Its provenance says what ran; the caller fills in command and inputs.
  std::vector<std::uint64_t> bytes_sent;  ///< Per robot of the session.
  EstimateDifference online;              ///< Of the first robot's estimate, kept from meeting to meeting.
  std::size_t num_mapped = 0;       ///< Recordings that were mapped; robots of earlier sessions come on top.
  std::vector<FailedRobot> failed;  ///< Recordings that could not be mapped; the others went on.
  /// Robots that are no part of the session, as another one has the same drive; a note says each.
  std::vector<RepeatedRobot> repeated;
  std::vector<std::string>
      notes;  ///< Fallbacks, changed names, what messages could not bring, one line each.
  std::vector<MessageBody> findings;  ///< All loops and merge checks, for a later session.
  /// Of the maps of earlier sessions. Those maps may have moved: the control points have to be fitted anew
  /// (kept_control.hpp, georeference.hpp).
  std::vector<EarlierGeoreferences> georeferences;
};

/// What a person says of two robots, by name, or of one loop between them, against the test.
struct Ruling {
  /// Which of the two.
  enum class Kind : std::uint8_t {
    veto,      ///< Their loops, or that one, join nothing; others may still join their maps.
    confirm,   ///< They are joined by the best alignment that was found, or by that of the loop, as long as
               ///< cycles with others close.
    withdraw,  ///< What the test said last counts again, in place of all rulings.
  };
  /// The keyframes that a loop joins.
  struct Loop {
    std::uint32_t of_a = 0;  ///< Index of a's keyframe.
    std::uint32_t of_b = 0;  ///< Index of b's keyframe.
  };
  Kind kind = Kind::veto;         ///< What is said.
  std::string a;                  ///< One robot.
  std::string b;                  ///< The other.
  std::optional<Loop> loop = {};  ///< None: of all loops between them.
};

/// Maps every robot, lets each meet every other, and solves for the joint maps. With the default
/// configuration maps are merged only where tested evidence says so; a pair that is not merged has its reason
/// in `session.solution.pairs`. Names are made safe and distinct (core/robot_name). The same recordings and
/// configuration give the same bytes with any number of threads. Ground truth in recordings is not read.
/// Where messages between robots are lost (bus.loss), each still has its whole map in the session, with a
/// note. Reports its phases to the observer in scope and may throw `Cancelled` (core/progress.hpp); fails as
/// `map_robots` does.
[[nodiscard]] Result<SlamRun> slam(std::vector<Recording> recordings, const SlamConfig& config = {});

/// The same from where sessions were left (read_fleet): robots of one session are neither mapped nor searched
/// again, and meet those of the others and the new ones. With the configuration that a session was made with,
/// it gives what `slam` of all recordings at once would (docs/decisions/0055). Names that occur twice get a
/// number, with a note; of robots with the same drive the first one counts, with a note. `rulings` come last
/// and are kept as the reason of the pair. Fails, too, where there are more than 256 robots, where sessions
/// described places in different ways, on a ruling about a robot that does not exist, under a policy without
/// merge checks, where no alignment was found that could be confirmed, or a loop is in none or not in use,
/// and where there is no ruling to withdraw, or no test before it.
[[nodiscard]] Result<SlamRun> slam_on(std::vector<SavedFleet> saved, std::vector<Recording> recordings,
                                      const SlamConfig& config, const std::vector<Ruling>& rulings = {});

/// Writes the session directory (io/session_dir.hpp, slam/saved_fleet.hpp, metrics.json, report.html) into
/// `dir`, which exists: an OutputDir's path, or any folder.
Result<> write_slam(const std::filesystem::path& dir, const SlamRun& run);

}  // namespace adit
