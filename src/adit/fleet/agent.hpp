// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "adit/fleet/joint/fleet_graph.hpp"
#include "adit/fleet/merge/keyframe_store.hpp"
#include "adit/fleet/merge/merge_check.hpp"
#include "adit/fleet/search/lanes.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/place/place_index.hpp"
#include "adit/registration/registration.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// Of an agent under MergePolicy::adaptive: how it chooses candidates, registers them and tests merges.
struct AdaptiveConfig {
  int candidates = 64;
  int further_candidates = 40;
  int segments = 7;
  int segments_that_stand_out = 7;
  int of_a_segment = 4;
  bool stand_out = true;
  double lane_m = 1.0;
  int lanes = 2;
  bool revisits = true;
  int revisit_candidates = 32;
  RegistrationConfig registration;
  MergeCheckConfig merge_check;
};
Fields fields_of(AdaptiveConfig& config);

struct AgentConfig {
  MergePolicy policy = MergePolicy::adaptive;
  PlaceIndexConfig place;
  RegistrationConfig registration;
  int max_candidates = 6000;
  int candidates_per_peer = 8;
  AdaptiveConfig adaptive;  ///< Read under MergePolicy::adaptive alone.

  [[nodiscard]] const RegistrationConfig& registration_in_use() const {
    return policy == MergePolicy::adaptive ? adaptive.registration : registration;
  }
};
Fields fields_of(AgentConfig& config);

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
///  - the features of its own keyframes, FeatureStore::kMaxBytes at most, and if it is adaptive the surfaces
///    that it compares, SurfaceStore::kMaxBytes at most.
/// It stores no clouds of others: they are asked for a message at a time, registered and forgotten.
class Agent {
 public:
  Agent(std::shared_ptr<const RobotMap> map, const AgentConfig& config);

  [[nodiscard]] RobotId id() const { return map_->id; }
  /// Looks for places of its own map to which the robot came back, and tests what it finds as it does with
  /// peers: an adaptive agent, once. Call it before the first meeting.
  void find_revisits();
  /// What to say when `peer` comes into range.
  [[nodiscard]] std::vector<Message> meet(RobotId peer) const;
  /// What to answer. Messages for another robot are a ContractViolation.
  [[nodiscard]] std::vector<Message> on(const Message& message);

  [[nodiscard]] const FleetGraph& known() const { return known_; }
  /// All candidates that this agent or its peers registered, accepted or not, are in `known().loops`.
  [[nodiscard]] FleetSolution solve(const BackEndConfig& config) const { return adit::solve(known_, config); }

 private:
  [[nodiscard]] bool is_adaptive() const { return config_.policy == MergePolicy::adaptive; }
  using Replies = std::vector<Message>;
  using Ends = std::pair<KeyframeId, KeyframeId>;
  struct Peer {
    std::uint32_t num_places = 0;       ///< Received so far.
    std::vector<Places::Place> places;  ///< Those of them that have not been searched.
    bool has_all_places = false;        ///< None of them is still to come.
    std::map<std::uint32_t, std::vector<LoopCandidate>>
        waiting;                         ///< By the peer's keyframe whose cloud is awaited.
    std::vector<LoopCandidate> further;  ///< For a second search.
    std::optional<MergeTest> test;       ///< When all loops have been tried; it asks for clouds itself.
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
  Replies on(RobotId from, const MergeChecks& checks);

