// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

/// Writes down what it is told: "+name/total<parent", "name*steps", "-name".
class Notes : public ProgressObserver {
 public:
  PhaseId begin(std::string_view name, std::size_t total, PhaseId parent) override {
    const std::lock_guard lock(mutex_);
    names_[++last_] = name;
    lines_.push_back(parent == 0 ? format("+{}/{}", name, total)
                                 : format("+{}/{}<{}", name, total, names_.at(parent)));
    return last_;
  }
  void advance(PhaseId phase, std::size_t steps) override {
    const std::lock_guard lock(mutex_);
    lines_.push_back(format("{}*{}", names_.at(phase), steps));
  }
  void end(PhaseId phase) noexcept override {
    const std::lock_guard lock(mutex_);
    lines_.push_back(format("-{}", names_.at(phase)));
  }
  [[nodiscard]] bool cancelled() const noexcept override { return cancelled_; }

  void cancel() { cancelled_ = true; }
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::mutex mutex_;
  std::map<PhaseId, std::string> names_;
  PhaseId last_ = 0;
  std::vector<std::string> lines_;
  std::atomic<bool> cancelled_ = false;
};

class Progress : public testing::Test {
 protected:
  void TearDown() override { set_num_threads(before_); }
  int before_ = num_threads();
};

TEST_F(Progress, PhasesNest) {
  Notes notes;
  {
    const ObserverScope scope(notes);
    const Phase outer("outer", 2);
    outer.advance();
    {
      const Phase inner("inner");
      inner.advance(3);
      outer.advance();
    }
    const Phase second("second", 1);
  }
  EXPECT_EQ(notes.lines(),
            (std::vector<std::string>{"+outer/2", "outer*1", "+inner/0<outer", "inner*3", "outer*1", "-inner",
                                      "+second/1<outer", "-second", "-outer"}));
}

TEST_F(Progress, NothingIsReportedOutsideOfAScope) {
  Notes notes;
  notes.cancel();
  { const ObserverScope scope(notes); }
  const Phase phase("unheard", 1);
  EXPECT_NO_THROW(phase.advance());
  EXPECT_NO_THROW(throw_if_cancelled());
  EXPECT_TRUE(notes.lines().empty());
}

TEST_F(Progress, ParallelLoopsReportToTheObserverOfTheirCaller) {
  for (const int threads : {1, 4}) {
    set_num_threads(threads);
    Notes notes;
    const ObserverScope scope(notes);
    const Phase outer("outer", 20);
    parallel_for_each(20, [&](std::size_t) {
      const Phase inner("inner", 1);
      outer.advance();
    });
    EXPECT_EQ(std::ranges::count(notes.lines(), "+inner/1<outer"), 20);
    EXPECT_EQ(std::ranges::count(notes.lines(), "outer*1"), 20);
    EXPECT_EQ(progress_context().observer, &notes);
  }
}

TEST_F(Progress, TwoObserversInOneProcess) {
  set_num_threads(4);
  Notes left;
  Notes right;
  right.cancel();
  std::atomic<int> done = 0;
  std::atomic<int> cancelled = 0;
  parallel_for_each(16, [&](std::size_t robot) {
    const ObserverScope scope(robot % 2 == 0 ? left : right);
    try {
      parallel_for_each(50, [](std::size_t) { const Phase phase("work"); });
      ++done;
    } catch (const Cancelled&) {
      ++cancelled;
    }
  });
  EXPECT_EQ(done, 8);
  EXPECT_EQ(cancelled, 8);
  EXPECT_EQ(std::ranges::count(left.lines(), "+work/0"), 400);
  EXPECT_TRUE(right.lines().empty());
}

TEST_F(Progress, CancellingStopsLoopsAndPhases) {
  for (const int threads : {1, 4}) {
    set_num_threads(threads);
    Notes notes;
    const ObserverScope scope(notes);
    std::atomic<int> items = 0;
    EXPECT_THROW(parallel_for_each(100000,
                                   [&](std::size_t) {
                                     if (++items == 10) notes.cancel();
                                   }),
                 Cancelled);
    EXPECT_LT(items, 1000);
    EXPECT_THROW(throw_if_cancelled(), Cancelled);
    const Phase phase("late", 1);
    EXPECT_THROW(phase.advance(), Cancelled);
  }
}

TEST_F(Progress, CodeThatSwallowsFailuresLetsACancellationPass) {
  Notes notes;
  notes.cancel();
  const ObserverScope scope(notes);
  EXPECT_THROW(
      {
        try {
          throw_if_cancelled();
        } catch (const std::exception&) {
        }
      },
      Cancelled);
}

TEST_F(Progress, APhaseEndsWhenItIsLeftByAnException) {
  Notes notes;
  const ObserverScope scope(notes);
  EXPECT_THROW(
      {
        const Phase phase("left");
        throw std::runtime_error("");
      },
      std::runtime_error);
  EXPECT_EQ(notes.lines().back(), "-left");
  EXPECT_EQ(progress_context().phase, 0U);
}

}  // namespace
}  // namespace adit
