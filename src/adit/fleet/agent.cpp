// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/agent.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "adit/core/parallel.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {
namespace {

/// The items of `all`, at most `size` at a time.
template <class T, class Visit>
void in_parts(const std::vector<T>& all, std::size_t size, const Visit& visit) {
  for (std::size_t begin = 0; begin < all.size(); begin += size) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), begin + size));
    visit(begin, std::vector<T>(first, last));
  }
}

RobotGraph graph_of(const RobotMap& map) {
  RobotGraph graph{map.name, {}};
  graph.nodes.reserve(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    graph.nodes.push_back({map.keyframes[k].stamp, map.keyframes[k].T_odom_base, map.step_covariances[k]});
  }
  return graph;
}

/// The back-end inverts the covariance of each step; the first keyframe has none.
bool is_usable(const GraphPart& part) {
  for (std::size_t i = part.first_index == 0 ? 1 : 0; i < part.nodes.size(); ++i) {
    const Matrix6& covariance = part.nodes[i].step_covariance;
    if (!covariance.allFinite() || covariance.llt().info() != Eigen::Success) return false;
  }
  return true;
}

bool same_grid(const ScanContext& a, const ScanContext& b) {
  return a.num_rings == b.num_rings && a.num_sectors == b.num_sectors;
}

std::vector<std::uint32_t> searchable_indices(const RobotMap& map) {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    if (map.searchable[k]) indices.push_back(k);
  }
  return indices;
}

}  // namespace

Fields fields_of(AgentConfig& c) {
  Fields fields;
  append(fields, "place", fields_of(c.place));
  append(fields, "registration", fields_of(c.registration));
  return fields;
}

FeatureStore::FeatureStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config)
    : map_(std::move(map)), config_(config), features_(map_->keyframes.size()) {}

void FeatureStore::prepare(const std::vector<std::uint32_t>& indices) {
  std::vector<std::uint32_t> missing;
  std::ranges::copy_if(indices, std::back_inserter(missing),
                       [&](std::uint32_t i) { return !features_.at(i); });
  std::ranges::sort(missing);
  missing.erase(std::ranges::unique(missing).begin(), missing.end());
  parallel_for_each(missing.size(), [&](std::size_t i) {
    features_[missing[i]] = compute_features(*map_->keyframes[missing[i]].cloud, config_);
  });
}

const Features& FeatureStore::at(std::uint32_t index) const {
  ADIT_CHECK(features_.at(index).has_value(), "features are prepared before they are asked for");
  return *features_[index];
}

Agent::Agent(std::shared_ptr<const RobotMap> map, std::shared_ptr<FeatureStore> features,
             const AgentConfig& config)
    : map_(std::move(map)), features_(std::move(features)), config_(config) {
  known_.robots[map_->id] = graph_of(*map_);
}

Message Agent::to(RobotId peer, decltype(Message::body) body) const {
  return {map_->id, peer, std::move(body)};
}

Hello Agent::hello() const {
  Hello hello;
  for (const auto& [robot, graph] : known_.robots) {
    const auto peer = peers_.find(robot);
    const std::size_t num_places = peer == peers_.end() ? 0 : peer->second.places.size();
    hello.known.push_back(
        {robot, static_cast<std::uint32_t>(graph.nodes.size()), static_cast<std::uint32_t>(num_places)});
  }
  hello.num_loops = static_cast<std::uint32_t>(known_.loops.size());
  return hello;
}

std::vector<Message> Agent::meet(RobotId peer) const { return {to(peer, hello())}; }

std::vector<Message> Agent::on(const Message& message) {
  ADIT_CHECK(message.to == map_->id, "an agent gets its own messages only");
  if (message.from == map_->id) return {};  // an echo; answering it would never end
  return std::visit([&](const auto& body) { return on(message.from, body); }, message.body);
}

