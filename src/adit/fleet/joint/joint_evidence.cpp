// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/joint_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "adit/fleet/joint/frames.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"

namespace adit {
namespace {

/// One hypothesis of a pair whose own test did not join it.
struct Candidate {
  const MergeCheck* check;
  const MergeHypothesis* hypothesis;
  Merge merge;
  [[nodiscard]] bool is_refuted() const { return hypothesis->outcome == HypothesisOutcome::refuted; }
};

/// Of the robots that merges join, each in the frame of the smallest id.
struct Groups {
  std::map<RobotId, RobotId> group;
  std::map<RobotId, Pose> T_group_robot;
};

Groups groups_of(const FleetGraph& fleet, const std::vector<Merge>& merges) {
  Groups out;
  for (const auto& [robot, graph] : fleet.robots) {
    if (out.group.contains(robot)) continue;
    out.group[robot] = robot;
    out.T_group_robot[robot] = Pose();
    std::vector<RobotId> reached{robot};
    for (std::size_t i = 0; i < reached.size(); ++i)  // grows on the way
      for (const Merge& merge : merges) {
        if (merge.a != reached[i] && merge.b != reached[i]) continue;
        const RobotId next = merge.a == reached[i] ? merge.b : merge.a;
        if (!out.group.emplace(next, robot).second) continue;
        std::vector<const LoopClosure*> loops;
        for (const PcmLoop& loop : merge.loops)
          loops.push_back(&fleet.loops.at({{merge.a, static_cast<std::uint32_t>(loop.a)},
                                           {merge.b, static_cast<std::uint32_t>(loop.b)}}));
        const Pose T_a_b = mean_frame(fleet, loops);
        out.T_group_robot[next] =
            out.T_group_robot.at(reached[i]) * (merge.a == reached[i] ? T_a_b : T_a_b.inverse());
        reached.push_back(next);
      }
  }
  return out;
}

/// What the pairs between two groups know.
struct Between {
  std::vector<Candidate> candidates;
  double needed = 0.0;
};

/// Pairs of loops, of two pairs of robots, around which a cycle closes.
double num_cycles(const std::vector<const Candidate*>& candidates, const CycleCheck& cycles) {
  double num = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      const Merge& one = candidates[i]->merge;
      const Merge& other = candidates[j]->merge;
      if (std::pair(one.a, one.b) != std::pair(other.a, other.b) && cycles.agree(one, other))
        num += static_cast<double>(one.loops.size() * other.loops.size());
    }
  return num;
}

/// Those that agree with `seed`, the likeliest of each pair.
std::vector<const Candidate*> agreeing_with(const Between& between, const Candidate& seed,
                                            const CycleCheck& cycles) {
  std::map<RobotPair, const Candidate*> of_pair;
  of_pair[{seed.merge.a, seed.merge.b}] = &seed;
  for (const Candidate& other : between.candidates) {
    const RobotPair pair{other.merge.a, other.merge.b};
    if (pair == RobotPair{seed.merge.a, seed.merge.b}) continue;
    const auto known = of_pair.find(pair);
    const bool is_likelier = known == of_pair.end() || (known->second->is_refuted() && !other.is_refuted()) ||
                             (!other.is_refuted() && other.merge.evidence > known->second->merge.evidence);
    if (is_likelier && cycles.agree(seed.merge, other.merge)) of_pair[pair] = &other;
  }
  std::vector<const Candidate*> out;
  for (const auto& [pair, candidate] : of_pair) out.push_back(candidate);
  return out;
}

/// The frame of one group of robots, in which the places of hypotheses about it are told apart.
struct GroupFrame {
  const FleetGraph& fleet;
  const Groups& groups;
  RobotId group;
  double one_place_m;  ///< Comparisons nearer than this are of one place.
};

/// Where the places are that a hypothesis was tested at.
std::vector<Vector3> positions_of(const GroupFrame& frame, const Candidate& candidate) {
  const auto& [fleet, groups, group, one_place_m] = frame;
  const bool by_a = groups.group.at(candidate.merge.a) == group;
  const RobotId robot = by_a ? candidate.merge.a : candidate.merge.b;
  std::vector<Vector3> positions;
  for (const TestedPlace& place : candidate.hypothesis->places)
    positions.push_back(groups.T_group_robot.at(robot) *
                        fleet.robots.at(robot).nodes.at(by_a ? place.a : place.b).T_odom_base.translation());
  return positions;
}

/// Evidence of all their places, each counted once, and of walls.
double evidence_of(const GroupFrame& frame, const std::vector<const Candidate*>& members) {
  std::vector<std::vector<Vector3>> positions;
  for (const Candidate* member : members) positions.push_back(positions_of(frame, *member));
  /// Members that compared this place.
  const auto num_sharing = [&](const Vector3& position) {
    return std::ranges::count_if(positions, [&](const std::vector<Vector3>& of_one) {
      return std::ranges::any_of(
          of_one, [&](const Vector3& other) { return (other - position).norm() < frame.one_place_m; });
    });
  };
  double of_places = 0.0;
  double num_distinctive = 0.0;
  double of_walls = 0.0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::vector<double> evidence =
        evidence_at_places(members[m]->hypothesis->places, members[m]->check->goes_on);
    double positive = 0.0;
    double counted = 0.0;
    for (std::size_t p = 0; p < evidence.size(); ++p) {
      if (evidence[p] <= 0.0) {
        of_places += evidence[p];
        continue;
      }
      positive += evidence[p];
      const auto share = 1.0 / static_cast<double>(num_sharing(positions[m][p]));
      counted += share * evidence[p];
      num_distinctive += share;
    }
    const double walls = members[m]->hypothesis->walls;
    of_places += counted;
    of_walls += walls > 0.0 && positive > 0.0 ? walls * counted / positive : walls;
  }
  return unless_copied(of_places, num_distinctive) + of_walls;
}

