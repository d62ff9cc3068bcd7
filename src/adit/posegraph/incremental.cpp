// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/incremental_cholesky.hpp"

namespace adit {
namespace {

constexpr std::size_t kItemsPerPart = 256;
constexpr double kSlow = 0.5;  // a step after which more than this share of the gain is left is slow
constexpr double kNoise =
    1e-12;  // gain per edge, in standard deviations squared, below which nothing is left

}  // namespace

template <class P>
struct IncrementalOptimizer<P>::Impl {
  static constexpr int D = P::kDof;
  using Tangent = typename P::Tangent;

  OptimizerConfig config;
  BasicPoseGraph<P> graph;
  std::vector<P> poses;
  std::vector<std::vector<std::pair<std::size_t, bool>>> edges_of_node;  // edge, and whether it starts here
  std::size_t num_linearized = 0;                                        // edges that the factor holds
  IncrementalCholesky cholesky{D};
  bool broken = false;  // the last refresh failed: the factor is of no use

  // Variable of a node: the first has none.
  static std::size_t variable(std::size_t node) { return node - 1; }

  // The edges that the factor lacks, linearized at the present poses. A node that this leaves free, or
  // nothing.
  [[nodiscard]] std::optional<std::size_t> add_terms() {
    while (cholesky.size() + 1 < graph.nodes.size()) cholesky.add_variable();
    for (; num_linearized < graph.edges.size(); ++num_linearized) {
      const Edge& edge = graph.edges[num_linearized];
      const BetweenFactor<P> f = linearize(edge.T_from_to, poses[edge.from], poses[edge.to]);
      const typename P::Jacobian from_information = f.d_from.transpose() * edge.information;
      if (edge.from != 0) cholesky.add(variable(edge.from), variable(edge.from), from_information * f.d_from);
      if (edge.to != 0)
        cholesky.add(variable(edge.to), variable(edge.to), f.d_to.transpose() * edge.information * f.d_to);
      if (edge.from != 0 && edge.to != 0)
        cholesky.add(variable(edge.from), variable(edge.to), from_information * f.d_to);
    }
    const auto free = cholesky.refresh();
    broken = free.has_value();
    return free ? std::optional(*free + 1) : std::nullopt;
  }

  [[nodiscard]] std::optional<std::size_t> renew_all() {
    cholesky = IncrementalCholesky(D);
    num_linearized = 0;
    return add_terms();
  }

  struct Gradient {
    Eigen::VectorXd g;
    double cost = 0.0;
  };
  [[nodiscard]] Gradient gradient_at(const std::vector<P>& at) const {
    struct Parts {
      Tangent from, to;
    };
    std::vector<Parts> parts(graph.edges.size());
    Gradient out;
    out.cost = parallel_sum(graph.edges.size(), kItemsPerPart, 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0.0;
      for (std::size_t e = begin; e < end; ++e) {
        const Edge& edge = graph.edges[e];
        const BetweenFactor<P> f = linearize(edge.T_from_to, at[edge.from], at[edge.to]);
        const Tangent weighted = edge.information * f.residual;
        sum += f.residual.dot(weighted);
        parts[e].from.noalias() = f.d_from.transpose() * weighted;
        parts[e].to.noalias() = f.d_to.transpose() * weighted;
      }
      return sum;
    });
    out.g.resize(static_cast<Eigen::Index>(cholesky.size()) * D);
    parallel_for_each(
        cholesky.size(),
        [&](std::size_t v) {
          Tangent sum = Tangent::Zero();
          for (const auto& [e, starts_here] : edges_of_node[v + 1])
            sum += starts_here ? parts[e].from : parts[e].to;
          out.g.template segment<D>(static_cast<Eigen::Index>(v) * D) = sum;
        },
        kItemsPerPart);
    return out;
  }

  [[nodiscard]] std::vector<P> stepped(const Eigen::VectorXd& step) const {
    std::vector<P> out = poses;
    parallel_for_each(
        cholesky.size(),
        [&](std::size_t v) {
          out[v + 1] =
              retract(out[v + 1], Tangent(step.template segment<D>(static_cast<Eigen::Index>(v) * D)));
        },
        kItemsPerPart);
    return out;
  }

