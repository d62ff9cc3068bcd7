// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental_cholesky.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/posegraph/block_symbolic.hpp"
#include "adit/posegraph/dense_kernels.hpp"

namespace adit {
namespace {

using Index = std::size_t;
constexpr double kMinPivot = 1e-13;  // relative to the diagonal element that the pivot started from
constexpr Index kLarge = 300;        // variables, from which on a shallow tree is worth finding

}  // namespace

Index IncrementalCholesky::new_block() {
  if (!free_blocks_.empty()) {
    const Index b = free_blocks_.back();
    free_blocks_.pop_back();
    return b;
  }
  blocks_.resize(blocks_.size() + d_ * d_, 0.0);
  uses_.push_back(0);
  return uses_.size() - 1;
}

Index IncrementalCholesky::add_variable() {
  const Index v = size();
  diagonal_.push_back(new_block());
  neighbours_.emplace_back();
  clique_of_.push_back(kNone);
  row_of_.push_back(kNone);
  work_.resize(work_.size() + d_, 0.0);
  touched_.push_back(v);
  return v;
}

void IncrementalCholesky::add(Index i, Index j, const Eigen::Ref<const Eigen::MatrixXd>& term) {
  ADIT_CHECK(i < size() && j < size(), "two variables that have been added");
  const auto d = static_cast<Eigen::Index>(d_);
  const auto at = [&](Index b) { return Eigen::Map<Eigen::MatrixXd>(block(b), d, d); };
  dirty_.push_back(i);
  if (i == j) {
    at(diagonal_[i]) += term;
    return;
  }
  dirty_.push_back(j);
  auto known = std::ranges::find(neighbours_[i], j, &Neighbour::variable);
  if (known == neighbours_[i].end()) {
    touched_.push_back(i);
    touched_.push_back(j);
    const Index b = new_block();
    neighbours_[j].push_back({i, b, false});
    known = neighbours_[i].insert(neighbours_[i].end(), {j, b, true});
  }
  ++uses_[known->block];
  if (known->transposed)
    at(known->block) += term;
  else
    at(known->block) += term.transpose();
}

void IncrementalCholesky::remove(Index i, Index j, const Eigen::Ref<const Eigen::MatrixXd>& term) {
  add(i, j, -term);
  if (i == j) return;
  const Index b = std::ranges::find(neighbours_[i], j, &Neighbour::variable)->block;
  uses_[b] -= 2;
  if (uses_[b] == 0) unused_.emplace_back(i, j);
}

// Only now: a term that was replaced by another has left its pair as it was.
void IncrementalCholesky::forget_unused() {
  for (const auto& [i, j] : unused_) {
    const auto known = std::ranges::find(neighbours_[i], j, &Neighbour::variable);
    if (known == neighbours_[i].end() || uses_[known->block] > 0) continue;
    std::fill_n(block(known->block), d_ * d_, 0.0);
    free_blocks_.push_back(known->block);
    neighbours_[i].erase(known);
    neighbours_[j].erase(std::ranges::find(neighbours_[j], i, &Neighbour::variable));
  }
  unused_.clear();
}

IncrementalCholesky::Removed IncrementalCholesky::remove_touched() {
  std::ranges::sort(touched_);
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  std::vector<Index> affected;
  for (const Index v : touched_) {
    for (Index c = clique_of_[v]; c != kNone && !cliques_[c].is_marked; c = cliques_[c].parent) {
      cliques_[c].is_marked = true;
      affected.push_back(c);
    }
  }
  std::ranges::sort(affected);
  Removed removed;
  const auto is_touched = [&](Index v) { return std::ranges::binary_search(touched_, v); };
  for (const Index c : affected) {
    std::ranges::copy_if(cliques_[c].own, std::back_inserter(removed.variables), std::not_fn(is_touched));
    for (const Index child : cliques_[c].children) {
      if (!cliques_[child].is_marked) removed.orphans.push_back(child);
    }
  }
  for (const Index c : affected) {
    cliques_[c] = {};
    free_cliques_.push_back(c);
  }
  removed.num_touched = touched_.size();
  removed.variables.insert(removed.variables.end(), touched_.begin(), touched_.end());
  touched_.clear();
  return removed;
}

std::optional<Index> IncrementalCholesky::refresh() {
  num_renewed_ = 0;
  forget_unused();
  std::vector<Index> renewed;
  if (!touched_.empty()) {
    const Removed removed = remove_touched();
    for (Index l = 0; l < removed.variables.size(); ++l) row_of_[removed.variables[l]] = l;
    const BlockSymbolic symbolic = analyze(removed);
    renewed = make_cliques(symbolic, removed.variables);
    adopt(removed.orphans, symbolic);
    for (const Index v : removed.variables) row_of_[v] = kNone;
  }
  // Where only numbers have changed, the order of elimination stays. New cliques are above all others.
  std::vector<Index> order = paths_to_root(dirty_);
  dirty_.clear();
  for (const Index c : renewed) cliques_[c].is_marked = true;
  std::erase_if(order, [&](Index c) { return cliques_[c].is_marked; });
  for (const Index c : renewed) cliques_[c].is_marked = false;
  std::ranges::reverse(order);
  order.insert(order.end(), renewed.begin(), renewed.end());
  num_renewed_ = order.size();
  for (const Index c : order) {
    if (const auto free = eliminate(cliques_[c])) return free;
  }
  return std::nullopt;
}

// The part to renew as a matrix of its own, row_of_ being the place of a variable in it: its terms, and a
// full block for what each orphan hands up.
BlockSymbolic IncrementalCholesky::analyze(const Removed& removed) const {
  const std::vector<Index>& variables = removed.variables;
  std::vector<std::pair<Index, Index>> pairs;
  for (Index l = 0; l < variables.size(); ++l) {
    for (const Neighbour& n : neighbours_[variables[l]]) {
      if (row_of_[n.variable] != kNone && row_of_[n.variable] < l) pairs.emplace_back(l, row_of_[n.variable]);
    }
  }
  for (const Index orphan : removed.orphans) {
    const std::vector<Index>& below = cliques_[orphan].below;
    for (Index a = 0; a < below.size(); ++a) {
      for (Index b = 0; b < a; ++b) pairs.emplace_back(row_of_[below[a]], row_of_[below[b]]);
    }
  }
  // Where nearly all is new, no variable deserves the last place.
  const bool few = 4 * removed.num_touched < variables.size();
  const auto ordering = variables.size() > kLarge ? Ordering::nested_dissection : Ordering::minimum_degree;
  return BlockSymbolic(BlockPattern::of_pairs(variables.size(), std::move(pairs)), ordering,
                       few ? removed.num_touched : 0);
}

// A clique for each supernode, in their order; returns where they are in cliques_.
std::vector<Index> IncrementalCholesky::make_cliques(const BlockSymbolic& symbolic,
                                                     const std::vector<Index>& variables) {
  const auto variable_at = [&](Index position) { return variables[symbolic.old_of_new[position]]; };
  std::vector<Index> place;
  for (const Supernode& node : symbolic.nodes) {
    if (free_cliques_.empty()) {
      free_cliques_.push_back(cliques_.size());
      cliques_.emplace_back();
    }
    place.push_back(free_cliques_.back());
    free_cliques_.pop_back();
    Clique& clique = cliques_[place.back()];
    for (Index k = 0; k < node.width; ++k) {
      clique.own.push_back(variable_at(node.first + k));
      clique_of_[clique.own.back()] = place.back();
    }
    for (const Index position : node.below) clique.below.push_back(variable_at(position));
    for (const Index child : node.children) {
      clique.children.push_back(place[child]);
      cliques_[place[child]].parent = place.back();
    }
  }
  return place;
}

// The new parent of an orphan owns the variable below it that is eliminated first.
void IncrementalCholesky::adopt(const std::vector<Index>& orphans, const BlockSymbolic& symbolic) {
  const auto position = [&](Index variable) { return symbolic.new_of_old[row_of_[variable]]; };
  for (const Index orphan : orphans) {
    const Index parent = clique_of_[*std::ranges::min_element(cliques_[orphan].below, {}, position)];
    cliques_[orphan].parent = parent;
    cliques_[parent].children.push_back(orphan);
  }
}

std::optional<Index> IncrementalCholesky::eliminate(Clique& clique) {
  const Index width = clique.own.size();
  const Index rows = (width + clique.below.size()) * d_;
  const Index columns = width * d_;
  const Index below = rows - columns;
  for (Index k = 0; k < width; ++k) row_of_[clique.own[k]] = k;
  for (Index k = 0; k < clique.below.size(); ++k) row_of_[clique.below[k]] = width + k;

  clique.panel.assign(rows * columns, 0.0);
  std::vector<double> min_pivot(columns);
  for (Index k = 0; k < width; ++k) {
    const auto place = [&](Index row, const double* b, bool transposed) {
      for (Index j = 0; j < d_; ++j) {
        double* to = clique.panel.data() + (k * d_ + j) * rows + row * d_;
        for (Index i = 0; i < d_; ++i) to[i] = transposed ? b[j + i * d_] : b[i + j * d_];
      }
    };
    const double* own = block(diagonal_[clique.own[k]]);
    place(k, own, false);
    for (Index i = 0; i < d_; ++i) min_pivot[k * d_ + i] = kMinPivot * own[i * d_ + i];
    for (const Neighbour& n : neighbours_[clique.own[k]]) {
      const Index row = row_of_[n.variable];
      if (row != kNone && row > k) place(row, block(n.block), n.transposed);
    }
  }
  for (const Index child : clique.children) add_update(cliques_[child], clique, Part::columns);
  const Index done = dense::factorize_panel(clique.panel.data(), rows, rows, columns, min_pivot.data());
  if (done == columns) {
    clique.update.assign(below * below, 0.0);
    dense::PackedPanel<double> packed;
    packed.pack(clique.panel.data() + columns, rows, below, columns);
    dense::subtract_outer_product(clique.update.data(), below, packed, 0, below, dense::Into::replace);
    for (const Index child : clique.children) add_update(cliques_[child], clique, Part::update);
  }
  for (const Index v : clique.own) row_of_[v] = kNone;
  for (const Index v : clique.below) row_of_[v] = kNone;
  return done == columns ? std::nullopt : std::optional(clique.own[done / d_]);
}

// Adds what of the child's update belongs to this part of the parent. The child may list its rows in another
// order than the parent.
void IncrementalCholesky::add_update(const Clique& child, Clique& parent, Part part) const {
  const Index width = parent.own.size();
  const bool square = part == Part::columns;
  std::vector<double>& to = square ? parent.panel : parent.update;
  const Index skipped = square ? 0 : width;
  const Index to_rows = (width + parent.below.size() - skipped) * d_;
  const Index from_rows = child.below.size() * d_;
  for (Index b = 0; b < child.below.size(); ++b) {
    for (Index a = b; a < child.below.size(); ++a) {
      const Index row_a = row_of_[child.below[a]];
      const Index row_b = row_of_[child.below[b]];
      const bool turned = row_a < row_b;
      const Index row = turned ? row_b : row_a;
      const Index column = turned ? row_a : row_b;
      if ((column < width) != square) continue;
      const double* from = child.update.data() + b * d_ * from_rows + a * d_;
      double* target = to.data() + (column - skipped) * d_ * to_rows + (row - skipped) * d_;
      for (Index j = 0; j < d_; ++j) {
        for (Index i = 0; i < d_; ++i)
          target[j * to_rows + i] += turned ? from[i * from_rows + j] : from[j * from_rows + i];
      }
    }
  }
}

}  // namespace adit
