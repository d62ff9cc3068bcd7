// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/gnc.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

using test::kSigma;

// A graph whose first `num_true` edges are honest; the rest are false loops.
template <class P>
struct Spoiled {
  BasicPoseGraph<P> graph;
  std::vector<P> clean_optimum;  // poses without the false loops
  std::size_t num_true = 0;
};

// Noise of kSigma metres and radians on every axis.
template <class P>
void add_edge(Rng& rng, const std::vector<P>& truth, std::size_t from, std::size_t to, EdgeKind kind,
              BasicPoseGraph<P>& graph) {
  const P noise = retract(P(), test::random_tangent<P>(rng, kSigma));
  graph.edges.push_back({from, to, truth[from].inverse() * truth[to] * noise,
                         P::Jacobian::Identity() / (kSigma * kSigma), kind});
}

template <class P>
void dead_reckon(BasicPoseGraph<P>& graph) {
  for (const auto& edge : graph.edges) {
    if (edge.kind == EdgeKind::odometry)
      graph.nodes[edge.to].pose = graph.nodes[edge.from].pose * edge.T_from_to;
  }
}

// A walk to and fro over a grid, each row linked to the one before; the guess is dead reckoning.
template <class P>
Spoiled<P> grid(Rng& rng, std::size_t side, const std::vector<P>& truth) {
  Spoiled<P> made;
  for (std::size_t i = 0; i < truth.size(); ++i) made.graph.nodes.push_back({i, truth[i]});
  for (std::size_t i = 0; i + 1 < truth.size(); ++i)
    add_edge(rng, truth, i, i + 1, EdgeKind::odometry, made.graph);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::size_t above = (i / side + 1) * side + (side - 1 - i % side);
    if (above < truth.size() && above > i + 1) add_edge(rng, truth, i, above, EdgeKind::loop, made.graph);
  }
  dead_reckon(made.graph);
  made.clean_optimum = optimize(made.graph).poses;
  made.num_true = made.graph.edges.size();
  return made;
}

Spoiled<Pose2> grid_in_the_plane(Rng& rng, std::size_t side) {
  std::vector<Pose2> truth;
  for (std::size_t i = 0; i < side * side; ++i) {
    const std::size_t row = i / side;
    const bool back = row % 2 == 1;
    const std::size_t x = back ? side - 1 - i % side : i % side;
    truth.emplace_back(static_cast<double>(x), static_cast<double>(row), back ? M_PI : 0.0);
  }
  return grid(rng, side, truth);
}

// Rings from pole to pole, as in the well-known sphere data; each ring turns the other way.
Spoiled<Pose> sphere(Rng& rng, std::size_t side) {
  std::vector<Pose> truth;
  for (std::size_t i = 0; i < side * side; ++i) {
    const std::size_t ring = i / side;
    const bool back = ring % 2 == 1;
    const auto x = static_cast<double>(back ? side - 1 - i % side : i % side);
    const double azimuth = 2.0 * M_PI * x / static_cast<double>(side);
    const double polar = M_PI * (static_cast<double>(ring) + 0.5) / static_cast<double>(side);
    const Vector3 position = 5.0 * Vector3(std::sin(polar) * std::cos(azimuth),
                                           std::sin(polar) * std::sin(azimuth), std::cos(polar));
    truth.emplace_back(so3::exp(Vector3(0.0, 0.0, azimuth)) * so3::exp(Vector3(0.0, polar, 0.0)), position);
  }
  return grid(rng, side, truth);
}

// `share` of all loops is false afterwards: between any two nodes, with any transform of the graph's size.
template <class P>
void add_random_false_loops(Rng& rng, double share, Spoiled<P>& made) {
  const std::size_t n = made.graph.nodes.size();
  const auto num_loops = static_cast<double>(made.num_true - (n - 1));
  const auto num_false = static_cast<std::size_t>(num_loops * share / (1.0 - share));
  while (made.graph.edges.size() < made.num_true + num_false) {
    const std::size_t a = rng.below(n);
    const std::size_t b = rng.below(n);
    if (a + 1 >= b) continue;
    made.graph.edges.push_back(
        {a, b, test::random_pose<P>(rng, 5.0), P::Jacobian::Identity() / (kSigma * kSigma), EdgeKind::loop});
  }
}

