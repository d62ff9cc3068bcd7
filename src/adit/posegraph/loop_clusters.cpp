// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/loop_clusters.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/gnc.hpp"

namespace adit {
namespace {

constexpr std::size_t kGrain = 32;  // loops that one thread takes at a time
constexpr std::size_t kNone = LoopClusters::kNone;

Matrix6 adjoint_of(const Pose& T) { return T.adjoint(); }
Matrix3 adjoint_of(const Pose2& T) {
  Matrix3 A = Matrix3::Identity();
  A.topLeftCorner<2, 2>() = T.rotation_matrix();
  A(0, 2) = T.translation().y();
  A(1, 2) = -T.translation().x();
  return A;
}

template <class Matrix>
Matrix carried(const Matrix& adjoint, const Matrix& covariance) {
  return adjoint * covariance * adjoint.transpose();
}

// An open direction of the information becomes one of very large variance.
template <class Matrix>
Matrix covariance_of(const Matrix& information) {
  constexpr double kOpen = 1e-9;
  const double open = kOpen * information.diagonal().maxCoeff();
  return (information + open * Matrix::Identity()).llt().solve(Matrix::Identity());
}

// The odometry of a graph as chains: where each node stands, dead reckoning, and covariances that add up
// along it.
template <class P>
struct Chains {
  using Matrix = typename P::Jacobian;
  std::vector<std::size_t> chain;     // of each node
  std::vector<std::size_t> position;  // along it
  std::vector<P> T_start_node;
  std::vector<Matrix> prefix;  // sum of the steps' covariances so far, seen from the start

  explicit Chains(const BasicPoseGraph<P>& graph) {
    const std::size_t n = graph.nodes.size();
    chain.assign(n, kNone);
    position.assign(n, 0);
    T_start_node.resize(n);
    prefix.assign(n, Matrix::Zero());
    for (const OdometryPath& path : odometry_paths(graph)) {
      chain[path.nodes.front()] = path.nodes.front();
      for (std::size_t k = 0; k < path.steps.size(); ++k) {
        const auto& edge = graph.edges[path.steps[k]];
        chain[edge.to] = path.nodes.front();
        position[edge.to] = k + 1;
        T_start_node[edge.to] = T_start_node[edge.from] * edge.T_from_to;
        prefix[edge.to] = prefix[edge.from] + carried<Matrix>(adjoint_of(T_start_node[edge.to]),
                                                              covariance_of<Matrix>(edge.information));
      }
    }
  }

