// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/peer_session.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace adit {

PeerState PeerSession::state() const {
  if (!waiting_.empty()) return PeerState::awaiting_clouds;
  if (!to_compare_.empty()) return PeerState::comparing;
  if (has_all_places_) return PeerState::awaiting_path;
  if (!places_.empty()) return PeerState::receiving_places;
  return is_searched_ ? PeerState::decided : PeerState::greeting;
}

bool PeerSession::hear(const Hello& hello, RobotId peer) {
  const auto own = std::ranges::find(hello.known, peer, &Hello::Known::robot);
  if (own == hello.known.end()) return true;
  num_keyframes_ = own->num_nodes;
  std::erase_if(waiting_, [&](const auto& entry) { return !exists(entry.first); });
  if (std::ranges::all_of(to_compare_, [&](std::uint32_t view) { return exists(view); })) return true;
  await_comparison_of({});
  return false;
}

void PeerSession::restore_searched(std::uint32_t num) {
  num_places_ = num;
  is_searched_ = true;
}

bool PeerSession::take(const Places& part) {
  const std::size_t num = part.first + part.places.size();
  if (!num_keyframes_ || num > *num_keyframes_ || num > kKeyframesPerRobot) return false;
  if (part.first > num_places_) return false;
  for (std::size_t i = num_places_ - part.first; i < part.places.size(); ++i) {
    places_.push_back(part.places[i]);
    ++num_places_;
  }
  has_all_places_ |= part.last && !places_.empty();  // what was searched is not searched again
  return true;
}

void PeerSession::forget_places() {
  num_places_ -= static_cast<std::uint32_t>(places_.size());
  places_ = {};
  has_all_places_ = false;
}

bool PeerSession::lie_within(std::size_t num_nodes) const {
  return std::ranges::all_of(
      places_, [&](const Places::Place& place) { return place.index < num_nodes || !exists(place.index); });
}

std::vector<Places::Place> PeerSession::places() const {
  std::vector<Places::Place> places;
  std::ranges::copy_if(places_, std::back_inserter(places),
                       [&](const Places::Place& place) { return exists(place.index); });
  return places;
}

void PeerSession::finish_search() {
  places_ = {};
  has_all_places_ = false;
  is_searched_ = true;
}

void PeerSession::await_clouds_of(const std::vector<LoopCandidate>& candidates) {
  for (const LoopCandidate& candidate : candidates) waiting_[candidate.match.index].push_back(candidate);
}

std::size_t PeerSession::num_waiting() const {
  std::size_t num = 0;
  for (const auto& [index, candidates] : waiting_) num += candidates.size();
  return num;
}

std::optional<CloudRequest> PeerSession::request() const {
  CloudRequest request;
  request.kind = CloudKind::submap;
  for (const auto& [index, candidates] : waiting_) {
    if (request.indices.size() == kCloudsPerMessage) break;
    request.indices.push_back(index);
  }
  if (request.indices.empty()) request = {missing_views(), CloudKind::view};
  if (request.indices.empty()) return std::nullopt;
  return request;
}

void PeerSession::await_comparison_of(std::vector<std::uint32_t> keyframes) {
  constexpr std::size_t kMaxViews = 512;  // some tens of megabytes
  to_compare_ = std::move(keyframes);
  if (to_compare_.empty() || views_.size() > kMaxViews) forget_views();
}

void PeerSession::forget_views() {
  std::erase_if(views_, [&](const auto& view) { return !awaits(view.first); });
}

bool PeerSession::awaits(std::uint32_t view) const {
  return std::ranges::find(to_compare_, view) != to_compare_.end();
}

std::vector<std::uint32_t> PeerSession::missing_views() const {
  std::vector<std::uint32_t> missing;
  for (const std::uint32_t keyframe : to_compare_)
    if (!views_.contains(keyframe)) missing.push_back(keyframe);
  return missing;
}

void PeerSession::take_views(const Clouds& clouds) {
  if (clouds.kind != CloudKind::view) return;
  for (const Clouds::Cloud& cloud : clouds.clouds)
    if (awaits(cloud.index)) views_.insert_or_assign(cloud.index, cloud);
}

std::vector<PeerSession::Arrived> PeerSession::arrived(const Clouds& clouds) const {
  std::vector<Arrived> arrived;
  if (clouds.kind != CloudKind::submap) return arrived;
  std::set<std::uint32_t> seen;
  for (std::size_t c = 0; c < clouds.clouds.size(); ++c) {
    const auto waiting = waiting_.find(clouds.clouds[c].index);
    if (waiting == waiting_.end() || !seen.insert(waiting->first).second) continue;
    for (const LoopCandidate& candidate : waiting->second) arrived.push_back({candidate, c});
  }
  return arrived;
}

void PeerSession::finish_registration(const std::vector<Arrived>& arrived) {
  for (const Arrived& one : arrived) waiting_.erase(one.candidate.match.index);
}

}  // namespace adit
