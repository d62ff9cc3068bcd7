// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The agent dispatches: what happens in each step is in the rooms sync, search, merge and joint.
#include "adit/fleet/agent.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/fleet/merge/advised_verdict.hpp"
#include "adit/fleet/merge/loop_check.hpp"
#include "adit/fleet/merge/place_comparer.hpp"
#include "adit/fleet/sync/own_map_parts.hpp"
#include "adit/fleet/sync/parts.hpp"

namespace adit {
namespace {

bool have_same_grid(const ScanContext& a, const ScanContext& b) {
  return a.num_rings == b.num_rings && a.num_sectors == b.num_sectors;
}

// Keyframes lie closer together than places differ: every fourth still meets each place of the other.
constexpr std::size_t kStrideInLargeFleets = 4;

std::vector<MessageBody> request_of(const PeerSession& session) {
  const std::optional<CloudRequest> request = session.request();
  return request ? std::vector<MessageBody>{*request} : std::vector<MessageBody>{};
}

}  // namespace

Agent::Agent(std::shared_ptr<const RobotMap> map, const AgentConfig& config)
    : map_(std::move(map)),
      config_(config),
      ledger_(map_->id, graph_of(*map_), config.policy),
      features_(std::make_shared<FeatureStore>(map_, config.registration_in_use(), config.submap_in_use())),
      registration_(features_, config.loop_registration()),
      search_(std::make_shared<CandidateSearch>(map_, chain_by(map_->id), config.place,
                                                config.adaptive.search)) {}

bool Agent::restore(const std::vector<MessageBody>& findings, const std::map<RobotId, std::uint32_t>& met) {
  bool all_make_sense = true;
  for (const MessageBody& finding : findings) all_make_sense &= ledger_.restore(finding);
  for (const auto& [peer, num_places] : met)
    if (searches(peer)) sessions_[peer].restore_searched(num_places);
  looked_for_revisits_ = true;
  return all_make_sense;
}

std::vector<Message> Agent::meet(RobotId peer) const { return addressed(peer, {hello()}); }

std::vector<Message> Agent::on(const Message& message) {
  ADIT_CHECK(message.to == map_->id, "an agent gets its own messages only");
  if (message.from == map_->id) return {};  // an echo; answering it would never end
  Replies replies = std::visit([&](const auto& body) { return on(message.from, body); }, message.body);
  for (const auto& [robot, graph] : known().robots)
    if (searches(robot)) ledger_.note_unsearched(robot, why_unsearched(robot, graph.name));
  return addressed(message.from, std::move(replies));
}

std::string Agent::why_unsearched(RobotId peer, const std::string& name) const {
  const auto session = sessions_.find(peer);
  if (session != sessions_.end() && session->second.is_searched()) return {};
  if (on_other_grids_.contains(peer))
    return format(
        "{} describes places on another grid than {}, so that none could be compared; give both the same "
        "settings",
        name, map_->name);
  return format(
      "{} has not searched {}: its descriptors or its odometry have not all come, or the search was broken "
      "off; the robots have to meet again",
      map_->name, name);
}

bool Agent::counted(bool is_taken) {
  num_left_out_ += is_taken ? 0 : 1;
  return is_taken;
}

// ---- synchronising: who has what -------------------------------------------------------------------------

Agent::Replies Agent::on(RobotId from, const Hello& theirs) {
  PeerSession& session = sessions_[from];
  if (!session.hear(theirs, from)) checks_.erase(from);  // it is begun anew, on the map as it is now
  Replies replies;
  if (!theirs.answer) {
    Hello mine = hello();
    mine.answer = true;
    replies.emplace_back(std::move(mine));
  }
  append(replies, ledger_.news_for(from, theirs));
  const auto known = std::ranges::find(theirs.known, map_->id, &Hello::Known::robot);
  const std::uint32_t num_known_places = known == theirs.known.end() ? 0 : known->num_places;
  append(replies, searches(from) ? resume(from) : places_since(*map_, num_known_places));
  return replies;
}

Agent::Replies Agent::resume(RobotId peer) {
  PeerSession& session = sessions_[peer];
  switch (session.state()) {
    case PeerState::greeting:
    case PeerState::receiving_places:
      break;
    case PeerState::awaiting_path:  // which may have come by way of a third robot
      return search_when_ready(peer);
    case PeerState::awaiting_clouds:
      return request_of(session);
    case PeerState::comparing:
      return go_on_checking(peer);
    case PeerState::decided:
      return check_if_due(peer);
  }
  return {};
}

Agent::Replies Agent::on(RobotId from, const GraphPart& part) {
  const bool may_be_awaited = counted(ledger_.take(part)) && part.owner == from && searches(from);
  if (!may_be_awaited) return {};
  Replies replies = search_when_ready(from);
  if (sessions_[from].state() == PeerState::decided) append(replies, check_if_due(from));
  return replies;
}

Agent::Replies Agent::on(RobotId /*from*/, const Loops& part) {
  counted(ledger_.take(part));
  return {};
}

Agent::Replies Agent::on(RobotId /*from*/, const MergeChecks& part) {
  counted(ledger_.take(part));
  return {};
}

Agent::Replies Agent::on(RobotId /*from*/, const CloudRequest& request) const {
  return {
      clouds_of(*map_, request,
                {config_.registration_in_use().voxel_size, config_.submap_in_use(), config_.adaptive.view})};
}

// ---- searching: candidates -------------------------------------------------------------------------------

Agent::Replies Agent::on(RobotId from, const Places& part) {
  // Descriptors on another grid cannot be compared with the own ones: a robot configured otherwise shares
  // none.
  const bool are_comparable = std::ranges::all_of(part.places, [&](const Places::Place& place) {
    return !map_->places.empty() && have_same_grid(place.context, map_->places.front());
  });
  if (searches(from) && !are_comparable) on_other_grids_.insert(from);
  if (!counted(searches(from) && are_comparable)) return {};
  PeerSession& session = sessions_[from];
  const std::uint32_t num_before = session.num_places();
  const bool is_next = counted(session.take(part));
  // One transfer at a time: another one starts anew in a later meeting. A part that brings nothing ends none.
  if (session.num_places() > num_before)
    for (auto& [robot, other] : sessions_)
      if (robot != from) other.forget_places();
  return is_next ? search_when_ready(from) : Replies{};
}

Agent::Replies Agent::search_when_ready(RobotId peer) {
  PeerSession& session = sessions_[peer];
  const bool has_path = !is_adaptive() || session.lie_within(ledger_.num_nodes_of(peer));
  if (!session.has_all_places() || !has_path) return {};
  std::vector<LoopCandidate> found = candidates_with(peer);
  if (is_adaptive() && !found.empty()) found = search_->most_promising(std::move(found));
  await_clouds(session, std::move(found));
  session.finish_search();  // last: what breaks off before leaves the search to a later meeting
  return session.state() == PeerState::decided ? check_if_due(peer) : request_of(session);
}

std::vector<LoopCandidate> Agent::candidates_with(RobotId peer) {
  const bool has_met_many = num_tried() >= static_cast<std::size_t>(config_.max_candidates);
  const std::size_t stride = has_met_many ? kStrideInLargeFleets : 1;
  const PeerPlaces theirs{peer, sessions_[peer].places()};
  std::vector<LoopCandidate> found =
      is_adaptive() ? search_->most_similar(theirs, stride)
                    : most_similar_places(*map_, query_keyframes(*map_, stride), theirs, config_.place);
  std::erase_if(found, [&](const LoopCandidate& candidate) {
    return known().loops.contains({candidate.query, candidate.match});
  });
  return found;
}

std::size_t Agent::num_tried() const {
  std::size_t num = ledger_.num_own_loops();
  for (const auto& [robot, session] : sessions_) num += session.num_waiting();
  return num;
}

void Agent::await_clouds(PeerSession& session, std::vector<LoopCandidate> candidates) const {
  const auto in_all = static_cast<std::size_t>(config_.max_candidates);
  const std::size_t room =
      std::max(in_all - std::min(in_all, num_tried()), static_cast<std::size_t>(config_.candidates_per_peer));
  candidates.resize(std::min(candidates.size(), room));
  session.await_clouds_of(candidates);
}

// ---- registering, comparing, deciding --------------------------------------------------------------------

Agent::Replies Agent::on(RobotId from, const Clouds& clouds) {
  switch (sessions_[from].state()) {
    case PeerState::awaiting_clouds:
      return register_clouds(from, clouds);
    case PeerState::comparing:
      return compare_clouds(from, clouds);
    case PeerState::greeting:
    case PeerState::receiving_places:
    case PeerState::awaiting_path:
    case PeerState::decided:
      break;
  }
  return {};  // nobody asked for them
}

Agent::Replies Agent::register_clouds(RobotId peer, const Clouds& clouds) {
  PeerSession& session = sessions_[peer];
  const std::vector<PeerSession::Arrived> arrived = session.arrived(clouds);
  if (arrived.empty()) return {};
  const std::size_t num_before = ledger_.num_own_loops();
  for (const LoopClosure& loop : registration_.with_clouds(arrived, clouds)) ledger_.add_own(loop);
  session.finish_registration(arrived);
  Replies replies = ledger_.loops_since(map_->id, num_before);
  const bool is_done = session.state() != PeerState::awaiting_clouds;
  append(replies, is_adaptive() && is_done ? begin_check(peer) : request_of(session));
  return replies;
}

std::vector<LoopClosure> Agent::loops_with(RobotId peer) const {
  std::vector<LoopClosure> loops;
  for (const auto& [ends, loop] : known().loops)
    if (ends.first.robot == map_->id && ends.second.robot == peer && known().knows(ends.first) &&
        known().knows(ends.second) && sessions_.at(peer).exists(ends.second.index))
      loops.push_back(loop);
  return loops;
}

Agent::Replies Agent::check_if_due(RobotId peer) {
  if (!is_adaptive()) return {};
  if (checks_.contains(peer)) return go_on_checking(peer);
  // Before all of the path has come, a check would be of a part of the loops.
  const bool has_path = sessions_[peer].is_whole(ledger_.num_nodes_of(peer));
  const bool has_news = to_check_.contains(peer) || !known().checks.contains({map_->id, peer});
  const bool is_due = has_path && has_news && !loops_with(peer).empty();
  return is_due ? begin_check(peer) : Replies{};
}

Agent::Replies Agent::begin_check(RobotId peer) {
  to_check_.insert(peer);
  // Of keyframes that the peer has no longer it could not send what it saw there.
  RobotGraph theirs = known().robots.at(peer);
  while (!theirs.nodes.empty() &&
         !sessions_[peer].exists(static_cast<std::uint32_t>(theirs.nodes.size() - 1)))
    theirs.nodes.pop_back();
  const auto earlier = known().checks.find({map_->id, peer});
  checks_.insert_or_assign(
      peer, merge_checker_of(accepted_without_sliding(loops_with(peer)), chain_by(map_->id), chain_of(theirs),
                             discernment(), config_.adaptive,
                             earlier == known().checks.end() ? nullptr : &earlier->second));
  sessions_[peer].await_comparison_of({});  // the peer's map may have grown since a check that was broken off
  for (auto& [robot, session] : sessions_) session.forget_views();
  return go_on_checking(peer);
}

Agent::Replies Agent::compare_clouds(RobotId peer, const Clouds& clouds) {
  PeerSession& session = sessions_[peer];
  session.take_views(clouds);
  return session.has_comparison() ? go_on_checking(peer) : Replies();  // it wants all of them, in its order
}

Agent::Replies Agent::go_on_checking(RobotId peer) {
  PeerSession& session = sessions_[peer];
  MergeChecker& check = checks_.at(peer);
  PlaceComparer comparer(*map_, discernment(), config_.registration_in_use());
  for (auto asked = check.next(kCloudsPerMessage); !asked.empty(); asked = check.next(kCloudsPerMessage)) {
    session.await_comparison_of(their_keyframes(asked));
    if (!session.has_comparison()) return request_of(session);
    check.add(comparer.with_views(asked, session.views()));
  }
  session.await_comparison_of({});
  return conclude_check(peer);
}

Agent::Replies Agent::conclude_check(RobotId peer) {
  const std::size_t num_before = ledger_.num_own_checks();
  ledger_.add_own(
      advised_verdict(checks_.at(peer), {map_->id, peer},
                      {known(), *search_, discernment(), config_.adaptive.merge_check.spacing_m}));
  checks_.erase(peer);
  to_check_.erase(peer);
  return ledger_.checks_since(map_->id, num_before);
}

void Agent::find_revisits() {
  if (!is_adaptive() || !config_.adaptive.search.revisits || looked_for_revisits_) return;
  look_for_revisits();
  looked_for_revisits_ = true;
}

void Agent::look_for_revisits() {
  const OdometryChain chain = chain_by(map_->id);
  const RevisitConfig& revisit = config_.adaptive.search.revisit;
  std::vector<LoopClosure> loops = registration_.within_own_map(search_->revisits());
  for (LoopClosure& loop : loops) {
    if (loop.verdict == LoopVerdict::accepted && !fits_odometry(chain, pcm_loop_of(loop), revisit)) {
      loop.verdict = LoopVerdict::rejected;
      loop.reason = "the robot's own odometry excludes it";
    }
    ledger_.add_own(loop);
  }
  loops = accepted_without_sliding(std::move(loops));
  if (loops.empty()) return;
  MergeChecker check = merge_checker_of(loops, chain, chain, discernment(), config_.adaptive);
  PlaceComparer comparer(*map_, discernment(), config_.registration_in_use());
  for (auto asked = check.next(kCloudsPerMessage); !asked.empty(); asked = check.next(kCloudsPerMessage))
    check.add(comparer.within_own_map(asked));
  ledger_.add_own(check.verdict(map_->id, map_->id));
}

std::size_t Agent::num_cached_bytes() const {
  return features_->num_bytes() + (discernment_ ? discernment_->num_cached_bytes() : 0);
}

void Agent::forget_cached() {
  features_->forget_all();
  if (discernment_) discernment_->forget_cached();
}

// ---- what the steps share --------------------------------------------------------------------------------

Hello Agent::hello() const {
  std::map<RobotId, Hello::Known> summary = ledger_.summary();
  for (const auto& [robot, session] : sessions_) {
    if (session.num_places() == 0) continue;
    summary[robot].robot = robot;
    summary[robot].num_places = session.num_places();
  }
  Hello hello;
  for (const auto& [robot, entry] : summary) hello.known.push_back(entry);
  return hello;
}

std::vector<Message> Agent::addressed(RobotId peer, Replies bodies) const {
  std::vector<Message> messages;
  for (MessageBody& body : bodies) messages.push_back({map_->id, peer, std::move(body)});
  return messages;
}

OdometryChain Agent::chain_by(RobotId robot) const { return chain_of(known().robots.at(robot)); }

Discernment& Agent::discernment() {
  if (!discernment_)
    discernment_ = std::make_unique<Discernment>(
        map_, chain_by(map_->id),
        [search = search_] { return search->self_similarity().look_alikes(search->lanes()); }, features_,
        config_.adaptive);
  return *discernment_;
}

}  // namespace adit