  void minimize(Update& u) {
    Gradient now = gradient_at(poses);
    double last_gain = std::numeric_limits<double>::infinity();
    u.cost = now.cost;
    if (!std::isfinite(now.cost)) {
      u.status = SolveStatus::non_finite;
      u.reason = "the cost of the start is not a finite number";
      return;
    }
    u.status = SolveStatus::max_iterations;
    u.reason = format("stopped after {} iterations", config.max_iterations);
    while (u.iterations < config.max_iterations) {
      ++u.iterations;
      const Eigen::VectorXd step = cholesky.solve(-now.g);
      const double gain = -now.g.dot(step);
      if (gain <=
          std::max(config.relative_tolerance * now.cost, kNoise * static_cast<double>(graph.edges.size())))
        return converge(u, "the cost no longer falls");
      std::vector<P> next_poses = stepped(step);
      Gradient next = gradient_at(next_poses);
      const bool falls = next.cost < now.cost;
      if (falls) {
        poses = std::move(next_poses);
        now = std::move(next);
        u.cost = now.cost;
      }
      if ((!falls || gain > kSlow * last_gain) && !renew_or_settle(u, falls)) return;
      last_gain = gain;
    }
  }

  // After a step that was poor: linearize anew, once; if that has been done the step is as good as they get.
  bool renew_or_settle(Update& u, bool falls) {
    if (!u.all_renewed || falls) {
      u.all_renewed = true;
      if (!renew_all()) return true;
      u.status = SolveStatus::singular;
      u.reason = "linearized anew, the edges leave a node free to move";
      return false;
    }
    // A full Gauss-Newton step that climbs: Levenberg-Marquardt on the whole graph.
    BasicPoseGraph<P> whole = graph;
    for (std::size_t i = 0; i < poses.size(); ++i) whole.nodes[i].pose = poses[i];
    Solution<P> solution = optimize(whole, config);
    u.iterations += solution.iterations;
    u.status = solution.status;
    u.reason = solution.reason;
    if (solution.ok() && solution.cost_final < u.cost) {
      const P back =
          poses.front() * solution.poses.front().inverse();  // another anchor, if keys are not in order
      for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = back * solution.poses[i];
      u.cost = solution.cost_final;
    }
    if (renew_all()) u.status = SolveStatus::singular;
    return false;
  }

  static void converge(Update& u, const char* why) {
    u.status = SolveStatus::converged;
    u.reason = why;
  }
};

template <class P>
IncrementalOptimizer<P>::IncrementalOptimizer(const OptimizerConfig& config)
    : impl_(std::make_unique<Impl>()) {
  impl_->config = config;
}
template <class P>
IncrementalOptimizer<P>::IncrementalOptimizer(IncrementalOptimizer&&) noexcept = default;
template <class P>
IncrementalOptimizer<P>& IncrementalOptimizer<P>::operator=(IncrementalOptimizer&&) noexcept = default;
template <class P>
IncrementalOptimizer<P>::~IncrementalOptimizer() = default;

template <class P>
std::size_t IncrementalOptimizer<P>::add_node(std::uint64_t key, const P& pose) {
  impl_->graph.nodes.push_back({key, pose});
  impl_->poses.push_back(pose);
  impl_->edges_of_node.emplace_back();
  return impl_->poses.size() - 1;
}

template <class P>
void IncrementalOptimizer<P>::add_edge(const Edge& edge) {
  ADIT_CHECK(edge.from < impl_->poses.size() && edge.to < impl_->poses.size() && edge.from != edge.to,
             "an edge joins two nodes that have been added");
  impl_->edges_of_node[edge.from].emplace_back(impl_->graph.edges.size(), true);
  impl_->edges_of_node[edge.to].emplace_back(impl_->graph.edges.size(), false);
  impl_->graph.edges.push_back(edge);
}

template <class P>
typename IncrementalOptimizer<P>::Update IncrementalOptimizer<P>::update() {
  Update u;
  Impl& impl = *impl_;
  const std::vector<P> before = impl.poses;
  if (impl.graph.nodes.size() < 2) return u;
  if (const auto bad = indefinite_edges(impl.graph, impl.num_linearized); !bad.empty()) {
    const Edge& edge = impl.graph.edges[bad.front()];
    u.status = SolveStatus::indefinite_information;
    u.reason = format("the information matrix of edge {} -> {} is indefinite",
                      impl.graph.nodes[edge.from].key, impl.graph.nodes[edge.to].key);
    return u;
  }
  if (const auto free = impl.broken ? impl.renew_all() : impl.add_terms()) {
    u.status = SolveStatus::singular;
    u.reason = format("the edges leave node {} free to move: give them information in every direction",
                      impl.graph.nodes[*free].key);
    return u;
  }
  u.num_renewed = impl.cholesky.num_renewed();
  u.num_supernodes = impl.cholesky.num_supernodes();
  impl.minimize(u);
  if (u.status != SolveStatus::converged && u.status != SolveStatus::max_iterations) impl.poses = before;
  return u;
}

template <class P>
const std::vector<P>& IncrementalOptimizer<P>::poses() const {
  return impl_->poses;
}
template <class P>
const BasicPoseGraph<P>& IncrementalOptimizer<P>::graph() const {
  return impl_->graph;
}

template class IncrementalOptimizer<Pose>;
template class IncrementalOptimizer<Pose2>;

}  // namespace adit