/// Messages about its keyframes and loops may still be on their way.
bool is_known(const FleetGraph& fleet, const Candidate& candidate) {
  const auto& [check, hypothesis, merge] = candidate;
  const RobotId a = check->a;
  const RobotId b = check->b;
  return !merge.loops.empty() && merge.loops.size() == hypothesis->loops.size() &&
         std::ranges::all_of(hypothesis->places, [&](const TestedPlace& place) {
           return fleet.knows({a, place.a}) && fleet.knows({b, place.b});
         });
}

std::map<RobotPair, Between> between_groups(const FleetGraph& fleet, const Groups& groups) {
  std::map<RobotPair, Between> out;
  for (const auto& [pair, check] : fleet.checks) {
    if (check.accepted) continue;
    if (!fleet.robots.contains(check.a) || !fleet.robots.contains(check.b)) continue;
    const RobotId x = groups.group.at(check.a);
    const RobotId y = groups.group.at(check.b);
    if (x == y) continue;
    Between& between = out[std::minmax(x, y)];
    between.needed = std::max(between.needed, check.needed);
    for (const MergeHypothesis& hypothesis : check.hypotheses) {
      Candidate candidate{&check, &hypothesis, merge_of(fleet, check, hypothesis)};
      if (is_known(fleet, candidate)) between.candidates.push_back(std::move(candidate));
    }
  }
  return out;
}

/// Whether all that was not refuted would be enough if it agreed: most groups need no going around cycles
/// then.
bool can_be_enough(const GroupFrame& frame, const Between& between) {
  std::set<RobotPair> pairs;
  double most = 0.0;
  for (const Candidate& candidate : between.candidates) {
    if (candidate.is_refuted()) continue;
    pairs.emplace(candidate.merge.a, candidate.merge.b);
    most += std::max(0.0, evidence_of(frame, {&candidate}));
  }
  return pairs.size() > 1 && most >= between.needed;
}

/// One alignment of two groups.
struct Alignment {
  std::vector<const Candidate*> members;
  double evidence;
};

/// All that no member refutes, the likeliest first.
std::vector<Alignment> alignments_of(const GroupFrame& frame, const Between& between,
                                     const CycleCheck& cycles) {
  std::vector<Alignment> alignments;
  for (const Candidate& seed : between.candidates) {
    const auto has_seed = [&](const Alignment& one) { return std::ranges::count(one.members, &seed) > 0; };
    if (seed.is_refuted() || std::ranges::any_of(alignments, has_seed)) continue;
    std::vector<const Candidate*> members = agreeing_with(between, seed, cycles);
    if (std::ranges::any_of(members, &Candidate::is_refuted)) continue;
    const double evidence = evidence_of(frame, members);
    alignments.push_back({std::move(members), evidence});
  }
  std::ranges::stable_sort(alignments, std::greater{}, &Alignment::evidence);
  return alignments;
}

/// The likeliest alignment, where it has enough evidence and no other one has nearly as much.
std::optional<JointMerge> likeliest(const GroupFrame& frame, const Between& between,
                                    const CycleCheck& cycles) {
  if (!can_be_enough(frame, between)) return {};
  const std::vector<Alignment> alignments = alignments_of(frame, between, cycles);
  if (alignments.empty() || alignments[0].members.size() < 2 || alignments[0].evidence < between.needed)
    return {};
  if (alignments.size() > 1 && alignments[1].evidence > alignments[0].evidence - between.needed) return {};
  std::vector<const Candidate*> all;
  for (const Candidate& candidate : between.candidates) all.push_back(&candidate);
  const double share = num_cycles(alignments[0].members, cycles) / num_cycles(all, cycles);
  JointMerge out{{}, alignments[0].evidence + std::log(share), between.needed};
  if (out.evidence < out.needed) return {};
  for (const Candidate* member : alignments[0].members) out.merges.push_back(member->merge);
  return out;
}

}  // namespace

Merge merge_of(const FleetGraph& fleet, const MergeCheck& check, const MergeHypothesis& hypothesis) {
  Merge merge{check.a, check.b, hypothesis.evidence, {}};
  for (const auto& [a, b] : hypothesis.loops) {
    const auto loop = fleet.loops.find({{check.a, a}, {check.b, b}});
    if (loop != fleet.loops.end() && fleet.knows({check.a, a}) && fleet.knows({check.b, b}))
      merge.loops.push_back(pcm_loop_of(loop->second));
  }
  return merge;
}

std::vector<JointMerge> joint_merges(const FleetGraph& fleet, std::vector<Merge> merges, const Chains& chains,
                                     const BackEndConfig& config) {
  std::vector<JointMerge> out;
  while (true) {
    const Groups groups = groups_of(fleet, merges);
    const CycleCheck cycles(merges, chains, config.cycles);
    std::optional<JointMerge> best;
    for (const auto& [pair, between] : between_groups(fleet, groups)) {
      std::optional<JointMerge> one =
          likeliest({fleet, groups, pair.first, config.one_place_m}, between, cycles);
      if (one && (!best || one->evidence > best->evidence)) best = std::move(one);
    }
    if (!best) return out;
    merges.insert(merges.end(), best->merges.begin(), best->merges.end());
    out.push_back(std::move(*best));
  }
}

}  // namespace adit
