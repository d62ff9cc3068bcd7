// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/merge_cycles.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include "adit/fleet/merge/discernment.hpp"

namespace adit {
namespace {

using Robots = std::vector<RobotId>;

// Of Student's t: the configured noise of odometry is believed like that many measurements of it. A wheel
// that slips once, by ten sigmas, is then still drift.
constexpr double kFreedom = 24.0;
// Of ways around that drive little more than the shortest, the one that closes best is taken.
constexpr double kDetour = 1.5;
constexpr double kNear = 10.0;  // metres

Matrix6 carried(const Matrix6& adjoint, const Matrix6& covariance) {
  return adjoint * covariance * adjoint.transpose();
}

/// Going around a cycle once.
struct Round {
  double miss_m = 0.0;
  double driven_m = 0.0;
  double log_ratio = 0.0;  ///< Of the likelihood of drift to that of a wrong merge.
  [[nodiscard]] bool contradicts() const { return log_ratio < 0.0; }
};

/// A loop as it is passed on the way around.
struct Passage {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to;
  Matrix6 covariance;
};

std::vector<Passage> passages(const Merge& merge, RobotId from) {
  std::vector<Passage> out;
  for (const PcmLoop& loop : merge.loops) {
    const Matrix6 covariance = loop.information.inverse();
    if (merge.a == from)
      out.push_back({loop.a, loop.b, loop.T_a_b, covariance});
    else
      out.push_back({loop.b, loop.a, loop.T_a_b.inverse(), carried(loop.T_a_b.adjoint(), covariance)});
  }
  return out;
}

/// The variance of the drift over the configured one, by what the first and the last loop of each merge leave
/// between them.
double drift_scale(const std::vector<Merge>& merges, const std::map<RobotId, OdometryChain>& chains) {
  double sum = kFreedom;
  double num = kFreedom;
  for (const Merge& merge : merges) {
    if (merge.loops.size() < 2) continue;
    const auto [first, last] = std::ranges::minmax_element(merge.loops, {}, &PcmLoop::a);
    sum += consistency_distance2(chains.at(merge.a), chains.at(merge.b), *first, *last);
    num += 6.0;
  }
  return sum / num;
}

/// Robots, and the merges that lead from each to the next and from the last to the first.
class Cycle {
 public:
  Cycle(const Robots& robots, const std::vector<const Merge*>& merges,
        const std::map<RobotId, OdometryChain>& chains, double scale)
      : scale_(scale) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      legs_.push_back(passages(*merges[i], robots[i]));
      arrives_.push_back(&chains.at(robots[(i + 1) % robots.size()]));
      ways_.push_back(way_along(*arrives_.back()));
    }
  }

  [[nodiscard]] Round best() const {
    std::vector<Closed> all;
    for (std::size_t leg = 0; leg < legs_.size(); ++leg)
      for (std::size_t p = 0; p < legs_[leg].size(); ++p) all.push_back(shortest_through(leg, p));
    const double shortest = std::ranges::min_element(all, {}, &Closed::driven_m)->driven_m;
    std::optional<Round> best;
    for (const Closed& way : all) {
      if (way.driven_m > kDetour * shortest + kNear) continue;
      const Round one = miss(way);
      if (!best || one.log_ratio > best->log_ratio) best = one;
    }
    return *best;
  }

 private:
  /// A passage of each leg.
  struct Closed {
    std::vector<std::size_t> passages;
    double driven_m = 0.0;
  };

  /// Between arriving by passage p of a leg and leaving by passage q of the next.
  [[nodiscard]] double driven(std::size_t leg, std::size_t p, std::size_t q) const {
    const std::size_t next = (leg + 1) % legs_.size();
    return std::abs(ways_[leg][legs_[leg][p].to] - ways_[leg][legs_[next][q].from]);
  }

