// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/loop_clusters.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "adit/core/disjoint_sets.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/odometry_chain.hpp"

namespace adit {
namespace {

constexpr std::size_t kLoopsPerPart = 32;  // loops that one thread takes at a time
constexpr std::size_t kManyCycles = 100;   // more do not make the scale surer: they share odometry

// An open direction of the information becomes one of very large variance.
template <class Matrix>
Matrix covariance_of(const Matrix& information) {
  constexpr double kOpenShare = 1e-9;  // of the largest diagonal element
  const double open = kOpenShare * information.diagonal().maxCoeff();
  return (information + open * Matrix::Identity()).llt().solve(Matrix::Identity());
}

// A loop with its ends in the order of the chains.
template <class P>
struct Loop {
  std::size_t edge;
  PlaceOnPath from;
  PlaceOnPath to;
  P T_from_to;
  typename P::Jacobian covariance;
};

// All loops, sorted by the paths they join and then by their places there.
template <class P>
std::vector<Loop<P>> sorted_loops(const BasicPoseGraph<P>& graph, const std::vector<PlaceOnPath>& places) {
  using Matrix = typename P::Jacobian;
  std::vector<Loop<P>> loops;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto& edge = graph.edges[e];
    if (edge.kind != EdgeKind::loop) continue;
    const PlaceOnPath from = places[edge.from];
    const PlaceOnPath to = places[edge.to];
    const Matrix covariance = covariance_of<Matrix>(edge.information);
    if (from <= to) {
      loops.push_back({e, from, to, edge.T_from_to, covariance});
    } else {
      loops.push_back(
          {e, to, from, edge.T_from_to.inverse(), carry_covariance(edge.T_from_to.adjoint(), covariance)});
    }
  }
  std::ranges::sort(loops, {}, [](const Loop<P>& l) {
    return std::tuple(l.from.path, l.to.path, l.from.position, l.to.position, l.edge);
  });
  return loops;
}

// How badly the cycle over two loops and the odometry between their ends closes.
template <class P>
double cycle_chi2(const std::vector<BasicOdometryChain<P>>& chains, const Loop<P>& first,
                  const Loop<P>& second) {
  const BasicOdometryChain<P>& from = chains[first.from.path];
  const BasicOdometryChain<P>& to = chains[first.to.path];
  const P last_leg = to.between(second.to.position, first.to.position);
  const P back = second.T_from_to * last_leg;
  const P E = first.T_from_to.inverse() * from.between(first.from.position, second.from.position) * back;
  const typename P::Jacobian S =
      carry_covariance(E.inverse().adjoint(), first.covariance) +
      carry_covariance(last_leg.inverse().adjoint(), second.covariance) +
      carry_covariance((from.from_first(second.from.position) * back).inverse().adjoint(),
                       from.covariance_from_first(first.from.position, second.from.position)) +
      carry_covariance(to.from_first(first.to.position).inverse().adjoint(),
                       to.covariance_from_first(second.to.position, first.to.position));
  const typename P::Tangent error = between_residual(P(), P(), E);
  return error.dot(S.llt().solve(error));
}

std::size_t gap(const PlaceOnPath& a, const PlaceOnPath& b) {
  return std::max(a.position, b.position) - std::min(a.position, b.position);
}

// A later loop in the list that was compared with one before.
struct Neighbour {
  std::size_t loop;
  double chi2;
};

// The nearest of the later loops between the same paths, with how well they agree with loop i.
template <class P>
std::vector<Neighbour> neighbours_of(std::size_t i, const std::vector<Loop<P>>& loops,
                                     const std::vector<BasicOdometryChain<P>>& chains,
                                     const LoopClusterConfig& config) {
  const Loop<P>& first = loops[i];
  std::vector<std::pair<std::size_t, std::size_t>> near;  // steps apart, loop
  for (std::size_t j = i + 1; j < loops.size(); ++j) {
    const Loop<P>& second = loops[j];
    if (second.from.path != first.from.path || second.to.path != first.to.path) break;
    const std::size_t at_from = gap(first.from, second.from);
    const std::size_t at_to = gap(first.to, second.to);
    if (at_from > config.max_steps) break;
    if (at_to <= config.max_steps) near.emplace_back(at_from + at_to, j);
  }
  std::ranges::sort(near);
  near.resize(std::min(near.size(), config.max_neighbours));
  std::vector<Neighbour> neighbours;
  for (const auto& [steps, j] : near) neighbours.push_back({j, cycle_chi2(chains, first, loops[j])});
  return neighbours;
}

using Neighbours = std::vector<std::vector<Neighbour>>;  // of each loop

std::vector<double> best_agreements(const Neighbours& neighbours) {
  std::vector<double> best(neighbours.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    for (const Neighbour& n : neighbours[i]) {
      best[i] = std::min(best[i], n.chi2);
      best[n.loop] = std::min(best[n.loop], n.chi2);
    }
  }
  return best;
}

// Exact agreement says nothing of the noise: loops that agree to this share of the bound are copies of one
// another.
constexpr double kCopyShare = 1e-9;

// `best`: chi2 of each loop's best agreement. Even with half of all loops false, the 40th percentile is that
// of a true one.
double agreement_bound(std::vector<double> best, double bound) {
  constexpr double kPercentile = 0.4;
  constexpr double kPercentileHeadroom = 20.0;  // true loops reach several times the percentile
  std::erase_if(best, [&](double chi2) { return chi2 < kCopyShare * bound || !std::isfinite(chi2); });
  if (best.empty()) return bound;
  const auto middle =
      best.begin() + static_cast<std::ptrdiff_t>(kPercentile * static_cast<double>(best.size()));
  std::nth_element(best.begin(), middle, best.end());
  return std::min(bound, kPercentileHeadroom * *middle);
}

DisjointSets joined_below(double bound, const Neighbours& neighbours) {
  DisjointSets sets(neighbours.size());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    for (const Neighbour& n : neighbours[i]) {
      if (n.chi2 < bound) sets.join(n.loop, i);
    }
  }
  return sets;
}