// All false loops go, at most `max_lost` true ones with them, and the poses are those without false loops.
template <class P>
void expect_recovered(const Spoiled<P>& made, std::size_t max_lost, const GncConfig& config = {}) {
  const Solution<P> s = optimize_gnc(made.graph, config);
  ASSERT_EQ(s.status, SolveStatus::converged) << s.reason;
  std::size_t num_lost = 0;
  for (std::size_t e = 0; e < made.graph.edges.size(); ++e) {
    if (e >= made.num_true)
      EXPECT_EQ(s.edge_weights[e], 0.0) << "edge " << e;
    else if (s.edge_weights[e] < 0.5)
      ++num_lost;
  }
  EXPECT_LE(num_lost, max_lost);
  double squares = 0.0;
  for (std::size_t i = 0; i < s.poses.size(); ++i)
    squares += (s.poses[i].translation() - made.clean_optimum[i].translation()).squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(s.poses.size())), kSigma);
}

TEST(Gnc, RejectsRandomLoopsOfAGridInThePlane) {
  for (const double share : {0.1, 0.3, 0.6}) {
    Rng rng(21);
    Spoiled<Pose2> made = grid_in_the_plane(rng, 9);
    add_random_false_loops(rng, share, made);
    SCOPED_TRACE(share);
    expect_recovered(made, 1);
  }
}

TEST(Gnc, RejectsRandomLoopsOfASphere) {
  for (const double share : {0.1, 0.3, 0.6}) {
    Rng rng(22);
    Spoiled<Pose> made = sphere(rng, 10);
    add_random_false_loops(rng, share, made);
    SCOPED_TRACE(share);
    expect_recovered(made, 1);
  }
}

TEST(Gnc, ThePlainSearchRejectsRandomLoopsToo) {
  GncConfig config;
  config.plain = true;
  for (const double share : {0.1, 0.3}) {
    Rng rng(22);
    Spoiled<Pose> made = sphere(rng, 10);
    add_random_false_loops(rng, share, made);
    SCOPED_TRACE(share);
    expect_recovered(made, 1, config);
  }
}

TEST(Gnc, ThePlainSearchKeepsItsBound) {
  // Information that understates: the whole search draws the bound in, the plain one keeps what passes it.
  Rng rng(30);
  Spoiled<Pose> made = sphere(rng, 8);
  for (auto& edge : made.graph.edges) edge.information *= 1e-4;
  auto off = made.graph.edges.back();
  off.T_from_to = off.T_from_to * Pose::translation_of(40.0 * kSigma, 0.0, 0.0);
  made.graph.edges.push_back(off);
  GncConfig config;
  EXPECT_EQ(optimize_gnc(made.graph, config).edge_weights.back(), 0.0);
  config.plain = true;
  EXPECT_EQ(optimize_gnc(made.graph, config).edge_weights.back(), 1.0);
}

TEST(Gnc, StandsFalseLoopsThatAgreeWithEachOther) {
  // Two galleries that look alike: ten loops say that row 7 is row 2, as if one wall stood for the other.
  Rng rng(23);
  Spoiled<Pose> made = sphere(rng, 10);
  for (std::size_t k = 0; k < 10; ++k) {
    made.graph.edges.push_back({20 + k, 70 + (9 - k), Pose::exp(test::random_tangent<Pose>(rng, kSigma)),
                                Matrix6::Identity() / (kSigma * kSigma), EdgeKind::loop});
  }
  expect_recovered(made, 1);
}

// Two robots, each along its own row of one hall; `T_guess_world` displaces the second one's guess.
Spoiled<Pose> two_robots(Rng& rng, const Pose& T_guess_world) {
  constexpr std::size_t kLength = 40;
  std::vector<Pose> truth;
  Spoiled<Pose> made;
  for (std::size_t i = 0; i < 2 * kLength; ++i) {
    const bool second = i >= kLength;
    const auto along = static_cast<double>(i % kLength);
    truth.push_back(Pose::planar(along, second ? 1.0 : 0.0, 0.0, std::sin(0.3 * along)));
    made.graph.nodes.push_back({second ? i - kLength + (std::uint64_t{1} << 56U) : i, truth.back()});
  }
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    if (i + 1 != kLength) add_edge(rng, truth, i, i + 1, EdgeKind::odometry, made.graph);
  }
  for (std::size_t i = 0; i < kLength; i += 2)
    add_edge(rng, truth, i, i + kLength, EdgeKind::loop, made.graph);
  dead_reckon(made.graph);
  made.clean_optimum = optimize(made.graph).poses;
  made.num_true = made.graph.edges.size();
  for (std::size_t i = kLength; i < 2 * kLength; ++i)
    made.graph.nodes[i].pose = T_guess_world * made.graph.nodes[i].pose;
  return made;
}

