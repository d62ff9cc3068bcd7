// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "adit/fleet/agent_config.hpp"
#include "adit/fleet/joint/fleet_estimate.hpp"
#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/merge/loop_registration.hpp"
#include "adit/fleet/merge/merge_checker.hpp"
#include "adit/fleet/search/candidate_search.hpp"
#include "adit/fleet/sync/fleet_ledger.hpp"
#include "adit/fleet/sync/peer_session.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// One robot of the fleet: messages in, messages out; no thread, socket or clock. It knows what its own robot
/// measured and what messages brought, nothing else. fleet/README.md draws what happens in which room.
///
/// Of two robots that meet, the one with the smaller id searches: it receives the other's descriptors, asks
/// for the clouds of promising matches, registers them, compares both maps along what the loops claim to
/// share, and shares loops and verdict. Messages may be repeated or lost; a later meeting sends what is
/// missing. What makes no sense (loops between keyframes that do not exist, descriptors on another grid,
/// covariances that are not positive definite) is left out and stops nobody.
///
/// Whatever throws on the way (no memory, `Cancelled`) leaves what was found, and what it broke off is done
/// in the next meeting, with the same result.
///
/// Cost in a large fleet: a robot registers at most `max_candidates` candidates, those of the peers it meets
/// first, and of each later peer the best `candidates_per_peer`, which it looks for with every fourth
/// keyframe, so that its time grows more slowly than the number of robots it meets. Beside its own map an
/// agent stores
///  - of each robot that it heard of the graph, 0.4 kB per keyframe, and the candidates that this robot
///  registered,
///    0.6 kB each: with n keyframes per robot and r robots at most
///    r (0.4 n + 0.6 (max_candidates + r candidates_per_peer)) kB;
///  - the descriptors of one peer at a time, 6 kB per keyframe, until they have been searched;
///  - the features of its own keyframes, at most FeatureStore::kMaxBytes, and under MergePolicy::adaptive the
///    surfaces that it compares, at most ViewStore::kMaxBytes and ScanStore::kMaxBytes;
///  - what one peer saw at the places that a check compares, some tens of megabytes, until the check is over.
/// Other clouds are asked for, registered and forgotten. A broken or hostile peer that makes up more fills at
/// most what protocol.hpp says is taken of any one robot (kKeyframesPerRobot and so on: less than 1 GB of
/// each robot that it speaks of, and 1.2 GB of descriptors).
class Agent {
 public:
  /// Shares `map`, which has to be complete: keyframes that it gets later are not known to others.
  Agent(std::shared_ptr<const RobotMap> map, const AgentConfig& config);

  /// That of its map.
  [[nodiscard]] RobotId id() const { return map_->id; }
  /// Looks for places of its own map to which the robot came back, and checks what it finds as it does with
  /// peers. Under MergePolicy::adaptive, once; call it before the first meeting. Where it throws, it may be
  /// called again.
  void find_revisits();
  /// Takes up where it was when it was saved: `findings` of then, and how many searchable keyframes each
  /// robot had that it had met. It does not look for loops in its own map or with them again. Before the
  /// first meeting. False where a finding makes no sense and is left out.
  bool restore(const std::vector<MessageBody>& findings, const std::map<RobotId, std::uint32_t>& met);
  /// What a person decided about two robots replaces the verdict, for all that this agent solves from then
  /// on.
  void overrule(MergeCheck check) { ledger_.overrule(std::move(check)); }
  /// What to say when `peer` comes into range.
  [[nodiscard]] std::vector<Message> meet(RobotId peer) const;
  /// What to answer, to the sender. Messages for another robot are a ContractViolation.
  [[nodiscard]] std::vector<Message> on(const Message& message);

