// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/odometry_chain.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {

template <class P>
BasicOdometryChain<P>::BasicOdometryChain(std::vector<P> T_odom_keyframe,
                                          const std::vector<Covariance>& step_covariances)
    : T_odom_keyframe_(std::move(T_odom_keyframe)), path_m_(T_odom_keyframe_.size(), 0.0) {
  ADIT_CHECK(T_odom_keyframe_.empty() ? step_covariances.empty()
                                      : step_covariances.size() + 1 == T_odom_keyframe_.size(),
             "one step covariance between each two consecutive keyframes");
  for (std::size_t k = 1; k < path_m_.size(); ++k)
    path_m_[k] = path_m_[k - 1] + between(k - 1, k).translation().norm();
  for (std::size_t k = 0; k < size(); ++k) T_first_keyframe_.push_back(between(0, k));
  if (!T_odom_keyframe_.empty()) prefix_.push_back(Covariance::Zero());
  for (std::size_t k = 0; k < step_covariances.size(); ++k)
    prefix_.push_back(prefix_.back() + carry_covariance(from_first(k + 1).adjoint(), step_covariances[k]));
}

template <class P>
typename BasicOdometryChain<P>::Covariance BasicOdometryChain<P>::covariance_from_first(std::size_t i,
                                                                                        std::size_t j) const {
  return prefix_[std::max(i, j)] - prefix_[std::min(i, j)];
}

template <class P>
typename BasicOdometryChain<P>::Covariance BasicOdometryChain<P>::covariance(std::size_t i,
                                                                             std::size_t j) const {
  return carry_covariance(from_first(j).inverse().adjoint(), covariance_from_first(i, j));
}

std::vector<PlaceOnPath> places_on(const std::vector<OdometryPath>& paths, std::size_t num_nodes) {
  std::vector<PlaceOnPath> places(num_nodes);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    for (std::size_t k = 0; k < paths[p].nodes.size(); ++k) places[paths[p].nodes[k]] = {p, k};
  }
  return places;
}

template class BasicOdometryChain<Pose>;
template class BasicOdometryChain<Pose2>;

}  // namespace adit