Agent::Replies Agent::on(RobotId from, const Hello& theirs) {
  Replies replies;
  const auto append = [&](const Replies& more) { replies.insert(replies.end(), more.begin(), more.end()); };
  if (!theirs.answer) {
    Hello mine = hello();
    mine.answer = true;
    replies.push_back(to(from, std::move(mine)));
  }
  append(graph_news(from, theirs));
  if (theirs.num_loops != known_.loops.size()) {
    std::vector<LoopClosure> loops;
    for (const auto& [ends, loop] : known_.loops) loops.push_back(loop);
    append(in_messages(from, loops));
  }
  // Clouds that were asked for in an earlier meeting and never came are asked for again.
  append(searches(from) ? cloud_requests(from) : place_news(from, theirs));
  return replies;
}

Agent::Replies Agent::graph_news(RobotId peer, const Hello& theirs) const {
  Replies replies;
  for (const auto& [robot, graph] : known_.robots) {
    const auto known = std::ranges::find(theirs.known, robot, &Hello::Known::robot);
    if (known == theirs.known.end() && graph.nodes.empty()) {  // nothing to send but that it exists
      replies.push_back(to(peer, GraphPart{robot, graph.name, 0, {}}));
    }
    const std::size_t has =
        known == theirs.known.end() ? 0 : std::min<std::size_t>(known->num_nodes, graph.nodes.size());
    const std::vector<GraphNode> rest(graph.nodes.begin() + static_cast<std::ptrdiff_t>(has),
                                      graph.nodes.end());
    in_parts(rest, kNodesPerMessage, [&](std::size_t begin, std::vector<GraphNode> nodes) {
      replies.push_back(
          to(peer, GraphPart{robot, graph.name, static_cast<std::uint32_t>(has + begin), std::move(nodes)}));
    });
  }
  return replies;
}

Agent::Replies Agent::place_news(RobotId peer, const Hello& theirs) const {
  std::vector<std::uint32_t> indices = searchable_indices(*map_);
  const auto known = std::ranges::find(theirs.known, map_->id, &Hello::Known::robot);
  const std::uint32_t has = known == theirs.known.end()
                                ? 0
                                : std::min(known->num_places, static_cast<std::uint32_t>(indices.size()));
  indices.erase(indices.begin(), indices.begin() + has);
  Replies replies;
  in_parts(indices, kPlacesPerMessage, [&](std::size_t begin, const std::vector<std::uint32_t>& part) {
    Places places;
    places.first = has + static_cast<std::uint32_t>(begin);
    for (const std::uint32_t k : part) places.places.push_back({k, map_->places[k]});
    places.last = begin + part.size() == indices.size();
    replies.push_back(to(peer, std::move(places)));
  });
  return replies;
}

Agent::Replies Agent::in_messages(RobotId peer, const std::vector<LoopClosure>& loops) const {
  Replies replies;
  in_parts(loops, kLoopsPerMessage, [&](std::size_t, std::vector<LoopClosure> part) {
    replies.push_back(to(peer, Loops{std::move(part)}));
  });
  return replies;
}

Agent::Replies Agent::on(RobotId /*from*/, const GraphPart& part) {
  if (part.owner == map_->id || !is_usable(part)) return {};
  const auto known = known_.robots.find(part.owner);
  const std::size_t has = known == known_.robots.end() ? 0 : known->second.nodes.size();
  if (part.first_index > has) return {};  // a part before it was lost; the next Hello asks for it
  RobotGraph& graph = known_.robots[part.owner];
  graph.name = part.name;
  for (std::size_t i = has - part.first_index; i < part.nodes.size(); ++i) {
    graph.nodes.push_back(part.nodes[i]);
  }
  return {};
}

Agent::Replies Agent::on(RobotId from, const Places& part) {
  // Contexts of another grid cannot be compared with ours: a robot configured otherwise shares no places.
  const bool comparable = std::ranges::all_of(part.places, [&](const Places::Place& place) {
    return !map_->places.empty() && same_grid(place.context, map_->places.front());
  });
  if (!searches(from) || !comparable) return {};
  Peer& peer = peers_[from];
  if (part.first > peer.places.size()) return {};
  for (const Places::Place& place : part.places) peer.places.emplace(place.index, place.context);
  if (!part.last) return {};
  find_candidates(from);
  return cloud_requests(from);
}