// Of agreements between each loop and its nearest neighbour. Below the given `bound` all of them are seen;
// at the bound the larger ones are cut off, and the median is the median of the rest.
double scale_of(const Neighbours& neighbours, double bound, int dof, double probability) {
  constexpr double kSureness = 1e-3;  // that as few cycles as these close so well by luck
  std::vector<double> nearest;
  for (const std::vector<Neighbour>& of_loop : neighbours) {
    if (of_loop.empty()) continue;
    const double chi2 = of_loop.front().chi2;
    if (chi2 < bound && chi2 > kCopyShare * bound) nearest.push_back(chi2);
  }
  if (nearest.empty()) return 1.0;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  const bool is_cut = bound >= chi2_quantile(probability, dof);
  const double median = chi2_quantile(is_cut ? 0.5 * probability : 0.5, dof);
  const int redundancy = dof * static_cast<int>(std::min<std::size_t>(nearest.size(), kManyCycles));
  return *middle / median * redundancy / chi2_quantile(kSureness, redundancy);
}

// Groups of at most `max_size` loops; pairs that agree best are joined first.
// `misfit`: of the group that each loop stands for, the chi2 of the cycles that joined it.
struct JoinedGroups {
  DisjointSets sets;
  std::vector<double> misfit;
};
JoinedGroups joined_best_first(double bound, std::size_t max_size, const Neighbours& neighbours) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    for (const Neighbour& n : neighbours[i])
      if (n.chi2 < bound) pairs.emplace_back(n.chi2, i, n.loop);
  std::ranges::sort(pairs);
  DisjointSets sets(neighbours.size());
  std::vector<std::size_t> size(neighbours.size(), 1);
  std::vector<double> misfit(neighbours.size(), 0.0);
  for (const auto& [chi2, i, j] : pairs) {
    const std::size_t a = sets.find(i);
    const std::size_t b = sets.find(j);
    if (a == b || size[a] + size[b] > max_size) continue;
    sets.join(a, b);
    const std::size_t both = sets.find(a);
    size[both] = size[a] + size[b];
    misfit[both] = misfit[a] + misfit[b] + chi2;
  }
  return {std::move(sets), std::move(misfit)};
}

