// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What an adaptive agent does beyond the paper's: candidates that stand out, loops within its own map, and
/// merges that are tested.
#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/fleet/agent.hpp"
#include "adit/fleet/search/revisits.hpp"
#include "adit/fleet/search/segments.hpp"

namespace adit {

Fields fields_of(AdaptiveConfig& c) {
  Fields fields = {
      {"candidates", &c.candidates, "", 1, 1e6, "candidates that are registered with each peer"},
      {"further_candidates", &c.further_candidates, "", 0, 1e6,
       "and so many more where these led to many loops, all of which are refuted"},
      {"segments", &c.segments, "", 0, 1e6,
       "stretches along which candidates agree, whose best ones are registered first"},
      {"segments_that_stand_out", &c.segments_that_stand_out, "", 0, 1e6,
       "the same of those that agree where the robot's own map has nothing as similar; taken in turns"},
      {"of_a_segment", &c.of_a_segment, "", 1, 1e6, "candidates that are registered of each of them"},
      {"stand_out", &c.stand_out, "", 0, 0,
       "rank candidates by their distance over that to the most similar other place of one's "
       "own; otherwise by their distance"},
      {"lane_m", &c.lane_m, "m", 0.0, 100.0,
       "between the lanes from which a keyframe is described for the search"},
      {"lanes", &c.lanes, "", 0, 100, "such lanes on each side of the one that was driven"},
      {"revisits", &c.revisits, "", 0, 0, "look for loops within the robot's own map"},
      {"revisit_candidates", &c.revisit_candidates, "", 1, 1e6, "candidates that are registered within it"}};
  append(fields, "registration", fields_of(c.registration));
  append(fields, "merge_check", fields_of(c.merge_check));
  return fields;
}

Lanes Agent::lanes() const {
  if (!is_adaptive()) return {};
  return {config_.adaptive.lanes, config_.adaptive.lane_m};
}

OdometryChain Agent::chain_by(RobotId robot) const {
  return chain_of(known_.robots.at(robot), config_.adaptive.merge_check.odometry_slack);
}

std::shared_ptr<const OtherPlaces> Agent::other_places() {
  if (!other_places_) other_places_ = std::make_shared<OtherPlaces>(map_, own_chain(), config_.place);
  return other_places_;
}

const std::vector<double>& Agent::own_likeness() {
  if (own_likeness_.empty()) own_likeness_ = other_places()->likeness();
  return own_likeness_;
}

Discernment& Agent::discernment() {
  if (!discernment_)
    discernment_ = std::make_unique<Discernment>(
        map_, own_chain(), [others = other_places(), lanes = lanes()] { return others->look_alikes(lanes); },
        features_, config_.registration_in_use(), config_.adaptive.merge_check.discernment);
  return *discernment_;
}

MergeTest Agent::test_of(const std::vector<PcmLoop>& loops, const OdometryChain& own,
                         const OdometryChain& theirs, const std::vector<double>& known_before) {
  double reach_m = 0.0;
  MeasuredWhenAsked measured;
  if (!loops.empty()) {  // without one there is nothing to test
    reach_m = discernment().reach_m();
    measured = [&on_own_map = discernment()]() -> const Measured& { return on_own_map.measured(); };
  }
  return {own, theirs, loops, reach_m, std::move(measured), config_.adaptive.merge_check, known_before};
}

void Agent::find_revisits() {
  if (!is_adaptive() || !config_.adaptive.revisits || std::exchange(looked_for_revisits_, true)) return;
  const OdometryChain chain = own_chain();
  const std::vector<PcmLoop> loops = register_own(own_candidates(chain), chain);
  if (loops.empty()) return;
  std::vector<double> known_before;
  for (const PcmLoop& loop : loops) known_before.push_back(odometry_evidence(chain, loop));
  MergeTest test = test_of(loops, chain, chain, known_before);
  for (auto asked = test.next(kCloudsPerMessage); !asked.empty(); asked = test.next(kCloudsPerMessage))
    test.add(compare_own(asked));
  decide(test.verdict(map_->id, map_->id));
}

std::vector<LoopCandidate> Agent::own_candidates(const OdometryChain& chain) {
  const std::vector<double> way = way_along(chain);
  std::vector<std::optional<LoopCandidate>> best(chain.size());
  parallel_for_each(best.size(), [&](std::size_t i) {
    const auto k = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> later = possible_revisits(chain, way, k);
    std::erase_if(later, [&](std::uint32_t other) { return !map_->searchable[other]; });
    if (later.empty() || !map_->searchable[k]) return;
    const std::vector<ScanContext> contexts = contexts_from(lanes(), *map_, k);
    for (const std::uint32_t other : later)
      for (const ScanContext& context : contexts) {
        const ContextMatch match = compare(context, map_->places[other]);
        if (!best[i] || match.distance < best[i]->distance)
          best[i] = LoopCandidate{{map_->id, k}, {map_->id, other}, match.yaw, match.distance};
      }
  });
  std::vector<LoopCandidate> found;
  for (const std::optional<LoopCandidate>& candidate : best)
    if (candidate) found.push_back(*candidate);
  return found.empty() ? found : standing_out(std::move(found), config_.adaptive.revisit_candidates);
}

std::vector<PcmLoop> Agent::register_own(const std::vector<LoopCandidate>& candidates,
                                         const OdometryChain& chain) {
  std::vector<std::uint32_t> used;
  for (const LoopCandidate& candidate : candidates)
    used.insert(used.end(), {candidate.query.index, candidate.match.index});
  features_->prepare(used);
  std::vector<LoopClosure> found(candidates.size());
  parallel_for_each(found.size(), [&](std::size_t i) {
    found[i] = verify(candidates[i], features_->at(candidates[i].match.index));
  });
  std::vector<PcmLoop> accepted;
  for (LoopClosure& loop : found) {
    const PcmLoop measured = pcm_loop_of(loop, {});
    if (loop.verdict == LoopVerdict::accepted && !fits_odometry(chain, measured)) {
      loop.verdict = LoopVerdict::rejected;
      loop.reason = "the robot's own odometry excludes it";
    }
    if (loop.verdict == LoopVerdict::accepted && !loop.is_free_to_slide()) accepted.push_back(measured);
    registered_[map_->id].emplace_back(loop.from, loop.to);
    known_.loops[{loop.from, loop.to}] = std::move(loop);
  }
  return telling(accepted);
}

std::vector<PcmLoop> Agent::telling(const std::vector<PcmLoop>& loops) {
  if (loops.empty()) return {};
  std::vector<std::uint32_t> own;
  for (const PcmLoop& loop : loops) own.push_back(static_cast<std::uint32_t>(loop.a));
  const std::vector<bool> tells = discernment().distinctive(own);
  std::vector<PcmLoop> out;
  for (std::size_t l = 0; l < loops.size(); ++l)
    if (tells[l]) out.push_back(loops[l]);
  return out;
}

CheckedPlace Agent::compared(const PlannedCheck& check, const SeenSurface& theirs,
                             bool is_distinctive) const {
  const double limit = discernment_->limit();
  const SeenSurface& own = discernment_->surfaces().at(check.own);
  const LocalFit fit = fit_near(own, theirs, check.T_own_theirs, limit, config_.registration_in_use());
  CheckedPlace place{fit.agreement.largest_difference / limit, is_distinctive};
  if (!place.differs())
    place.offsets = patch_offsets(own, theirs, fit.T_a_b, map_->keyframes[check.own].T_odom_base,
                                  config_.registration_in_use().relief);
  return place;
}

std::vector<CheckedPlace> Agent::compare_own(const std::vector<PlannedCheck>& asked) {
  std::vector<std::uint32_t> earlier;
  std::vector<std::uint32_t> both;
  for (const PlannedCheck& check : asked) {
    earlier.push_back(check.own);
    both.insert(both.end(), {check.own, check.theirs});
  }
  const std::vector<bool> distinctive = discernment().distinctive(earlier);
  SurfaceStore& surfaces = discernment().surfaces();
  surfaces.prepare(both);
  std::vector<CheckedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    places[i] = compared(asked[i], surfaces.at(asked[i].theirs), distinctive[i]);
  });
  return places;
}

