// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/block_cholesky.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/block_symbolic.hpp"
#include "adit/posegraph/dense_kernels.hpp"

namespace adit {
namespace {

using Index = std::size_t;
constexpr Index kNoColumn = Supernode::kNone;

// Relative to the diagonal element that the pivot started from.
template <class Real>
constexpr double kMinPivot = sizeof(Real) == sizeof(double) ? 1e-13 : 1e-6;

// One supernode's part of a factorization. Its own columns lie in the factor, what is left for its parent in
// the update; each lower trapezoid counts.
template <class Real>
class Front {
 public:
  Front(const BlockSymbolic& symbolic, const Supernode& node, Index d, BasicLargeBuffer<Real>& factor,
        BasicLargeBuffer<Real>& updates)
      : symbolic_(symbolic),
        node_(node),
        d_(d),
        rows_(node.height() * d),
        columns_(node.width * d),
        below_(node.below.size() * d),
        factor_(factor.data() + node.factor_offset * d * d),
        updates_(updates.data()),
        update_(updates_ + node.update_offset * d * d) {}

  // Column of the front that is not positive definite, or kNoColumn.
  [[nodiscard]] Index run(const std::vector<double>& values) const {
    std::fill(factor_, factor_ + rows_ * columns_, Real{0});
    for (const Supernode::Scatter& s : node_.scatter) place(values.data() + s.block * d_ * d_, s);
    for (const Index child : node_.children) add_square(symbolic_.nodes[child]);
    const Index done = dense::factorize_panel(factor_, rows_, rows_, columns_, least_pivots(values).data());
    if (done < columns_) return done;
    if (below_ == 0) return kNoColumn;
    dense::PackedPanel<Real> packed;
    packed.pack(factor_ + columns_, rows_, below_, columns_);
    parallel_for(below_, dense::kStripe, [&](Index begin, Index end) {
      dense::subtract_outer_product(update_, below_, packed, begin, end, dense::Into::replace);
    });
    for (const Index child : node_.children) add_rest(symbolic_.nodes[child]);
    return kNoColumn;
  }

 private:
  void place(const double* block, const Supernode::Scatter& s) const {
    for (Index j = 0; j < d_; ++j) {
      Real* to = factor_ + (s.column * d_ + j) * rows_ + s.row * d_;
      for (Index i = 0; i < d_; ++i)
        to[i] = static_cast<Real>(s.transposed ? block[j + i * d_] : block[i + j * d_]);
    }
  }

  // The least pivot that counts as positive, for each column.
  [[nodiscard]] std::vector<Real> least_pivots(const std::vector<double>& values) const {
    std::vector<Real> least(columns_, Real{0});
    for (const Supernode::Scatter& s : node_.scatter) {
      if (s.row != s.column) continue;
      for (Index i = 0; i < d_; ++i)
        least[s.column * d_ + i] =
            static_cast<Real>(kMinPivot<Real> * values[s.block * d_ * d_ + i * d_ + i]);
    }
    return least;
  }

  // A child's update goes to two places: columns of the square, which come first, and the update.
  void add_square(const Supernode& child) const {
    Index bj = 0;
    for (; bj < child.below.size() && child.in_parent[bj] < node_.width; ++bj)
      add_columns(child, bj, {factor_ + child.in_parent[bj] * d_ * rows_, rows_, 0});
  }
  void add_rest(const Supernode& child) const {
    for (Index bj = child.below.size(); bj-- > 0 && child.in_parent[bj] >= node_.width;)
      add_columns(child, bj,
                  {update_ + (child.in_parent[bj] - node_.width) * d_ * below_, below_, node_.width});
  }
  // A block column of the front: `column` holds its rows from block `first_row` on.
  struct Target {
    Real* column;
    Index stride;
    Index first_row;
  };
  void add_columns(const Supernode& child, Index bj, Target to) const {
    const Index height = child.below.size();
    const Real* from = updates_ + child.update_offset * d_ * d_ + bj * d_ * height * d_;
    for (Index j = 0; j < d_; ++j, to.column += to.stride, from += height * d_) {
      for (Index bi = bj; bi < height; ++bi) {
        Real* t = to.column + (child.in_parent[bi] - to.first_row) * d_;
        const Real* x = from + bi * d_;
        for (Index i = 0; i < d_; ++i) t[i] += x[i];
      }
    }
  }

