// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/agent.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

#include "adit/core/format.hpp"
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

/// The back-end inverts the covariance of each step; the first keyframe has none.
bool is_usable(const GraphPart& part) {
  for (std::size_t i = part.first_index == 0 ? 1 : 0; i < part.nodes.size(); ++i) {
    const Matrix6& covariance = part.nodes[i].step_covariance;
    if (!covariance.allFinite() || covariance.llt().info() != Eigen::Success) return false;
  }
  return true;
}

// Farther apart two scans may show the same walls, but it is not a place to which a robot came.
constexpr double kOnePlace = 10.0;  // metres

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

// Keyframes lie closer together than places differ: every fourth still meets each place of the other.
std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& indices) {
  constexpr std::size_t kEvery = 4;
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < indices.size(); i += kEvery) out.push_back(indices[i]);
  return out;
}

std::vector<Message> with(std::vector<Message> replies, std::vector<Message> more) {
  std::ranges::move(more, std::back_inserter(replies));
  return replies;
}

}  // namespace

Fields fields_of(AgentConfig& c) {
  Fields fields = {{"max_candidates", &c.max_candidates, "", 0, 1e9,
                    "candidates that a robot registers with the peers it meets first"},
                   {"candidates_per_peer", &c.candidates_per_peer, "", 1, 1e6,
                    "candidates that it registers with each further peer, the most similar ones"}};
  append(fields, "place", fields_of(c.place));
  append(fields, "registration", fields_of(c.registration));
  append(fields, "adaptive", fields_of(c.adaptive));
  return fields;
}

Agent::Agent(std::shared_ptr<const RobotMap> map, const AgentConfig& config)
    : map_(std::move(map)),
      features_(std::make_shared<FeatureStore>(map_, config.registration_in_use())),
      config_(config) {
  known_.policy = config_.policy;
  known_.robots[map_->id] = graph_of(*map_);
}

Message Agent::to(RobotId peer, decltype(Message::body) body) const {
  return {map_->id, peer, std::move(body)};
}

Hello Agent::hello() const {
  std::map<RobotId, Hello::Known> known;
  for (const auto& [robot, graph] : known_.robots) {
    known[robot].num_nodes = static_cast<std::uint32_t>(graph.nodes.size());
  }
  for (const auto& [robot, peer] : peers_) known[robot].num_places = peer.num_places;
  for (const auto& [robot, loops] : registered_) {
    known[robot].num_loops = static_cast<std::uint32_t>(loops.size());
  }
  for (const auto& [robot, checks] : decided_) {
    known[robot].num_checks = static_cast<std::uint32_t>(checks.size());
  }
  Hello hello;
  for (auto& [robot, entry] : known) {
    entry.robot = robot;
    hello.known.push_back(entry);
  }
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
  const auto append = [&](Replies more) { std::ranges::move(more, std::back_inserter(replies)); };
  if (!theirs.answer) {
    Hello mine = hello();
    mine.answer = true;
    replies.push_back(to(from, std::move(mine)));
  }
  append(graph_news(from, theirs));
  append(loop_news(from, theirs));
  // Clouds that were asked for in an earlier meeting and never came are asked for again.
  append(searches(from) ? cloud_request(from) : place_news(from, theirs));
  return replies;
}

