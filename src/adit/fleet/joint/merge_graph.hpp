// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "adit/fleet/joint/cycle.hpp"

namespace adit {

/// The merges that have not been taken back, as a graph.
class MergeGraph {
 public:
  /// Merges are known by their indices; at most one between two robots.
  explicit MergeGraph(const std::vector<Merge>& merges) {
    for (std::size_t m = 0; m < merges.size(); ++m) add(merges[m].a, merges[m].b, m);
  }
  /// A copy without the merge between these two robots; both have to be in the graph.
  ///@{
  [[nodiscard]] MergeGraph without(const Merge& merge) const { return without(merge.a, merge.b); }
  [[nodiscard]] MergeGraph without(RobotId a, RobotId b) const {
    MergeGraph rest = *this;
    rest.merge_.at(a).erase(b);
    rest.merge_.at(b).erase(a);
    return rest;
  }
  ///@}
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
  /// From a to b, the fewest robots, b first; empty where there is none.
  [[nodiscard]] Robots shortest_path(RobotId a, RobotId b) const {
    if (a == b) return {a};
    if (!merge_.contains(a) || !merge_.contains(b)) return {};
    std::map<RobotId, RobotId> towards_a{{a, a}};
    Robots reached{a};
    for (std::size_t i = 0; i < reached.size() && !towards_a.contains(b); ++i)  // grows meanwhile
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

}  // namespace adit
