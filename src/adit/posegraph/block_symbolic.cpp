// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/block_symbolic.hpp"

#include <metis.h>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Index = std::size_t;
constexpr Index kNone = Supernode::kNone;

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

// Position in the order of elimination for each block, by approximate minimum degree; the last ones stay
// last.
std::vector<Index> minimum_degree(const BlockPattern& pattern, Index num_last) {
  const Index n = pattern.size() - num_last;
  std::vector<Index> new_of_old(pattern.size());
  std::iota(new_of_old.begin(), new_of_old.end(), Index{0});
  if (n == 0) return new_of_old;
  std::vector<Eigen::Triplet<char, int>> entries;
  entries.reserve(pattern.num_blocks());
  for (Index j = 0; j < n; ++j) {
    for (Index p = pattern.column_start[j]; p < pattern.column_start[j + 1]; ++p) {
      if (pattern.row[p] >= n) break;
      entries.emplace_back(static_cast<int>(pattern.row[p]), static_cast<int>(j), char{1});
    }
  }
  Eigen::SparseMatrix<char, Eigen::ColMajor, int> matrix(static_cast<int>(n), static_cast<int>(n));
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> old_of_new;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Lower>(), old_of_new);
  for (Index i = 0; i < n; ++i) {
    new_of_old[static_cast<Index>(old_of_new.indices()[static_cast<Eigen::Index>(i)])] = i;
  }
  return new_of_old;
}

// The same by nested dissection (METIS).
std::vector<Index> dissected(const BlockPattern& pattern, Index num_last) {
  const Index n = pattern.size() - num_last;
  std::vector<Index> new_of_old(pattern.size());
  std::iota(new_of_old.begin(), new_of_old.end(), Index{0});
  const Adjacency adjacency = adjacency_of(pattern, new_of_old);
  std::vector<idx_t> start{0};
  std::vector<idx_t> neighbour;
  for (Index i = 0; i < n; ++i) {
    for (Index p = adjacency.start[i]; p < adjacency.start[i + 1]; ++p) {
      if (adjacency.neighbour[p] < n) neighbour.push_back(static_cast<idx_t>(adjacency.neighbour[p]));
    }
    start.push_back(static_cast<idx_t>(neighbour.size()));
  }
  auto size = static_cast<idx_t>(n);
  std::vector<idx_t> old_of_position(n);
  std::vector<idx_t> position(n);
  {
    // METIS draws from the C library's generator, which it seeds at each call: two calls at a time would mix.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    const int status = METIS_NodeND(&size, start.data(), neighbour.data(), nullptr, nullptr,
                                    old_of_position.data(), position.data());
    ADIT_CHECK(status == METIS_OK, "METIS orders every graph that fits into memory");
  }
  std::ranges::copy(position, new_of_old.begin());
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

BlockSymbolic::BlockSymbolic(const BlockPattern& pattern, Ordering ordering, Index num_last)
    : size(pattern.size()), num_blocks(pattern.num_blocks()) {
  new_of_old = ordering == Ordering::nested_dissection && pattern.size() > num_last
                   ? dissected(pattern, num_last)
                   : minimum_degree(pattern, num_last);
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
  place_updates();
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
    node.below_offset = below_size;
    below_size += node.below.size();
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

// Each update lives from its supernode to its parent. Subtrees run at the same time, so that each has a room
// of its own; within one the order is known, and an update takes the first gap that is wide enough.
void BlockSymbolic::place_updates() {
  struct Piece {
    Index begin;
    Index end;
    Index node;
  };
  std::vector<Piece> handed_up;  // by the roots of the subtrees
  const auto run = [&](const std::vector<Index>& list, std::vector<Piece> live, Index base) {
    for (const Index s : list) {
      const Index room = nodes[s].below.size() * nodes[s].below.size();
      Index begin = base;
      auto at = live.begin();
      for (; at != live.end() && at->begin < begin + room; ++at) begin = std::max(begin, at->end);
      nodes[s].update_offset = begin;
      live.insert(at, {begin, begin + room, s});
      update_room = std::max(update_room, begin + room);
      std::erase_if(live, [&](const Piece& piece) { return nodes[piece.node].parent == s; });
    }
    return live;
  };
  for (const std::vector<Index>& subtree : subtrees) {
    const std::vector<Piece> left = run(subtree, {}, update_room);
    handed_up.insert(handed_up.end(), left.begin(), left.end());
  }
  run(top, std::move(handed_up), 0);
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

}  // namespace adit
