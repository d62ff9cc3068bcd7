// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Solving with the factor of IncrementalCholesky, where the right side or the solution is sparse.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/core/check.hpp"
#include "adit/posegraph/dense_kernels.hpp"
#include "adit/posegraph/incremental_cholesky.hpp"

namespace adit {
namespace {

using Index = std::size_t;

// For a handful of numbers, where the call of memmove would cost more than the copy.
double* copy_few(const double* from, Index n, double* to) {
  for (Index i = 0; i < n; ++i) to[i] = from[i];
  return to + n;
}

}  // namespace

std::vector<Index> IncrementalCholesky::paths_to_root(const std::vector<Index>& variables) {
  ADIT_CHECK(touched_.empty(), "refresh comes first");
  std::vector<Index> order;
  std::vector<Index> ends;  // of each path in `order`
  for (const Index v : variables) {
    for (Index c = clique_of_[v]; c != kNone && !cliques_[c].is_marked; c = cliques_[c].parent) {
      cliques_[c].is_marked = true;
      order.push_back(c);
    }
    if (ends.empty() || order.size() > ends.back()) ends.push_back(order.size());
  }
  // Each path climbs, and ends below one that came before it.
  Index begin = 0;
  for (const Index end : ends) {
    std::reverse(order.begin() + static_cast<std::ptrdiff_t>(begin),
                 order.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  for (const Index c : order) cliques_[c].is_marked = false;
  return order;
}

// L11 y = b for the clique's own rows of `work`, and what they leave for the rows below.
void IncrementalCholesky::forward(const Clique& clique, double* work) {
  const Index columns = clique.own.size() * d_;
  front_.assign(columns + clique.below.size() * d_, 0.0);
  double* to = front_.data();
  for (const Index v : clique.own) to = copy_few(work + v * d_, d_, to);
  dense::solve_lower(clique.panel.data(), front_.size(), columns, front_.data());
  const double* from = front_.data();
  for (const Index v : clique.own) {
    copy_few(from, d_, work + v * d_);
    from += d_;
  }
  for (const Index v : clique.below) {
    for (Index i = 0; i < d_; ++i) work[v * d_ + i] += *from++;
  }
}

void IncrementalCholesky::backward(const Clique& clique, double* work) {
  const Index columns = clique.own.size() * d_;
  front_.resize(columns + clique.below.size() * d_);
  double* to = front_.data();
  for (const Index v : clique.own) to = copy_few(work + v * d_, d_, to);
  for (const Index v : clique.below) to = copy_few(work + v * d_, d_, to);
  dense::solve_lower_transposed(clique.panel.data(), front_.size(), columns, front_.data());
  const double* from = front_.data();
  for (const Index v : clique.own) {
    copy_few(from, d_, work + v * d_);
    from += d_;
  }
}

// All cliques of the paths, since their right sides are not zero, and what hangs from them as far as it
// moves, which is added to `order`.
void IncrementalCholesky::backward_from(std::vector<Index>& order, double threshold) {
  for (const Index c : order) cliques_[c].is_marked = true;
  const auto moves = [&](const Clique& clique) {
    return std::ranges::any_of(clique.below, [&](Index v) {
      return std::any_of(work_.data() + v * d_, work_.data() + (v + 1) * d_,
                         [&](double x) { return std::abs(x) > threshold; });
    });
  };
  const Index num_on_paths = order.size();
  for (const Index c : order) backward(cliques_[c], work_.data());
  for (Index k = 0; k < order.size(); ++k) {
    const Index c = order[k];
    if (k >= num_on_paths) backward(cliques_[c], work_.data());
    for (const Index child : cliques_[c].children)
      if (!cliques_[child].is_marked && moves(cliques_[child])) order.push_back(child);
  }
  for (const Index c : order) cliques_[c].is_marked = false;
}

IncrementalCholesky::PartialSolution IncrementalCholesky::solve(const Sparse& right_side, double threshold,
                                                                double least_gain) {
  for (Index k = 0; k < right_side.variables.size(); ++k)
    std::copy_n(right_side.rows.data() + k * d_, d_, work_.data() + right_side.variables[k] * d_);
  std::vector<Index> order = paths_to_root(right_side.variables);
  PartialSolution out;
  for (Index k = order.size(); k-- > 0;) {
    forward(cliques_[order[k]], work_.data());
    const Index columns = cliques_[order[k]].own.size() * d_;
    out.gain += std::inner_product(front_.data(), front_.data() + columns, front_.data(), 0.0);
  }
  const bool is_worth_it = out.gain > least_gain;
  if (is_worth_it) backward_from(order, threshold);
  for (const Index c : order) {
    for (const Index v : cliques_[c].own) {
      double* const rows = work_.data() + v * d_;
      if (is_worth_it) {
        out.x.variables.push_back(v);
        out.x.rows.insert(out.x.rows.end(), rows, rows + d_);
      }
      std::fill_n(rows, d_, 0.0);
    }
  }
  return out;
}

Eigen::VectorXd IncrementalCholesky::solve(const Eigen::VectorXd& right_side) {
  ADIT_CHECK(right_side.size() == static_cast<Eigen::Index>(size() * d_), "one row for each scalar variable");
  Sparse all{std::vector<Index>(size()), {right_side.data(), right_side.data() + right_side.size()}};
  std::iota(all.variables.begin(), all.variables.end(), Index{0});
  const Sparse solution = solve(all, 0.0).x;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right_side.size());
  for (Index k = 0; k < solution.variables.size(); ++k)
    std::copy_n(solution.rows.data() + k * d_, d_, x.data() + solution.variables[k] * d_);
  return x;
}

Eigen::MatrixXd IncrementalCholesky::quadratic_form(const std::vector<Index>& variables,
                                                    const Eigen::MatrixXd& columns) {
  const std::vector<Index> order = paths_to_root(variables);
  Index height = 0;
  for (const Index c : order) height += cliques_[c].own.size() * d_;
  Eigen::MatrixXd y(static_cast<Eigen::Index>(height), columns.cols());
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    for (Index k = 0; k < variables.size(); ++k)
      std::copy_n(columns.col(column).data() + k * d_, d_, work_.data() + variables[k] * d_);
    double* to = y.col(column).data();
    for (Index k = order.size(); k-- > 0;) {
      forward(cliques_[order[k]], work_.data());
      for (const Index v : cliques_[order[k]].own) {
        to = std::copy_n(work_.data() + v * d_, d_, to);
        std::fill_n(work_.data() + v * d_, d_, 0.0);
      }
    }
  }
  return y.transpose() * y;
}

}  // namespace adit