  /// Dynamic programming over the legs, from passage p of `first` back to it.
  [[nodiscard]] Closed shortest_through(std::size_t first, std::size_t p) const {
    const std::size_t n = legs_.size();
    std::vector<std::vector<double>> cost(n);
    std::vector<std::vector<std::size_t>> came_from(n);
    cost[first].assign(legs_[first].size(), std::numeric_limits<double>::infinity());
    cost[first][p] = 0.0;
    for (std::size_t i = 1; i < n; ++i) {
      const std::size_t before = (first + i - 1) % n;
      const std::size_t leg = (first + i) % n;
      for (std::size_t q = 0; q < legs_[leg].size(); ++q) {
        double best = std::numeric_limits<double>::infinity();
        std::size_t best_from = 0;
        for (std::size_t r = 0; r < cost[before].size(); ++r) {
          const double through = cost[before][r] + driven(before, r, q);
          if (through < best) std::tie(best, best_from) = std::pair(through, r);
        }
        cost[leg].push_back(best);
        came_from[leg].push_back(best_from);
      }
    }
    const std::size_t last = (first + n - 1) % n;
    Closed closed{std::vector<std::size_t>(n, p), std::numeric_limits<double>::infinity()};
    for (std::size_t q = 0; q < cost[last].size(); ++q) {
      const double through = cost[last][q] + driven(last, q, p);
      if (through < closed.driven_m) std::tie(closed.driven_m, closed.passages[last]) = std::pair(through, q);
    }
    for (std::size_t i = n - 1; i > 1; --i) {
      const std::size_t leg = (first + i) % n;
      closed.passages[(first + i - 1) % n] = came_from[leg][closed.passages[leg]];
    }
    return closed;
  }

  [[nodiscard]] Round miss(const Closed& way) const {
    Pose T;
    Matrix6 S = Matrix6::Zero();
    const auto go = [&](const Pose& step, const Matrix6& covariance) {
      S = carried(step.inverse().adjoint(), S) + covariance;
      T = T * step;
    };
    for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
      const std::size_t next = (leg + 1) % legs_.size();
      const Passage& passage = legs_[leg][way.passages[leg]];
      const std::size_t leaves = legs_[next][way.passages[next]].from;
      go(passage.T_from_to, passage.covariance);
      go(arrives_[leg]->between(passage.to, leaves), arrives_[leg]->covariance(passage.to, leaves));
    }
    return {T.translation().norm(), way.driven_m, log_drift(T.log(), scale_ * S) - log_elsewhere()};
  }

  /// Student's t.
  static double log_drift(const Vector6& x, const Matrix6& S) {
    const Eigen::LDLT<Matrix6> ldlt(S);
    const double half = 0.5 * (kFreedom + 6.0);
    return std::lgamma(half) - std::lgamma(0.5 * kFreedom) - 3.0 * std::log(kFreedom * std::numbers::pi) -
           0.5 * ldlt.vectorD().array().log().sum() - half * std::log1p(x.dot(ldlt.solve(x)) / kFreedom);
  }

  /// Any place in a cube as wide as the longest drive, at any attitude.
  [[nodiscard]] double log_elsewhere() const {
    double longest = 1.0;
    for (const std::vector<double>& way : ways_) longest = std::max(longest, way.back());
    return -3.0 * std::log(longest) - std::log(8.0 * std::numbers::pi * std::numbers::pi);
  }

  double scale_;                               ///< Of the covariances.
  std::vector<std::vector<Passage>> legs_;     ///< From robot i to robot i + 1.
  std::vector<const OdometryChain*> arrives_;  ///< Of robot i + 1.
  std::vector<std::vector<double>> ways_;      ///< The same, metres driven.
};

