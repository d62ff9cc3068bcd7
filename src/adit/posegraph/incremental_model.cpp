// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/posegraph/factors.hpp"

namespace adit {
namespace {

// In chi2, by one node alone, below which its gradient is left for later. Gradients of many nodes add up in
// smooth motions: with 1e-9, steps on manhattan climb.
constexpr double kSmallestGain = 1e-13;
constexpr double kSmallestDiagonal = 1e-12;  // keeps a node that nothing holds out of a division by zero
// Error of the linear model that is tolerated, of the gain. One more step costs less than a factor renewed
// in most places, which 0.1 asks for more often (decision 0029).
constexpr double kStaleShare = 0.5;
constexpr double kNoResidual = 1e-12;  // chi2 that is rounding

// Radians from one rotation to another, for small angles.
double angle_between(const Pose& a, const Pose& b) {
  const auto& p = a.rotation().coeffs();
  const auto& q = b.rotation().coeffs();
  return 2.0 * std::min((p - q).norm(), (p + q).norm());
}
double angle_between(const Pose2& a, const Pose2& b) { return std::abs(wrap_angle(a.theta() - b.theta())); }

Pose between(const Pose& a, const Pose& b) { return a.inverse() * b; }
Pose2 between(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.theta());
  const double s = std::sin(a.theta());
  const Eigen::Vector2d t = b.translation() - a.translation();
  return {c * t.x() + s * t.y(), c * t.y() - s * t.x(), b.theta() - a.theta()};
}

// chi2 of an edge at T_from_to = `now`, and half its derivatives by the perturbations of both nodes.
double gradients(const PoseGraph::Edge& edge, const Pose& now, Vector6& from, Vector6& to) {
  const BetweenFactor<Pose> f = linearize(edge.T_from_to, now);
  const Vector6 weighted = edge.information * f.residual;
  from.noalias() = f.d_from.transpose() * weighted;
  to.noalias() = f.d_to.transpose() * weighted;
  return f.residual.dot(weighted);
}
// The same as by `linearize`, written out: of all edges of a large map it is what an update spends most on.
double gradients(const PoseGraph2::Edge& edge, const Pose2& now, Vector3& from, Vector3& to) {
  const double angle = wrap_angle(now.theta() - edge.T_from_to.theta());
  const double c = std::cos(edge.T_from_to.theta());
  const double s = std::sin(edge.T_from_to.theta());
  const Eigen::Vector2d t = now.translation() - edge.T_from_to.translation();
  const Vector3 r(c * t.x() + s * t.y(), c * t.y() - s * t.x(), angle);
  const Vector3 w = edge.information * r;
  const Eigen::Vector2d turned(c * w.x() - s * w.y(), s * w.x() + c * w.y());  // R_from_to w
  const double ce = std::cos(angle);
  const double se = std::sin(angle);
  from << -turned, turned.x() * now.translation().y() - turned.y() * now.translation().x() - w.z();
  to << ce * w.x() + se * w.y(), ce * w.y() - se * w.x(), w.z();
  return r.dot(w);
}

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
  term_of_.push_back(kNone);
}

template <class P>
void IncrementalModel<P>::set_use(std::size_t edge, bool is_used) {
  if (this->is_used(edge) == is_used) return;
  if (term_of_[edge] == kNone) {
    constexpr int kTranslation = D == 6 ? 3 : 2;
    term_of_[edge] = terms_.size();
    Term& term = terms_.emplace_back();
    costs_.push_back(0.0);
    term.edge = graph_.edges[edge];
    const auto weights = term.edge.information.diagonal();
    term.weight_of_translation = weights.template head<kTranslation>().mean();
    term.weight_of_rotation = weights.template tail<D - kTranslation>().mean();
  }
  terms_[term_of_[edge]].is_used = is_used;
  changed_.push_back(edge);
}

template <class P>
double IncrementalModel<P>::cost() const {
  return std::accumulate(costs_.begin(), costs_.end(), 0.0);
}