  /// Its `loops` are all candidates that this agent or others registered, accepted or not.
  [[nodiscard]] const FleetGraph& known() const { return ledger_.known(); }
  /// Parts of graphs, loops, checks and descriptors that it did not take: a part before them was lost, they
  /// went beyond what is taken of one robot, or they made no sense. None where all goes well.
  [[nodiscard]] std::size_t num_left_out() const { return num_left_out_; }
  /// All loops and merge checks, by whoever found them, as messages.
  [[nodiscard]] std::vector<MessageBody> findings() const { return ledger_.findings(); }
  /// The joint solution of all that it knows now. Agents that know the same get the same, to the last bit.
  [[nodiscard]] FleetSolution solve(const BackEndConfig& config) const {
    return adit::solve(known(), config);
  }
  /// Where all that it knows of is, while it drives and meets others: solves for what changed since the last
  /// call.
  FleetEstimate::Step update_estimate(const BackEndConfig& config) {
    return estimate_.update(known(), config);
  }
  /// As of the last `update_estimate`; empty before the first.
  [[nodiscard]] const FleetEstimate& estimate() const { return estimate_; }

  /// Bytes of features and surfaces of its own keyframes, which it can compute again.
  [[nodiscard]] std::size_t num_cached_bytes() const;
  /// Forgets them, where many agents live in one process and this one searches no more for now.
  void forget_cached();

 private:
  using Replies = std::vector<MessageBody>;
  [[nodiscard]] bool is_adaptive() const { return config_.policy == MergePolicy::adaptive; }
  /// Of two robots the one with the smaller id searches.
  [[nodiscard]] bool searches(RobotId peer) const { return map_->id < peer; }

  Replies on(RobotId from, const Hello& theirs);
  Replies on(RobotId from, const GraphPart& part);
  Replies on(RobotId from, const Places& part);
  Replies on(RobotId from, const CloudRequest& request) const;
  Replies on(RobotId from, const Clouds& clouds);
  Replies on(RobotId from, const Loops& part);
  Replies on(RobotId from, const MergeChecks& part);

  /// Counts what is not taken.
  bool counted(bool is_taken);
  /// Empty: it was searched.
  [[nodiscard]] std::string why_unsearched(RobotId peer, const std::string& name) const;

  /// What an earlier meeting has left undone, as far as it can go on.
  Replies resume(RobotId peer);
  /// Once all places of the peer have come, and the path on which they lie.
  Replies search_when_ready(RobotId peer);
  void look_for_revisits();
  Replies register_clouds(RobotId peer, const Clouds& clouds);
  Replies begin_check(RobotId peer);
  /// Where all is searched: the check that an exception or a restart has left undone.
  Replies check_if_due(RobotId peer);
  Replies compare_clouds(RobotId peer, const Clouds& clouds);
  /// What the check asks for next, beyond what has come; or its verdict.
  Replies go_on_checking(RobotId peer);
  Replies conclude_check(RobotId peer);

  [[nodiscard]] Hello hello() const;
  [[nodiscard]] std::vector<Message> addressed(RobotId peer, Replies bodies) const;
  /// Candidates registered or waiting.
  [[nodiscard]] std::size_t num_tried() const;
  void await_clouds(PeerSession& session, std::vector<LoopCandidate> candidates) const;
  [[nodiscard]] std::vector<LoopCandidate> candidates_with(RobotId peer);
  /// All that this robot registered whose ends are known and, as the peer last said, exist; accepted or not.
  [[nodiscard]] std::vector<LoopClosure> loops_with(RobotId peer) const;
  [[nodiscard]] OdometryChain chain_by(RobotId robot) const;
  [[nodiscard]] Discernment& discernment();

  std::shared_ptr<const RobotMap> map_;
  AgentConfig config_;
  FleetLedger ledger_;
  FleetEstimate estimate_;
  std::map<RobotId, PeerSession> sessions_;
  std::map<RobotId, MergeChecker> checks_;  ///< Under way.
  std::set<RobotId> to_check_;              ///< Peers whose check has begun and has no verdict yet.
  std::shared_ptr<FeatureStore> features_;
  LoopRegistration registration_;
  std::shared_ptr<CandidateSearch> search_;
  std::unique_ptr<Discernment> discernment_;  ///< Made when first needed.
  bool looked_for_revisits_ = false;
  std::set<RobotId> on_other_grids_;  ///< Peers whose descriptors cannot be compared with the own ones.
  std::size_t num_left_out_ = 0;
};

}  // namespace adit
