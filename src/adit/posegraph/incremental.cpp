// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/incremental_model.hpp"

namespace adit {
namespace {

constexpr double kSlowGain = 0.5;     // a step after which more than this share of the gain is left is slow
constexpr double kGainNoise = 1e-12;  // gain per edge, in chi2, below which nothing is left
// Change of an edge's relative pose since it was linearized, radians and share of its length plus a metre.
constexpr double kStaleChange = 0.1;   // linearized anew
constexpr double kFreshChange = 1e-3;  // not even where steps converge slowly

}  // namespace

template <class P>
struct IncrementalOptimizer<P>::Impl {
  using Model = IncrementalModel<P>;
  using Replaced = typename Model::Replaced;

  OptimizerConfig config;
  Model model;
  std::vector<std::pair<std::size_t, P>> before;  // poses at the start of this update, of nodes moved
  std::vector<std::size_t> moved_in;              // update that moved each node last
  std::size_t num_updates = 0;
  bool is_settled = false;     // the last update converged
  bool all_are_fresh = false;  // the last step climbed, so that all was linearized at the present poses

  // Whether the factor is as it should be, given the node that is free to move.
  [[nodiscard]] bool is_renewed(Update& u, std::optional<std::size_t> free) const {
    u.num_renewed += model.cholesky().num_renewed();
    u.num_supernodes = model.cholesky().num_supernodes();
    if (!free) return true;
    u.status = SolveStatus::singular;
    u.reason = format("the edges leave node {} free to move: give them information in every direction",
                      model.graph().nodes[*free].key);
    return false;
  }
  [[nodiscard]] bool linearize_changed(Update& u, const std::vector<std::size_t>& terms, double change) {
    const std::size_t num_before = u.num_linearized;
    const auto free = model.linearize_changed(terms, change, u.num_linearized);
    return u.num_linearized == num_before || is_renewed(u, free);
  }

  void keep(const Replaced& replaced) {
    moved_in.resize(model.poses().size(), 0);
    for (const auto& [node, pose] : replaced.poses) {
      if (std::exchange(moved_in[node], num_updates) != num_updates) before.emplace_back(node, pose);
    }
  }

  // What may be left of the cost where nothing needs to be done.
  [[nodiscard]] double negligible(const Update& u) const {
    return std::max(config.relative_tolerance * u.cost,
                    kGainNoise * static_cast<double>(model.graph().edges.size()));
  }

  void minimize(Update& u, int max_iterations) {
    double last_gain = std::numeric_limits<double>::infinity();
    u.status = SolveStatus::max_iterations;
    u.reason = format("stopped after {} iterations", max_iterations);
    while (u.iterations < max_iterations) {
      const double least_gain = negligible(u);
      const auto step = model.step(least_gain);
      if (step.gain > 0.0) ++u.iterations;
      if (step.gain <= least_gain) return converge(u, "the cost no longer falls");
      if (const auto stale = model.stale_for(step); !stale.empty()) {
        if (!linearize_changed(u, stale, 0.0)) return;
        continue;
      }
      const Replaced replaced = model.take(step);
      u.num_evaluated += replaced.terms.size();
      if (replaced.poses.empty()) return converge(u, "the steps are below a micrometre");
      const bool falls = replaced.cost < 0.0;
      if (falls) {
        keep(replaced);
        u.cost += replaced.cost;
        if (!linearize_changed(u, replaced.terms, kStaleChange)) return;
      } else {
        model.put_back(replaced.poses);
        if (all_are_fresh) return solve_as_a_whole(u);
      }
      if (!falls || step.gain > kSlowGain * last_gain) {
        all_are_fresh = !falls;
        if (!linearize_changed(u, falls ? replaced.terms : model.all_terms(), kFreshChange)) return;
      }
      last_gain = step.gain;
    }
  }

  // After a full Gauss-Newton step that climbs: Levenberg-Marquardt on the whole graph.
  void solve_as_a_whole(Update& u) {
    BasicPoseGraph<P> whole = model.graph();
    std::vector<double> weights(whole.edges.size());
    for (std::size_t i = 0; i < whole.nodes.size(); ++i) whole.nodes[i].pose = model.poses()[i];
    for (std::size_t e = 0; e < weights.size(); ++e) weights[e] = model.is_used(e) ? 1.0 : 0.0;
    Solution<P> solution = optimize(whole, config, weights);
    u.iterations += solution.iterations;
    u.status = solution.status;
    u.reason = solution.reason;
    if (!solution.ok() || solution.cost_final >= u.cost) return;
    // Another anchor, if keys are not in order.
    const P back = model.poses().front() * solution.poses.front().inverse();
    for (P& pose : solution.poses) pose = back * pose;
    keep(model.take_all(solution.poses));
    u.cost = solution.cost_final;
    (void)linearize_changed(u, model.all_terms(), kFreshChange);
  }

  static void converge(Update& u, const char* why) {
    u.status = SolveStatus::converged;
    u.reason = why;
  }