/// The merges that have not been taken back, as a graph.
class MergeGraph {
 public:
  explicit MergeGraph(const std::vector<Merge>& merges) {
    for (std::size_t m = 0; m < merges.size(); ++m) add(merges[m].a, merges[m].b, m);
  }
  [[nodiscard]] MergeGraph without(const Merge& merge) const { return without(merge.a, merge.b); }
  [[nodiscard]] MergeGraph without(RobotId a, RobotId b) const {
    MergeGraph rest = *this;
    rest.merge_.at(a).erase(b);
    rest.merge_.at(b).erase(a);
    return rest;
  }
  /// From each robot to the next, and from the last to the first.
  [[nodiscard]] std::vector<std::size_t> along(const Robots& cycle) const {
    std::vector<std::size_t> out = along_path(cycle);
    out.push_back(merge_.at(cycle.back()).at(cycle.front()));
    return out;
  }
  /// From each robot to the next.
  [[nodiscard]] std::vector<std::size_t> along_path(const Robots& path) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) out.push_back(merge_.at(path[i]).at(path[i + 1]));
    return out;
  }
  /// From a to b, the fewest robots, b first; empty where there is no way.
  [[nodiscard]] Robots shortest_path(RobotId a, RobotId b) const {
    if (a == b) return {a};
    if (!merge_.contains(a) || !merge_.contains(b)) return {};
    std::map<RobotId, RobotId> towards_a{{a, a}};
    Robots reached{a};
    for (std::size_t i = 0; i < reached.size() && !towards_a.contains(b); ++i)  // grows on the way
      for (const auto& [next, merge] : merge_.at(reached[i]))
        if (towards_a.emplace(next, reached[i]).second) reached.push_back(next);
    if (!towards_a.contains(b)) return {};
    Robots path{b};
    while (path.back() != a) path.push_back(towards_a.at(path.back()));
    return path;
  }

  /// All triangles, and of a merge in none the shortest cycle; each once, from its smallest robot on, the
  /// smaller neighbour first.
  [[nodiscard]] std::set<Robots> cycles() const {
    std::set<Robots> out;
    for (const auto& [a, of_a] : merge_)
      for (const auto& [b, merge] : of_a) {
        if (b < a) continue;
        bool in_triangle = false;
        for (const auto& [c, other] : of_a) {
          if (!merge_.at(b).contains(c)) continue;
          in_triangle = true;
          out.insert(in_order({a, b, c}));
        }
        if (in_triangle) continue;
        if (const Robots around = without(a, b).shortest_path(a, b); !around.empty())
          out.insert(in_order(around));
      }
    return out;
  }

 private:
  void add(RobotId a, RobotId b, std::size_t merge) {
    merge_[a][b] = merge;
    merge_[b][a] = merge;
  }
  static Robots in_order(Robots cycle) {
    std::rotate(cycle.begin(), std::ranges::min_element(cycle), cycle.end());
    if (cycle.back() < cycle[1]) std::reverse(cycle.begin() + 1, cycle.end());
    return cycle;
  }
  std::map<RobotId, std::map<RobotId, std::size_t>> merge_;
};

/// Each cycle is gone around once, however often it is asked about.
class CycleTest {
 public:
  CycleTest(const std::vector<Merge>& merges, const std::map<RobotId, OdometryChain>& chains)
      : merges_(merges), chains_(chains), scale_(drift_scale(merges, chains)) {}

  [[nodiscard]] const Round& around(const Robots& robots, const MergeGraph& graph) {
    const auto known = rounds_.find(robots);
    if (known != rounds_.end()) return known->second;
    std::vector<const Merge*> legs;
    for (const std::size_t m : graph.along(robots)) legs.push_back(&merges_[m]);
    return rounds_.emplace(robots, Cycle(robots, legs, chains_, scale_).best()).first->second;
  }
  [[nodiscard]] std::vector<Robots> contradicting(const MergeGraph& graph) {
    std::vector<Robots> out;
    for (const Robots& robots : graph.cycles())
      if (around(robots, graph).contradicts()) out.push_back(robots);
    return out;
  }

 private:
  const std::vector<Merge>& merges_;
  const std::map<RobotId, OdometryChain>& chains_;
  double scale_;
  std::map<Robots, Round> rounds_;
};

/// The merge that explains them best.
std::size_t guilty_of(const std::vector<Robots>& cycles, const MergeGraph& graph,
                      const std::vector<Merge>& merges, CycleTest& test) {
  std::set<std::size_t> suspects;
  for (const Robots& robots : cycles)
    for (const std::size_t m : graph.along(robots)) suspects.insert(m);
  const auto explains = [&](std::size_t m) {
    return std::tuple(test.contradicting(graph.without(merges[m])).size(), merges[m].evidence, m);
  };
  return *std::ranges::min_element(suspects, {}, explains);
}

using RobotPair = std::pair<RobotId, RobotId>;

