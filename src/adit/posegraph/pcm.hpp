// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/pose.hpp"
#include "adit/geometry/max_clique.hpp"
#include "adit/posegraph/odometry_chain.hpp"

namespace adit {

/// How strict the test is, and how long the search may take.
struct PcmConfig {
  double probability =
      0.99;  ///< Two true loops pass the test this often (chi-square with 6 degrees of freedom).
  std::uint64_t max_search_nodes = 20'000'000;
};
/// The keys are the names of the fields.
inline Fields fields_of(PcmConfig& c) {
  return {{"probability", &c.probability, "", 0.01, 0.999999, "probability that two true loops agree"},
          {"max_search_nodes", &c.max_search_nodes, "", 1, 1e15, "budget of the clique search, in branches"}};
}

/// A loop as PCM sees it: keyframe `a` of the first chain, `b` of the second.
struct PcmLoop {
  std::size_t a = 0;                          ///< Index into the first chain.
  std::size_t b = 0;                          ///< Index into the second.
  Pose T_a_b;                                 ///< The measurement.
  Matrix6 information = Matrix6::Identity();  ///< Of T_a_b, right perturbation.
};

/// Which loops agree, and the largest sets of those that all do.
struct PcmResult {
  BitGraph consistency{0};           ///< One vertex per loop.
  std::vector<std::size_t> largest;  ///< Indices of loops, ascending: the loops to keep.
  std::vector<std::size_t>
      second;           ///< Largest clique among the rest: a rival explanation if nearly as large.
  bool optimal = true;  ///< Both cliques are proven largest.
};

/// Pairwise consistent measurement set maximization: the largest set of loops of which any two agree along
/// both odometries. Two loops (i, k), (j, l) agree when E = Z_ik^-1 X_ij Z_jl X_lk, the way round the cycle,
/// has log(E)^T S^-1 log(E) < chi2inv(probability, 6), S being composed of the four covariances, each carried
/// to the end of the cycle by adjoints. With the same chain given twice (loops within one robot) the
/// correlation of shared stretches is taken into account. Loops with a singular information matrix or indices
/// outside the chains throw ContractViolation. Source: Mangelson, Dominic, Eustice, Vasudevan, "Pairwise
/// consistent measurement set maximization for robust multi-robot map merging" (ICRA 2018), eq. (3)-(6).
[[nodiscard]] PcmResult pcm(const OdometryChain& chain_a, const OdometryChain& chain_b,
                            const std::vector<PcmLoop>& loops, const PcmConfig& config = {});

/// log(E)^T S^-1 log(E) of one pair of loops.
[[nodiscard]] double consistency_distance2(const OdometryChain& chain_a, const OdometryChain& chain_b,
                                           const PcmLoop& first, const PcmLoop& second);

}  // namespace adit
