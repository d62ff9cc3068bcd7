// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the robot that searches knows about one peer, and what it waits for.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Where the conversation with a peer stands. It follows from what has come and what is asked for, so that a
/// lost or repeated message cannot leave it somewhere else.
enum class PeerState : std::uint8_t {
  greeting,          ///< Nothing but a Hello has come.
  receiving_places,  ///< Some descriptors have come, not all.
  awaiting_path,     ///< All descriptors have come; part of the odometry that they lie on has not.
  awaiting_clouds,   ///< Candidates wait for clouds of the peer, to be registered.
  comparing,         ///< The merge check waits for clouds of the peer.
  decided,           ///< Searched, and checked where loops were found: nothing is awaited.
};

/// The conversation with one peer, over all meetings.
class PeerSession {
 public:
  /// Computed anew from what is awaited and what has come.
  [[nodiscard]] PeerState state() const;

  /// The peer says how many keyframes it has. What waits for others is given up: it would wait for ever.
  /// False where that is the comparison: it was planned on a map that is gone.
  bool hear(const Hello& hello, RobotId peer);
  /// Whether the peer has that keyframe, as it last said; any before its first Hello.
  [[nodiscard]] bool exists(std::uint32_t keyframe) const {
    return !num_keyframes_ || keyframe < *num_keyframes_;
  }

  /// All of its `num` descriptors were searched before this robot was saved.
  void restore_searched(std::uint32_t num);

  /// Descriptors received so far, over all meetings.
  [[nodiscard]] std::uint32_t num_places() const { return num_places_; }
  /// False where a part before it was lost, and the next Hello asks for it, before the first Hello, and where
  /// there would be more places than the peer has keyframes or than kKeyframesPerRobot.
  bool take(const Places& part);
  /// Forgets descriptors that no search has used; a later meeting sends them again.
  void forget_places();
  /// Whether all descriptors of the peer have come and the search has not taken them yet.
  [[nodiscard]] bool has_all_places() const { return has_all_places_; }
  /// Whether all places lie on the first `num_nodes` nodes of the peer's graph.
  [[nodiscard]] bool lie_within(std::size_t num_nodes) const;
  /// Whether `num_nodes` are all nodes of the peer's graph; false before its first Hello.
  [[nodiscard]] bool is_whole(std::size_t num_nodes) const {
    return num_keyframes_ && num_nodes >= *num_keyframes_;
  }
  /// The descriptors to search, without those of keyframes that do not exist.
  [[nodiscard]] std::vector<Places::Place> places() const;
  /// They were searched, and are forgotten. Until then a search that was broken off can begin again.
  void finish_search();
  /// Whether a search was finished.
  [[nodiscard]] bool is_searched() const { return is_searched_; }

  /// Candidates to register.
  void await_clouds_of(const std::vector<LoopCandidate>& candidates);
  /// Candidates that wait for clouds.
  [[nodiscard]] std::size_t num_waiting() const;
  /// By the peer's keyframe.
  using Views = std::map<std::uint32_t, Clouds::Cloud>;
  /// The peer's keyframes whose views the merge check needs; none ends the comparison, and all views are
  /// forgotten.
  void await_comparison_of(std::vector<std::uint32_t> keyframes);
  /// Forgets clouds that are not awaited; they are asked for again when they are.
  void forget_views();

  /// The clouds to ask for next.
  [[nodiscard]] std::optional<CloudRequest> request() const;
  /// Candidates that the peer's keyframe `cloud` lets one register.
  struct Arrived {
    LoopCandidate candidate;  ///< Its match is that keyframe.
    std::size_t cloud = 0;    ///< Index into Clouds::clouds.
  };
  /// Candidates whose clouds have come, each once.
  [[nodiscard]] std::vector<Arrived> arrived(const Clouds& clouds) const;
  /// They were registered, and wait no longer.
  void finish_registration(const std::vector<Arrived>& arrived);
  /// Keeps the clouds that the merge check waits for. Other alignments of the maps compare the same ones.
  void take_views(const Clouds& clouds);
  /// Whether the merge check has all clouds that it waits for.
  [[nodiscard]] bool has_comparison() const { return missing_views().empty(); }
  /// All that have come and were not forgotten.
  [[nodiscard]] const Views& views() const { return views_; }

 private:
  [[nodiscard]] bool awaits(std::uint32_t view) const;
  [[nodiscard]] std::vector<std::uint32_t> missing_views() const;

  std::optional<std::uint32_t> num_keyframes_;  ///< As the peer last said.
  std::uint32_t num_places_ = 0;
  std::vector<Places::Place> places_;  ///< Not searched yet.
  bool has_all_places_ = false;        ///< None of them is still to come.
  bool is_searched_ = false;
  std::map<std::uint32_t, std::vector<LoopCandidate>> waiting_;  ///< By the peer's keyframe.
  std::vector<std::uint32_t> to_compare_;
  Views views_;
};

}  // namespace adit