  // The first edge that was put in use and must not be.
  [[nodiscard]] bool refuse_indefinite(Update& u) {
    for (const std::size_t e : model.changed()) {
      if (!model.is_used(e)) continue;
      const Edge& edge = model.graph().edges[e];
      BasicPoseGraph<P> one;
      one.nodes.resize(2);
      one.edges = {{0, 1, edge.T_from_to, edge.information, edge.kind}};
      if (indefinite_edges(one).empty()) continue;
      const auto& nodes = model.graph().nodes;
      u.status = SolveStatus::indefinite_information;
      u.reason = format("the information matrix of edge {} -> {} is indefinite", nodes[edge.from].key,
                        nodes[edge.to].key);
      model.set_use(e, false);
      return true;
    }
    return false;
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
  impl_->model.add_node(key, pose);
  return impl_->model.poses().size() - 1;
}

template <class P>
std::size_t IncrementalOptimizer<P>::add_edge(const Edge& edge, EdgeUse use) {
  const std::size_t num_nodes = impl_->model.poses().size();
  ADIT_CHECK(edge.from < num_nodes && edge.to < num_nodes && edge.from != edge.to,
             "an edge joins two nodes that have been added");
  impl_->model.add_edge(edge);
  const std::size_t e = impl_->model.graph().edges.size() - 1;
  set_use(e, use);
  return e;
}

template <class P>
void IncrementalOptimizer<P>::set_use(std::size_t edge, EdgeUse use) {
  ADIT_CHECK(edge < impl_->model.graph().edges.size(), "an edge that has been added");
  impl_->model.set_use(edge, use == EdgeUse::in_use);
}

template <class P>
bool IncrementalOptimizer<P>::is_used(std::size_t edge) const {
  ADIT_CHECK(edge < impl_->model.graph().edges.size(), "an edge that has been added");
  return impl_->model.is_used(edge);
}

template <class P>
double IncrementalOptimizer<P>::chi2(std::size_t edge) const {
  ADIT_CHECK(is_used(edge), "an edge that is in use");
  return impl_->model.cost(edge);
}

template <class P>
typename IncrementalOptimizer<P>::Update IncrementalOptimizer<P>::update() {
  return update(impl_->config.max_iterations);
}

template <class P>
typename IncrementalOptimizer<P>::Update IncrementalOptimizer<P>::update(int max_iterations) {
  Update u;
  Impl& impl = *impl_;
  if (impl.model.poses().size() < 2) return u;
  ++impl.num_updates;
  impl.before.clear();
  const bool was_settled = std::exchange(impl.is_settled, false);
  if (impl.refuse_indefinite(u)) return u;
  if (!impl.is_renewed(u, impl.model.renew())) return u;
  u.cost = impl.model.cost();
  if (!std::isfinite(u.cost)) {
    u.status = SolveStatus::non_finite;
    u.reason = "the cost of the start is not a finite number";
    return u;
  }
  if (was_settled && !impl.model.has_new_gradient())
    Impl::converge(u, "nothing pulls at the poses");
  else
    impl.minimize(u, max_iterations);
  impl.is_settled = u.status == SolveStatus::converged;
  if (u.status != SolveStatus::converged && u.status != SolveStatus::max_iterations) {
    impl.model.put_back(impl.before);
    u.cost = impl.model.cost();
    return u;
  }
  for (std::size_t node = 0; node < impl.moved_in.size(); ++node)
    if (impl.moved_in[node] == impl.num_updates) u.moved.push_back(node);
  return u;
}

template <class P>
typename IncrementalOptimizer<P>::Prediction IncrementalOptimizer<P>::predict(
    const std::vector<std::size_t>& edges) {
  constexpr int D = P::kDof;
  const auto rows = static_cast<Eigen::Index>(edges.size()) * D;
  Prediction out{Eigen::VectorXd(rows), {}};
  std::vector<std::size_t> variables;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * rows, rows);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Edge& edge = impl_->model.graph().edges.at(edges[k]);
    const auto at = static_cast<Eigen::Index>(k) * D;
    const BetweenFactor<P> f = linearize(edge.T_from_to, impl_->model.relative(edge));
    out.residual.segment(at, D) = f.residual;
    for (const auto& [node, jacobian] : {std::pair(edge.from, f.d_from), std::pair(edge.to, f.d_to)}) {
      if (node == 0) continue;
      const std::size_t variable = Impl::Model::variable(node);
      const auto known = std::ranges::find(variables, variable);
      const auto row = static_cast<Eigen::Index>(known - variables.begin()) * D;
      if (known == variables.end()) variables.push_back(variable);
      columns.block(row, at, D, D) += jacobian.transpose();
    }
  }
  columns.conservativeResize(static_cast<Eigen::Index>(variables.size()) * D, rows);
  out.covariance = impl_->model.cholesky().quadratic_form(variables, columns);
  return out;
}

template <class P>
const std::vector<P>& IncrementalOptimizer<P>::poses() const {
  return impl_->model.poses();
}
template <class P>
const BasicPoseGraph<P>& IncrementalOptimizer<P>::graph() const {
  return impl_->model.graph();
}

template class IncrementalOptimizer<Pose>;
template class IncrementalOptimizer<Pose2>;

}  // namespace adit