  [[nodiscard]] Replies graph_news(RobotId peer, const Hello& theirs) const;
  [[nodiscard]] Replies place_news(RobotId peer, const Hello& theirs) const;
  [[nodiscard]] Replies loop_news(RobotId peer, const Hello& theirs) const;
  /// What `author` registered, from number `first` on.
  [[nodiscard]] Replies loops_from(RobotId peer, RobotId author, std::size_t first) const;
  /// When all places of the peer have come, and the way on which they lie.
  Replies search(RobotId peer_id);
  [[nodiscard]] bool has_way_of(RobotId peer_id) const;
  /// The most similar place of the peer to each of its own, and if adaptive to how that looks from each lane.
  [[nodiscard]] std::vector<LoopCandidate> best_candidates(RobotId peer_id) const;
  struct Chosen {
    std::vector<LoopCandidate> first;
    std::vector<LoopCandidate> further;  ///< If loops among the first ones only contradict one another.
  };
  /// Those that agree along the way.
  [[nodiscard]] Chosen of_segments(RobotId peer_id, const std::vector<LoopCandidate>& found);
  /// The same, and after the first ones those that stand out.
  [[nodiscard]] Chosen promising(RobotId peer_id, std::vector<LoopCandidate> found);
  /// Those that stand out most from what the robot's own map has that looks like them; spread over its way.
  [[nodiscard]] std::vector<LoopCandidate> standing_out(std::vector<LoopCandidate> found, int max_candidates);
  [[nodiscard]] std::vector<LoopCandidate> own_candidates(const OdometryChain& chain);
  /// Those that registration and odometry accept.
  std::vector<PcmLoop> register_own(const std::vector<LoopCandidate>& candidates, const OdometryChain& chain);
  /// Those that start where a displacement along the way would show: others do not say where along it they
  /// are.
  [[nodiscard]] std::vector<PcmLoop> telling(const std::vector<PcmLoop>& loops);
  /// With the peer's or a later surface of its own; the own surface has been prepared.
  [[nodiscard]] CheckedPlace compared(const PlannedCheck& check, const SeenSurface& theirs,
                                      bool is_distinctive) const;
  /// Of comparisons within the own map.
  [[nodiscard]] std::vector<CheckedPlace> compare_own(const std::vector<PlannedCheck>& asked);
  void register_clouds_of(RobotId from, const Clouds& clouds);
  /// The test of the maps, when all loops with the peer have been tried.
  void begin_test(RobotId peer_id);
  /// What the test asks for next, or its verdict.
  Replies go_on_testing(RobotId peer_id);
  /// Whether they were what the test had asked for.
  bool compare_clouds_of(RobotId from, const Clouds& clouds);
  /// Many loops, and all that they say, if anything, is refuted: the true ones may not have been among the
  /// candidates.
  [[nodiscard]] bool leads_nowhere(const MergeCheck& check) const;
  Replies conclude_test(RobotId peer_id);
  void decide(MergeCheck check);
  [[nodiscard]] std::shared_ptr<const OtherPlaces> other_places();
  /// Of each keyframe the distance to the most similar other place.
  [[nodiscard]] const std::vector<double>& own_likeness();
  [[nodiscard]] Discernment& discernment();
  [[nodiscard]] MergeTest test_of(const std::vector<PcmLoop>& loops, const OdometryChain& own,
                                  const OdometryChain& theirs, const std::vector<double>& known_before = {});
  [[nodiscard]] OdometryChain own_chain() const { return chain_by(map_->id); }
  /// The way of a robot by its own odometry, as far as it is known.
  [[nodiscard]] OdometryChain chain_by(RobotId robot) const;
  [[nodiscard]] Replies checks_from(RobotId peer, RobotId author, std::size_t first) const;
  void find_candidates(RobotId peer_id);
  /// As many of them as there is room for wait for the peer's clouds.
  void await_clouds(RobotId peer_id, std::vector<LoopCandidate> candidates);
  /// From which it looks for similar places: only the one it drove, unless it is adaptive.
  [[nodiscard]] Lanes lanes() const;
  [[nodiscard]] std::size_t num_tried() const;
  [[nodiscard]] Replies cloud_request(RobotId peer_id) const;
  [[nodiscard]] LoopClosure verify(const LoopCandidate& candidate, const Features& match) const;
  [[nodiscard]] Message to(RobotId peer, decltype(Message::body) body) const;

  std::shared_ptr<const RobotMap> map_;
  std::shared_ptr<FeatureStore> features_;
  AgentConfig config_;
  FleetGraph known_;
  std::map<RobotId, std::vector<Ends>> registered_;     ///< By author, in the order of registration.
  std::map<RobotId, std::vector<MergeCheck>> decided_;  ///< By author, in order.
  std::map<RobotId, Peer> peers_;
  bool looked_for_revisits_ = false;
  // Of an adaptive agent, each made when it is first needed.
  std::shared_ptr<const OtherPlaces> other_places_;
  std::vector<double> own_likeness_;
  std::unique_ptr<Discernment> discernment_;
};

}  // namespace adit
