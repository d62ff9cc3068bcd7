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
#include "adit/posegraph/incremental_cholesky.hpp"

namespace adit {
namespace {

constexpr double kSlowGain = 0.5;     // a step after which more than this share of the gain is left is slow
constexpr double kGainNoise = 1e-12;  // gain per edge, in chi2, below which nothing is left
constexpr double kSmallestGain =
    1e-13;  // in chi2, by one node alone, below which its gradient is left for later
constexpr double kSmallestStep = 1e-5;  // metres and radians: what moves less stays
// Change of an edge's relative pose since it was linearized, radians and share of its length plus a metre.
constexpr double kStaleChange = 0.1;   // linearized anew
constexpr double kStaleShare = 0.1;    // of the gain: error of the linear model that is tolerated
constexpr double kFreshChange = 1e-3;  // not even where steps converge slowly

}  // namespace

template <class P>
struct IncrementalOptimizer<P>::Impl {
  static constexpr int D = P::kDof;
  using Tangent = typename P::Tangent;
  using Matrix = typename P::Jacobian;

  // An edge at the present poses, and as the factor has it.
  struct State {
    bool is_used = false;
    bool is_in_factor = false;
    P T_linear;  // T_from_to where the factor's terms were linearized
    Tangent from = Tangent::Zero();
    Tangent to = Tangent::Zero();
    double cost = 0.0;
    double change = 0.0;  // of the relative pose since then, radians and share of its length plus a metre
  };
  struct Node {
    Tangent gradient = Tangent::Zero();
    std::vector<std::size_t> edges;  // in use
    bool is_active = false;
    std::size_t moved_in = 0;  // update
  };

  OptimizerConfig config;
  BasicPoseGraph<P> graph;
  std::vector<P> poses;
  std::vector<Node> nodes;
  std::vector<State> states;
  std::vector<std::size_t> changed;               // edges whose use changed since the last update
  std::vector<std::size_t> active;                // nodes whose gradient may matter
  std::vector<std::pair<std::size_t, P>> before;  // poses at the start of this update, of nodes moved
  std::vector<std::size_t> visited_in;            // step that last evaluated each edge
  std::size_t num_updates = 0;
  std::size_t num_steps = 0;
  IncrementalCholesky cholesky{D};
  bool broken = false;  // the last refresh failed: the factor is of no use

  // Variable of a node: the first has none.
  static std::size_t variable(std::size_t node) { return node - 1; }

  [[nodiscard]] P relative(const Edge& edge) const { return poses[edge.from].inverse() * poses[edge.to]; }

  // The terms of an edge, as it was linearized: residuals and Jacobians depend on the relative pose only.
  enum class Terms { added, removed };
  void change_terms(std::size_t e, Terms terms) {
    const Edge& edge = graph.edges[e];
    const BetweenFactor<P> f = linearize(edge.T_from_to, states[e].T_linear);
    const Matrix from_information = f.d_from.transpose() * edge.information;
    const auto change = [&](std::size_t i, std::size_t j, const Matrix& term) {
      if (i == 0 || j == 0) return;
      if (terms == Terms::added)
        cholesky.add(variable(i), variable(j), term);
      else
        cholesky.remove(variable(i), variable(j), term);
    };
    change(edge.from, edge.from, from_information * f.d_from);
    change(edge.to, edge.to, f.d_to.transpose() * edge.information * f.d_to);
    change(edge.from, edge.to, from_information * f.d_to);
    states[e].is_in_factor = terms == Terms::added;
  }

  void linearize_anew(std::size_t e) {
    if (states[e].is_in_factor) change_terms(e, Terms::removed);
    states[e].T_linear = relative(graph.edges[e]);
    states[e].change = 0.0;
    change_terms(e, Terms::added);
  }

  // Radians, and share of the length plus a metre.
  [[nodiscard]] static double change_between(const P& T_linear, const P& now) {
    const double length = 1.0 + T_linear.translation().norm();
    const double moved = (now.translation() - T_linear.translation()).norm() / length;
    if constexpr (D == 6)
      return std::max(moved, 2.0 * (now.rotation().coeffs() - T_linear.rotation().coeffs()).norm());
    else
      return std::max(moved, std::abs(wrap_angle(now.theta() - T_linear.theta())));
  }

  void activate(std::size_t node) {
    if (node == 0 || nodes[node].is_active) return;
    nodes[node].is_active = true;
    active.push_back(node);
  }

  void evaluate(std::size_t e) {
    const Edge& edge = graph.edges[e];
    State& state = states[e];
    const P now = relative(edge);
    const BetweenFactor<P> f = linearize(edge.T_from_to, now);
    state.change = change_between(state.T_linear, now);
    const Tangent weighted = edge.information * f.residual;
    state.cost = f.residual.dot(weighted);
    state.from.noalias() = f.d_from.transpose() * weighted;
    state.to.noalias() = f.d_to.transpose() * weighted;
  }