void Agent::find_candidates(RobotId peer_id) {
  Peer& peer = peers_[peer_id];
  PlaceIndex index(config_.place);
  for (const auto& [k, context] : peer.places) index.add({peer_id, k}, context);
  const std::vector<std::uint32_t> queries = searchable_indices(*map_);
  std::vector<std::optional<LoopCandidate>> best(queries.size());
  parallel_for_each(
      queries.size(),
      [&](std::size_t i) {
        best[i] = index.best_match({map_->id, queries[i]}, map_->places[queries[i]], peer_id);
      },
      16);
  for (const std::optional<LoopCandidate>& candidate : best) {
    if (!candidate || known_.loops.contains({candidate->query, candidate->match})) continue;
    std::vector<LoopCandidate>& waiting = peer.waiting[candidate->match.index];
    if (std::ranges::find(waiting, candidate->query, &LoopCandidate::query) == waiting.end()) {
      waiting.push_back(*candidate);
    }
  }
}

Agent::Replies Agent::cloud_requests(RobotId peer_id) const {
  const auto peer = peers_.find(peer_id);
  if (peer == peers_.end()) return {};
  std::vector<std::uint32_t> indices;
  for (const auto& [index, candidates] : peer->second.waiting) indices.push_back(index);
  Replies replies;
  in_parts(indices, kCloudsPerMessage, [&](std::size_t, std::vector<std::uint32_t> part) {
    replies.push_back(to(peer_id, CloudRequest{std::move(part)}));
  });
  return replies;
}

Agent::Replies Agent::on(RobotId from, const CloudRequest& request) const {
  Clouds clouds;
  for (const std::uint32_t index : request.indices) {
    if (index >= map_->keyframes.size()) continue;  // a confused peer gets less, and stops nobody
    // The receiver's features thin the cloud to the same voxels; sending more points would change nothing.
    clouds.clouds.push_back(
        {index, voxel_centroids(*map_->keyframes[index].cloud, config_.registration.voxel_size).points});
  }
  return {to(from, std::move(clouds))};
}

LoopClosure Agent::verify(const LoopCandidate& candidate, const Features& match) const {
  const Registration registration =
      register_features(features_->at(candidate.query.index), match, config_.registration);
  LoopClosure loop;
  loop.from = candidate.query;
  loop.to = candidate.match;
  loop.T_from_to = registration.T_a_b.value_or(Pose());
  loop.information = registration.information;
  loop.place_distance = candidate.distance;
  loop.num_inliers = registration.num_inliers;
  loop.overlap = registration.overlap;
  loop.weak_axis = registration.weak_axis;
  loop.verdict = registration.verdict;
  loop.reason = registration.reason;
  return loop;
}

Agent::Replies Agent::on(RobotId from, const Clouds& clouds) {
  Peer& peer = peers_[from];
  std::vector<std::pair<LoopCandidate, std::size_t>> jobs;  // candidate, place in clouds
  std::vector<std::uint32_t> own;
  for (std::size_t c = 0; c < clouds.clouds.size(); ++c) {
    const auto waiting = peer.waiting.extract(clouds.clouds[c].index);
    if (waiting.empty()) continue;
    for (const LoopCandidate& candidate : waiting.mapped()) {
      jobs.emplace_back(candidate, c);
      own.push_back(candidate.query.index);
    }
  }
  features_->prepare(own);
  std::vector<Features> theirs(clouds.clouds.size());
  parallel_for_each(theirs.size(), [&](std::size_t c) {
    PointCloud cloud;
    cloud.points = clouds.clouds[c].points;
    theirs[c] = compute_features(cloud, config_.registration);
  });
  Loops found;
  found.loops.resize(jobs.size());
  parallel_for_each(jobs.size(),
                    [&](std::size_t i) { found.loops[i] = verify(jobs[i].first, theirs[jobs[i].second]); });
  for (const LoopClosure& loop : found.loops) known_.loops.try_emplace({loop.from, loop.to}, loop);
  return in_messages(from, found.loops);
}

Agent::Replies Agent::on(RobotId /*from*/, const Loops& loops) {
  for (const LoopClosure& loop : loops.loops) {
    // The graph that a loop's ends belong to may still be on its way; `solve` leaves the loop out until then.
    if (loop.from.robot < loop.to.robot) known_.loops.try_emplace({loop.from, loop.to}, loop);
  }
  return {};
}

}  // namespace adit
