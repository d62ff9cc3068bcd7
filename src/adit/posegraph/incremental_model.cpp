// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/posegraph/factors.hpp"

namespace adit {
namespace {

constexpr double kSmallestGain = 1e-13;  // in chi2, by one node alone, below which its gradient is left
constexpr double kSmallestDiagonal = 1e-12;
constexpr double kStaleShare = 0.1;  // of the gain: error of the linear model that is tolerated

// Radians from one rotation to another, for small angles.
double angle_between(const Pose& a, const Pose& b) {
  const auto& p = a.rotation().coeffs();
  const auto& q = b.rotation().coeffs();
  return 2.0 * std::min((p - q).norm(), (p + q).norm());
}
double angle_between(const Pose2& a, const Pose2& b) { return std::abs(wrap_angle(a.theta() - b.theta())); }

}  // namespace

template <class P>
void IncrementalModel<P>::add_node(std::uint64_t key, const P& pose) {
  graph_.nodes.push_back({key, pose});
  poses_.push_back(pose);
  nodes_.emplace_back();
}

template <class P>
void IncrementalModel<P>::add_edge(const Edge& edge) {
  graph_.edges.push_back(edge);
  State state;
  constexpr int kTranslation = P::kDof == 6 ? 3 : 2;
  const auto weights = edge.information.diagonal();
  state.weight_of_translation = weights.template head<kTranslation>().mean();
  state.weight_of_rotation = weights.template tail<D - kTranslation>().mean();
  states_.push_back(state);
  costs_.push_back(0.0);
}

template <class P>
void IncrementalModel<P>::set_use(std::size_t edge, bool is_used) {
  if (states_[edge].is_used == is_used) return;
  states_[edge].is_used = is_used;
  changed_.push_back(edge);
}

template <class P>
double IncrementalModel<P>::cost() const {
  return std::accumulate(costs_.begin(), costs_.end(), 0.0);
}

// The terms of an edge, as it was linearized: residuals and Jacobians depend on the relative pose only.
template <class P>
void IncrementalModel<P>::change_terms(std::size_t e, Terms terms) {
  using Matrix = typename P::Jacobian;
  const Edge& edge = graph_.edges[e];
  const BetweenFactor<P> f = linearize(edge.T_from_to, states_[e].T_linear);
  const Matrix from_information = f.d_from.transpose() * edge.information;
  const auto change = [&](std::size_t i, std::size_t j, const Matrix& term) {
    if (i == 0 || j == 0) return;
    if (terms == Terms::added)
      cholesky_.add(variable(i), variable(j), term);
    else
      cholesky_.remove(variable(i), variable(j), term);
  };
  change(edge.from, edge.from, from_information * f.d_from);
  change(edge.to, edge.to, f.d_to.transpose() * edge.information * f.d_to);
  change(edge.from, edge.to, from_information * f.d_to);
  states_[e].is_in_factor = terms == Terms::added;
}

template <class P>
void IncrementalModel<P>::linearize_anew(std::size_t e) {
  State& state = states_[e];
  if (state.is_in_factor) change_terms(e, Terms::removed);
  state.T_linear = relative(graph_.edges[e]);
  state.turned = 0.0;
  state.moved = 0.0;
  change_terms(e, Terms::added);
}

template <class P>
double IncrementalModel<P>::change(std::size_t e) const {
  const State& state = states_[e];
  return std::max(state.turned, state.moved / (1.0 + state.T_linear.translation().norm()));
}

template <class P>
void IncrementalModel<P>::evaluate(std::size_t e) {
  const Edge& edge = graph_.edges[e];
  State& state = states_[e];
  const P now = relative(edge);
  const BetweenFactor<P> f = linearize(edge.T_from_to, now);
  state.turned = angle_between(state.T_linear, now);
  state.moved = (now.translation() - state.T_linear.translation()).norm();
  const Tangent weighted = edge.information * f.residual;
  costs_[e] = f.residual.dot(weighted);
  state.from.noalias() = f.d_from.transpose() * weighted;
  state.to.noalias() = f.d_to.transpose() * weighted;
}

template <class P>
void IncrementalModel<P>::sum_gradient(std::size_t node) {
  Tangent sum = Tangent::Zero();
  for (const std::size_t e : nodes_[node].edges)
    sum += graph_.edges[e].from == node ? states_[e].from : states_[e].to;
  nodes_[node].gradient = sum;
  if (node == 0 || nodes_[node].is_active) return;
  nodes_[node].is_active = true;
  active_.push_back(node);
}

// Edges whose use changed enter the sums and the factor, or leave them.
template <class P>
void IncrementalModel<P>::apply_changes() {
  for (const std::size_t e : changed_) {
    State& state = states_[e];
    const Edge& edge = graph_.edges[e];
    if (state.is_used == state.is_in_factor) continue;
    for (const std::size_t node : {edge.from, edge.to}) {
      if (state.is_used)
        nodes_[node].edges.push_back(e);
      else
        std::erase(nodes_[node].edges, e);
    }
    if (state.is_used) {
      evaluate(e);
      linearize_anew(e);
    } else {
      change_terms(e, Terms::removed);
      costs_[e] = 0.0;
    }
    sum_gradient(edge.from);
    sum_gradient(edge.to);
  }
  changed_.clear();
}

template <class P>
std::optional<std::size_t> IncrementalModel<P>::refresh() {
  const auto free = cholesky_.refresh();
  broken_ = free.has_value();
  return free ? std::optional(*free + 1) : std::nullopt;
}

template <class P>
std::optional<std::size_t> IncrementalModel<P>::renew() {
  while (cholesky_.size() + 1 < graph_.nodes.size()) (void)cholesky_.add_variable();
  apply_changes();
  if (!broken_) return refresh();
  cholesky_ = IncrementalCholesky(D);
  while (cholesky_.size() + 1 < graph_.nodes.size()) (void)cholesky_.add_variable();
  for (std::size_t e = 0; e < states_.size(); ++e) {
    states_[e].is_in_factor = false;
    if (states_[e].is_used) linearize_anew(e);
  }
  return refresh();
}

template <class P>
std::optional<std::size_t> IncrementalModel<P>::linearize_changed(const std::vector<std::size_t>& edges,
                                                                  double least_change,
                                                                  std::size_t& num_linearized) {
  bool any = false;
  for (const std::size_t e : edges) {
    if (!states_[e].is_used || change(e) <= least_change) continue;
    linearize_anew(e);
    ++num_linearized;
    any = true;
  }
  return any ? refresh() : std::nullopt;
}

template <class P>
std::vector<std::size_t> IncrementalModel<P>::all_edges() const {
  std::vector<std::size_t> all(states_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// Minus the gradient of the nodes where it matters; the others are active no longer.
template <class P>
typename IncrementalModel<P>::Step IncrementalModel<P>::right_side() {
  Step b;
  std::size_t num_active = 0;
  for (const std::size_t node : active_) {
    const Tangent& g = nodes_[node].gradient;
    const auto diagonal = cholesky_.diagonal(variable(node)).diagonal();
    nodes_[node].is_active =
        (g.array().square() / diagonal.array().max(kSmallestDiagonal)).sum() > kSmallestGain;
    if (!nodes_[node].is_active) continue;
    active_[num_active++] = node;
    b.variables.push_back(variable(node));
    for (const double x : g) b.rows.push_back(-x);
  }
  active_.resize(num_active);
  return b;
}

template <class P>
typename IncrementalModel<P>::Step IncrementalModel<P>::step() {
  const Step b = right_side();
  return b.variables.empty() ? Step{} : cholesky_.solve(b, kSmallestStep);
}

// Minus gradient times step.
template <class P>
double IncrementalModel<P>::gain(const Step& step) const {
  double gain = 0.0;
  for (std::size_t k = 0; k < step.variables.size(); ++k)
    gain -= nodes_[step.variables[k] + 1].gradient.dot(Eigen::Map<const Tangent>(step.rows.data() + k * D));
  return gain;
}

// Where both nodes of an edge move as one, its residual stays, but that of its linear model does not: it errs
// by the edge's turn times the displacement, and by its shift times the nodes' turn. What of the step is a
// common motion is not asked, so that this is a bound. Errors matter together, by their chi2.
template <class P>
std::vector<std::size_t> IncrementalModel<P>::stale_for(const Step& step, double gain) {
  constexpr int kTranslation = D == 6 ? 3 : 2;
  ++pass_;
  std::vector<std::pair<std::size_t, double>> errors;
  double sum = 0.0;
  for (std::size_t k = 0; k < step.variables.size(); ++k) {
    const Eigen::Map<const Tangent> d(step.rows.data() + k * D);
    const double moved2 = d.template head<kTranslation>().squaredNorm();
    const double turned2 = d.template tail<D - kTranslation>().squaredNorm();
    if (moved2 + turned2 < kSmallestStep * kSmallestStep) continue;
    for (const std::size_t e : nodes_[step.variables[k] + 1].edges) {
      if (!visit(states_[e].visited_in)) continue;
      const State& state = states_[e];
      const double turn2 = state.turned * state.turned;
      const double error =
          state.weight_of_translation * (turn2 * moved2 + state.moved * state.moved * turned2) +
          state.weight_of_rotation * turn2 * turned2;
      errors.emplace_back(e, error);
      sum += error;
    }
  }
  std::vector<std::size_t> stale;
  if (sum <= kStaleShare * gain) return stale;
  const double smallest = 0.1 * kStaleShare * gain / static_cast<double>(errors.size());
  for (const auto& [e, error] : errors)
    if (error > smallest) stale.push_back(e);
  return stale;
}

template <class P>
typename IncrementalModel<P>::Replaced IncrementalModel<P>::take(const Step& step) {
  Replaced out;
  for (std::size_t k = 0; k < step.variables.size(); ++k) {
    const Eigen::Map<const Tangent> d(step.rows.data() + k * D);
    if (!(d.cwiseAbs().maxCoeff() > kSmallestStep)) continue;
    const std::size_t node = step.variables[k] + 1;
    out.poses.emplace_back(node, poses_[node]);
    poses_[node] = retract(poses_[node], d);
  }
  evaluate_around(out);
  return out;
}

// Edges of the nodes that have moved, and the gradients of these nodes and their neighbours.
template <class P>
void IncrementalModel<P>::evaluate_around(Replaced& replaced) {
  ++pass_;
  std::vector<std::size_t> around;
  for (const auto& [node, pose] : replaced.poses) {
    for (const std::size_t e : nodes_[node].edges) {
      if (!visit(states_[e].visited_in)) continue;
      replaced.edges.push_back(e);
      replaced.cost -= costs_[e];
      evaluate(e);
      replaced.cost += costs_[e];
      for (const std::size_t end : {graph_.edges[e].from, graph_.edges[e].to})
        if (visit(nodes_[end].visited_in)) around.push_back(end);
    }
  }
  for (const std::size_t node : around) sum_gradient(node);
}

template <class P>
void IncrementalModel<P>::put_back(const std::vector<std::pair<std::size_t, P>>& old) {
  Replaced replaced{old, {}, 0.0};
  for (const auto& [node, pose] : old) poses_[node] = pose;
  evaluate_around(replaced);
}

template <class P>
typename IncrementalModel<P>::Replaced IncrementalModel<P>::take_all(const std::vector<P>& poses) {
  Replaced out;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    out.poses.emplace_back(i, poses_[i]);
    poses_[i] = poses[i];
  }
  evaluate_around(out);
  return out;
}

template class IncrementalModel<Pose>;
template class IncrementalModel<Pose2>;

}  // namespace adit