// What an edge adds to the Hessian, as it was linearized: Jacobians depend on the relative pose only.
template <class P>
void IncrementalModel<P>::change_factor(Term& term, Change change) {
  using Matrix = typename P::Jacobian;
  const Edge& edge = term.edge;
  const BetweenFactor<P> f = linearize(edge.T_from_to, term.T_linear);
  const Matrix from_information = f.d_from.transpose() * edge.information;
  const auto apply = [&](std::size_t i, std::size_t j, const Matrix& block) {
    if (i == 0 || j == 0) return;
    if (change == Change::added)
      cholesky_.add(variable(i), variable(j), block);
    else
      cholesky_.remove(variable(i), variable(j), block);
  };
  apply(edge.from, edge.from, from_information * f.d_from);
  apply(edge.to, edge.to, f.d_to.transpose() * edge.information * f.d_to);
  apply(edge.from, edge.to, from_information * f.d_to);
  term.is_in_factor = change == Change::added;
}

template <class P>
void IncrementalModel<P>::linearize_anew(Term& term) {
  if (term.is_in_factor) change_factor(term, Change::removed);
  term.T_linear = relative(term.edge);
  term.turned = 0.0;
  term.moved = 0.0;
  change_factor(term, Change::added);
}

template <class P>
double IncrementalModel<P>::change(const Term& term) {
  return std::max(term.turned, term.moved / (1.0 + term.T_linear.translation().norm()));
}

template <class P>
void IncrementalModel<P>::evaluate(std::size_t t) {
  Term& term = terms_[t];
  const Edge& edge = term.edge;
  const P now = between(poses_[edge.from], poses_[edge.to]);
  term.turned = angle_between(term.T_linear, now);
  term.moved = (now.translation() - term.T_linear.translation()).norm();
  costs_[t] = gradients(edge, now, term.from, term.to);
}

template <class P>
void IncrementalModel<P>::sum_gradient(std::size_t node) {
  Tangent sum = Tangent::Zero();
  for (const std::size_t t : nodes_[node].terms)
    sum += terms_[t].edge.from == node ? terms_[t].from : terms_[t].to;
  nodes_[node].gradient = sum;
  if (node == 0 || nodes_[node].is_active) return;
  nodes_[node].is_active = true;
  active_.push_back(node);
}

