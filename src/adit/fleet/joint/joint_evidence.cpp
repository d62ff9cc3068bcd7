// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/joint_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "adit/fleet/merge/merge_evidence.hpp"

namespace adit {
namespace {

using RobotPair = std::pair<RobotId, RobotId>;

constexpr double kOneSpot = 4.0;  // metres within which two comparisons are of one place

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

/// Loops of two pairs that lead around a cycle and back to where it began.
double num_cycles(const std::vector<const Candidate*>& candidates, const CycleCheck& cycles) {
  double num = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      const Merge& one = candidates[i]->merge;
      const Merge& other = candidates[j]->merge;
      if (std::pair(one.a, one.b) != std::pair(other.a, other.b) && cycles.say_the_same(one, other))
        num += static_cast<double>(one.loops.size() * other.loops.size());
    }
  return num;
}

/// Which of them say what the `seed` says, the likeliest of each pair.
std::vector<const Candidate*> saying_the_same(const Between& between, const Candidate& seed,
                                              const CycleCheck& cycles) {
  std::map<RobotPair, const Candidate*> of_pair;
  of_pair[{seed.merge.a, seed.merge.b}] = &seed;
  for (const Candidate& other : between.candidates) {
    const RobotPair pair{other.merge.a, other.merge.b};
    if (pair == RobotPair{seed.merge.a, seed.merge.b}) continue;
    const auto known = of_pair.find(pair);
    const bool is_likelier = known == of_pair.end() || (known->second->is_refuted() && !other.is_refuted()) ||
                             (!other.is_refuted() && other.merge.evidence > known->second->merge.evidence);
    if (is_likelier && cycles.say_the_same(seed.merge, other.merge)) of_pair[pair] = &other;
  }
  std::vector<const Candidate*> out;
  for (const auto& [pair, candidate] : of_pair) out.push_back(candidate);
  return out;
}

/// Where the places are that a hypothesis was tested at, in the frame of the group of its robots that is
/// `group`.
std::vector<Vector3> spots_of(const FleetGraph& fleet, const Groups& groups, const Candidate& candidate,
                              RobotId group) {
  const bool by_a = groups.group.at(candidate.merge.a) == group;
  const RobotId robot = by_a ? candidate.merge.a : candidate.merge.b;
  std::vector<Vector3> spots;
  for (const TestedPlace& place : candidate.hypothesis->places)
    spots.push_back(groups.T_group_robot.at(robot) *
                    fleet.robots.at(robot).nodes.at(by_a ? place.a : place.b).T_odom_base.translation());
  return spots;
}

bool is_near(const std::vector<Vector3>& spots, const Vector3& spot) {
  return std::ranges::any_of(spots, [&](const Vector3& s) { return (s - spot).norm() < kOneSpot; });
}

/// Of all their places, each counted once, and of walls.
double evidence_of(const FleetGraph& fleet, const Groups& groups, RobotId group,
                   const std::vector<const Candidate*>& members) {
  std::vector<std::vector<Vector3>> spots;
  for (const Candidate* member : members) spots.push_back(spots_of(fleet, groups, *member, group));
  double sum = 0.0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::vector<double> evidence =
        evidence_at_places(members[m]->hypothesis->places, members[m]->check->goes_on);
    double for_it = 0.0;
    double counted = 0.0;
    for (std::size_t p = 0; p < evidence.size(); ++p) {
      if (evidence[p] <= 0.0) {
        sum += evidence[p];
        continue;
      }
      const auto num = std::ranges::count_if(
          spots, [&](const std::vector<Vector3>& of_one) { return is_near(of_one, spots[m][p]); });
      for_it += evidence[p];
      counted += evidence[p] / static_cast<double>(num);
    }
    const double walls = members[m]->hypothesis->walls;
    sum += counted + (walls > 0.0 && for_it > 0.0 ? walls * counted / for_it : walls);
  }
  return sum;
}

bool has_node(const FleetGraph& fleet, RobotId robot, std::uint32_t index) {
  const auto graph = fleet.robots.find(robot);
  return graph != fleet.robots.end() && index < graph->second.nodes.size();
}

