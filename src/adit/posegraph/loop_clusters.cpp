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
      carry_covariance((from.pose(second.from.position) * back).inverse().adjoint(),
                       from.covariance_in_odom(first.from.position, second.from.position)) +
      carry_covariance(to.pose(first.to.position).inverse().adjoint(),
                       to.covariance_in_odom(second.to.position, first.to.position));
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

// `best`: chi2 of each loop's best agreement. Even with half of all loops false, the 40th percentile is that
// of a true one. Exact agreement says nothing of the noise: such loops are copies of one another.
double agreement_bound(std::vector<double> best, double bound) {
  constexpr double kCopyShare = 1e-9;
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
  DisjointSets sets = joined_below(bound, neighbours);

  LoopClusters clusters{std::vector<std::size_t>(graph.edges.size(), LoopClusters::kNone), {}};
  std::vector<std::size_t> number(loops.size(),
                                  LoopClusters::kNone);  // of the cluster that a loop represents
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::size_t& cluster = number[sets.find(i)];
    if (cluster == LoopClusters::kNone) {
      cluster = clusters.sizes.size();
      clusters.sizes.push_back(0);
    }
    clusters.of_edge[loops[i].edge] = cluster;
    ++clusters.sizes[cluster];
  }
  return clusters;
}

template LoopClusters loop_clusters(const PoseGraph&, const LoopClusterConfig&);
template LoopClusters loop_clusters(const PoseGraph2&, const LoopClusterConfig&);

}  // namespace adit