TEST(Gnc, FindsTheFrameBetweenTwoRobotsFromABadGuess) {
  for (const double far : {0.0, 3.0, 300.0}) {
    Rng rng(24);
    Spoiled<Pose> made = two_robots(rng, Pose::planar(far, -far, far > 0.0 ? 2.5 : 0.0));
    add_random_false_loops(rng, 0.3, made);
    SCOPED_TRACE(far);
    expect_recovered(made, 0);
  }
}

TEST(Gnc, KeepsTheFrameOfAGoodGuessThatLeastSquaresWouldSpoil) {
  // Ten false loops agree that the second robot runs 20 m further on; the guess knows better.
  Rng rng(25);
  Spoiled<Pose> made = two_robots(rng, Pose());
  for (std::size_t k = 0; k < 10; ++k) {
    made.graph.edges.push_back({k + 20, k + 40, Pose::exp(test::random_tangent<Pose>(rng, kSigma)),
                                Matrix6::Identity() / (kSigma * kSigma), EdgeKind::loop});
  }
  expect_recovered(made, 0);
}

// Loops of a run of neighbours that share one wrong transform, each with noise of its own.
template <class P>
void add_false_run(Rng& rng, const std::vector<P>& truth, std::size_t from, std::size_t to,
                   std::size_t length, const P& mistake, BasicPoseGraph<P>& graph) {
  for (std::size_t k = 0; k < length; ++k) {
    const P noise = retract(P(), test::random_tangent<P>(rng, kSigma));
    const P seen = truth[from].inverse() * truth[from + k];
    graph.edges.push_back({from + k, to + k,
                           seen.inverse() * mistake * (truth[to].inverse() * truth[to + k]) * noise,
                           P::Jacobian::Identity() / (kSigma * kSigma), EdgeKind::loop});
  }
}

std::vector<Pose2> rows(std::size_t side) {
  std::vector<Pose2> truth;
  for (std::size_t i = 0; i < side * side; ++i) {
    const bool back = i / side % 2 == 1;
    truth.emplace_back(static_cast<double>(back ? side - 1 - i % side : i % side),
                       static_cast<double>(i / side), back ? M_PI : 0.0);
  }
  return truth;
}

// A thin graph, few of whose loops are neighbours, with as many false loops in runs of ten as true ones. Its
// information matrices understate what the sensors can do: by them odometry bends to anything.
Spoiled<Pose2> thin_and_loose(Rng& rng, std::size_t num_runs) {
  constexpr std::size_t kSide = 14;
  const std::vector<Pose2> truth = rows(kSide);
  Spoiled<Pose2> made = grid(rng, kSide, truth);
  std::size_t loop = 0;
  std::erase_if(made.graph.edges,
                [&](const auto& edge) { return edge.kind == EdgeKind::loop && loop++ % 6 > 2; });
  for (auto& edge : made.graph.edges) edge.information *= 1e-4;
  made.clean_optimum = optimize(made.graph).poses;
  made.num_true = made.graph.edges.size();
  for (std::size_t k = 0; k < num_runs; ++k) {
    // Drawn one by one: the order in which arguments are evaluated is the compiler's choice.
    const std::size_t from = rng.below(60);
    const std::size_t to = from + 60 + rng.below(60);
    const double x = 5.0 * rng.normal();
    const double y = 5.0 * rng.normal();
    add_false_run(rng, truth, from, to, 10, Pose2(x, y, rng.normal()), made.graph);
  }
  for (std::size_t e = made.num_true; e < made.graph.edges.size(); ++e)
    made.graph.edges[e].information *= 1e-4;
  return made;
}

// Whether no false loop is kept and hardly a true one lost.
bool is_recovered(const Spoiled<Pose2>& made, std::size_t most_lost) {
  const Solution<Pose2> s = optimize_gnc(made.graph);
  std::size_t lost = 0;
  for (std::size_t e = 0; e < made.graph.edges.size(); ++e) {
    const bool kept = s.edge_weights[e] > 0.5;
    if (e < made.num_true && !kept) ++lost;
    if (e >= made.num_true && kept) return false;
  }
  return s.ok() && lost <= most_lost;
}

