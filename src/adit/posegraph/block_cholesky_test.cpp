// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

struct Problem {
  BlockPattern pattern;
  std::vector<double> values;
  Eigen::MatrixXd dense;
};

// A chain with random chords, diagonally dominant.
Problem random_problem(std::size_t n, std::size_t chords, std::size_t d, Rng& rng) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i + 1 < n; ++i) pairs.emplace_back(i, i + 1);
  for (std::size_t i = 0; i < chords; ++i) {
    const std::size_t a = rng.below(n);
    const std::size_t b = rng.below(n);
    if (a != b) pairs.emplace_back(a, b);
  }
  Problem p{BlockPattern::of_pairs(n, pairs), {}, {}};
  p.values.resize(p.pattern.num_blocks() * d * d);
  const auto size = static_cast<Eigen::Index>(n * d);
  p.dense = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t b = p.pattern.column_start[j]; b < p.pattern.column_start[j + 1]; ++b) {
      Eigen::Map<Eigen::MatrixXd> block(p.values.data() + b * d * d, static_cast<Eigen::Index>(d),
                                        static_cast<Eigen::Index>(d));
      for (double& v : block.reshaped()) v = rng.normal();
      const std::size_t i = p.pattern.row[b];
      if (i == j) {
        block = (block + block.transpose()).eval();
        block.diagonal().array() += 400.0;
      }
      const auto at = [d](std::size_t k) { return static_cast<Eigen::Index>(k * d); };
      p.dense.block(at(i), at(j), at(1), at(1)) = block;
      p.dense.block(at(j), at(i), at(1), at(1)) = block.transpose();
    }
  }
  return p;
}

TEST(BlockCholesky, SolvesAsADenseFactorizationDoes) {
  Rng rng(1);
  for (const std::size_t d : {1U, 2U, 3U, 6U}) {
    for (const std::size_t n : {1U, 2U, 5U, 40U, 90U}) {
      for (const std::size_t chords : {0U, 4U, 60U}) {
        const Problem p = random_problem(n, chords, d, rng);
        BlockCholesky cholesky(analyze(p.pattern), d);
        ASSERT_FALSE(cholesky.factorize(p.values));
        const Eigen::MatrixXd b = Eigen::MatrixXd::Random(p.dense.rows(), 3);
        const Eigen::MatrixXd expected = p.dense.llt().solve(b);
        EXPECT_LT((cholesky.solve(b) - expected).norm(), 1e-12 * expected.norm())
            << n << ' ' << chords << ' ' << d;
      }
    }
  }
}

TEST(BlockCholesky, GivesTheSameBytesWithAnyNumberOfThreads) {
  Rng rng(2);
  const Problem p = random_problem(300, 900, 6, rng);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Ones(p.dense.rows(), 1);
  const auto symbolic = analyze(p.pattern);
  const int before = num_threads();
  std::vector<Eigen::MatrixXd> solutions;
  for (const int threads : {1, 2, 4}) {
    set_num_threads(threads);
    BlockCholesky cholesky(symbolic, 6);
    ASSERT_FALSE(cholesky.factorize(p.values));
    solutions.push_back(cholesky.solve(b));
  }
  set_num_threads(before);
  EXPECT_TRUE(solutions[0] == solutions[1]);
  EXPECT_TRUE(solutions[0] == solutions[2]);
  EXPECT_LT((p.dense * solutions[0] - b).norm(), 1e-10);
}

// Widths and heights of fronts that fill the blocks of the dense kernels, and that do not.
TEST(BlockCholesky, SolvesInFloatsToTheirPrecision) {
  Rng rng(4);
  for (const std::size_t d : {1U, 3U, 6U}) {
    for (const std::size_t n : {1U, 9U, 90U}) {
      const Problem p = random_problem(n, 2 * n, d, rng);
      BasicBlockCholesky<float> cholesky(analyze(p.pattern), d);
      ASSERT_FALSE(cholesky.factorize(p.values));
      const Eigen::MatrixXd b = Eigen::MatrixXd::Random(p.dense.rows(), 2);
      const Eigen::MatrixXd expected = p.dense.llt().solve(b);
      EXPECT_LT((cholesky.solve(b) - expected).norm(), 1e-5 * expected.norm()) << n << ' ' << d;
    }
  }
}

// A chain of equal springs, held at one end.
TEST(BlockCholesky, KnowsItsLeastPivot) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i + 1 < 30; ++i) pairs.emplace_back(i, i + 1);
  const BlockPattern pattern = BlockPattern::of_pairs(30, pairs);
  std::vector<double> values;
  for (std::size_t j = 0; j < 30; ++j) {
    values.push_back(j + 1 < 30 ? 2.0 : 1.0);
    if (j + 1 < 30) values.push_back(-1.0);
  }
  BlockCholesky cholesky(analyze(pattern), 1);
  ASSERT_FALSE(cholesky.factorize(values));
  const Eigen::MatrixXd dense = [&] {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(30, 30);
    for (int j = 0; j < 30; ++j) {
      m(j, j) = values[static_cast<std::size_t>(2 * j)];
      if (j < 29) m(j + 1, j) = m(j, j + 1) = -1.0;
    }
    return m;
  }();
  // However it is ordered, the last pivot is the inverse of an element of the inverse's diagonal.
  const Eigen::VectorXd last = (dense.inverse().diagonal().array() * dense.diagonal().array()).inverse();
  EXPECT_GE(cholesky.least_pivot(values), last.minCoeff() - 1e-12);
  EXPECT_LE(cholesky.least_pivot(values), last.maxCoeff() + 1e-12);
}

TEST(BlockCholesky, NamesAFreeVariable) {
  Rng rng(3);
  Problem p = random_problem(10, 0, 3, rng);
  const std::size_t block = p.pattern.block(4, 4);
  for (std::size_t i = 0; i < 9; ++i) p.values[block * 9 + i] = 0.0;
  BlockCholesky cholesky(analyze(p.pattern), 3);
  EXPECT_TRUE(cholesky.factorize(p.values).has_value());
  Problem again = random_problem(10, 0, 3, rng);
  BlockCholesky other(analyze(again.pattern), 3);
  EXPECT_FALSE(other.factorize(again.values).has_value());
}

TEST(BlockCholesky, TakesAnEmptyMatrix) {
  BlockCholesky cholesky(analyze(BlockPattern::of_pairs(0, {})), 6);
  EXPECT_FALSE(cholesky.factorize({}));
  EXPECT_EQ(cholesky.solve(Eigen::MatrixXd(0, 1)).rows(), 0);
}

}  // namespace
}  // namespace adit