void Agent::begin_test(RobotId peer_id) {
  std::vector<PcmLoop> loops;
  for (const auto& [ends, loop] : known_.loops)
    if (ends.first.robot == map_->id && ends.second.robot == peer_id &&
        loop.verdict == LoopVerdict::accepted && !loop.is_free_to_slide())
      loops.push_back(pcm_loop_of(loop, {}));
  peers_[peer_id].test = test_of(telling(loops), own_chain(), chain_by(peer_id));
}

bool Agent::compare_clouds_of(RobotId from, const Clouds& clouds) {
  MergeTest& test = *peers_[from].test;
  const std::vector<PlannedCheck> asked = test.next(kCloudsPerMessage);
  std::map<std::uint32_t, const Clouds::Cloud*> came;
  for (const Clouds::Cloud& cloud : clouds.clouds) came[cloud.index] = &cloud;
  // The test wants all of them, in its order; a part, or something else, is no use.
  if (!std::ranges::all_of(asked, [&](const PlannedCheck& check) { return came.contains(check.theirs); }))
    return false;
  std::vector<std::uint32_t> own;
  for (const PlannedCheck& check : asked) own.push_back(check.own);
  const std::vector<bool> distinctive = discernment().distinctive(own);
  SurfaceStore& surfaces = discernment().surfaces();
  surfaces.prepare(own);
  std::vector<CheckedPlace> places(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    const PlannedCheck& check = asked[i];
    PointCloud cloud;
    cloud.points = came.at(check.theirs)->points;
    const SeenSurface theirs(compute_surface(cloud, config_.registration_in_use()),
                             came.at(check.theirs)->viewpoint.cast<double>());
    places[i] = compared(check, theirs, distinctive[i]);
  });
  test.add(places);
  return true;
}

