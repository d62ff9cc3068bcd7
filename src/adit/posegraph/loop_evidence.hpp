// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well a choice of loops fits, by a measure that is the same for every choice; for `optimize_gnc`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/loop_clusters.hpp"

namespace adit {

/// The bound follows the variance of short cycles over loops up to this factor: long ones close worse.
inline constexpr double kScaleHeadroom = 30.0;
inline constexpr double kFitSureness = 1e-3;        ///< Chance that a fit as good as this is luck.
inline constexpr int kManyRedundancies = 600;       ///< More leave no doubt of the variance.
inline constexpr double kSmallestVariance = 1e-12;  ///< Of what the information states; less is rounding.

/// chi2 of what is in use, and how many of its numbers are redundant: measurements minus unknowns.
struct Redundancy {
  double chi2 = 0.0;  ///< By the information as stated.
  int number = 0;     ///< A multiple of kDof; 0 where nothing can contradict.
};
/// Of the edges with a weight of one half and more. `costs`: chi2 of each edge at the poses of `s`.
template <class P>
[[nodiscard]] Redundancy redundancy_of(const BasicPoseGraph<P>& graph, const Solution<P>& s,
                                       const std::vector<double>& costs) {
  Redundancy out;
  std::size_t num_used = 0;
  for (std::size_t e = 0; e < costs.size(); ++e) {
    if (s.edge_weights[e] < 0.5) continue;
    out.chi2 += costs[e];
    ++num_used;
  }
  const std::size_t parts = connected_components(graph, s.edge_weights).anchors.size();
  out.number = static_cast<int>(num_used + parts - graph.nodes.size()) * P::kDof;
  return out;
}

/// The variance of what is in use, by that which its information states; 1 where nothing is redundant, as a
/// loop that nothing contradicts fits exactly and says nothing. Source: the a-posteriori variance of unit
/// weight in least-squares adjustment (Helmert).
template <class P>
[[nodiscard]] double variance_of(const BasicPoseGraph<P>& graph, const Solution<P>& s,
                                 const std::vector<double>& costs) {
  const Redundancy r = redundancy_of(graph, s, costs);
  return r.number > 0 ? std::max(kSmallestVariance, r.chi2 / r.number) : 1.0;
}

/// The largest variance that a fit as good as this one leaves possible: where the redundancy is small, a good
/// fit may be luck.
template <class P>
[[nodiscard]] double largest_variance(const BasicPoseGraph<P>& graph, const Solution<P>& s,
                                      const std::vector<double>& costs) {
  const int number = std::clamp(redundancy_of(graph, s, costs).number, 1, kManyRedundancies);
  return variance_of(graph, s, costs) * number / chi2_quantile(kFitSureness, number);
}

/// What solutions are compared by: one measure for all of them, whatever bound each search ended with. Minus
/// twice the logarithm of the likelihood, up to a constant. What is in use costs its chi2. Loops that are
/// rejected cost as much as one mistake per piece (loop_clusters.hpp), because loops of one mistake agree
/// with one another as true ones do; the others of a piece cost what they cost one another.
template <class P>
class LoopEvidence {
 public:
  /// `clusters` of the graph, which must outlive this; `given_bound`: chi2 as the configuration states it.
  LoopEvidence(const BasicPoseGraph<P>& graph, LoopClusters clusters, double given_bound)
      : graph_(graph),
        clusters_(std::move(clusters)),
        scale_(std::clamp(clusters_.scale, kSmallestVariance, 1.0)),
        bound_(given_bound * std::min(1.0, kScaleHeadroom * scale_)) {}

  /// As given.
  [[nodiscard]] const LoopClusters& clusters() const { return clusters_; }
  [[nodiscard]] double bound() const { return bound_; }  ///< Largest chi2 of a loop that may be true.
  [[nodiscard]] double scale() const { return scale_; }  ///< Variance by that which is stated, at most 1.

  /// False where long cycles close far worse than short ones: false loops then hold the long ones.
  [[nodiscard]] bool has_right_scale(const Solution<P>& s) const {
    return variance_of(graph_, s, edge_costs(graph_, s.poses)) <= kScaleHeadroom * scale_;
  }

  /// The measure above: the less, the likelier.
  [[nodiscard]] double cost(const Solution<P>& s) const {
    const std::vector<double> costs = edge_costs(graph_, s.poses);
    std::vector<std::size_t> rejected(clusters_.piece_sizes.size(), 0);
    double sum = 0.0;
    for (std::size_t e = 0; e < costs.size(); ++e) {
      if (graph_.edges[e].kind == EdgeKind::loop && s.edge_weights[e] < 0.5)
        ++rejected[clusters_.piece_of_edge[e]];
      else
        sum += costs[e];
    }
    for (std::size_t p = 0; p < rejected.size(); ++p) {
      const double others = static_cast<double>(std::max<std::size_t>(2, clusters_.piece_sizes[p]) - 1);
      if (rejected[p] > 0)
        sum += bound_ + clusters_.piece_misfits[p] * static_cast<double>(rejected[p] - 1) / others;
    }
    return sum;
  }

  /// The graph in which each piece weighs as much as one loop.
  [[nodiscard]] BasicPoseGraph<P> one_loop_per_piece() const {
    BasicPoseGraph<P> out = graph_;
    for (std::size_t e = 0; e < out.edges.size(); ++e) {
      if (out.edges[e].kind == EdgeKind::loop)
        out.edges[e].information /= static_cast<double>(clusters_.piece_sizes[clusters_.piece_of_edge[e]]);
    }
    return out;
  }

 private:
  const BasicPoseGraph<P>& graph_;
  LoopClusters clusters_;
  double scale_;
  double bound_;
};

}  // namespace adit