Agent::Replies Agent::graph_news(RobotId peer, const Hello& theirs) const {
  Replies replies;
  for (const auto& entry : known_.robots) {
    const RobotId robot = entry.first;
    const RobotGraph& graph = entry.second;
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

Agent::Replies Agent::loop_news(RobotId peer, const Hello& theirs) const {
  Replies replies;
  for (const auto& [author, loops] : registered_) {
    if (author == peer) continue;
    const auto known = std::ranges::find(theirs.known, author, &Hello::Known::robot);
    const std::size_t has = known == theirs.known.end() ? 0 : known->num_loops;
    std::ranges::move(loops_from(peer, author, has), std::back_inserter(replies));
  }
  for (const auto& [author, checks] : decided_) {
    if (author == peer) continue;
    const auto known = std::ranges::find(theirs.known, author, &Hello::Known::robot);
    const std::size_t has = known == theirs.known.end() ? 0 : known->num_checks;
    std::ranges::move(checks_from(peer, author, has), std::back_inserter(replies));
  }
  return replies;
}

Agent::Replies Agent::checks_from(RobotId peer, RobotId author, std::size_t first) const {
  const std::vector<MergeCheck>& all = decided_.at(author);
  if (first >= all.size()) return {};
  return {to(peer, MergeChecks{author,
                               static_cast<std::uint32_t>(first),
                               {all.begin() + static_cast<std::ptrdiff_t>(first), all.end()}})};
}

Agent::Replies Agent::loops_from(RobotId peer, RobotId author, std::size_t first) const {
  Replies replies;
  const std::vector<Ends>& all = registered_.at(author);
  for (; first < all.size(); first += kLoopsPerMessage) {
    Loops part{author, static_cast<std::uint32_t>(first), {}};
    for (std::size_t l = first; l < std::min(all.size(), first + kLoopsPerMessage); ++l) {
      part.loops.push_back(known_.loops.at(all[l]));
    }
    replies.push_back(to(peer, std::move(part)));
  }
  return replies;
}

Agent::Replies Agent::on(RobotId from, const GraphPart& part) {
  if (part.owner == map_->id || !is_usable(part)) return {};
  const auto known = known_.robots.find(part.owner);
  const std::size_t has = known == known_.robots.end() ? 0 : known->second.nodes.size();
  if (part.first_index > has) return {};  // a part before it was lost; the next Hello asks for it
  RobotGraph& graph = known_.robots[part.owner];
  graph.name = part.name;
  for (std::size_t i = has - part.first_index; i < part.nodes.size(); ++i) {
    graph.nodes.push_back(part.nodes[i]);
  }
  const auto peer = peers_.find(from);
  if (!is_adaptive() || from != part.owner || peer == peers_.end() || !searches(from)) return {};
  return search(from);  // which may have waited for this part
}

Agent::Replies Agent::on(RobotId from, const Places& part) {
  // Contexts of another grid cannot be compared with ours: a robot configured otherwise shares no places.
  const bool comparable = std::ranges::all_of(part.places, [&](const Places::Place& place) {
    return !map_->places.empty() && same_grid(place.context, map_->places.front());
  });
  if (!searches(from) || !comparable) return {};
  for (auto& [robot, other] :
       peers_) {  // an unfinished transfer gives way to a new one, and starts anew later
    if (robot == from) continue;
    other.num_places -= static_cast<std::uint32_t>(other.places.size());
    other.places = {};
    other.has_all_places = false;
  }
  Peer& peer = peers_[from];
  if (part.first > peer.num_places) return {};
  for (std::size_t i = peer.num_places - part.first; i < part.places.size(); ++i) {
    peer.places.push_back(part.places[i]);
    ++peer.num_places;
  }
  peer.has_all_places |= part.last;
  return search(from);
}

Agent::Replies Agent::search(RobotId peer_id) {
  Peer& peer = peers_.at(peer_id);
  if (!peer.has_all_places || !has_way_of(peer_id)) return {};
  peer.has_all_places = false;
  find_candidates(peer_id);
  return cloud_request(peer_id);
}

std::vector<LoopCandidate> Agent::best_candidates(RobotId peer_id) const {
  PlaceIndexConfig search = config_.place;
  if (is_adaptive()) search.max_distance = 1.0;  // ranked, not cut off
  PlaceIndex index(search);
  std::set<std::uint32_t> added;  // a confused peer may name a keyframe twice
  for (const Places::Place& place : peers_.at(peer_id).places) {
    if (added.insert(place.index).second) index.add({peer_id, place.index}, place.context);
  }
  std::vector<std::uint32_t> queries = searchable_indices(*map_);
  if (num_tried() >= static_cast<std::size_t>(config_.max_candidates)) queries = thinned(queries);
  std::vector<std::vector<LoopCandidate>> best(queries.size());
  parallel_for_each(
      queries.size(),
      [&](std::size_t i) {
        best[i] = most_similar_from(lanes(), *map_, queries[i], [&](const ScanContext& context) {
          return index.best_match({map_->id, queries[i]}, context, peer_id);
        });
      },
      16);
  std::vector<LoopCandidate> found;
  for (const std::vector<LoopCandidate>& of_query : best)
    for (const LoopCandidate& candidate : of_query)
      if (!known_.loops.contains({candidate.query, candidate.match})) found.push_back(candidate);
  std::ranges::sort(found, {},
                    [](const LoopCandidate& c) { return std::tuple(c.distance, c.query, c.match); });
  return found;
}

std::size_t Agent::num_tried() const {
  const auto own = registered_.find(map_->id);
  std::size_t num = own == registered_.end() ? 0 : own->second.size();
  for (const auto& [robot, peer] : peers_) {
    for (const auto& [index, candidates] : peer.waiting) num += candidates.size();
  }
  return num;
}

void Agent::find_candidates(RobotId peer_id) {
  std::vector<LoopCandidate> found = best_candidates(peer_id);
  Peer& peer = peers_[peer_id];
  if (is_adaptive()) {
    Chosen chosen = promising(peer_id, std::move(found));
    found = std::move(chosen.first);
    peer.further = std::move(chosen.further);
  }
  peer.places = {};
  await_clouds(peer_id, std::move(found));
}

void Agent::await_clouds(RobotId peer_id, std::vector<LoopCandidate> candidates) {
  const auto in_all = static_cast<std::size_t>(config_.max_candidates);
  const std::size_t room =
      std::max(in_all - std::min(in_all, num_tried()), static_cast<std::size_t>(config_.candidates_per_peer));
  candidates.resize(std::min(candidates.size(), room));
  for (const LoopCandidate& candidate : candidates)
    peers_[peer_id].waiting[candidate.match.index].push_back(candidate);
}

Agent::Replies Agent::cloud_request(RobotId peer_id) const {
  const auto peer = peers_.find(peer_id);
  if (peer == peers_.end()) return {};
  CloudRequest request;
  for (const auto& [index, candidates] : peer->second.waiting) {
    if (request.indices.size() == kCloudsPerMessage) break;
    request.indices.push_back(index);
  }
  if (request.indices.empty() && peer->second.test)
    for (const PlannedCheck& check : peer->second.test->next(kCloudsPerMessage))
      request.indices.push_back(check.theirs);
  if (request.indices.empty()) return {};
  return {to(peer_id, std::move(request))};
}

Agent::Replies Agent::on(RobotId from, const CloudRequest& request) const {
  Clouds clouds;
  for (const std::uint32_t index : request.indices) {
    if (index >= map_->keyframes.size()) continue;  // a confused peer gets less, and stops nobody
    // The receiver's features thin the cloud to the same voxels; sending more points would change nothing.
    clouds.clouds.push_back(
        {index, map_->viewpoint.cast<float>(),
         voxel_centroids(*map_->keyframes[index].cloud, config_.registration_in_use().voxel_size).points});
  }
  return {to(from, std::move(clouds))};
}

LoopClosure Agent::verify(const LoopCandidate& candidate, const Features& match) const {
  const Registration registration =
      register_features(features_->at(candidate.query.index), match, config_.registration_in_use());
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
  if (const double apart = loop.T_from_to.translation().norm();
      is_adaptive() && loop.verdict == LoopVerdict::accepted && apart > kOnePlace) {
    loop.verdict = LoopVerdict::rejected;
    loop.reason = format("its ends would be {:.1f} m apart: not one place", apart);
  }
  return loop;
}

Agent::Replies Agent::on(RobotId from, const Clouds& clouds) {
  Peer& peer = peers_[from];
  const std::size_t before = registered_[map_->id].size();
  Replies replies;
  if (!peer.waiting.empty()) {
    // Nothing of use: nor is more asked for.
    if (std::ranges::none_of(clouds.clouds,
                             [&](const auto& cloud) { return peer.waiting.contains(cloud.index); }))
      return {};
    register_clouds_of(from, clouds);
    replies = loops_from(from, map_->id, before);
    if (!is_adaptive() || !peer.waiting.empty()) return with(std::move(replies), cloud_request(from));
    begin_test(from);
  } else if (peer.test && !peer.test->next(kCloudsPerMessage).empty()) {
    if (!compare_clouds_of(from, clouds)) return {};
  } else {
    return {};
  }
  return with(std::move(replies), go_on_testing(from));
}

Agent::Replies Agent::go_on_testing(RobotId peer_id) {
  return peers_.at(peer_id).test->next(kCloudsPerMessage).empty() ? conclude_test(peer_id)
                                                                  : cloud_request(peer_id);
}

void Agent::register_clouds_of(RobotId from, const Clouds& clouds) {
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
    theirs[c] = compute_features(cloud, config_.registration_in_use());
  });
  std::vector<LoopClosure> found(jobs.size());
  parallel_for_each(jobs.size(),
                    [&](std::size_t i) { found[i] = verify(jobs[i].first, theirs[jobs[i].second]); });
  std::vector<Ends>& registered = registered_[map_->id];
  for (LoopClosure& loop : found) {
    const Ends ends{loop.from, loop.to};
    if (known_.loops.try_emplace(ends, std::move(loop)).second) registered.push_back(ends);
  }
}