// The cycles that joined a piece are the best of several, and close better than chance would have it. Over
// all pieces but copies their mean is known.
void level_misfits(LoopClusters& clusters, int dof, double bound) {
  double expected = 0.0;
  double found = 0.0;
  for (std::size_t p = 0; p < clusters.piece_sizes.size(); ++p) {
    const double redundancy = static_cast<double>(clusters.piece_sizes[p] - 1) * dof;
    if (clusters.piece_misfits[p] <= kCopyShare * bound * redundancy) continue;
    expected += redundancy * clusters.scale;
    found += clusters.piece_misfits[p];
  }
  if (found == 0.0) return;
  for (double& misfit : clusters.piece_misfits) misfit *= expected / found;
}

// The group of each edge, numbered in the order of the loops, and the size of each group.
template <class P>
std::pair<std::vector<std::size_t>, std::vector<std::size_t>> numbered(DisjointSets sets,
                                                                       const std::vector<Loop<P>>& loops,
                                                                       std::size_t num_edges) {
  std::vector<std::size_t> of_edge(num_edges, LoopClusters::kNone);
  std::vector<std::size_t> sizes;
  std::vector<std::size_t> number(loops.size(), LoopClusters::kNone);  // of the group that a loop represents
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::size_t& group = number[sets.find(i)];
    if (group == LoopClusters::kNone) {
      group = sizes.size();
      sizes.push_back(0);
    }
    of_edge[loops[i].edge] = group;
    ++sizes[group];
  }
  return {std::move(of_edge), std::move(sizes)};
}

}  // namespace

template <class P>
LoopClusters loop_clusters(const BasicPoseGraph<P>& graph, const LoopClusterConfig& config) {
  const std::vector<OdometryPath> paths = odometry_paths(graph);
  std::vector<BasicOdometryChain<P>> chains;
  for (const OdometryPath& path : paths)
    chains.push_back(chain_along(graph, path, covariance_of<typename P::Jacobian>));
  const std::vector<Loop<P>> loops = sorted_loops(graph, places_on(paths, graph.nodes.size()));
  Neighbours neighbours(loops.size());
  parallel_for_each(
      loops.size(), [&](std::size_t i) { neighbours[i] = neighbours_of(i, loops, chains, config); },
      kLoopsPerPart);
  const double bound =
      agreement_bound(best_agreements(neighbours), chi2_quantile(config.probability, P::kDof));
  LoopClusters clusters;
  std::tie(clusters.of_edge, clusters.sizes) =
      numbered(joined_below(bound, neighbours), loops, graph.edges.size());
  clusters.scale = scale_of(neighbours, bound, P::kDof, config.probability);
  JoinedGroups pieces = joined_best_first(bound, config.max_piece, neighbours);
  std::tie(clusters.piece_of_edge, clusters.piece_sizes) = numbered(pieces.sets, loops, graph.edges.size());
  clusters.piece_misfits.assign(clusters.piece_sizes.size(), 0.0);
  for (std::size_t i = 0; i < loops.size(); ++i)
    clusters.piece_misfits[clusters.piece_of_edge[loops[i].edge]] = pieces.misfit[pieces.sets.find(i)];
  level_misfits(clusters, P::kDof, bound);
  return clusters;
}

template LoopClusters loop_clusters(const PoseGraph&, const LoopClusterConfig&);
template LoopClusters loop_clusters(const PoseGraph2&, const LoopClusterConfig&);

}  // namespace adit
