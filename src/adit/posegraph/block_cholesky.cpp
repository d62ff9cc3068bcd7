// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/block_cholesky.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/dense_kernels.hpp"

namespace adit {
namespace {

using Index = std::size_t;
constexpr Index kNone = std::numeric_limits<Index>::max();

// Where a block of the matrix goes in the front of its supernode.
struct Scatter {
  Index block;
  Index row;
  Index column;
  bool transposed;
};

// Consecutive columns of the factor with (nearly) the same rows, held as one dense front. All in blocks.
struct Supernode {
  Index first = 0;  // columns [first, first + width) in the order of elimination
  Index width = 0;
  std::vector<Index> below;      // rows under the square, ascending
  std::vector<Index> in_parent;  // where each of these rows lies in the parent's front
  Index parent = kNone;
  std::vector<Index> children;  // ascending
  std::vector<Scatter> scatter;
  Index factor_offset = 0;  // of its columns in the factor, for block size 1

  [[nodiscard]] Index height() const { return width + below.size(); }
  [[nodiscard]] double work() const {
    const auto h = static_cast<double>(height());
    const auto b = static_cast<double>(below.size());
    return (h * h * h - b * b * b) / 3.0;
  }
};

// Neighbours of each vertex, both ways, without the vertex itself.
struct Adjacency {
  std::vector<Index> start;
  std::vector<Index> neighbour;
};

Adjacency adjacency_of(const BlockPattern& pattern, const std::vector<Index>& new_of_old) {
  const Index n = pattern.size();
  Adjacency a{std::vector<Index>(n + 1, 0), {}};
  const auto for_pairs = [&](const auto& visit) {
    for (Index j = 0; j < n; ++j) {
      for (Index p = pattern.column_start[j] + 1; p < pattern.column_start[j + 1]; ++p) {
        visit(new_of_old[pattern.row[p]], new_of_old[j]);
        visit(new_of_old[j], new_of_old[pattern.row[p]]);
      }
    }
  };
  for_pairs([&](Index i, Index) { ++a.start[i + 1]; });
  std::partial_sum(a.start.begin(), a.start.end(), a.start.begin());
  a.neighbour.resize(a.start.back());
  std::vector<Index> next(a.start.begin(), a.start.end() - 1);
  for_pairs([&](Index i, Index j) { a.neighbour[next[i]++] = j; });
  return a;
}

// Position in the order of elimination for each block, by approximate minimum degree.
std::vector<Index> minimum_degree(const BlockPattern& pattern) {
  const Index n = pattern.size();
  std::vector<Eigen::Triplet<char, int>> entries;
  entries.reserve(pattern.num_blocks());
  for (Index j = 0; j < n; ++j) {
    for (Index p = pattern.column_start[j]; p < pattern.column_start[j + 1]; ++p) {
      entries.emplace_back(static_cast<int>(pattern.row[p]), static_cast<int>(j), char{1});
    }
  }
  Eigen::SparseMatrix<char, Eigen::ColMajor, int> matrix(static_cast<int>(n), static_cast<int>(n));
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> old_of_new;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Lower>(), old_of_new);
  std::vector<Index> new_of_old(n);
  for (Index i = 0; i < n; ++i) {
    new_of_old[static_cast<Index>(old_of_new.indices()[static_cast<Eigen::Index>(i)])] = i;
  }
  return new_of_old;
}

// Elimination tree (Liu 1986): parent of each column, kNone for roots.
std::vector<Index> elimination_tree(const Adjacency& adjacency) {
  const Index n = adjacency.start.size() - 1;
  std::vector<Index> parent(n, kNone);
  std::vector<Index> ancestor(n, kNone);
  for (Index j = 0; j < n; ++j) {
    for (Index p = adjacency.start[j]; p < adjacency.start[j + 1]; ++p) {
      Index i = adjacency.neighbour[p];
      while (i < j) {
        const Index next = std::exchange(ancestor[i], j);
        if (next == kNone) parent[i] = j;
        i = next == kNone ? j : next;
      }
    }
  }
  return parent;
}

// Children before parents, each subtree consecutive: position of each column.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const Index n = parent.size();
  std::vector<Index> first_child(n, kNone);
  std::vector<Index> sibling(n, kNone);
  for (Index j = n; j-- > 0;) {
    if (parent[j] != kNone) sibling[j] = std::exchange(first_child[parent[j]], j);
  }
  std::vector<Index> position(n);
  std::vector<Index> stack;
  Index next = 0;
  for (Index root = 0; root < n; ++root) {
    if (parent[root] != kNone) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index j = stack.back();
      if (first_child[j] != kNone) {
        stack.push_back(std::exchange(first_child[j], kNone));
        continue;
      }
      position[j] = next++;
      stack.pop_back();
      if (sibling[j] != kNone) stack.push_back(sibling[j]);
    }
  }
  return position;
}

