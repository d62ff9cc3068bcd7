// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/robust_incremental.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/gnc.hpp"

namespace adit {
namespace {

constexpr double kVarianceHeadroom = 4.0;  // times the variance: long cycles close worse than short ones
constexpr double kLuckOfFit = 1e-3;        // that a fit as good as the one at hand is luck
constexpr int kManyRedundancies = 600;     // more leave no doubt of the variance
constexpr double kSmallestVariance = 1e-6;
constexpr std::size_t kExaminedPerStep = 500;  // loops left out whose residual is looked at again
constexpr std::size_t kWeighedPerStep = 20;    // of these, weighed anew
constexpr std::size_t kPairsPerLoop = 8;       // waiting loops that a new one is compared with
constexpr std::size_t kDroppedPerStep = 5;     // loops taken out of use
constexpr std::size_t kPairReach = 25;         // nodes between the ends of loops that are compared together

enum class Verdict { unjudged, in_use, waits, left_out };

}  // namespace

template <class P>
struct RobustIncremental<P>::Impl {
  static constexpr int D = P::kDof;

  explicit Impl(const RobustIncrementalConfig& c) : config(c), optimizer(solver_config(c)) {
    for (int pair = 1; pair <= 2; ++pair) bounds[pair] = chi2_quantile(c.inlier_probability, pair * D);
  }
  static OptimizerConfig solver_config(const RobustIncrementalConfig& c) {
    OptimizerConfig out;
    out.max_iterations = c.max_iterations;
    out.relative_tolerance = c.relative_tolerance;
    return out;
  }

  RobustIncrementalConfig config;
  IncrementalOptimizer<P> optimizer;
  std::vector<Verdict> verdicts;       // one per edge; in use for odometry
  std::vector<std::size_t> new_loops;  // not judged yet
  std::vector<std::size_t> waiting;
  std::vector<std::size_t> left_out;              // and those that wait
  std::vector<std::vector<std::size_t>> kept_at;  // loops in use, by node
  std::size_t next_examined = 0;                  // of left_out
  std::size_t num_used = 0;                       // loops
  double bounds[3] = {0.0, 0.0, 0.0};             // chi2 of one loop and of two
  double variance = 1.0;                          // expected
  double variance_limit = 1.0;                    // that the bound allows for

  [[nodiscard]] const Edge& edge(std::size_t e) const { return optimizer.graph().edges[e]; }

  bool solve(Step& step) {
    const auto u = optimizer.update(std::max(0, config.max_iterations - step.iterations));
    step.iterations += u.iterations;
    is_solved = u.status == SolveStatus::converged;
    step.status = u.status;
    step.reason = u.reason;
    if (u.status != SolveStatus::converged && u.status != SolveStatus::max_iterations) return false;
    moved.insert(moved.end(), u.moved.begin(), u.moved.end());
    const int redundancy = static_cast<int>(num_used) * D;
    if (redundancy == 0) return true;
    const int counted = std::min(redundancy, kManyRedundancies);
    const double fit = std::clamp(u.cost / redundancy, kSmallestVariance, 1.0);
    variance = std::min(1.0, fit * counted / chi2_quantile(kLuckOfFit, counted));
    variance_limit = std::min(1.0, kVarianceHeadroom * variance);
    return true;
  }
  std::vector<std::size_t> moved;  // nodes whose loops in use are to be looked at again
  bool is_solved = true;           // the last solution converged

  // Variance of the map's positions, by the axis in which it is largest.
  [[nodiscard]] double spread() const {
    const auto& poses = optimizer.poses();
    auto sum = poses.front().translation();
    sum.setZero();
    auto squares = sum;
    for (const P& pose : poses) {
      sum += pose.translation();
      squares += pose.translation().cwiseAbs2();
    }
    const auto n = static_cast<double>(poses.size());
    return (squares / n - (sum / n).cwiseAbs2()).maxCoeff();
  }

