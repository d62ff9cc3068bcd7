// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The trials with which `optimize_gnc` ends: groups of loops are taken out of a solution, or put into it, to
/// see whether the rest of the graph speaks for them. For gnc.cpp only.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/gnc_search.hpp"
#include "adit/posegraph/marginals.hpp"

namespace adit {

inline constexpr std::size_t kSmallestTried = 2;  ///< Loops; a single one is judged by its own chi2.
inline constexpr std::size_t kLargestTried = 64;  ///< Loops; larger clusters are tried piece by piece.
/// Of a graph of that many nodes one trial may be made, of smaller ones more: what trials may cost.
///@{
inline constexpr std::size_t kTrialNodes = 100'000;
inline constexpr std::size_t kTrialNodesOfParts = 20'000;
///@}
inline constexpr std::size_t kMaxTrials = 100;  ///< Of one pass at most, however small the graph.
inline constexpr std::size_t kMistake = 5;      ///< Loops of a rejected cluster that is hardly chance.
inline constexpr double kMisfitHeadroom = 3.0;  ///< So many times the variance of the solution still passes.
/// Pieces that are strained by more than so many times the median of all groups are tried.
inline constexpr double kStrained = 1.5;
inline constexpr double kOpenShare = 1e-9;  ///< Of the largest information: what an open direction is given.
inline constexpr double kTrueShare = 0.99;  ///< Of the groups that stay so many are to be true, at least.
inline constexpr double kLikeSize = 2.0 / 3.0;  ///< Of a group's loops: clusters with so many are as strong.

/// Which groups are tried: all clusters, or the pieces of those too large to be tried as a whole. Where there
/// are only a few groups all are.
enum class Tried { all, parts_of_large };

/// A group: a cluster of loops, or a piece of a large one (loop_clusters.hpp). All of its loops may be one
/// mistake, so it is judged as one measurement, however many loops it has: by what chi2 the rest of the graph
/// saves without it, beyond what its own loops cost one another, and by how sharply the rest predicts it.
template <class P>
class LoopTrials {
 public:
  using Group = std::vector<std::size_t>;  ///< Edges.

  /// All but `tried` must outlive this.
  LoopTrials(const BasicPoseGraph<P>& graph, const GncSearch<P>& search, const LoopEvidence<P>& evidence,
             Tried tried)
      : graph_(graph), search_(search), evidence_(evidence) {
    const std::size_t nodes = tried == Tried::all ? kTrialNodes : kTrialNodesOfParts;
    budget_ = std::clamp<std::size_t>(nodes / std::max<std::size_t>(1, graph.nodes.size()), 1, kMaxTrials);
    const LoopClusters& clusters = evidence.clusters();
    const auto whole = groups_by(clusters.of_edge, clusters.sizes, kSmallestTried, kLargestTried);
    const auto large = groups_by(clusters.of_edge, clusters.sizes, kLargestTried + 1, graph.edges.size());
    std::vector<std::size_t> piece(graph.edges.size(), LoopClusters::kNone);
    for (const Group& group : large)
      for (const std::size_t e : group) piece[e] = clusters.piece_of_edge[e];
    groups_ = groups_by(piece, clusters.piece_sizes, kSmallestTried, graph.edges.size());
    num_pieces_ = groups_.size();
    are_few_ = groups_.size() + whole.size() <= budget_;
    if (tried == Tried::all || are_few_) groups_.insert(groups_.end(), whole.begin(), whole.end());
  }

  /// Whether `s` rejects a whole cluster that is hardly chance; any cluster of two loops and more counts
  /// where there are only a few groups.
  [[nodiscard]] bool rejects_mistakes(const Solution<P>& s) const {
    return !clusters_like(s, static_cast<double>(are_few_ ? kSmallestTried : kMistake), Fate::rejected)
                .empty();
  }