// Rows below the diagonal of each column of the factor, ascending: those of the matrix and of the column's
// children.
std::vector<std::vector<Index>> factor_rows(const Adjacency& adjacency, const std::vector<Index>& parent) {
  const Index n = parent.size();
  std::vector<std::vector<Index>> rows(n);
  std::vector<Index> seen_by(n, kNone);
  std::vector<std::vector<Index>> children(n);
  for (Index j = 0; j < n; ++j) {
    if (parent[j] != kNone) children[parent[j]].push_back(j);
  }
  for (Index j = 0; j < n; ++j) {
    const auto take = [&](Index i) {
      if (i > j && std::exchange(seen_by[i], j) != j) rows[j].push_back(i);
    };
    for (Index p = adjacency.start[j]; p < adjacency.start[j + 1]; ++p) take(adjacency.neighbour[p]);
    for (const Index child : children[j]) std::ranges::for_each(rows[child], take);
    std::ranges::sort(rows[j]);
  }
  return rows;
}

// Merging a child into its parent stores zeros but saves bookkeeping: allowed while the zeros stay few.
bool worth_merging(Index width, double zeros, double stored) {
  const double share = zeros / stored;
  return width <= 2 || (width <= 6 && share < 0.4) || (width <= 16 && share < 0.15) || share < 0.05;
}

std::vector<Supernode> supernodes_of(std::vector<std::vector<Index>> rows, const std::vector<Index>& parent) {
  const Index n = parent.size();
  std::vector<Supernode> nodes;
  std::vector<double> zeros;  // explicit zeros of each
  for (Index j = 0; j < n; ++j) {
    Supernode node{j, 1, std::move(rows[j]), {}, kNone, {}, {}, 0};
    double node_zeros = 0.0;
    // The column before may be the last of a child; that child may have been merged with its own children
    // already.
    while (!nodes.empty()) {
      const Supernode& child = nodes.back();
      if (child.first + child.width != node.first || parent[node.first - 1] != node.first + 0) break;
      const auto width = static_cast<double>(child.width);
      const double added = width * static_cast<double>(node.height() - child.below.size());
      const Index merged_width = child.width + node.width;
      const auto stored = static_cast<double>(merged_width) * (static_cast<double>(node.below.size()) +
                                                               0.5 * static_cast<double>(merged_width + 1));
      const double merged_zeros = zeros.back() + node_zeros + added;
      if (added > 0.0 && !worth_merging(merged_width, merged_zeros, stored)) break;
      node.first = child.first;
      node.width = merged_width;
      node_zeros = merged_zeros;
      nodes.pop_back();
      zeros.pop_back();
    }
    nodes.push_back(std::move(node));
    zeros.push_back(node_zeros);
  }
  return nodes;
}

}  // namespace

class BlockSymbolic {
 public:
  explicit BlockSymbolic(const BlockPattern& pattern);

  Index size = 0;
  Index num_blocks = 0;
  std::vector<Index> new_of_old;  // position of each variable in the order of elimination
  std::vector<Index> old_of_new;
  std::vector<Supernode> nodes;              // children before parents
  std::vector<std::vector<Index>> subtrees;  // independent of one another, largest first; each in order
  std::vector<Index> top;                    // the supernodes above all subtrees, in order
  Index factor_size = 0;
  double work = 0.0;

 private:
  void link_supernodes();
  void place_blocks(const BlockPattern& pattern);
  void cut_subtrees();
};

BlockSymbolic::BlockSymbolic(const BlockPattern& pattern)
    : size(pattern.size()), num_blocks(pattern.num_blocks()) {
  new_of_old = minimum_degree(pattern);
  const std::vector<Index> order = postorder(elimination_tree(adjacency_of(pattern, new_of_old)));
  old_of_new.resize(size);
  for (Index i = 0; i < size; ++i) {
    new_of_old[i] = order[new_of_old[i]];
    old_of_new[new_of_old[i]] = i;
  }
  const Adjacency adjacency = adjacency_of(pattern, new_of_old);
  const std::vector<Index> parent = elimination_tree(adjacency);
  nodes = supernodes_of(factor_rows(adjacency, parent), parent);
  link_supernodes();
  place_blocks(pattern);
  cut_subtrees();
}