  [[nodiscard]] P between(std::size_t a, std::size_t b) const {
    return T_start_node[a].inverse() * T_start_node[b];
  }
  [[nodiscard]] Matrix covariance(std::size_t a, std::size_t b) const {  // of T_a_b, seen from the start
    return position[a] < position[b] ? Matrix(prefix[b] - prefix[a]) : Matrix(prefix[a] - prefix[b]);
  }
};

// A loop with its ends in the order of the chains.
template <class P>
struct Loop {
  std::size_t edge;
  std::size_t from;
  std::size_t to;
  P T_from_to;
  typename P::Jacobian covariance;
};

template <class P>
double cycle_chi2(const Chains<P>& chains, const Loop<P>& first, const Loop<P>& second) {
  using Matrix = typename P::Jacobian;
  const P last_leg = chains.between(second.to, first.to);
  const P back = second.T_from_to * last_leg;
  const P E = first.T_from_to.inverse() * chains.between(first.from, second.from) * back;
  const Matrix S = carried<Matrix>(adjoint_of(E.inverse()), first.covariance) +
                   carried<Matrix>(adjoint_of(last_leg.inverse()), second.covariance) +
                   carried<Matrix>(adjoint_of((chains.T_start_node[second.from] * back).inverse()),
                                   chains.covariance(first.from, second.from)) +
                   carried<Matrix>(adjoint_of(chains.T_start_node[first.to].inverse()),
                                   chains.covariance(second.to, first.to));
  const typename P::Tangent error = between_residual(P(), P(), E);
  return error.dot(S.llt().solve(error));
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

std::size_t gap(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

// `best`: chi2 of each loop's best agreement. Even with half of all loops false, the 40th percentile is that
// of a true one. Exact agreement says nothing of the noise: such loops are copies of one another.
double agreement_bound(std::vector<double> best, double bound) {
  constexpr double kCopy = 1e-9;
  constexpr double kShare = 0.4;
  constexpr double kHeadroom = 20.0;  // true loops reach several times the percentile
  std::erase_if(best, [&](double chi2) { return chi2 < kCopy * bound || !std::isfinite(chi2); });
  if (best.empty()) return bound;
  const auto middle = best.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(best.size()));
  std::nth_element(best.begin(), middle, best.end());
  return std::min(bound, kHeadroom * *middle);
}

}  // namespace

template <class P>
LoopClusters loop_clusters(const BasicPoseGraph<P>& graph, const LoopClusterConfig& config) {
  const Chains<P> chains(graph);
  std::vector<Loop<P>> loops;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto& edge = graph.edges[e];
    if (edge.kind != EdgeKind::loop) continue;
    const auto covariance = covariance_of<typename P::Jacobian>(edge.information);
    const auto place = [&](std::size_t node) { return std::pair(chains.chain[node], chains.position[node]); };
    if (place(edge.from) <= place(edge.to)) {
      loops.push_back({e, edge.from, edge.to, edge.T_from_to, covariance});
    } else {
      loops.push_back({e, edge.to, edge.from, edge.T_from_to.inverse(),
                       carried<typename P::Jacobian>(adjoint_of(edge.T_from_to), covariance)});
    }
  }
  const auto place = [&](const Loop<P>& l) {
    return std::tuple(chains.chain[l.from], chains.chain[l.to], chains.position[l.from],
                      chains.position[l.to], l.edge);
  };
  std::ranges::sort(loops, {}, place);

  struct Neighbour {
    std::size_t loop;
    double chi2;
  };
  std::vector<std::vector<Neighbour>> neighbours(loops.size());  // later ones in the list, of each
  parallel_for_each(
      loops.size(),
      [&](std::size_t i) {
        const Loop<P>& first = loops[i];
        std::vector<std::pair<std::size_t, std::size_t>> near;  // steps apart, loop
        for (std::size_t j = i + 1; j < loops.size(); ++j) {
          const Loop<P>& second = loops[j];
          if (chains.chain[second.from] != chains.chain[first.from] ||
              chains.chain[second.to] != chains.chain[first.to])
            break;
          const std::size_t at_from = gap(chains.position[first.from], chains.position[second.from]);
          const std::size_t at_to = gap(chains.position[first.to], chains.position[second.to]);
          if (at_from > config.max_steps) break;
          if (at_to <= config.max_steps) near.emplace_back(at_from + at_to, j);
        }
        std::ranges::sort(near);
        near.resize(std::min(near.size(), config.max_neighbours));
        for (const auto& [steps, j] : near) neighbours[i].push_back({j, cycle_chi2(chains, first, loops[j])});
      },
      kGrain);

  std::vector<double> best(loops.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (const Neighbour& n : neighbours[i]) {
      best[i] = std::min(best[i], n.chi2);
      best[n.loop] = std::min(best[n.loop], n.chi2);
    }
  }
  const double bound = agreement_bound(std::move(best), chi2_quantile(config.probability, P::kDof));
  std::vector<std::size_t> parent(loops.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (const Neighbour& n : neighbours[i]) {
      if (n.chi2 < bound) parent[root_of(parent, n.loop)] = root_of(parent, i);
    }
  }
  LoopClusters clusters{std::vector<std::size_t>(graph.edges.size(), kNone), {}};
  std::vector<std::size_t> number(loops.size(), kNone);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::size_t& cluster = number[root_of(parent, i)];
    if (cluster == kNone) {
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