// Edges whose use changed enter the sums and the factor, or leave them.
template <class P>
void IncrementalModel<P>::apply_changes() {
  has_new_gradient_ = false;
  for (const std::size_t e : changed_) {
    const std::size_t t = term_of_[e];
    Term& term = terms_[t];
    if (term.is_used == term.is_in_factor) continue;
    for (const std::size_t node : {term.edge.from, term.edge.to}) {
      if (term.is_used)
        nodes_[node].terms.push_back(t);
      else
        std::erase(nodes_[node].terms, t);
    }
    if (term.is_used) {
      evaluate(t);
      linearize_anew(term);
      has_new_gradient_ = has_new_gradient_ || costs_[t] > kNoResidual;
    } else {
      has_new_gradient_ = true;
      change_factor(term, Change::removed);
      costs_[t] = 0.0;
    }
    sum_gradient(term.edge.from);
    sum_gradient(term.edge.to);
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
  for (Term& term : terms_) {
    term.is_in_factor = false;
    if (term.is_used) linearize_anew(term);
  }
  return refresh();
}

template <class P>
std::optional<std::size_t> IncrementalModel<P>::linearize_changed(const std::vector<std::size_t>& terms,
                                                                  double least_change,
                                                                  std::size_t& num_linearized) {
  bool any = false;
  for (const std::size_t t : terms) {
    if (!terms_[t].is_used || change(terms_[t]) <= least_change) continue;
    linearize_anew(terms_[t]);
    ++num_linearized;
    any = true;
  }
  return any ? refresh() : std::nullopt;
}

template <class P>
std::vector<std::size_t> IncrementalModel<P>::all_terms() const {
  std::vector<std::size_t> all(terms_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// Minus the gradient of the nodes where it matters; the others are active no longer.
template <class P>
IncrementalCholesky::Sparse IncrementalModel<P>::right_side() {
  IncrementalCholesky::Sparse b;
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
typename IncrementalModel<P>::Step IncrementalModel<P>::step(double least_gain) {
  const IncrementalCholesky::Sparse b = right_side();
  return b.variables.empty() ? Step{} : cholesky_.solve(b, kSmallestStep, least_gain);
}

// Terms in use of these nodes. Where most nodes are meant, in the order in which they lie in memory.
template <class P>
std::vector<std::size_t> IncrementalModel<P>::terms_around(const std::vector<std::size_t>& nodes) {
  std::vector<std::size_t> terms;
  if (2 * nodes.size() > nodes_.size()) {
    for (std::size_t t = 0; t < terms_.size(); ++t)
      if (terms_[t].is_used) terms.push_back(t);
    return terms;
  }
  ++pass_;
  for (const std::size_t node : nodes) {
    for (const std::size_t t : nodes_[node].terms)
      if (visit(terms_[t].visited_in)) terms.push_back(t);
  }
  return terms;
}

// Where both nodes of an edge move as one, its residual stays, but that of its linear model does not: it errs
// by the edge's turn times the displacement, and by its shift times the nodes' turn. What of the step is a
// common motion is not asked, so that this is a bound. Errors matter together, by their chi2.
template <class P>
std::vector<std::size_t> IncrementalModel<P>::stale_for(const Step& step) {
  constexpr int kTranslation = D == 6 ? 3 : 2;
  squares_.resize(nodes_.size(), {});
  std::vector<std::size_t> moved;
  for (std::size_t k = 0; k < step.x.variables.size(); ++k) {
    const Eigen::Map<const Tangent> d(step.x.rows.data() + k * D);
    const Squares squares{d.template head<kTranslation>().squaredNorm(),
                          d.template tail<D - kTranslation>().squaredNorm()};
    if (squares.moved + squares.turned < kSmallestStep * kSmallestStep) continue;
    moved.push_back(step.x.variables[k] + 1);
    squares_[moved.back()] = squares;
  }
  std::vector<std::pair<std::size_t, double>> errors;
  double sum = 0.0;
  for (const std::size_t t : terms_around(moved)) {
    const Term& term = terms_[t];
    const Squares& a = squares_[term.edge.from];
    const Squares& b = squares_[term.edge.to];
    const double turn2 = term.turned * term.turned;
    const double turned2 = std::max(a.turned, b.turned);
    const double error = term.weight_of_translation *
                             (turn2 * std::max(a.moved, b.moved) + term.moved * term.moved * turned2) +
                         term.weight_of_rotation * turn2 * turned2;
    errors.emplace_back(t, error);
    sum += error;
  }
  for (const std::size_t node : moved) squares_[node] = {};
  std::vector<std::size_t> stale;
  if (sum <= kStaleShare * step.gain) return stale;
  const double smallest = 0.1 * kStaleShare * step.gain / static_cast<double>(errors.size());
  for (const auto& [t, error] : errors)
    if (error > smallest) stale.push_back(t);
  return stale;
}

template <class P>
typename IncrementalModel<P>::Replaced IncrementalModel<P>::take(const Step& step) {
  Replaced out;
  for (std::size_t k = 0; k < step.x.variables.size(); ++k) {
    const Eigen::Map<const Tangent> d(step.x.rows.data() + k * D);
    if (!(d.cwiseAbs().maxCoeff() > kSmallestStep)) continue;
    const std::size_t node = step.x.variables[k] + 1;
    out.poses.emplace_back(node, poses_[node]);
    poses_[node] = retract(poses_[node], d);
  }
  evaluate_around(out);
  return out;
}

// Edges of the nodes that have moved, and the gradients of these nodes and their neighbours.
template <class P>
void IncrementalModel<P>::evaluate_around(Replaced& replaced) {
  std::vector<std::size_t> nodes;
  for (const auto& [node, pose] : replaced.poses) nodes.push_back(node);
  replaced.terms = terms_around(nodes);
  ++pass_;
  nodes.clear();
  for (const std::size_t t : replaced.terms) {
    replaced.cost -= costs_[t];
    evaluate(t);
    replaced.cost += costs_[t];
    for (const std::size_t end : {terms_[t].edge.from, terms_[t].edge.to})
      if (visit(nodes_[end].visited_in)) nodes.push_back(end);
  }
  for (const std::size_t node : nodes) sum_gradient(node);
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