TEST(Gnc, FindsRunsOfFalseLoopsWhereOdometryIsStatedLoosely) {
  // Where more than half of the loops are false (9 runs) the search misses one arrangement in five: the truth
  // would cost less.
  std::string missed;
  int num_missed = 0;
  for (const std::uint64_t seed : {31U, 32U, 33U, 34U}) {
    for (const std::size_t num_runs : {1U, 4U, 9U}) {
      Rng rng(seed);
      if (is_recovered(thin_and_loose(rng, num_runs), 6)) continue;
      missed += " seed " + std::to_string(seed) + " with " + std::to_string(num_runs) + " runs";
      ++num_missed;
    }
  }
  EXPECT_LE(num_missed, 1) << "of 12:" << missed;
}

// A path along which odometry drifts by `sigma` metres and radians per step of one metre.
BasicPoseGraph<Pose2> path(Rng& rng, const std::vector<Pose2>& truth, double sigma) {
  BasicPoseGraph<Pose2> graph;
  for (std::size_t i = 0; i < truth.size(); ++i) graph.nodes.push_back({i, truth[i]});
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    const Pose2 noise = retract(Pose2(), test::random_tangent<Pose2>(rng, sigma));
    graph.edges.push_back({i, i + 1, truth[i].inverse() * truth[i + 1] * noise,
                           Pose2::Jacobian::Identity() / (sigma * sigma), EdgeKind::odometry});
  }
  dead_reckon(graph);
  return graph;
}

TEST(Gnc, KeepsALoneGroupOfTrueLoopsThatMovesTheMap) {
  Rng rng(34);
  const std::vector<Pose2> truth = rows(9);
  BasicPoseGraph<Pose2> graph = path(rng, truth, 0.1);
  for (std::size_t k = 0; k < 6; ++k) add_edge(rng, truth, k, 72 + k, EdgeKind::loop, graph);
  const Solution<Pose2> s = optimize_gnc(graph);
  EXPECT_EQ(s.edge_weights, std::vector<double>(graph.edges.size(), 1.0));
  EXPECT_TRUE(s.refused.empty());
}

TEST(Gnc, RefusesBothOfTwoGroupsThatContradictEachOtherWhereOdometryCannotDecide) {
  // Both ends of a path of 80 m, which drifts by half a metre and half a radian per step.
  Rng rng(35);
  const std::vector<Pose2> truth = rows(9);
  BasicPoseGraph<Pose2> graph = path(rng, truth, 0.5);
  const std::size_t num_odometry = graph.edges.size();
  for (std::size_t k = 0; k < 6; ++k) add_edge(rng, truth, k, 72 + k, EdgeKind::loop, graph);
  add_false_run(rng, truth, 0, 72, 6, Pose2(9.0, -7.0, 2.0), graph);
  const Solution<Pose2> s = optimize_gnc(graph);
  ASSERT_TRUE(s.ok());
  for (std::size_t e = num_odometry; e < graph.edges.size(); ++e) EXPECT_EQ(s.edge_weights[e], 0.0) << e;
  EXPECT_EQ(s.refused.size(), 6U);
  ASSERT_FALSE(s.notes.empty());
  EXPECT_NE(s.notes.front().find("6 loops in one group refused"), std::string::npos) << s.notes.front();
}

TEST(Gnc, KeepsLoopsThatShowTheirNoiseBesideThoseThatCannot) {
  // Loops over 100 steps fit far better than their noise, as odometry gives way. That is no reason to expect
  // as much of those over two steps.
  std::vector<Pose2> truth;
  for (std::size_t i = 0; i < 2001; ++i) truth.emplace_back(static_cast<double>(i), 0.0, 0.0);
  std::size_t lost = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Rng rng(36 + seed);
    BasicPoseGraph<Pose2> graph = path(rng, truth, kSigma);
    for (std::size_t k = 0; k < 20; ++k) add_edge(rng, truth, 100 * k, 100 * k + 100, EdgeKind::loop, graph);
    for (const std::size_t k : {350U, 1150U}) add_edge(rng, truth, k, k + 2, EdgeKind::loop, graph);
    lost += static_cast<std::size_t>(std::ranges::count(optimize_gnc(graph).edge_weights, 0.0));
  }
  EXPECT_EQ(lost, 0U);
}