void BlockSymbolic::link_supernodes() {
  std::vector<Index> node_of(size);
  for (Index s = 0; s < nodes.size(); ++s) {
    for (Index j = 0; j < nodes[s].width; ++j) node_of[nodes[s].first + j] = s;
  }
  for (Index s = 0; s < nodes.size(); ++s) {
    Supernode& node = nodes[s];
    node.factor_offset = factor_size;
    factor_size += node.height() * node.width;
    work += node.work();
    if (node.below.empty()) continue;
    node.parent = node_of[node.below.front()];
    const Supernode& parent = nodes[node.parent];
    nodes[node.parent].children.push_back(s);
    Index p = 0;
    for (const Index row : node.below) {
      if (row < parent.first + parent.width) {
        node.in_parent.push_back(row - parent.first);
        continue;
      }
      while (parent.below[p] != row) ++p;
      node.in_parent.push_back(parent.width + p);
    }
  }
}

void BlockSymbolic::place_blocks(const BlockPattern& pattern) {
  std::vector<Index> node_of(size);
  for (Index s = 0; s < nodes.size(); ++s) {
    for (Index j = 0; j < nodes[s].width; ++j) node_of[nodes[s].first + j] = s;
  }
  for (Index j = 0; j < size; ++j) {
    for (Index p = pattern.column_start[j]; p < pattern.column_start[j + 1]; ++p) {
      const Index a = new_of_old[pattern.row[p]];
      const Index b = new_of_old[j];
      const Index row = std::max(a, b);
      const Index column = std::min(a, b);
      Supernode& node = nodes[node_of[column]];
      const Index local = row < node.first + node.width
                              ? row - node.first
                              : node.width + static_cast<Index>(std::ranges::lower_bound(node.below, row) -
                                                                node.below.begin());
      node.scatter.push_back({p, local, column - node.first, a < b});
    }
  }
}

// Splits the tree from its roots until no subtree holds more than a sixteenth of all work: enough parts for
// any small machine, and the same parts on all of them.
void BlockSymbolic::cut_subtrees() {
  std::vector<double> total(nodes.size());
  std::vector<Index> first(nodes.size());  // smallest supernode of each subtree: subtrees are consecutive
  for (Index s = 0; s < nodes.size(); ++s) {
    total[s] = nodes[s].work();
    first[s] = s;
    for (const Index child : nodes[s].children) total[s] += total[child];
    if (!nodes[s].children.empty()) first[s] = first[nodes[s].children.front()];
  }
  std::vector<Index> roots;
  std::vector<Index> open;
  for (Index s = 0; s < nodes.size(); ++s) {
    if (nodes[s].parent == kNone) open.push_back(s);
  }
  while (!open.empty()) {
    const Index s = open.back();
    open.pop_back();
    if (total[s] <= work / 16.0) {
      roots.push_back(s);
      continue;
    }
    top.push_back(s);
    open.insert(open.end(), nodes[s].children.begin(), nodes[s].children.end());
  }
  std::ranges::sort(top);
  std::ranges::sort(roots,
                    [&](Index a, Index b) { return std::pair(-total[a], a) < std::pair(-total[b], b); });
  for (const Index root : roots) {
    std::vector<Index>& subtree = subtrees.emplace_back(root - first[root] + 1);
    std::iota(subtree.begin(), subtree.end(), first[root]);
  }
}

Index BlockPattern::block(Index i, Index j) const {
  const auto begin = row.begin() + static_cast<std::ptrdiff_t>(column_start[j]);
  const auto end = row.begin() + static_cast<std::ptrdiff_t>(column_start[j + 1]);
  const auto found = std::lower_bound(begin, end, i);
  ADIT_CHECK(found != end && *found == i, "the block is in the pattern");
  return static_cast<Index>(found - row.begin());
}

BlockPattern BlockPattern::of_pairs(Index size, std::vector<std::pair<Index, Index>> pairs) {
  for (auto& [column, row] : pairs) {
    if (column > row) std::swap(column, row);
  }
  for (Index j = 0; j < size; ++j) pairs.emplace_back(j, j);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  BlockPattern pattern{std::vector<Index>(size + 1, 0), {}};
  for (const auto& [column, row] : pairs) {
    ++pattern.column_start[column + 1];
    pattern.row.push_back(row);
  }
  std::partial_sum(pattern.column_start.begin(), pattern.column_start.end(), pattern.column_start.begin());
  return pattern;
}

std::shared_ptr<const BlockSymbolic> analyze(const BlockPattern& pattern) {
  return std::make_shared<const BlockSymbolic>(pattern);
}
double factorization_work(const BlockSymbolic& symbolic) { return symbolic.work; }

namespace {

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
    for (const Scatter& s : node_.scatter) place(values.data() + s.block * d_ * d_, s);
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

  void place(const double* block, const Scatter& s) const {
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
  for (const Scatter& s : node.scatter) {
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