  /// Takes out, one after another, the group that the rest contradicts most. What a group contradicts changes
  /// little when others go, so that only the worst so far is measured again.
  [[nodiscard]] Solution<P> without_misfits(Solution<P> s) {
    std::vector<std::pair<double, std::size_t>> worst;  // misfit and group; a heap
    std::vector<std::size_t> list = most_strained(s);
    std::vector<bool> is_listed(groups_.size(), false);
    for (const std::size_t g : list) is_listed[g] = true;
    for (std::size_t n = 0; n < std::min(list.size(), budget_); ++n) {
      const double misfit = tried(s, groups_[list[n]]).misfit;
      if (misfit <= misfit_bound(s)) continue;
      worst.emplace_back(misfit, list[n]);
      // What a true group misfits is a false one beside it, which may show less strain.
      std::size_t next = n + 1;
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (is_listed[g] || num_kept(s, groups_[g]) == 0 || !are_near(groups_[list[n]], groups_[g])) continue;
        is_listed[g] = true;
        list.insert(list.begin() + static_cast<std::ptrdiff_t>(next++), g);
      }
    }
    std::ranges::make_heap(worst);
    for (std::size_t n = 0; n < budget_ && !worst.empty(); ++n) {
      std::ranges::pop_heap(worst);
      const std::size_t g = worst.back().second;
      worst.pop_back();
      Trial trial = tried(s, groups_[g]);
      if (trial.misfit <= misfit_bound(s)) continue;
      if (!worst.empty() && trial.misfit < worst.front().first) {
        worst.emplace_back(trial.misfit, g);
        std::ranges::push_heap(worst);
        continue;
      }
      if (log_odds(s, groups_[g], trial) < 0.0) s = search_.settle(std::move(trial.without));
    }
    return s;
  }