// Expects of every phase that its number of steps is known and not exceeded.
class StepCounter : public ProgressObserver {
 public:
  PhaseId begin(std::string_view /*name*/, std::size_t total, PhaseId /*parent*/) override {
    EXPECT_GT(total, 0U);
    left_[++last_] = total;
    return last_;
  }
  void advance(PhaseId phase, std::size_t steps) override {
    EXPECT_GE(left_.at(phase), steps);
    left_.at(phase) -= steps;
    num_steps_ += steps;
  }
  void end(PhaseId /*phase*/) noexcept override {}
  [[nodiscard]] bool cancelled() const noexcept override { return false; }
  [[nodiscard]] std::size_t num_steps() const { return num_steps_; }

 private:
  std::map<PhaseId, std::size_t> left_;
  PhaseId last_ = 0;
  std::size_t num_steps_ = 0;
};

TEST(Gnc, TellsHowFarItIs) {
  Rng rng(21);
  Spoiled<Pose2> made = grid_in_the_plane(rng, 9);
  add_random_false_loops(rng, 0.6, made);
  for (const bool plain : {false, true}) {
    GncConfig config;
    config.plain = plain;
    StepCounter counter;
    const ObserverScope scope(counter);
    ASSERT_TRUE(optimize_gnc(made.graph, config).ok());
    EXPECT_GT(counter.num_steps(), 3U);
  }
}

TEST(Gnc, LosesNothingWithoutFalseLoops) {
  Rng rng(26);
  GncConfig config;
  config.inlier_probability = 0.999999;
  expect_recovered(sphere(rng, 8), 0, config);
  expect_recovered(grid_in_the_plane(rng, 8), 0, config);
  expect_recovered(two_robots(rng, Pose::planar(50.0, 20.0, -2.0)), 0, config);
}

TEST(Gnc, LeavesOdometryAlone) {
  Rng rng(27);
  auto made = test::make_graph<Pose>(rng, 20, 0, 0.05);
  made.graph.nodes[7].pose = test::random_pose<Pose>(rng, 10.0);
  const auto s = optimize_gnc(made.graph);
  EXPECT_EQ(s.status, SolveStatus::converged);
  EXPECT_NEAR(s.cost_final, 0.0, 1e-9);
  EXPECT_EQ(s.edge_weights, std::vector<double>(made.graph.edges.size(), 1.0));
  EXPECT_EQ(optimize_gnc(PoseGraph{}).status, SolveStatus::converged);
}

TEST(Gnc, PassesErrorsOn) {
  Rng rng(28);
  auto made = test::make_graph<Pose>(rng, 5, 3, 0.05);
  made.graph.edges[2].information(0, 5) = made.graph.edges[2].information(5, 0) = 1e9;
  EXPECT_EQ(optimize_gnc(made.graph).status, SolveStatus::indefinite_information);
  made.graph.edges[2].information.setZero();
  made.graph.edges.resize(4);
  EXPECT_EQ(optimize_gnc(made.graph).status, SolveStatus::singular);
}

TEST(Gnc, GivesTheSameBytesWithAnyNumberOfThreads) {
  Rng rng(29);
  Spoiled<Pose> made = sphere(rng, 8);
  add_random_false_loops(rng, 0.3, made);
  const int before = num_threads();
  std::vector<Solution<Pose>> solutions;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    solutions.push_back(optimize_gnc(made.graph));
  }
  set_num_threads(before);
  EXPECT_EQ(solutions[0].cost_final, solutions[1].cost_final);
  EXPECT_EQ(solutions[0].edge_weights, solutions[1].edge_weights);
  for (std::size_t i = 0; i < made.graph.nodes.size(); ++i)
    EXPECT_EQ(solutions[0].poses[i].matrix(), solutions[1].poses[i].matrix());
}

TEST(Gnc, QuantilesOfChiSquare) {
  EXPECT_NEAR(chi2_quantile(0.99, 6), 16.811893829770927, 1e-9);
  EXPECT_NEAR(chi2_quantile(0.99, 3), 11.344866730144373, 1e-9);
  EXPECT_NEAR(chi2_quantile(0.9999, 6), 27.856340829937715, 1e-6);
  EXPECT_NEAR(chi2_quantile(0.5, 2), 1.3862943611198906, 1e-12);
}

}  // namespace
}  // namespace adit
