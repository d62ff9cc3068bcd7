// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/robot_map.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr std::array<std::pair<KeyframeSelection, std::string_view>, 4> kSelections = {
    {{KeyframeSelection::all, "all"},
     {KeyframeSelection::adaptive, "adaptive"},
     {KeyframeSelection::tunnel_filter, "tunnel_filter"},
     {KeyframeSelection::tunnel_filter_keep, "tunnel_filter_keep"}}};

void append_keyframe(RobotMap& to, const RobotMap& from, std::size_t k, const Matrix6& covariance) {
  Keyframe keyframe = from.keyframes[k];
  keyframe.id.index = static_cast<std::uint32_t>(to.keyframes.size());
  to.keyframes.push_back(std::move(keyframe));
  to.step_covariances.push_back(covariance);
  to.pose_noise.push_back(from.pose_noise[k]);
  to.places.push_back(from.places[k]);
  to.searchable.push_back(true);
  to.unconfirmed.push_back(from.unconfirmed[k]);
}

/// One per keyframe. They are the paper's policies' alone, which is why a map does not hold them.
std::vector<std::uint8_t> are_tunnel_like(const RobotMap& map, const TunnelFilterConfig& filter) {
  std::vector<std::uint8_t> are(map.keyframes.size());
  parallel_for_each(are.size(), [&](std::size_t k) {
    const Result<TunnelVerdict> verdict = tunnel_filter(*map.keyframes[k].cloud, filter);
    are[k] = !verdict || verdict->tunnel_like ? 1 : 0;
  });
  return are;
}

RobotMap without_tunnel_keyframes(const RobotMap& map, const std::vector<std::uint8_t>& are_tunnel_like) {
  RobotMap kept;
  kept.id = map.id;
  kept.name = map.name;
  kept.viewpoint = map.viewpoint;
  kept.scan_context = map.scan_context;
  kept.odometry = map.odometry;
  kept.slips = map.slips;
  kept.innovations = map.innovations;
  kept.num_degenerate = map.num_degenerate;
  kept.num_refused = map.num_refused;
  Matrix6 covariance = Matrix6::Zero();  // of the pose of k relative to the last keyframe that stayed
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    if (k > 0) {
      const Pose T_prev_k = map.keyframes[k - 1].T_odom_base.inverse() * map.keyframes[k].T_odom_base;
      const Matrix6 carry = T_prev_k.inverse().adjoint();
      covariance = carry * covariance * carry.transpose() + map.step_covariances[k];
    }
    if (are_tunnel_like[k] != 0) continue;
    append_keyframe(kept, map, k, kept.keyframes.empty() ? Matrix6(Matrix6::Zero()) : covariance);
    covariance.setZero();
  }
  return kept;
}

}  // namespace

std::optional<double> mean_of_judged(std::span<const std::optional<float>> shares) {
  double sum = 0.0;
  std::size_t num = 0;
  for (const std::optional<float>& share : shares) {
    if (!share) continue;
    sum += *share;
    ++num;
  }
  return num == 0 ? std::nullopt : std::optional(sum / static_cast<double>(num));
}

std::string_view to_string(KeyframeSelection selection) {
  return std::ranges::find(kSelections, selection, &decltype(kSelections)::value_type::first)->second;
}

Result<KeyframeSelection> keyframe_selection(std::string_view name) {
  for (const auto& [selection, text] : kSelections) {
    if (text == name) return selection;
  }
  return fail(format(
      "unknown keyframe policy '{}'; known are adaptive, all, tunnel_filter, tunnel_filter_keep", name));
}

RobotMap select_keyframes(const RobotMap& map, KeyframeSelection selection, TunnelFilterConfig filter) {
  const Result<> valid = check_fields(fields_of(filter));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
  if (selection == KeyframeSelection::tunnel_filter)
    return without_tunnel_keyframes(map, are_tunnel_like(map, filter));
  RobotMap selected = map;
  selected.searchable.assign(map.keyframes.size(), true);
  if (selection == KeyframeSelection::tunnel_filter_keep) {
    const std::vector<std::uint8_t> leave = are_tunnel_like(map, filter);
    for (std::size_t k = 0; k < leave.size(); ++k) selected.searchable[k] = leave[k] == 0;
  }
  return selected;
}

}  // namespace adit