  const BlockSymbolic& symbolic_;
  const Supernode& node_;
  Index d_;
  Index rows_;
  Index columns_;
  Index below_;
  Real* factor_;
  Real* updates_;
  Real* update_;
};

}  // namespace

template <class Real>
BasicBlockCholesky<Real>::BasicBlockCholesky(std::shared_ptr<const BlockSymbolic> symbolic,
                                             std::size_t block_size)
    : symbolic_(std::move(symbolic)),
      block_size_(block_size),
      factor_(symbolic_->factor_size * block_size * block_size),
      updates_(symbolic_->update_room * block_size * block_size) {}

template <class Real>
std::optional<std::size_t> BasicBlockCholesky<Real>::factorize(const std::vector<double>& values) {
  const BlockSymbolic& sym = *symbolic_;
  const Index d = block_size_;
  ADIT_CHECK(values.size() == sym.num_blocks * d * d, "one value for each element of the pattern's blocks");
  const auto eliminate = [&](Index s) -> Index {
    const Supernode& node = sym.nodes[s];
    const Index column = Front<Real>(sym, node, d, factor_, updates_).run(values);
    return column == kNoColumn ? kNoColumn : sym.old_of_new[node.first + column / d];
  };
  const auto eliminate_all = [&](const std::vector<Index>& list) {
    for (const Index s : list) {
      if (const Index variable = eliminate(s); variable != kNoColumn) return variable;
    }
    return kNoColumn;
  };
  std::vector<Index> failed(sym.subtrees.size(), kNoColumn);
  parallel_for_each(sym.subtrees.size(), [&](Index t) { failed[t] = eliminate_all(sym.subtrees[t]); });
  Index first = kNoColumn;
  for (const Index variable : failed) first = std::min(first, variable);
  if (first == kNoColumn) first = eliminate_all(sym.top);
  return first == kNoColumn ? std::nullopt : std::optional(first);
}

template <class Real>
Eigen::MatrixXd BasicBlockCholesky<Real>::solve(const Eigen::Ref<const Eigen::MatrixXd>& right_sides) const {
  const BlockSymbolic& sym = *symbolic_;
  const auto d = static_cast<Eigen::Index>(block_size_);
  const auto at = [d](Index i) { return static_cast<Eigen::Index>(i) * d; };
  ADIT_CHECK(right_sides.rows() == at(sym.size), "one row for each scalar variable");
  const Eigen::Index sides = right_sides.cols();
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix x(right_sides.rows(), sides);
  for (Index i = 0; i < sym.size; ++i)
    x.middleRows(at(sym.new_of_old[i]), d) = right_sides.middleRows(at(i), d).template cast<Real>();

  const auto panel_of = [&](const Supernode& node) {
    return factor_.data() + node.factor_offset * block_size_ * block_size_;
  };
  // What each supernode's rows below owe to its columns: added up by the parent, so that subtrees stay apart.
  Matrix owed(at(sym.below_size), sides);
  const auto forward = [&](const Supernode& node) {
    Matrix t = Matrix::Zero(at(node.height()), sides);
    t.topRows(at(node.width)) = x.middleRows(at(node.first), at(node.width));
    for (const Index c : node.children) {
      const Supernode& child = sym.nodes[c];
      for (Index i = 0; i < child.below.size(); ++i)
        t.middleRows(at(child.in_parent[i]), d) += owed.middleRows(at(child.below_offset + i), d);
    }
    for (Eigen::Index side = 0; side < sides; ++side)
      dense::solve_lower(panel_of(node), static_cast<Index>(t.rows()), node.width * block_size_, &t(0, side));
    x.middleRows(at(node.first), at(node.width)) = t.topRows(at(node.width));
    owed.middleRows(at(node.below_offset), at(node.below.size())) = t.bottomRows(at(node.below.size()));
  };
  const auto backward = [&](const Supernode& node) {
    Matrix t(at(node.height()), sides);
    t.topRows(at(node.width)) = x.middleRows(at(node.first), at(node.width));
    for (Index i = 0; i < node.below.size(); ++i)
      t.middleRows(at(node.width + i), d) = x.middleRows(at(node.below[i]), d);
    for (Eigen::Index side = 0; side < sides; ++side)
      dense::solve_lower_transposed(panel_of(node), static_cast<Index>(t.rows()), node.width * block_size_,
                                    &t(0, side));
    x.middleRows(at(node.first), at(node.width)) = t.topRows(at(node.width));
  };
  parallel_for_each(sym.subtrees.size(), [&](Index t) {
    for (const Index s : sym.subtrees[t]) forward(sym.nodes[s]);
  });
  for (const Index s : sym.top) forward(sym.nodes[s]);
  for (Index i = sym.top.size(); i-- > 0;) backward(sym.nodes[sym.top[i]]);
  parallel_for_each(sym.subtrees.size(), [&](Index t) {
    for (Index i = sym.subtrees[t].size(); i-- > 0;) backward(sym.nodes[sym.subtrees[t][i]]);
  });

  Eigen::MatrixXd out(right_sides.rows(), sides);
  for (Index i = 0; i < sym.size; ++i)
    out.middleRows(at(i), d) = x.middleRows(at(sym.new_of_old[i]), d).template cast<double>();
  return out;
}

template <class Real>
double BasicBlockCholesky<Real>::least_pivot(const std::vector<double>& values) const {
  const Index d = block_size_;
  double least = 1.0;
  for (const Supernode& node : symbolic_->nodes) {
    const Real* panel = factor_.data() + node.factor_offset * d * d;
    for (const Supernode::Scatter& s : node.scatter) {
      if (s.row != s.column) continue;
      for (Index i = 0; i < d; ++i) {
        const double root = panel[(s.column * d + i) * (node.height() * d + 1)];
        least = std::min(least, root * root / values[s.block * d * d + i * (d + 1)]);
      }
    }
  }
  return least;
}

template class BasicBlockCholesky<double>;
template class BasicBlockCholesky<float>;

}  // namespace adit