/// Of each merge the pairs that it puts, together with others, where their scans refuted that they are.
std::map<std::size_t, std::set<RobotPair>> refuting(const std::vector<Merge>& merges,
                                                    const std::vector<Merge>& refuted,
                                                    const MergeGraph& graph,
                                                    const std::map<RobotId, OdometryChain>& chains,
                                                    double scale) {
  std::map<std::size_t, std::set<RobotPair>> against;
  for (const Merge& hypothesis : refuted) {
    const Robots path = graph.shortest_path(hypothesis.a, hypothesis.b);
    if (path.empty()) continue;
    const std::vector<std::size_t> merged = graph.along_path(path);
    std::vector<const Merge*> legs;
    for (const std::size_t m : merged) legs.push_back(&merges[m]);
    legs.push_back(&hypothesis);  // from a, the last of the path, back to b
    if (Cycle(path, legs, chains, scale).best().contradicts()) continue;
    for (const std::size_t m : merged) against[m].insert({hypothesis.a, hypothesis.b});
  }
  return against;
}

}  // namespace

std::vector<Contradiction> contradictions(const std::vector<Merge>& merges, const std::vector<Merge>& refuted,
                                          const std::map<RobotId, OdometryChain>& chains) {
  constexpr std::size_t kNeeded = 2;
  std::vector<Contradiction> out;
  MergeGraph graph(merges);
  CycleTest test(merges, chains);
  for (std::vector<Robots> cycles = test.contradicting(graph); !cycles.empty();
       cycles = test.contradicting(graph)) {
    const std::size_t guilty = guilty_of(cycles, graph, merges, test);
    std::erase_if(cycles,
                  [&](const Robots& robots) { return std::ranges::count(graph.along(robots), guilty) == 0; });
    const Robots& clearest = *std::ranges::min_element(
        cycles, {}, [&](const Robots& robots) { return test.around(robots, graph).log_ratio; });
    const Round& round = test.around(clearest, graph);
    out.push_back({guilty, graph.along(clearest), {}, round.miss_m, round.driven_m});
    std::erase(out.back().others, guilty);
    graph = graph.without(merges[guilty]);
  }
  while (true) {
    const auto against = refuting(merges, refuted, graph, chains, drift_scale(merges, chains));
    const auto guilty = std::ranges::max_element(against, {}, [&](const auto& entry) {
      return std::tuple(entry.second.size(), -merges[entry.first].evidence, entry.first);
    });
    if (guilty == against.end() || guilty->second.size() < kNeeded) return out;
    Contradiction& contradiction = out.emplace_back();
    contradiction.merge = guilty->first;
    contradiction.refuted.assign(guilty->second.begin(), guilty->second.end());
    graph = graph.without(merges[guilty->first]);
  }
}

struct CycleCheck::Known {
  const std::vector<Merge>& merges;
  const std::map<RobotId, OdometryChain>& chains;
  MergeGraph graph;
  double scale;
};

CycleCheck::CycleCheck(const std::vector<Merge>& merges, const std::map<RobotId, OdometryChain>& chains)
    : known_(new Known{merges, chains, MergeGraph(merges), drift_scale(merges, chains)}) {}
CycleCheck::~CycleCheck() = default;

bool CycleCheck::say_the_same(const Merge& one, const Merge& other) const {
  constexpr double kSamePlace = 3.0;  // metres
  const std::vector<Merge>& merges = known_->merges;
  const MergeGraph& graph = known_->graph;
  const auto way = [&](RobotId from, RobotId to) {
    Robots path = graph.shortest_path(from, to);
    std::ranges::reverse(path);
    return path;
  };
  // From a robot of one group over `one` into the other group, and back over `other`.
  Robots there = way(one.b, other.b);
  Robots back = way(other.a, one.a);
  if (there.empty() || back.empty()) {
    there = way(one.b, other.a);
    back = way(other.b, one.a);
  }
  if (there.empty() || back.empty()) return false;
  Robots around{one.a};
  std::vector<const Merge*> legs{&one};
  const auto go_along = [&](const Robots& path) {
    around.insert(around.end(), path.begin(), path.end());
    for (const std::size_t m : graph.along_path(path)) legs.push_back(&merges[m]);
  };
  go_along(there);
  legs.push_back(&other);
  go_along(back);
  around.pop_back();  // where it began
  const Round round = Cycle(around, legs, known_->chains, known_->scale).best();
  return !round.contradicts() && round.miss_m <= kSamePlace;
}

}  // namespace adit
