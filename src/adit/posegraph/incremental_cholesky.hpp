// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace adit {

class BlockSymbolic;

/// Cholesky factorization of a symmetric positive definite block matrix that grows by variables and terms. A
/// refresh eliminates only the supernodes on the paths from the changed variables to the root; all other
/// subtrees keep their columns and what they pass to their parents. Where terms join variables that no term
/// joined before, the paths are also ordered anew:
/// approximate minimum degree, or nested dissection where it is large; changed variables last. Serves
/// `IncrementalOptimizer`. Source: Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, "iSAM2" (IJRR 2012),
/// section 3 (the Bayes tree is this tree), with dense fronts as in block_cholesky.hpp.
class IncrementalCholesky {
 public:
  /// Without variables; `block_size` is d.
  explicit IncrementalCholesky(std::size_t block_size) : d_(block_size) {}

  /// Variables added so far.
  [[nodiscard]] std::size_t size() const { return diagonal_.size(); }
  /// A variable with a zero diagonal block; returns its index.
  std::size_t add_variable();
  /// Adds `block` (d x d, column-major) to block (i, j) of the matrix, and its transpose to (j, i). i == j:
  /// once.
  void add(std::size_t i, std::size_t j, const Eigen::Ref<const Eigen::MatrixXd>& block);
  /// Takes back what an `add` of the same arguments added. A pair (i, j) that no term joins any longer causes
  /// no fill from the next refresh on.
  void remove(std::size_t i, std::size_t j, const Eigen::Ref<const Eigen::MatrixXd>& block);
  /// Block (i, i) of the matrix.
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> diagonal(std::size_t i) const {
    const auto d = static_cast<Eigen::Index>(d_);
    return {block(diagonal_[i]), d, d};
  }

  /// Brings the factor up to date. Returns a variable that the matrix leaves free (a pivot not above 1e-13 of
  /// its diagonal), or nothing when all is well; after a failure `solve` must not be called.
  [[nodiscard]] std::optional<std::size_t> refresh();
  /// Supernodes that the last refresh eliminated, and that there are.
  ///@{
  [[nodiscard]] std::size_t num_renewed() const { return num_renewed_; }
  [[nodiscard]] std::size_t num_supernodes() const { return cliques_.size() - free_cliques_.size(); }
  ///@}

  /// Solution of A x = b, after `refresh`.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right_side);

  /// Rows of a vector at some variables, d numbers each; zero elsewhere.
  struct Sparse {
    std::vector<std::size_t> variables;  ///< In any order, each once.
    std::vector<double> rows;            ///< Of the variables, in their order.
  };
  /// As much of a solution as `solve` worked out.
  struct PartialSolution {
    Sparse x;           ///< Of the variables whose rows it worked out.
    double gain = 0.0;  ///< b^T x of the whole solution.
  };
  /// Solution of A x = b as far as it matters, after `refresh`: the forward pass visits the paths from the
  /// variables of b to the root, the backward pass goes down from there as long as an element above exceeds
  /// `threshold`. The gain is known after the forward pass: where it is at most `least_gain`, x is left
  /// empty. Source: iSAM2, algorithm 4 ("partial state update").
  [[nodiscard]] PartialSolution solve(const Sparse& right_side, double threshold, double least_gain = 0.0);

  /// R^T A^-1 R, after `refresh`, where column k of `columns` has the rows of R at `variables`. Only the
  /// paths from these variables to the root are visited.
  [[nodiscard]] Eigen::MatrixXd quadratic_form(const std::vector<std::size_t>& variables,
                                               const Eigen::MatrixXd& columns);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// A supernode: variables that are eliminated together.
  struct Clique {
    std::vector<std::size_t> own;    ///< In the order of elimination.
    std::vector<std::size_t> below;  ///< Variables of ancestors that the columns reach.
    std::vector<double> panel;       ///< Columns of the factor: (own + below) * d rows.
    std::vector<double> update;      ///< Lower triangle of what the parent gets.
    std::size_t parent = kNone;
    std::vector<std::size_t> children;
    bool is_marked = false;  ///< Scratch of the walk at hand.
  };
  struct Neighbour {
    std::size_t variable;
    std::size_t block;  ///< Index into blocks_, in units of d * d.
    bool transposed;    ///< The block is (this, other); otherwise (other, this).
  };

  struct Removed {
    std::vector<std::size_t>
        variables;  ///< Of the cliques that were taken out, and new ones; touched ones last.
    std::size_t num_touched = 0;
    std::vector<std::size_t> orphans;  ///< Cliques that have lost their parent.
  };
  Removed remove_touched();
  void forget_unused();
  [[nodiscard]] BlockSymbolic analyze(const Removed& removed) const;
  std::vector<std::size_t> make_cliques(const BlockSymbolic& symbolic,
                                        const std::vector<std::size_t>& variables);
  void adopt(const std::vector<std::size_t>& orphans, const BlockSymbolic& symbolic);
  [[nodiscard]] std::optional<std::size_t> eliminate(Clique& clique);
  enum class Part { columns, update };  ///< Of a clique: its own columns, or what it hands on.
  void add_update(const Clique& child, Clique& parent, Part part) const;
  /// The cliques of these variables and all above them, parents first.
  [[nodiscard]] std::vector<std::size_t> paths_to_root(const std::vector<std::size_t>& variables);
  void forward(const Clique& clique, double* work);
  void backward(const Clique& clique, double* work);
  void backward_from(std::vector<std::size_t>& order, double threshold);
  [[nodiscard]] std::size_t new_block();
  [[nodiscard]] double* block(std::size_t i) { return blocks_.data() + i * d_ * d_; }
  [[nodiscard]] const double* block(std::size_t i) const { return blocks_.data() + i * d_ * d_; }

  std::size_t d_;
  std::vector<double> blocks_;
  std::vector<std::uint32_t> uses_;       ///< Terms of each block.
  std::vector<std::size_t> free_blocks_;  ///< Places in blocks_ that are not in use.
  std::vector<std::size_t> diagonal_;     ///< Block of each variable.
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<std::pair<std::size_t, std::size_t>> unused_;  ///< Pairs whose last term may have gone.
  std::vector<std::size_t>
      touched_;                     ///< Variables that are new or have new neighbours since the last refresh.
  std::vector<std::size_t> dirty_;  ///< Variables whose terms have changed since then.

  std::vector<Clique> cliques_;
  std::vector<std::size_t> free_cliques_;  ///< Places in cliques_ that are not in use.
  std::vector<std::size_t> clique_of_;     ///< Of each variable; kNone before its first elimination.
  std::vector<std::size_t> row_of_;        ///< Scratch: row of a variable in the front at hand, or kNone.
  std::vector<double> work_;               ///< Scratch of solves: zero between them.
  std::vector<double> front_;              ///< Scratch of solves.
  std::size_t num_renewed_ = 0;
};

}  // namespace adit