Agent::Replies Agent::on(RobotId /*from*/, const MergeChecks& part) {
  const auto is_authors = [&](const MergeCheck& check) {
    return check.a == part.author && check.a <= check.b;
  };
  if (part.author == map_->id || !std::ranges::all_of(part.checks, is_authors)) return {};
  std::vector<MergeCheck>& known = decided_[part.author];
  if (part.first > known.size()) return {};  // a part before it was lost; the next Hello asks for it
  for (std::size_t c = known.size() - part.first; c < part.checks.size(); ++c) {
    known.push_back(part.checks[c]);
    known_.checks[{part.checks[c].a, part.checks[c].b}] = part.checks[c];
  }
  return {};
}

Agent::Replies Agent::on(RobotId /*from*/, const Loops& part) {
  const auto is_authors = [&](const LoopClosure& loop) {
    return loop.from.robot == part.author && loop.from.robot <= loop.to.robot && loop.from < loop.to;
  };
  if (part.author == map_->id || !std::ranges::all_of(part.loops, is_authors)) return {};
  const auto known = registered_.find(part.author);
  const std::size_t has = known == registered_.end() ? 0 : known->second.size();
  if (part.first > has) return {};  // a part before it was lost; the next Hello asks for it
  for (std::size_t l = has - part.first; l < part.loops.size(); ++l) {
    // The graph that a loop's ends belong to may still be on its way; `solve` leaves the loop out until then.
    const Ends ends{part.loops[l].from, part.loops[l].to};
    known_.loops.try_emplace(ends, part.loops[l]);
    registered_[part.author].push_back(ends);
  }
  return {};
}

}  // namespace adit
