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
constexpr Index kNone = Supernode::kNone;

constexpr double kMinPivot = 1e-13;  // relative to the diagonal element that the pivot started from

// One supernode's part of a factorization.
class Front {
 public:
  Front(const Supernode& node, Index d, double* factor)
      : node_(node),
        d_(d),
        rows_(node.height() * d),
        columns_(node.width * d),
        below_(node.below.size() * d),
        factor_(factor) {}

  // Columns of the square go to the factor, the others to the update.
  void assemble(const std::vector<double>& values, std::vector<std::vector<double>>& updates,
                const std::vector<Supernode>& nodes, std::vector<double>& update) const {
    std::fill(factor_, factor_ + rows_ * columns_, 0.0);
    update.assign(below_ * below_, 0.0);
    for (const Supernode::Scatter& s : node_.scatter) place(values.data() + s.block * d_ * d_, s);
    for (const Index child : node_.children) {
      extend_add(nodes[child], updates[child], update);
      std::vector<double>().swap(updates[child]);
    }
  }

  // Column of the front that is not positive definite, or kNone.
  [[nodiscard]] Index eliminate(const std::vector<double>& min_pivot, std::vector<double>& update) const {
    const Index done = dense::factorize_panel(factor_, rows_, rows_, columns_, min_pivot.data());
    if (done < columns_) return done;
    if (below_ == 0) return kNone;
    dense::PackedPanel packed;
    packed.pack(factor_ + columns_, rows_, below_, columns_);
    // A wide front is shared between threads by columns; each element is still one sum in one order.
    parallel_for(below_, kStripe, [&](Index begin, Index end) {
      dense::subtract_outer_product(update.data(), below_, packed, begin, end);
    });
    return kNone;
  }

 private:
  static constexpr Index kStripe = 96;

  void place(const double* block, const Supernode::Scatter& s) const {
    for (Index j = 0; j < d_; ++j) {
      double* to = factor_ + (s.column * d_ + j) * rows_ + s.row * d_;
      for (Index i = 0; i < d_; ++i) to[i] = s.transposed ? block[j + i * d_] : block[i + j * d_];
    }
  }

  void extend_add(const Supernode& child, const std::vector<double>& from,
                  std::vector<double>& update) const {
    const Index height = child.below.size();
    const Index stride = height * d_;
    for (Index bj = 0; bj < height; ++bj) {
      const Index column = child.in_parent[bj];
      for (Index j = 0; j < d_; ++j) {
        const double* source = from.data() + (bj * d_ + j) * stride;
        const bool in_square = column < node_.width;
        double* to = in_square ? factor_ + (column * d_ + j) * rows_
                               : update.data() + ((column - node_.width) * d_ + j) * below_ - columns_;
        for (Index bi = bj; bi < height; ++bi) {
          double* t = to + child.in_parent[bi] * d_;
          const double* x = source + bi * d_;
          for (Index i = 0; i < d_; ++i) t[i] += x[i];
        }
      }
    }
  }

  const Supernode& node_;
  Index d_;
  Index rows_;
  Index columns_;
  Index below_;
  double* factor_;
};

// The least pivot that counts as positive, for each column of a supernode.
std::vector<double> least_pivots(const Supernode& node, Index d, const std::vector<double>& values) {
  std::vector<double> least(node.width * d, 0.0);
  for (const Supernode::Scatter& s : node.scatter) {
    if (s.row != s.column) continue;
    for (Index i = 0; i < d; ++i) {
      least[s.column * d + i] = kMinPivot * values[s.block * d * d + i * d + i];
    }
  }
  return least;
}

}  // namespace

BlockCholesky::BlockCholesky(std::shared_ptr<const BlockSymbolic> symbolic, std::size_t block_size)
    : symbolic_(std::move(symbolic)), block_size_(block_size) {
  factor_.resize(symbolic_->factor_size * block_size * block_size);
  updates_.resize(symbolic_->nodes.size());
}

std::optional<std::size_t> BlockCholesky::factorize(const std::vector<double>& values) {
  const BlockSymbolic& sym = *symbolic_;
  const Index d = block_size_;
  ADIT_CHECK(values.size() == sym.num_blocks * d * d, "one value for each element of the pattern's blocks");
  const auto eliminate = [&](Index s) -> Index {
    const Supernode& node = sym.nodes[s];
    const Front front(node, d, factor_.data() + node.factor_offset * d * d);
    front.assemble(values, updates_, sym.nodes, updates_[s]);
    const Index column = front.eliminate(least_pivots(node, d, values), updates_[s]);
    return column == kNone ? kNone : sym.old_of_new[node.first + column / d];
  };
  const auto eliminate_all = [&](const std::vector<Index>& list) {
    for (const Index s : list) {
      if (const Index variable = eliminate(s); variable != kNone) return variable;
    }
    return kNone;
  };
  std::vector<Index> failed(sym.subtrees.size(), kNone);
  parallel_for_each(sym.subtrees.size(), [&](Index t) { failed[t] = eliminate_all(sym.subtrees[t]); });
  Index first = kNone;
  for (const Index variable : failed) first = std::min(first, variable);
  if (first == kNone) first = eliminate_all(sym.top);
  for (std::vector<double>& update : updates_) update.clear();
  return first == kNone ? std::nullopt : std::optional(first);
}

Eigen::MatrixXd BlockCholesky::solve(const Eigen::Ref<const Eigen::MatrixXd>& right_sides) const {
  using Eigen::Map;
  using Stride = Eigen::OuterStride<>;
  const BlockSymbolic& sym = *symbolic_;
  const auto d = static_cast<Eigen::Index>(block_size_);
  const auto at = [d](Index i) { return static_cast<Eigen::Index>(i) * d; };
  ADIT_CHECK(right_sides.rows() == at(sym.size), "one row for each scalar variable");
  const Eigen::Index sides = right_sides.cols();
  Eigen::MatrixXd x(right_sides.rows(), sides);
  for (Index i = 0; i < sym.size; ++i)
    x.middleRows(at(sym.new_of_old[i]), d) = right_sides.middleRows(at(i), d);
  Eigen::MatrixXd below;
  const auto panel_of = [&](const Supernode& node) {
    const double* a = factor_.data() + node.factor_offset * block_size_ * block_size_;
    return Map<const Eigen::MatrixXd, 0, Stride>(a, at(node.height()), at(node.width),
                                                 Stride(at(node.height())));
  };
  for (const Supernode& node : sym.nodes) {
    const auto panel = panel_of(node);
    auto own = x.middleRows(at(node.first), at(node.width));
    panel.topRows(at(node.width)).triangularView<Eigen::Lower>().solveInPlace(own);
    below.noalias() = panel.bottomRows(at(node.below.size())) * own;
    for (Index i = 0; i < node.below.size(); ++i)
      x.middleRows(at(node.below[i]), d) -= below.middleRows(at(i), d);
  }
  for (Index s = sym.nodes.size(); s-- > 0;) {
    const Supernode& node = sym.nodes[s];
    const auto panel = panel_of(node);
    auto own = x.middleRows(at(node.first), at(node.width));
    below.resize(at(node.below.size()), sides);
    for (Index i = 0; i < node.below.size(); ++i)
      below.middleRows(at(i), d) = x.middleRows(at(node.below[i]), d);
    own.noalias() -= panel.bottomRows(at(node.below.size())).transpose() * below;
    panel.topRows(at(node.width)).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
  Eigen::MatrixXd out(right_sides.rows(), sides);
  for (Index i = 0; i < sym.size; ++i) out.middleRows(at(i), d) = x.middleRows(at(sym.new_of_old[i]), d);
  return out;
}

}  // namespace adit
