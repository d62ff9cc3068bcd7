// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

class Parallel : public testing::Test {
 protected:
  void TearDown() override { set_num_threads(before_); }
  int before_ = num_threads();
};

TEST_F(Parallel, EveryItemOnce) {
  for (const int threads : {1, 2, 4}) {
    set_num_threads(threads);
    for (const std::size_t n : {0U, 1U, 7U, 1000U}) {
      for (const std::size_t grain : {1U, 3U, 1000U, 5000U}) {
        std::vector<std::atomic<int>> visits(n);
        parallel_for_each(
            n, [&](std::size_t i) { ++visits[i]; }, grain);
        for (const auto& visit : visits) ASSERT_EQ(visit, 1);
      }
    }
  }
}

TEST_F(Parallel, PartsDependOnSizeAndGrainAlone) {
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    std::vector<std::size_t> ends(4, 0);
    parallel_for(10, 3, [&](std::size_t begin, std::size_t end) { ends[begin / 3] = end; });
    EXPECT_EQ(ends, (std::vector<std::size_t>{3, 6, 9, 10}));
  }
}

TEST_F(Parallel, SumsAreTheSameBytesWithAnyNumberOfThreads) {
  Rng rng(1);
  std::vector<double> values(100003);
  for (double& value : values) value = rng.normal() * std::exp(20.0 * rng.normal());
  const auto sum = [&] {
    return parallel_sum(values.size(), 64, 0.0, [&](std::size_t begin, std::size_t end) {
      double part = 0.0;
      for (std::size_t i = begin; i < end; ++i) part += values[i];
      return part;
    });
  };
  set_num_threads(1);
  const double alone = sum();
  for (const int threads : {2, 3, 4}) {
    set_num_threads(threads);
    for (int round = 0; round < 5; ++round) EXPECT_EQ(sum(), alone);  // Equal, not near.
  }
  EXPECT_EQ(parallel_sum(0, 8, 5, [](std::size_t, std::size_t) { return 1; }), 5);
}

TEST_F(Parallel, NumberOfThreads) {
  set_num_threads(1);
  EXPECT_EQ(num_threads(), 1);
  EXPECT_THROW(set_num_threads(0), ContractViolation);
  EXPECT_THROW(parallel_for(3, 0, [](std::size_t, std::size_t) {}), ContractViolation);
}

TEST_F(Parallel, ExceptionsReachTheCaller) {
  for (const int threads : {1, 4}) {
    set_num_threads(threads);
    EXPECT_THROW(parallel_for_each(100,
                                   [](std::size_t i) {
                                     if (i == 57) throw std::runtime_error("57");
                                   }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace adit