bool Agent::leads_nowhere(const MergeCheck& check) const {
  constexpr std::ptrdiff_t kMany = 4;  // one loop of so many candidates: where places differ there are fewer
  const bool is_all_refuted = std::ranges::all_of(check.hypotheses, [](const MergeHypothesis& hypothesis) {
    return hypothesis.outcome == HypothesisOutcome::refuted;
  });
  // Those that slide along a smooth tube, too: they fill a search that should have gone elsewhere.
  const auto num_loops = std::ranges::count_if(known_.loops, [&](const auto& entry) {
    const auto& [ends, loop] = entry;
    return ends.first.robot == check.a && ends.second.robot == check.b &&
           loop.verdict == LoopVerdict::accepted;
  });
  return is_all_refuted && kMany * num_loops >= config_.adaptive.candidates;
}

Agent::Replies Agent::conclude_test(RobotId peer_id) {
  Peer& peer = peers_.at(peer_id);
  MergeCheck check = peer.test->verdict(map_->id, peer_id);
  if (leads_nowhere(check)) await_clouds(peer_id, std::exchange(peer.further, {}));
  if (!peer.waiting.empty()) {
    peer.test.reset();
    return cloud_request(peer_id);
  }
  decide(std::move(check));
  return checks_from(peer_id, map_->id, decided_.at(map_->id).size() - 1);
}

void Agent::decide(MergeCheck check) {
  known_.checks[{check.a, check.b}] = check;
  decided_[map_->id].push_back(std::move(check));
}

bool Agent::has_way_of(RobotId peer_id) const {
  const auto graph = known_.robots.find(peer_id);
  const std::size_t num = graph == known_.robots.end() ? 0 : graph->second.nodes.size();
  return !is_adaptive() ||
         std::ranges::all_of(peers_.at(peer_id).places, [&](const auto& place) { return place.index < num; });
}

