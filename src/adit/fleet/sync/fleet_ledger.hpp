// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Who has what: everything an agent knows, with the order in which each robot found it. Two agents that meet
/// tell one another how much of each robot they know, and send the rest.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {

/// What one agent knows, and of each author how much.
class FleetLedger {
 public:
  /// `own` is the graph of robot `self`, which no message changes.
  FleetLedger(RobotId self, RobotGraph own, MergePolicy policy);

  /// All of it, whoever found it.
  [[nodiscard]] const FleetGraph& known() const { return known_; }
  /// Keyframes known of a robot; 0 where it is unknown.
  [[nodiscard]] std::size_t num_nodes_of(RobotId robot) const;
  /// Loops that this robot registered, accepted or not.
  [[nodiscard]] std::size_t num_own_loops() const;
  /// Merge checks that this robot decided, those that later ones replaced among them.
  [[nodiscard]] std::size_t num_own_checks() const;

  /// What this robot registered or decided itself. A loop that is known already is left as it is; an accepted
  /// one whose information the solver cannot use is kept as a rejected one, as those that messages bring.
  void add_own(const LoopClosure& loop);
  /// Replaces an earlier verdict on the same robots.
  void add_own(MergeCheck check);

  /// What a message brought. Nothing changes, and false is returned, where a part before it was lost (the
  /// next Hello asks for it), where it would go beyond what is taken of one robot (kKeyframesPerRobot and so
  /// on), and where it makes no sense: news about this robot itself, covariances of steps that are not
  /// usable (is_usable), loops or checks that are not their author's. An accepted loop whose information is
  /// not usable is kept as a rejected one: refused, it would keep back all that its author finds later.
  ///@{
  bool take(const GraphPart& part);
  bool take(const Loops& part);
  bool take(const MergeChecks& part);
  ///@}
  /// What `findings` named when this robot was saved, its own among it: before it adds or takes anything.
  /// False as above.
  bool restore(const MessageBody& finding);
  /// Replaces the verdict on its two robots, whoever decided it. Throws ContractViolation unless `check.a <=
  /// check.b`.
  void overrule(MergeCheck check);
  /// Why this robot has not searched `peer`; empty: it has.
  void note_unsearched(RobotId peer, std::string why);

  /// How much is known of each robot.
  [[nodiscard]] std::map<RobotId, Hello::Known> summary() const;
  /// What `peer`, who said `theirs`, does not know yet.
  [[nodiscard]] std::vector<MessageBody> news_for(RobotId peer, const Hello& theirs) const;
  /// What `author` registered or decided, from number `first` on.
  ///@{
  [[nodiscard]] std::vector<MessageBody> loops_since(RobotId author, std::size_t first) const;
  [[nodiscard]] std::vector<MessageBody> checks_since(RobotId author, std::size_t first) const;
  ///@}
  /// All that any robot registered or decided.
  [[nodiscard]] std::vector<MessageBody> findings() const;

 private:
  bool add(const Loops& part);
  bool add(const MergeChecks& part);
  void keep(RobotId author, LoopClosure loop);
  void keep(RobotId author, MergeCheck check);

  RobotId self_;
  FleetGraph known_;
  std::map<RobotId, std::vector<KeyframePair>> loops_by_;  ///< By author, in the order of registration.
  std::map<RobotId, std::vector<MergeCheck>> checks_by_;   ///< By author, in the order of decision.
};

}  // namespace adit