  struct Innovation {
    Eigen::VectorXd residual;
    Eigen::MatrixXd covariance;
  };
  // How well loops agree with the rest of the graph, and with one another.
  struct Weight {
    double chi2 = 0.0;      // by the variance limit
    double log_odds = 0.0;  // that all are true, beyond what is asked
  };
  // What is predicted of loops, with the noise of their own measurements.
  [[nodiscard]] Innovation innovation_of(const std::vector<std::size_t>& loops) {
    auto [residual, covariance] = optimizer.predict(loops);
    for (std::size_t k = 0; k < loops.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k) * D;
      covariance.block(at, at, D, D) += edge(loops[k]).information.llt().solve(P::Jacobian::Identity());
    }
    return {std::move(residual), std::move(covariance)};
  }
  [[nodiscard]] Weight weigh(const Innovation& innovation) const {
    const Eigen::Index rows = innovation.residual.size();
    Eigen::VectorXd anywhere(rows);
    constexpr int kTranslation = D == 6 ? 3 : 2;
    for (Eigen::Index at = 0; at < rows; at += D) {
      anywhere.segment(at, D).setConstant(std::numbers::pi * std::numbers::pi / 3.0);
      anywhere.segment(at, kTranslation).setConstant(2.0 * map_spread);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(innovation.covariance);
    Weight out;
    const double unscaled = innovation.residual.dot(factor.solve(innovation.residual));
    out.chi2 = unscaled / variance_limit;
    const double log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum() +
                           static_cast<double>(rows) * std::log(variance);
    const double false_share = static_cast<double>(verdicts_of_loops[1] + 1) /
                               static_cast<double>(verdicts_of_loops[0] + verdicts_of_loops[1] + 2);
    const double asked = std::log(config.true_share / (1.0 - config.true_share));
    const double prior = std::log(false_share / (1.0 - false_share));
    out.log_odds = 0.5 * (anywhere.array().log().sum() - log_det) - 0.5 * unscaled / variance -
                   static_cast<double>(rows) / D * prior - asked;
    return out;
  }
  [[nodiscard]] bool is_accepted(const Weight& weight) const {
    return weight.chi2 <= bounds[1] && weight.log_odds > 0.0;
  }
  double map_spread = 1.0;
  std::size_t verdicts_of_loops[2] = {0, 0};  // in use, left out

  [[nodiscard]] double own_chi2(std::size_t e) const {
    const Edge& loop = edge(e);
    const auto r = between_residual(loop.T_from_to, optimizer.poses()[loop.from], optimizer.poses()[loop.to]);
    return r.dot(loop.information * r);
  }

  void take(std::size_t e, Step& step) {
    if (verdicts[e] == Verdict::waits || verdicts[e] == Verdict::left_out) {
      std::erase(waiting, e);
      std::erase(left_out, e);
      --verdicts_of_loops[1];
    }
    verdicts[e] = Verdict::in_use;
    ++verdicts_of_loops[0];
    ++num_used;
    optimizer.set_use(e, EdgeUse::in_use);
    kept_at[edge(e).from].push_back(e);
    kept_at[edge(e).to].push_back(e);
    step.accepted.push_back(e);
  }

  void leave(std::size_t e, Verdict verdict) {
    if (verdicts[e] == Verdict::unjudged || verdicts[e] == Verdict::in_use) {
      left_out.push_back(e);
      ++verdicts_of_loops[1];
    }
    if (verdicts[e] == Verdict::waits) std::erase(waiting, e);
    if (verdict == Verdict::waits) waiting.push_back(e);
    verdicts[e] = verdict;
  }

  void drop(std::size_t e, Step& step) {
    --verdicts_of_loops[0];
    --num_used;
    leave(e, Verdict::left_out);
    optimizer.set_use(e, EdgeUse::out_of_use);
    std::erase(kept_at[edge(e).from], e);
    std::erase(kept_at[edge(e).to], e);
    if (std::erase(step.accepted, e) == 0) step.dropped.push_back(e);
  }

  // A loop by itself, then with those that wait near it.
  bool judge(std::size_t e, Step& step) {
    const Weight alone = weigh(innovation_of({e}));
    if (alone.chi2 > bounds[1]) {
      leave(e, Verdict::left_out);
      return true;
    }
    if (alone.log_odds > 0.0) {
      take(e, step);
      return solve(step);
    }
    const auto near = [](std::size_t a, std::size_t b) { return (a < b ? b - a : a - b) <= kPairReach; };
    std::size_t compared = 0;
    const std::vector<std::size_t> others = waiting;
    for (std::size_t k = others.size(); k-- > 0 && compared < kPairsPerLoop;) {
      const Edge& a = edge(e);
      const Edge& b = edge(others[k]);
      if (others[k] == e) continue;
      if (!(near(a.from, b.from) && near(a.to, b.to)) && !(near(a.from, b.to) && near(a.to, b.from)))
        continue;
      ++compared;
      const Weight both = weigh(innovation_of({e, others[k]}));
      if (both.chi2 > bounds[2] || both.log_odds <= 0.0) continue;
      take(e, step);
      take(others[k], step);
      return solve(step);
    }
    leave(e, Verdict::waits);
    return true;
  }

  // Of loops that are accepted by themselves, those that are still accepted after the ones before them: what
  // a loop makes of the prediction of the others follows from their joint covariance, without a solution.
  [[nodiscard]] std::vector<std::size_t> compatible(const std::vector<std::size_t>& loops) {
    if (loops.size() < 2) return loops;
    Innovation all = innovation_of(loops);
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < loops.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k) * D;
      const Innovation one{all.residual.segment(at, D), all.covariance.block(at, at, D, D)};
      if (!is_accepted(weigh(one))) continue;
      out.push_back(loops[k]);
      const Eigen::MatrixXd gain = one.covariance.llt().solve(all.covariance.middleRows(at, D)).transpose();
      all.residual -= gain * one.residual;
      all.covariance -= (gain * one.covariance * gain.transpose()).eval();
    }
    return out;
  }

  // New loops: those that are accepted together cost one solution; those that lack evidence are judged after
  // it.
  bool judge_new(const std::vector<std::size_t>& loops, Step& step) {
    if (loops.size() < 2) return loops.empty() || judge(loops.front(), step);
    std::vector<std::size_t> accepted;
    for (const std::size_t e : loops) {
      const Weight alone = weigh(innovation_of({e}));
      if (is_accepted(alone)) accepted.push_back(e);
      if (alone.chi2 > bounds[1]) leave(e, Verdict::left_out);
    }
    for (const std::size_t e : compatible(accepted)) take(e, step);
    if (!step.accepted.empty() && !solve(step)) return false;
    const double bound = bounds[1] * variance_limit;
    for (const std::size_t e : loops) {
      const bool may_fit_now =
          !step.accepted.empty() && verdicts[e] == Verdict::left_out && own_chi2(e) <= bound;
      if ((verdicts[e] == Verdict::unjudged || may_fit_now) && !judge(e, step)) return false;
    }
    return true;
  }

  // Loops in use that what came since contradicts. Where the poses are still on their way, that can wait.
  bool drop_contradicted(Step& step) {
    if (!is_solved) return true;
    for (std::size_t round = 0; round < kDroppedPerStep; ++round) {
      std::optional<std::size_t> worst;
      double largest = bounds[1] * variance_limit;
      if (!std::ranges::is_sorted(moved)) std::ranges::sort(moved);
      moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
      for (const std::size_t node : moved) {
        for (const std::size_t e : kept_at[node]) {
          const double chi2 = optimizer.chi2(e);
          if (chi2 <= largest) continue;
          largest = chi2;
          worst = e;
        }
      }
      if (!worst) {
        moved.clear();
        return true;
      }
      drop(*worst, step);
      if (!solve(step)) return false;
    }
    return true;
  }

  // Loops left out that the present map may explain.
  bool examine_again(Step& step) {
    std::vector<std::size_t> fits;
    const double bound = bounds[1] * variance_limit;
    for (std::size_t k = 0; k < std::min(kExaminedPerStep, left_out.size()); ++k) {
      next_examined = (next_examined + 1) % left_out.size();
      const std::size_t e = left_out[next_examined];
      if (verdicts[e] == Verdict::left_out && own_chi2(e) <= bound) fits.push_back(e);
    }
    const std::size_t num_waiting = std::min(waiting.size(), kWeighedPerStep);
    fits.resize(std::min(fits.size(), kWeighedPerStep));
    if (!moved.empty())
      fits.insert(fits.end(), waiting.end() - static_cast<std::ptrdiff_t>(num_waiting), waiting.end());
    for (const std::size_t e : fits)
      if (verdicts[e] != Verdict::in_use && !judge(e, step)) return false;
    return true;
  }

  bool run(Step& step) {
    if (!solve(step)) return false;
    map_spread = std::max(spread(), kSmallestVariance);
    const std::vector<std::size_t> loops = std::exchange(new_loops, {});
    if (!judge_new(loops, step)) return false;
    if (!step.accepted.empty() || !loops.empty()) {
      if (!drop_contradicted(step)) return false;
    }
    return examine_again(step) && drop_contradicted(step);
  }
};