  /// Leaves out the groups that the graph cannot tell from false ones, of which it has rejected some of their
  /// size: what the rest predicts is too uncertain to make their agreement with it more than chance.
  [[nodiscard]] Solution<P> without_undecided(Solution<P> s) {
    std::vector<double> weights = s.edge_weights;
    std::size_t num_groups = 0;
    std::size_t tries = 0;
    std::vector<std::size_t> order = most_strained(s);
    std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t g) { return groups_[g].size(); });
    for (const std::size_t g : order) {
      if (tries >= budget_) break;
      if (num_kept(s, groups_[g]) == 0) continue;
      if (clusters_like(s, kLikeSize * static_cast<double>(groups_[g].size()), Fate::rejected).empty())
        continue;
      ++tries;
      if (log_odds(s, groups_[g], tried(s, groups_[g])) >= 0.0) continue;
      for (const std::size_t e : groups_[g]) {
        if (weights[e] > 0.5) s.refused.push_back(e);
        weights[e] = 0.0;
      }
      ++num_groups;
    }
    if (num_groups == 0) return s;
    std::ranges::sort(s.refused);
    Solution<P> out = search_.settle(search_.with_weights(s, weights), s.refused);
    out.refused = std::move(s.refused);
    out.notes.push_back(format(
        "{} loops in {} refused: each group fits, but nothing else confirms it, and groups of its size were "
        "false elsewhere; drive there again",
        out.refused.size(), num_groups == 1 ? "one group" : format("{} groups", num_groups)));
    return out;
  }

 private:
  [[nodiscard]] static std::vector<Group> groups_by(const std::vector<std::size_t>& of_edge,
                                                    const std::vector<std::size_t>& sizes,
                                                    std::size_t smallest, std::size_t largest) {
    std::vector<Group> all(sizes.size());
    for (std::size_t e = 0; e < of_edge.size(); ++e)
      if (of_edge[e] != LoopClusters::kNone) all[of_edge[e]].push_back(e);
    std::erase_if(all, [&](const Group& g) { return g.size() < smallest || g.size() > largest; });
    return all;
  }

  [[nodiscard]] static std::size_t num_kept(const Solution<P>& s, const Group& group) {
    return static_cast<std::size_t>(
        std::ranges::count_if(group, [&](std::size_t e) { return s.edge_weights[e] > 0.5; }));
  }

  // Whether a loop of one has both ends near those of a loop of the other.
  [[nodiscard]] bool are_near(const Group& a, const Group& b) const {
    const auto near = [](std::size_t i, std::size_t j) {
      return std::max(i, j) - std::min(i, j) <= kGroupReach;
    };
    return std::ranges::any_of(a, [&](std::size_t e) {
      return std::ranges::any_of(b, [&](std::size_t f) {
        const auto& x = graph_.edges[e];
        const auto& y = graph_.edges[f];
        return (near(x.from, y.from) && near(x.to, y.to)) || (near(x.from, y.to) && near(x.to, y.from));
      });
    });
  }

  [[nodiscard]] static std::vector<double> weights_without(const Solution<P>& s, const Group& group) {
    std::vector<double> weights = s.edge_weights;
    for (const std::size_t e : group) weights[e] = 0.0;
    return weights;
  }

  [[nodiscard]] double misfit_bound(const Solution<P>& s) const {
    const double variance = std::min(1.0, variance_of(graph_, s, edge_costs(graph_, s.poses)));
    return kMisfitHeadroom * variance * search_.given_bound();
  }

  struct Trial {
    Solution<P> without;
    double misfit = 0.0;  // how far chi2 falls without the group, apart from what its loops cost one another
  };
  [[nodiscard]] Trial tried(const Solution<P>& s, const Group& group) const {
    Trial trial{search_.with_weights(s, weights_without(s, group)), 0.0};
    if (!trial.without.ok()) return trial;
    trial.misfit = s.cost_final - trial.without.cost_final;
    if (trial.misfit <= misfit_bound(s)) return trial;
    std::vector<double> alone = s.edge_weights;
    for (std::size_t e = 0; e < alone.size(); ++e)
      if (graph_.edges[e].kind == EdgeKind::loop) alone[e] = 0.0;
    for (const std::size_t e : group) alone[e] = s.edge_weights[e];
    const Solution<P> own = search_.with_weights(s, alone);
    if (own.ok()) trial.misfit -= own.cost_final;
    return trial;
  }

  enum class Fate { kept, rejected };
  // Clusters of at least `size` loops of which most are kept, or none; by number.
  [[nodiscard]] std::vector<std::size_t> clusters_like(const Solution<P>& s, double size, Fate fate) const {
    const LoopClusters& clusters = evidence_.clusters();
    std::vector<std::size_t> kept(clusters.sizes.size(), 0);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (clusters.of_edge[e] != LoopClusters::kNone && s.edge_weights[e] > 0.5) ++kept[clusters.of_edge[e]];
    std::vector<std::size_t> like;
    for (std::size_t c = 0; c < kept.size(); ++c) {
      const bool shares_it = fate == Fate::kept ? 2 * kept[c] > clusters.sizes[c] : kept[c] == 0;
      if (shares_it && static_cast<double>(clusters.sizes[c]) >= size) like.push_back(c);
    }
    return like;
  }

  // Whether a rejected cluster of this size joins the same two parts of the graph as this loop.
  [[nodiscard]] bool rejects_between(const Solution<P>& s, double size, const Components& parts,
                                     const typename BasicPoseGraph<P>::Edge& loop) const {
    const auto ends = [&](const auto& edge) {
      return std::minmax({parts.of_node[edge.from], parts.of_node[edge.to]});
    };
    const std::vector<std::size_t> like = clusters_like(s, size, Fate::rejected);
    for (std::size_t e = 0; e < graph_.edges.size(); ++e)
      if (std::ranges::binary_search(like, evidence_.clusters().of_edge[e]) &&
          ends(graph_.edges[e]) == ends(loop))
        return true;
    return false;
  }

  // How much more likely the group is true than false, over what is asked for; logarithmic. If true, its
  // transform is what the rest predicts, with the covariance of both; if false, it may join any two poses of
  // the map. Before that is known, it is false as often as the clusters of its size. A group that alone joins
  // two parts of the graph is predicted by nothing: it stays unless another of its size joins them otherwise.
  [[nodiscard]] double log_odds(const Solution<P>& s, const Group& group, const Trial& trial) const {
    using Matrix = typename P::Jacobian;
    const double size = kLikeSize * static_cast<double>(group.size());
    const double prior = static_cast<double>(clusters_like(s, size, Fate::rejected).size() + 1) /
                         static_cast<double>(clusters_like(s, size, Fate::kept).size() + 1);
    const double asked = std::log(kTrueShare / (1.0 - kTrueShare) * prior);
    if (!trial.without.ok()) return 0.0;
    const auto& middle = graph_.edges[group[group.size() / 2]];
    const Components parts = connected_components(graph_, trial.without.edge_weights);
    if (parts.of_node[middle.from] != parts.of_node[middle.to])
      return rejects_between(s, size, parts, middle) ? -asked : 0.0;
    const Result<Marginals<P>> marginals =
        Marginals<P>::compute(moved(graph_, trial.without.poses), trial.without.edge_weights);
    if (!marginals) return 0.0;
    const double variance = variance_of(graph_, s, edge_costs(graph_, s.poses));
    const Matrix open =
        middle.information + kOpenShare * middle.information.diagonal().maxCoeff() * Matrix::Identity();
    const Matrix predicted =
        variance * (marginals->relative(middle.from, middle.to) + open.llt().solve(Matrix::Identity()));
    const Matrix anywhere = predicted + 2.0 * spread_of(s.poses);
    const double narrower = log_determinant(anywhere) - log_determinant(predicted);
    return 0.5 * (narrower - std::max(0.0, trial.misfit) / (kMisfitHeadroom * variance)) - asked;
  }

  template <class Matrix>
  [[nodiscard]] static double log_determinant(const Matrix& covariance) {
    return 2.0 * covariance.llt().matrixLLT().diagonal().array().log().sum();
  }

  // Covariance of the map's poses about the middle one.
  [[nodiscard]] static typename P::Jacobian spread_of(const std::vector<P>& poses) {
    typename P::Jacobian sum = P::Jacobian::Zero();
    typename P::Tangent mean = P::Tangent::Zero();
    for (const P& pose : poses) {
      const typename P::Tangent v = between_residual(poses[poses.size() / 2], pose, P());
      sum += v * v.transpose();
      mean += v;
    }
    const auto n = static_cast<double>(poses.size());
    return sum / n - mean * mean.transpose() / (n * n);
  }

  // Groups in use for the most part, the most strained first: chi2 of its loops and of the odometry at their
  // ends, where what a group bends shows.
  [[nodiscard]] std::vector<std::size_t> most_strained(const Solution<P>& s) const {
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    std::vector<double> at_node(graph_.nodes.size(), 0.0);
    for (std::size_t e = 0; e < costs.size(); ++e) {
      if (graph_.edges[e].kind != EdgeKind::odometry) continue;
      for (const std::size_t node : {graph_.edges[e].from, graph_.edges[e].to})
        at_node[node] = std::max(at_node[node], costs[e]);
    }
    std::vector<std::pair<double, std::size_t>> strained;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (2 * num_kept(s, groups_[g]) < groups_[g].size()) continue;
      double sum = 0.0;
      for (const std::size_t e : groups_[g])
        sum += costs[e] + at_node[graph_.edges[e].from] + at_node[graph_.edges[e].to];
      strained.emplace_back(-sum / static_cast<double>(groups_[g].size()), g);
    }
    std::ranges::sort(strained);
    std::vector<std::size_t> order;
    if (strained.empty()) return order;
    const double median = strained[strained.size() / 2].first;
    for (const auto& [strain, g] : strained)
      if (g >= num_pieces_ || strain < kStrained * median) order.push_back(g);
    return order;
  }

  const BasicPoseGraph<P>& graph_;
  const GncSearch<P>& search_;
  const LoopEvidence<P>& evidence_;
  std::vector<Group> groups_;
  std::size_t num_pieces_ = 0;  // of `groups_`: they come first
  std::size_t budget_ = 0;
  bool are_few_ = false;  // groups: all of them can be tried
};

/// Where the search had to choose between explanations, every group is tried. Where the clusters settled it,
/// only parts of large ones are: a mistake may have come in with them by chance.
template <class P>
[[nodiscard]] Solution<P> try_loops(const BasicPoseGraph<P>& graph, const GncSearch<P>& search,
                                    const LoopEvidence<P>& evidence, Tried tried, Solution<P> best) {
  LoopTrials<P> trials(graph, search, evidence, tried);
  if (tried == Tried::parts_of_large && !trials.rejects_mistakes(best)) return best;
  best = trials.without_misfits(std::move(best));
  return best.ok() && tried == Tried::all ? trials.without_undecided(std::move(best)) : best;
}

}  // namespace adit