  void sum_gradient(std::size_t node) {
    Tangent sum = Tangent::Zero();
    for (const std::size_t e : nodes[node].edges)
      sum += graph.edges[e].from == node ? states[e].from : states[e].to;
    nodes[node].gradient = sum;
    activate(node);
  }

  // Edges whose use changed enter the sums and the factor, or leave them.
  void apply_changes() {
    for (const std::size_t e : changed) {
      State& state = states[e];
      const Edge& edge = graph.edges[e];
      if (state.is_used == state.is_in_factor) continue;
      for (const std::size_t node : {edge.from, edge.to}) {
        if (state.is_used)
          nodes[node].edges.push_back(e);
        else
          std::erase(nodes[node].edges, e);
      }
      if (state.is_used) {
        evaluate(e);
        linearize_anew(e);
      } else {
        change_terms(e, Terms::removed);
        state.cost = 0.0;
      }
      sum_gradient(edge.from);
      sum_gradient(edge.to);
    }
    changed.clear();
  }

  [[nodiscard]] bool refresh(Update& u) {
    const auto free = cholesky.refresh();
    u.num_renewed += cholesky.num_renewed();
    u.num_supernodes = cholesky.num_supernodes();
    broken = free.has_value();
    if (!free) return true;
    u.status = SolveStatus::singular;
    u.reason = format("the edges leave node {} free to move: give them information in every direction",
                      graph.nodes[*free + 1].key);
    return false;
  }

  // A factor from nothing.
  [[nodiscard]] bool renew_all(Update& u) {
    cholesky = IncrementalCholesky(D);
    while (cholesky.size() + 1 < graph.nodes.size()) (void)cholesky.add_variable();
    for (std::size_t e = 0; e < states.size(); ++e) {
      states[e].is_in_factor = false;
      if (states[e].is_used) linearize_anew(e);
    }
    return refresh(u);
  }

  // Edges, of those given, that have changed by more than this.
  template <class Edges>
  [[nodiscard]] bool renew_stale(Update& u, const Edges& edges, double change) {
    bool any = false;
    for (const std::size_t e : edges) {
      if (!states[e].is_used || states[e].change <= change) continue;
      linearize_anew(e);
      ++u.num_linearized;
      any = true;
    }
    return !any || refresh(u);
  }

  // Minus the gradient of the nodes where it matters; the others are active no longer.
  [[nodiscard]] IncrementalCholesky::Sparse right_side() {
    IncrementalCholesky::Sparse b;
    std::vector<std::size_t> still_active;
    for (const std::size_t node : active) {
      const Tangent& g = nodes[node].gradient;
      const auto diagonal = cholesky.diagonal(variable(node)).diagonal();
      nodes[node].is_active = (g.array().square() / diagonal.array().max(kGainNoise)).sum() > kSmallestGain;
      if (!nodes[node].is_active) continue;
      still_active.push_back(node);
      b.variables.push_back(variable(node));
      for (const double x : g) b.rows.push_back(-x);
    }
    active = std::move(still_active);
    return b;
  }

  [[nodiscard]] double total_cost() const {
    double sum = 0.0;
    for (const State& state : states) sum += state.is_used ? state.cost : 0.0;
    return sum;
  }