template <class P>
RobustIncremental<P>::RobustIncremental(const RobustIncrementalConfig& config)
    : impl_(std::make_unique<Impl>(config)) {}
template <class P>
RobustIncremental<P>::RobustIncremental(RobustIncremental&&) noexcept = default;
template <class P>
RobustIncremental<P>& RobustIncremental<P>::operator=(RobustIncremental&&) noexcept = default;
template <class P>
RobustIncremental<P>::~RobustIncremental() = default;

template <class P>
std::size_t RobustIncremental<P>::add_node(std::uint64_t key, const P& pose) {
  impl_->kept_at.emplace_back();
  return impl_->optimizer.add_node(key, pose);
}

template <class P>
std::size_t RobustIncremental<P>::add_edge(const Edge& edge) {
  const bool is_loop = edge.kind == EdgeKind::loop;
  const std::size_t e = impl_->optimizer.add_edge(edge, is_loop ? EdgeUse::out_of_use : EdgeUse::in_use);
  impl_->verdicts.push_back(is_loop ? Verdict::unjudged : Verdict::in_use);
  if (is_loop) impl_->new_loops.push_back(e);
  return e;
}

template <class P>
typename RobustIncremental<P>::Step RobustIncremental<P>::update() {
  Step step;
  (void)impl_->run(step);
  step.num_waiting = impl_->waiting.size();
  step.variance = impl_->variance;
  return step;
}

template <class P>
bool RobustIncremental<P>::is_in_use(std::size_t edge) const {
  return impl_->optimizer.is_used(edge);
}
template <class P>
const std::vector<P>& RobustIncremental<P>::poses() const {
  return impl_->optimizer.poses();
}
template <class P>
const BasicPoseGraph<P>& RobustIncremental<P>::graph() const {
  return impl_->optimizer.graph();
}

template class RobustIncremental<Pose>;
template class RobustIncremental<Pose2>;

}  // namespace adit
