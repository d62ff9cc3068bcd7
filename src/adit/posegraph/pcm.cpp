// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/pcm.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/gnc.hpp"

namespace adit {
namespace {

// Both chains are the same object: then steps that both legs of the cycle drive count together.
bool same_chain(const OdometryChain& a, const OdometryChain& b) { return &a == &b; }

// Of both odometry legs, given how a step, seen from the first keyframe, shows at the end of the cycle.
Matrix6 legs_covariance(const OdometryChain& chain_a, const OdometryChain& chain_b, const PcmLoop& first,
                        const PcmLoop& second, const Matrix6& a_to_end, const Matrix6& b_to_end) {
  Matrix6 S = carry_covariance(a_to_end, chain_a.covariance_from_first(first.a, second.a)) +
              carry_covariance(b_to_end, chain_b.covariance_from_first(second.b, first.b));
  if (!same_chain(chain_a, chain_b)) return S;
  const std::size_t begin = std::max(std::min(first.a, second.a), std::min(first.b, second.b));
  const std::size_t end = std::min(std::max(first.a, second.a), std::max(first.b, second.b));
  if (begin >= end) return S;
  // A leg driven backwards has the step's error with the other sign.
  const double sign = (first.a < second.a) == (second.b < first.b) ? 1.0 : -1.0;
  const Matrix6 cross = sign * a_to_end * chain_a.covariance_from_first(begin, end) * b_to_end.transpose();
  S += cross + cross.transpose();
  return S;
}

double distance2(const OdometryChain& chain_a, const OdometryChain& chain_b, const PcmLoop& first,
                 const PcmLoop& second, const std::pair<Matrix6, Matrix6>& covariances) {
  const Pose X_lk = chain_b.between(second.b, first.b);
  const Pose back = second.T_a_b * X_lk;  // from keyframe j of a to the end of the cycle, keyframe k of b
  const Pose E = first.T_a_b.inverse() * chain_a.between(first.a, second.a) * back;
  const Matrix6 a_to_end = (chain_a.from_first(second.a) * back).inverse().adjoint();
  const Matrix6 b_to_end = chain_b.from_first(first.b).inverse().adjoint();
  const Matrix6 S = carry_covariance(E.inverse().adjoint(), covariances.first) +
                    carry_covariance(X_lk.inverse().adjoint(), covariances.second) +
                    legs_covariance(chain_a, chain_b, first, second, a_to_end, b_to_end);
  const Vector6 error = E.log();
  return error.dot(solve_symmetric(S, error));
}

std::vector<std::size_t> without(std::size_t n, const std::vector<std::uint32_t>& taken) {
  std::vector<std::size_t> rest;
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::ranges::binary_search(taken, i)) rest.push_back(i);
  }
  return rest;
}

Matrix6 covariance_of(const PcmLoop& loop) {
  const std::optional<Matrix6> covariance = inverse_of_positive_definite(loop.information);
  ADIT_CHECK(covariance, "a loop's information matrix is positive definite");
  return *covariance;
}

}  // namespace

double consistency_distance2(const OdometryChain& chain_a, const OdometryChain& chain_b, const PcmLoop& first,
                             const PcmLoop& second) {
  return distance2(chain_a, chain_b, first, second, {covariance_of(first), covariance_of(second)});
}

PcmResult pcm(const OdometryChain& chain_a, const OdometryChain& chain_b, const std::vector<PcmLoop>& loops,
              const PcmConfig& config) {
  const std::size_t n = loops.size();
  std::vector<Matrix6> covariances;
  for (const PcmLoop& loop : loops) {
    ADIT_CHECK(loop.a < chain_a.size() && loop.b < chain_b.size(),
               "a loop joins keyframes of the two chains");
    covariances.push_back(covariance_of(loop));
  }
  const double bound = chi2_quantile(config.probability, 6);
  std::vector<std::vector<std::size_t>> agreeing(n);
  parallel_for_each(n, [&](std::size_t i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double d2 = distance2(chain_a, chain_b, loops[i], loops[j], {covariances[i], covariances[j]});
      if (d2 < bound) agreeing[i].push_back(j);
    }
  });
  PcmResult result;
  result.consistency = BitGraph(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (const std::size_t j : agreeing[i]) result.consistency.add_edge(i, j);
  }
  const Clique largest = max_clique(result.consistency, config.max_search_nodes);
  const std::vector<std::size_t> rest = without(n, largest.vertices);
  BitGraph remaining(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t j = i + 1; j < rest.size(); ++j) {
      if (result.consistency.has_edge(rest[i], rest[j])) remaining.add_edge(i, j);
    }
  }
  const Clique second = max_clique(remaining, config.max_search_nodes);
  result.largest.assign(largest.vertices.begin(), largest.vertices.end());
  for (const std::size_t i : second.vertices) result.second.push_back(rest[i]);
  result.optimal = largest.optimal && second.optimal;
  return result;
}

}  // namespace adit