/// Messages about its keyframes and loops may still be on their way.
bool is_known(const FleetGraph& fleet, const Candidate& candidate) {
  const auto& [check, hypothesis, merge] = candidate;
  const RobotId a = check->a;
  const RobotId b = check->b;
  return !merge.loops.empty() && merge.loops.size() == hypothesis->loops.size() &&
         std::ranges::all_of(hypothesis->places, [&](const TestedPlace& place) {
           return has_node(fleet, a, place.a) && has_node(fleet, b, place.b);
         });
}

std::map<RobotPair, Between> between_groups(const FleetGraph& fleet, const Groups& groups,
                                            const BackEndConfig& config) {
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
      Candidate candidate{&check, &hypothesis, merge_of(fleet, check, hypothesis, config)};
      if (is_known(fleet, candidate)) between.candidates.push_back(std::move(candidate));
    }
  }
  return out;
}

/// Whether all that was not refuted would be enough if it agreed: going around cycles takes time in large
/// fleets.
bool can_be_enough(const FleetGraph& fleet, const Groups& groups, RobotId group, const Between& between) {
  std::set<RobotPair> pairs;
  double most = 0.0;
  for (const Candidate& candidate : between.candidates) {
    if (candidate.is_refuted()) continue;
    pairs.emplace(candidate.merge.a, candidate.merge.b);
    most += std::max(0.0, evidence_of(fleet, groups, group, {&candidate}));
  }
  return pairs.size() > 1 && most >= between.needed;
}

/// The likeliest way to lay two groups over one another, where it is likely enough and no other one is.
std::optional<JointMerge> likeliest(const FleetGraph& fleet, const Groups& groups, RobotId group,
                                    const Between& between, const CycleCheck& cycles) {
  if (!can_be_enough(fleet, groups, group, between)) return {};
  struct Way {
    std::vector<const Candidate*> members;
    double evidence;
  };
  std::vector<Way> ways;
  for (const Candidate& seed : between.candidates) {
    const auto has_seed = [&](const Way& way) { return std::ranges::count(way.members, &seed) > 0; };
    if (seed.is_refuted() || std::ranges::any_of(ways, has_seed)) continue;
    std::vector<const Candidate*> members = saying_the_same(between, seed, cycles);
    if (std::ranges::any_of(members, &Candidate::is_refuted)) continue;
    const double evidence = evidence_of(fleet, groups, group, members);
    ways.push_back({std::move(members), evidence});
  }
  std::ranges::stable_sort(ways, std::greater{}, &Way::evidence);
  if (ways.empty() || ways[0].members.size() < 2 || ways[0].evidence < between.needed) return {};
  if (ways.size() > 1 && ways[1].evidence > ways[0].evidence - between.needed) return {};
  std::vector<const Candidate*> all;
  for (const Candidate& candidate : between.candidates) all.push_back(&candidate);
  const double share = num_cycles(ways[0].members, cycles) / num_cycles(all, cycles);
  JointMerge out{{}, ways[0].evidence + std::log(share), between.needed};
  if (out.evidence < out.needed) return {};
  for (const Candidate* member : ways[0].members) out.merges.push_back(member->merge);
  return out;
}

}  // namespace

Merge merge_of(const FleetGraph& fleet, const MergeCheck& check, const MergeHypothesis& hypothesis,
               const BackEndConfig& config) {
  Merge merge{check.a, check.b, hypothesis.evidence, {}};
  for (const auto& [a, b] : hypothesis.loops) {
    const auto loop = fleet.loops.find({{check.a, a}, {check.b, b}});
    if (loop != fleet.loops.end() && has_node(fleet, check.a, a) && has_node(fleet, check.b, b))
      merge.loops.push_back(pcm_loop_of(loop->second, config));
  }
  return merge;
}

std::vector<JointMerge> joint_merges(const FleetGraph& fleet, std::vector<Merge> merges,
                                     const std::map<RobotId, OdometryChain>& chains,
                                     const BackEndConfig& config) {
  std::vector<JointMerge> out;
  while (true) {
    const Groups groups = groups_of(fleet, merges);
    const CycleCheck cycles(merges, chains);
    std::optional<JointMerge> best;
    for (const auto& [pair, between] : between_groups(fleet, groups, config)) {
      std::optional<JointMerge> one = likeliest(fleet, groups, pair.first, between, cycles);
      if (one && (!best || one->evidence > best->evidence)) best = std::move(one);
    }
    if (!best) return out;
    merges.insert(merges.end(), best->merges.begin(), best->merges.end());
    out.push_back(std::move(*best));
  }
}

}  // namespace adit