Agent::Chosen Agent::of_segments(RobotId peer_id, const std::vector<LoopCandidate>& found) {
  if (found.empty()) return {};
  const AdaptiveConfig& config = config_.adaptive;
  const OdometryChain own = own_chain();
  const OdometryChain theirs = chain_by(peer_id);
  struct Ranking {
    std::size_t num_first;
    std::vector<Segment> segments;
  };
  std::vector<Ranking> rankings;
  const auto num_further =  // of either kind
      static_cast<std::size_t>(config.further_candidates / (2 * config.of_a_segment));
  const auto rank_by = [&](int num, const std::vector<double>& likeness) {
    const auto num_first = static_cast<std::size_t>(num);
    rankings.push_back({num_first, agreeing_segments(own, theirs, found, num_first + num_further, likeness)});
  };
  if (config.segments > 0) rank_by(config.segments, {});
  if (config.segments_that_stand_out > 0) rank_by(config.segments_that_stand_out, own_likeness());
  std::size_t num_ranks = 0;
  for (const Ranking& ranking : rankings) num_ranks = std::max(num_ranks, ranking.segments.size());
  Chosen chosen;
  std::set<Ends> taken;
  for (std::size_t rank = 0; rank < num_ranks; ++rank)
    for (const auto& [num_first, segments] : rankings) {
      if (rank >= segments.size()) continue;
      const std::vector<LoopCandidate>& candidates = segments[rank].candidates;
      const std::size_t num = std::min(static_cast<std::size_t>(config.of_a_segment), candidates.size());
      for (const LoopCandidate& candidate : std::span(candidates).first(num))
        if (taken.emplace(candidate.query, candidate.match).second)
          (rank < num_first ? chosen.first : chosen.further).push_back(candidate);
    }
  return chosen;
}

Agent::Chosen Agent::promising(RobotId peer_id, std::vector<LoopCandidate> found) {
  const auto num_first = static_cast<std::size_t>(config_.adaptive.candidates);
  const auto num_further = static_cast<std::size_t>(config_.adaptive.further_candidates);
  Chosen chosen = of_segments(peer_id, found);
  chosen.first.resize(std::min(chosen.first.size(), num_first));
  chosen.further.resize(std::min(chosen.further.size(), num_further));
  std::set<Ends> taken;
  for (const std::vector<LoopCandidate>* some : {&chosen.first, &chosen.further})
    for (const LoopCandidate& candidate : *some) taken.emplace(candidate.query, candidate.match);
  std::erase_if(found, [&](const LoopCandidate& c) { return taken.contains({c.query, c.match}); });
  const std::size_t num_left = num_first + num_further - taken.size();
  for (const LoopCandidate& candidate : standing_out(std::move(found), static_cast<int>(num_left)))
    (chosen.first.size() < num_first ? chosen.first : chosen.further).push_back(candidate);
  return chosen;
}

std::vector<LoopCandidate> Agent::standing_out(std::vector<LoopCandidate> found, int max_candidates) {
  const std::vector<double>& likeness = own_likeness();
  const auto ratio = [&](const LoopCandidate& c) {
    return config_.adaptive.stand_out ? c.distance / std::max(likeness[c.query.index], 1e-6) : c.distance;
  };
  std::ranges::sort(found, {},
                    [&](const LoopCandidate& c) { return std::tuple(ratio(c), c.query, c.match); });
  constexpr std::uint32_t kNear = 6;  // keyframes
  constexpr std::ptrdiff_t kOfAPlace = 3;
  std::vector<LoopCandidate> chosen;
  std::set<KeyframeId> queries;
  for (const LoopCandidate& candidate : found) {
    if (chosen.size() == static_cast<std::size_t>(max_candidates)) break;
    if (!queries.insert(candidate.query).second) continue;  // from another lane
    const auto near = std::ranges::count_if(chosen, [&](const LoopCandidate& c) {
      const std::uint32_t i = c.query.index, k = candidate.query.index;
      return (i < k ? k - i : i - k) < kNear;
    });
    if (near < kOfAPlace) chosen.push_back(candidate);
  }
  return chosen;
}

}  // namespace adit
