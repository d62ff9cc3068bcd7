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
};
Fields fields_of(AgentConfig& config);

/// A robot's own keyframes made ready for registration, each computed once, when first needed.
class FeatureStore {
 public:
  FeatureStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config);
  /// Computes what is missing of `indices`, in parallel. Call it before `at`.
  void prepare(const std::vector<std::uint32_t>& indices);
  [[nodiscard]] const Features& at(std::uint32_t index) const;

 private:
  std::shared_ptr<const RobotMap> map_;
  RegistrationConfig config_;
  std::vector<std::optional<Features>> features_;
};

/// One robot of the fleet: messages in, messages out; no thread, socket or clock. It knows what its own robot
/// measured and what messages brought, nothing else.
///
/// Of two robots that meet, the one with the smaller id searches: it receives the other's descriptors, asks
/// for the clouds of promising matches, registers them and shares the loops. Messages may be repeated or
/// lost; a later meeting sends what is missing. What makes no sense (loops between keyframes that do not
/// exist, descriptors on another grid, covariances that are none) is left out and stops nobody.
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
  struct Peer {
    std::map<std::uint32_t, ScanContext> places;
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
  [[nodiscard]] Replies in_messages(RobotId peer, const std::vector<LoopClosure>& loops) const;
  void find_candidates(RobotId peer_id);
  [[nodiscard]] Replies cloud_requests(RobotId peer_id) const;
  [[nodiscard]] LoopClosure verify(const LoopCandidate& candidate, const Features& match) const;
  [[nodiscard]] Message to(RobotId peer, decltype(Message::body) body) const;

  std::shared_ptr<const RobotMap> map_;
  std::shared_ptr<FeatureStore> features_;
  AgentConfig config_;
  FleetGraph known_;
  std::map<RobotId, Peer> peers_;
};

}  // namespace adit
