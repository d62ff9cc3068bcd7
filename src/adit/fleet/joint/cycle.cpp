// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/cycle.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "adit/core/decompositions.hpp"
#include "adit/core/log_gamma.hpp"

namespace adit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The covariance of a right perturbation behind T, as one in front of it.
Matrix6 carried(const Pose& T, const Matrix6& covariance) {
  const Matrix6 adjoint = T.adjoint();
  return adjoint * covariance * adjoint.transpose();
}

}  // namespace

double drift_scale(const std::vector<Merge>& merges, const Chains& chains, const CycleConfig& config) {
  double sum = config.freedom;
  double num = config.freedom;
  for (const Merge& merge : merges) {
    if (merge.loops.size() < 2) continue;
    const auto [first, last] = std::ranges::minmax_element(merge.loops, {}, &PcmLoop::a);
    sum += consistency_distance2(chains.at(merge.a), chains.at(merge.b), *first, *last);
    num += 6.0;
  }
  return sum / num;
}

Cycle::Cycle(const Robots& robots, const std::vector<const Merge*>& merges, const Chains& chains,
             double scale, const CycleConfig& config)
    : scale_(scale), config_(config) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    legs_.push_back(passages(*merges[i], robots[i]));
    arrives_.push_back(&chains.at(robots[(i + 1) % robots.size()]));
  }
}

std::vector<Cycle::Passage> Cycle::passages(const Merge& merge, RobotId from) {
  std::vector<Passage> out;
  for (const PcmLoop& loop : merge.loops) {
    const Matrix6 covariance = inverse(loop.information);
    if (merge.a == from)
      out.push_back({loop.a, loop.b, loop.T_a_b, covariance});
    else
      out.push_back({loop.b, loop.a, loop.T_a_b.inverse(), carried(loop.T_a_b, covariance)});
  }
  return out;
}

Round Cycle::best() const {
  std::vector<Path> all;
  for (std::size_t leg = 0; leg < legs_.size(); ++leg)
    for (std::size_t p = 0; p < legs_[leg].size(); ++p) all.push_back(shortest_through(leg, p));
  const double shortest_m = std::ranges::min_element(all, {}, &Path::driven_m)->driven_m;
  std::optional<Round> best;
  for (const Path& path : all) {
    if (path.driven_m > config_.detour * shortest_m + config_.detour_m) continue;
    const Round one = around(path);
    if (!best || one.log_ratio > best->log_ratio) best = one;
  }
  return *best;
}

double Cycle::driven_m(std::size_t leg, std::size_t p, std::size_t q) const {
  const std::size_t next = (leg + 1) % legs_.size();
  const std::vector<double>& path_m = arrives_[leg]->path_m();
  return std::abs(path_m[legs_[leg][p].to] - path_m[legs_[next][q].from]);
}

Cycle::Reached Cycle::step(const Reached& before, std::size_t leg) const {
  const std::size_t leg_before = (leg + legs_.size() - 1) % legs_.size();
  Reached out;
  for (std::size_t q = 0; q < legs_[leg].size(); ++q) {
    double best_m = kInfinity;
    std::size_t best_from = 0;
    for (std::size_t r = 0; r < before.driven_m.size(); ++r) {
      const double through_m = before.driven_m[r] + driven_m(leg_before, r, q);
      if (through_m < best_m) std::tie(best_m, best_from) = std::pair(through_m, r);
    }
    out.driven_m.push_back(best_m);
    out.from.push_back(best_from);
  }
  return out;
}

// Dynamic programming over the legs.
Cycle::Path Cycle::shortest_through(std::size_t first, std::size_t p) const {
  const std::size_t n = legs_.size();
  std::vector<Reached> reached(n);
  reached[first].driven_m.assign(legs_[first].size(), kInfinity);
  reached[first].driven_m[p] = 0.0;
  for (std::size_t i = 1; i < n; ++i)
    reached[(first + i) % n] = step(reached[(first + i - 1) % n], (first + i) % n);
  const std::size_t last = (first + n - 1) % n;
  Path path{std::vector<std::size_t>(n, p), kInfinity};
  for (std::size_t q = 0; q < reached[last].driven_m.size(); ++q) {
    const double through_m = reached[last].driven_m[q] + driven_m(last, q, p);
    if (through_m < path.driven_m) std::tie(path.driven_m, path.passages[last]) = std::pair(through_m, q);
  }
  for (std::size_t i = n - 1; i > 1; --i) {
    const std::size_t leg = (first + i) % n;
    path.passages[(first + i - 1) % n] = reached[leg].from[path.passages[leg]];
  }
  return path;
}

Round Cycle::around(const Path& path) const {
  Pose T;
  Matrix6 S = Matrix6::Zero();
  const auto go = [&](const Pose& step, const Matrix6& covariance) {
    S = carried(step.inverse(), S) + covariance;
    T = T * step;
  };
  for (std::size_t leg = 0; leg < legs_.size(); ++leg) {
    const std::size_t next = (leg + 1) % legs_.size();
    const Passage& passage = legs_[leg][path.passages[leg]];
    const std::size_t leaves = legs_[next][path.passages[next]].from;
    go(passage.T_from_to, passage.covariance);
    go(arrives_[leg]->between(passage.to, leaves), arrives_[leg]->covariance(passage.to, leaves));
  }
  return {T.translation().norm(), path.driven_m, log_drift(T.log(), scale_ * S) - log_elsewhere()};
}

/// Student's t in six dimensions.
double Cycle::log_drift(const Vector6& miss, const Matrix6& covariance) const {
  const Eigen::LDLT<Matrix6> ldlt(covariance);
  const double freedom = config_.freedom;
  const double half = 0.5 * (freedom + 6.0);
  return log_gamma(half) - log_gamma(0.5 * freedom) - 3.0 * std::log(freedom * std::numbers::pi) -
         0.5 * ldlt.vectorD().array().log().sum() - half * std::log1p(miss.dot(ldlt.solve(miss)) / freedom);
}

/// Any place in a cube as wide as the longest drive, at any attitude.
double Cycle::log_elsewhere() const {
  double longest_m = 1.0;
  for (const OdometryChain* chain : arrives_) longest_m = std::max(longest_m, chain->path_m().back());
  return -3.0 * std::log(longest_m) - std::log(8.0 * std::numbers::pi * std::numbers::pi);
}

}  // namespace adit
