// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/merge_cycles.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include "adit/fleet/joint/merge_graph.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {
namespace {

/// Each cycle is gone around once, however often it is asked about.
class CycleTest {
 public:
  CycleTest(const std::vector<Merge>& merges, const Chains& chains, const CycleConfig& config)
      : merges_(merges), chains_(chains), config_(config), scale_(drift_scale(merges, chains, config)) {}

  [[nodiscard]] const Round& around(const Robots& robots, const MergeGraph& graph) {
    const auto known = rounds_.find(robots);
    if (known != rounds_.end()) return known->second;
    std::vector<const Merge*> legs;
    for (const std::size_t m : graph.along(robots)) legs.push_back(&merges_[m]);
    return rounds_.emplace(robots, Cycle(robots, legs, chains_, scale_, config_).best()).first->second;
  }
  [[nodiscard]] std::vector<Robots> contradicting(const MergeGraph& graph) {
    std::vector<Robots> out;
    for (const Robots& robots : graph.cycles())
      if (around(robots, graph).contradicts()) out.push_back(robots);
    return out;
  }

 private:
  const std::vector<Merge>& merges_;
  const Chains& chains_;
  const CycleConfig& config_;
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

/// What the merges that are left claim together about pairs of robots whose scans refute it.
struct Refuting {
  const std::vector<Merge>& merges;
  const std::vector<Merge>& refuted;
  const Chains& chains;
  const CycleConfig& config;
  double scale;

  /// Of each merge the pairs that it and others align as their scans refuted.
  [[nodiscard]] std::map<std::size_t, std::set<RobotPair>> against(const MergeGraph& graph) const {
    std::map<std::size_t, std::set<RobotPair>> against;
    for (const Merge& hypothesis : refuted) {
      const Robots path = graph.shortest_path(hypothesis.a, hypothesis.b);
      if (path.empty()) continue;
      const std::vector<std::size_t> merged = graph.along_path(path);
      std::vector<const Merge*> legs;
      for (const std::size_t m : merged) legs.push_back(&merges[m]);
      legs.push_back(&hypothesis);  // from a, the last of the path, back to b
      // What cannot be computed says nothing: NaN is not counted against a merge.
      if (!(Cycle(path, legs, chains, scale, config).best().log_ratio >= 0.0)) continue;
      for (const std::size_t m : merged) against[m].insert({hypothesis.a, hypothesis.b});
    }
    return against;
  }
};

/// Takes merges back until no cycle contradicts those that are left.
void take_back_contradicted(const std::vector<Merge>& merges, CycleTest& test, MergeGraph& graph,
                            std::vector<Contradiction>& out) {
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
}

/// Takes merges back until scans refute nothing that those that are left claim together.
void take_back_refuted(const Refuting& refuting, MergeGraph& graph, std::vector<Contradiction>& out) {
  while (true) {
    const auto against = refuting.against(graph);
    const auto guilty = std::ranges::max_element(against, {}, [&](const auto& entry) {
      return std::tuple(entry.second.size(), -refuting.merges[entry.first].evidence, entry.first);
    });
    const auto needed = static_cast<std::size_t>(refuting.config.refuted_pairs);
    if (guilty == against.end() || guilty->second.size() < needed) return;
    Contradiction& contradiction = out.emplace_back();
    contradiction.merge = guilty->first;
    contradiction.refuted.assign(guilty->second.begin(), guilty->second.end());
    graph = graph.without(refuting.merges[guilty->first]);
  }
}

}  // namespace

std::vector<Contradiction> contradictions(const std::vector<Merge>& merges, const std::vector<Merge>& refuted,
                                          const Chains& chains, const CycleConfig& config) {
  std::vector<Contradiction> out;
  MergeGraph graph(merges);
  CycleTest test(merges, chains, config);
  take_back_contradicted(merges, test, graph, out);
  take_back_refuted({merges, refuted, chains, config, drift_scale(merges, chains, config)}, graph, out);
  return out;
}

}  // namespace adit