  // Edges that were linearized where this step makes their model err: by change times displacement. They
  // matter together, by their chi2 against the gain.
  [[nodiscard]] std::vector<std::size_t> stale_for(const IncrementalCholesky::Sparse& step, double gain) {
    ++num_steps;
    visited_in.resize(graph.edges.size(), 0);
    std::vector<std::pair<std::size_t, double>> errors;
    double sum = 0.0;
    for (std::size_t k = 0; k < step.variables.size(); ++k) {
      const double d2 = Eigen::Map<const Tangent>(step.rows.data() + k * D).squaredNorm();
      if (d2 < kSmallestStep * kSmallestStep) continue;
      for (const std::size_t e : nodes[step.variables[k] + 1].edges) {
        if (visited_in[e] == num_steps) continue;
        visited_in[e] = num_steps;
        const double change = states[e].change;
        const double error = change * change * d2 * graph.edges[e].information.trace();
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

  // What a step replaced.
  struct Replaced {
    std::vector<std::pair<std::size_t, P>> poses;
    std::vector<std::size_t> edges;
    double cost = 0.0;  // by how much that of the edges rose
  };
  [[nodiscard]] Replaced take(Update& u, const IncrementalCholesky::Sparse& step) {
    Replaced out;
    ++num_steps;
    visited_in.resize(graph.edges.size(), 0);
    for (std::size_t k = 0; k < step.variables.size(); ++k) {
      const Eigen::Map<const Tangent> d(step.rows.data() + k * D);
      if (!(d.cwiseAbs().maxCoeff() > kSmallestStep)) continue;
      const std::size_t node = step.variables[k] + 1;
      out.poses.emplace_back(node, poses[node]);
      poses[node] = retract(poses[node], d);
      for (const std::size_t e : nodes[node].edges) {
        if (visited_in[e] == num_steps) continue;
        visited_in[e] = num_steps;
        out.edges.push_back(e);
      }
    }
    u.num_evaluated += out.edges.size();
    for (const std::size_t e : out.edges) {
      out.cost -= states[e].cost;
      evaluate(e);
      out.cost += states[e].cost;
    }
    sum_gradients(out);
    return out;
  }

  void sum_gradients(const Replaced& replaced) {
    for (const auto& [node, pose] : replaced.poses) sum_gradient(node);
    for (const std::size_t e : replaced.edges) {
      sum_gradient(graph.edges[e].from);
      sum_gradient(graph.edges[e].to);
    }
  }

  void keep(const Replaced& replaced) {
    for (const auto& [node, pose] : replaced.poses) {
      if (nodes[node].moved_in == num_updates) continue;
      nodes[node].moved_in = num_updates;
      before.emplace_back(node, pose);
    }
  }

  void put_back(const std::vector<std::pair<std::size_t, P>>& old) {
    ++num_steps;
    for (const auto& [node, pose] : old) poses[node] = pose;
    Replaced replaced{old, {}, 0.0};
    for (const auto& [node, pose] : old) {
      for (const std::size_t e : nodes[node].edges) {
        if (visited_in[e] == num_steps) continue;
        visited_in[e] = num_steps;
        replaced.edges.push_back(e);
        evaluate(e);
      }
    }
    sum_gradients(replaced);
  }

  [[nodiscard]] std::vector<std::size_t> all_edges() const {
    std::vector<std::size_t> all(states.size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = e;
    return all;
  }

  void minimize(Update& u) {
    double last_gain = std::numeric_limits<double>::infinity();
    bool all_are_fresh = false;
    u.status = SolveStatus::max_iterations;
    u.reason = format("stopped after {} iterations", config.max_iterations);
    while (u.iterations < config.max_iterations) {
      const IncrementalCholesky::Sparse b = right_side();
      double gain = 0.0;
      IncrementalCholesky::Sparse step;
      if (!b.variables.empty()) {
        ++u.iterations;
        step = cholesky.solve(b, kSmallestStep);
        // The right side's variables come among the first of the solution, in another order.
        gain = gain_of(step);
      }
      if (gain <=
          std::max(config.relative_tolerance * u.cost, kGainNoise * static_cast<double>(states.size())))
        return converge(u, "the cost no longer falls");
      if (const auto stale = stale_for(step, gain); !stale.empty()) {
        if (!renew_stale(u, stale, 0.0)) return;
        continue;
      }
      const Replaced replaced = take(u, step);
      if (replaced.poses.empty()) return converge(u, "the steps are below a micrometre");
      const bool falls = replaced.cost < 0.0;
      if (falls) {
        keep(replaced);
        u.cost += replaced.cost;
        if (!renew_stale(u, replaced.edges, kStaleChange)) return;
      } else {
        put_back(replaced.poses);
        if (all_are_fresh) return solve_as_a_whole(u);
      }
      if (!falls || gain > kSlowGain * last_gain) {
        all_are_fresh = !falls;
        if (!(falls ? renew_stale(u, replaced.edges, kFreshChange)
                    : renew_stale(u, all_edges(), kFreshChange)))
          return;
      }
      last_gain = gain;
    }
  }

  // By how much the linear model falls: minus gradient times step.
  [[nodiscard]] double gain_of(const IncrementalCholesky::Sparse& step) const {
    double gain = 0.0;
    for (std::size_t k = 0; k < step.variables.size(); ++k)
      gain -= nodes[step.variables[k] + 1].gradient.dot(Eigen::Map<const Tangent>(step.rows.data() + k * D));
    return gain;
  }

  // After a full Gauss-Newton step that climbs: Levenberg-Marquardt on the whole graph.
  void solve_as_a_whole(Update& u) {
    BasicPoseGraph<P> whole = graph;
    std::vector<double> weights(states.size());
    for (std::size_t i = 0; i < poses.size(); ++i) whole.nodes[i].pose = poses[i];
    for (std::size_t e = 0; e < states.size(); ++e) weights[e] = states[e].is_used ? 1.0 : 0.0;
    Solution<P> solution = optimize(whole, config, weights);
    u.iterations += solution.iterations;
    u.status = solution.status;
    u.reason = solution.reason;
    if (!solution.ok() || solution.cost_final >= u.cost) return;
    const P back =
        poses.front() * solution.poses.front().inverse();  // another anchor, if keys are not in order
    Replaced replaced;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      replaced.poses.emplace_back(i, poses[i]);
      poses[i] = back * solution.poses[i];
    }
    keep(replaced);
    for (std::size_t e = 0; e < states.size(); ++e)
      if (states[e].is_used) evaluate(e);
    for (std::size_t i = 0; i < nodes.size(); ++i) sum_gradient(i);
    u.cost = solution.cost_final;
    (void)renew_stale(u, all_edges(), kFreshChange);
  }

  static void converge(Update& u, const char* why) {
    u.status = SolveStatus::converged;
    u.reason = why;
  }

  // The first edge that was put in use and must not be.
  [[nodiscard]] bool refuse_indefinite(Update& u) {
    for (const std::size_t e : changed) {
      if (!states[e].is_used || states[e].is_in_factor) continue;
      const Edge& edge = graph.edges[e];
      BasicPoseGraph<P> one;
      one.nodes.resize(2);
      one.edges = {{0, 1, edge.T_from_to, edge.information, edge.kind}};
      if (indefinite_edges(one).empty()) continue;
      states[e].is_used = false;
      u.status = SolveStatus::indefinite_information;
      u.reason = format("the information matrix of edge {} -> {} is indefinite", graph.nodes[edge.from].key,
                        graph.nodes[edge.to].key);
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
  impl_->graph.nodes.push_back({key, pose});
  impl_->poses.push_back(pose);
  impl_->nodes.emplace_back();
  return impl_->poses.size() - 1;
}

template <class P>
std::size_t IncrementalOptimizer<P>::add_edge(const Edge& edge, EdgeUse use) {
  Impl& impl = *impl_;
  ADIT_CHECK(edge.from < impl.poses.size() && edge.to < impl.poses.size() && edge.from != edge.to,
             "an edge joins two nodes that have been added");
  impl.graph.edges.push_back(edge);
  impl.states.emplace_back();
  set_use(impl.states.size() - 1, use);
  return impl.states.size() - 1;
}

template <class P>
void IncrementalOptimizer<P>::set_use(std::size_t edge, EdgeUse use) {
  const bool is_used = use == EdgeUse::in_use;
  ADIT_CHECK(edge < impl_->states.size(), "an edge that has been added");
  if (impl_->states[edge].is_used == is_used) return;
  impl_->states[edge].is_used = is_used;
  impl_->changed.push_back(edge);
}

template <class P>
bool IncrementalOptimizer<P>::is_used(std::size_t edge) const {
  return impl_->states.at(edge).is_used;
}

template <class P>
typename IncrementalOptimizer<P>::Update IncrementalOptimizer<P>::update() {
  Update u;
  Impl& impl = *impl_;
  if (impl.graph.nodes.size() < 2) return u;
  ++impl.num_updates;
  impl.before.clear();
  if (impl.refuse_indefinite(u)) return u;
  while (impl.cholesky.size() + 1 < impl.graph.nodes.size()) (void)impl.cholesky.add_variable();
  impl.apply_changes();
  if (!(impl.broken ? impl.renew_all(u) : impl.refresh(u))) return u;
  u.cost = impl.total_cost();
  if (!std::isfinite(u.cost)) {
    u.status = SolveStatus::non_finite;
    u.reason = "the cost of the start is not a finite number";
    return u;
  }
  impl.minimize(u);
  if (u.status != SolveStatus::converged && u.status != SolveStatus::max_iterations)
    impl.put_back(impl.before);
  for (const auto& [node, pose] : impl.before) u.moved.push_back(node);
  std::ranges::sort(u.moved);
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
    const Edge& edge = impl_->graph.edges.at(edges[k]);
    const auto at = static_cast<Eigen::Index>(k) * D;
    const BetweenFactor<P> f = linearize(edge.T_from_to, impl_->relative(edge));
    out.residual.segment(at, D) = f.residual;
    for (const auto& [node, jacobian] : {std::pair(edge.from, f.d_from), std::pair(edge.to, f.d_to)}) {
      if (node == 0) continue;
      const auto known = std::ranges::find(variables, Impl::variable(node));
      const auto row = static_cast<Eigen::Index>(known - variables.begin()) * D;
      if (known == variables.end()) variables.push_back(Impl::variable(node));
      columns.block(row, at, D, D) += jacobian.transpose();
    }
  }
  columns.conservativeResize(static_cast<Eigen::Index>(variables.size()) * D, rows);
  out.covariance = impl_->cholesky.quadratic_form(variables, columns);
  return out;
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
