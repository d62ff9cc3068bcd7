// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <set>

#include "adit/fleet/fleet_graph.hpp"
#include "adit/fleet/protocol.hpp"
#include "adit/place/place_index.hpp"
#include "adit/registration/registration.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

struct AgentConfig {
  PlaceIndexConfig place;
  RegistrationConfig registration;
  int max_candidates = 6000;
  int candidates_per_peer = 8;
};
Fields fields_of(AgentConfig& config);

/// A robot's own keyframes made ready for registration, each when it is needed. It keeps those used last, as
/// many as fit `kMaxBytes`.
class FeatureStore {
 public:
  static constexpr std::size_t kMaxBytes = 256'000'000;

  FeatureStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
               std::size_t max_bytes = kMaxBytes);
  /// Computes what is missing of `indices`, in parallel; forgets what was used longest ago and is not among
  /// them. Call it before `at`.
  void prepare(const std::vector<std::uint32_t>& indices);
  [[nodiscard]] const Features& at(std::uint32_t index) const;
  [[nodiscard]] std::size_t num_bytes() const { return num_bytes_; }

 private:
  struct Entry {
    std::optional<Features> features;
    std::uint64_t last_used = 0;
  };
  void forget_oldest();

  std::shared_ptr<const RobotMap> map_;
  RegistrationConfig config_;
  std::size_t max_bytes_;
  std::vector<Entry> entries_;
  std::uint64_t now_ = 0;  ///< Counts calls of `prepare`.
  std::size_t num_bytes_ = 0;
};

/// One robot of the fleet: messages in, messages out; no thread, socket or clock. It knows what its own robot
/// measured and what messages brought, nothing else.
///
/// Of two robots that meet, the one with the smaller id searches: it receives the other's descriptors, asks
/// for the clouds of promising matches, registers them and shares the loops. Messages may be repeated or
/// lost; a later meeting sends what is missing. What makes no sense (loops between keyframes that do not
/// exist, descriptors on another grid, covariances that are none) is left out and stops nobody.
///
/// What it costs in a large fleet: a robot registers at most `max_candidates` candidates, those of the peers
/// it meets first, and of each later peer the best `candidates_per_peer`, which it looks for with every
/// fourth keyframe, so that time a robot grows slower than the number of robots it meets. Beside its own map
/// an agent stores
///  - of each robot that it heard of the graph, 0.4 kB a keyframe, and the candidates that this robot
///    registered, 0.6 kB each: with n keyframes a robot and r robots at most
///    r (0.4 n + 0.6 (max_candidates + r candidates_per_peer)) kB;
///  - the descriptors of one peer at a time, 6 kB a keyframe, until they have been searched;
///  - the features of its own keyframes, FeatureStore::kMaxBytes at most.
/// It stores no clouds of others: they are asked for a message at a time, registered and forgotten.
class Agent {
 public:
  /// `features` may be shared between agents that were made from the same map.
  Agent(std::shared_ptr<const RobotMap> map, std::shared_ptr<FeatureStore> features,
        const AgentConfig& config);

  [[nodiscard]] RobotId id() const { return map_->id; }
  /// What to say when `peer` comes into range.
  [[nodiscard]] std::vector<Message> meet(RobotId peer) const;
  /// What to answer. Messages for another robot are a ContractViolation.
  [[nodiscard]] std::vector<Message> on(const Message& message);

  [[nodiscard]] const FleetGraph& known() const { return known_; }
  /// All candidates that this agent or its peers registered, accepted or not, are in `known().loops`.
  [[nodiscard]] FleetSolution solve(const BackEndConfig& config) const { return adit::solve(known_, config); }

 private:
  using Replies = std::vector<Message>;
  using Ends = std::pair<KeyframeId, KeyframeId>;
  struct Peer {
    std::uint32_t num_places = 0;       ///< Received so far.
    std::vector<Places::Place> places;  ///< Those of them that have not been searched.
    std::map<std::uint32_t, std::vector<LoopCandidate>>
        waiting;  ///< By the peer's keyframe whose cloud is awaited.
  };

  [[nodiscard]] Hello hello() const;
  /// Of two robots the one with the smaller id searches.
  [[nodiscard]] bool searches(RobotId peer) const { return map_->id < peer; }
  Replies on(RobotId from, const Hello& hello);
  Replies on(RobotId from, const GraphPart& part);
  Replies on(RobotId from, const Places& places);
  Replies on(RobotId from, const CloudRequest& request) const;
  Replies on(RobotId from, const Clouds& clouds);
  Replies on(RobotId from, const Loops& loops);

  [[nodiscard]] Replies graph_news(RobotId peer, const Hello& theirs) const;
  [[nodiscard]] Replies place_news(RobotId peer, const Hello& theirs) const;
  [[nodiscard]] Replies loop_news(RobotId peer, const Hello& theirs) const;
  /// What `author` registered, from number `first` on.
  [[nodiscard]] Replies loops_from(RobotId peer, RobotId author, std::size_t first) const;
  [[nodiscard]] std::vector<LoopCandidate> best_candidates(RobotId peer_id) const;
  void find_candidates(RobotId peer_id);
  [[nodiscard]] std::size_t num_tried() const;
  [[nodiscard]] Replies cloud_request(RobotId peer_id) const;
  [[nodiscard]] LoopClosure verify(const LoopCandidate& candidate, const Features& match) const;
  [[nodiscard]] Message to(RobotId peer, decltype(Message::body) body) const;

  std::shared_ptr<const RobotMap> map_;
  std::shared_ptr<FeatureStore> features_;
  AgentConfig config_;
  FleetGraph known_;
  std::map<RobotId, std::vector<Ends>> registered_;  ///< By author, in the order of registration.
  std::map<RobotId, Peer> peers_;
};

}  // namespace adit
