// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/distinctive_places.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/search/path.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/registration/registration.hpp"

namespace adit {
namespace {

constexpr double kEvery = 10.0;      // metres along a path
constexpr double kElsewhere = 15.0;  // metres from a place
constexpr double kSamePlace = 4.0;   // metres; of scans nearer to one another only the best match counts
constexpr std::size_t kMostAlike = 12;
constexpr int kByRingKey = 128;  // keyframes per robot whose descriptors are compared to find those

/// One robot's keyframes, where they truly stand, and what is needed to compare them.
struct Seen {
  std::shared_ptr<const RobotMap> map;
  std::vector<Vector3> positions;
  std::shared_ptr<FeatureStore> features;
  std::unique_ptr<Discernment> discernment;
};

Result<Seen> seen_by(const RobotRun& run, const SlamConfig& config) {
  const RegistrationConfig& registration = config.loops.adaptive.registration;
  Seen seen;
  seen.map = run.map;
  for (const Keyframe& keyframe : run.map->keyframes) {
    const Result<Pose> T_world_base = pose_at(run.truth, keyframe.stamp);
    if (!T_world_base) return fail(run.result.name, T_world_base.error());
    seen.positions.push_back(T_world_base->translation());
  }
  seen.features = std::make_shared<FeatureStore>(seen.map, registration, config.loops.adaptive.submap);
  seen.discernment = std::make_unique<Discernment>(
      seen.map, chain_of(graph_of(*seen.map)), [] { return std::vector<LoopCandidate>(); }, seen.features,
      config.loops.adaptive);
  return seen;
}

std::vector<std::uint32_t> sampled(const Seen& seen) {
  std::vector<std::uint32_t> out;
  const std::vector<double> lengths = path_lengths(chain_of(graph_of(*seen.map)));
  for (double metres = 0.5 * kEvery; const auto k = keyframe_at(lengths, metres); metres += kEvery)
    out.push_back(*k);
  return out;
}

/// The scans elsewhere that look most like this one, seen from any lane.
class MostAlike {
 public:
  MostAlike(const std::vector<Seen>& all, const SlamConfig& config)
      : all_(all), lanes_{config.loops.adaptive.search.lanes, config.loops.adaptive.search.lane_m} {
    PlaceIndexConfig search = config.loops.place;
    search.max_distance = 1.0;
    search.exclude_recent = 0;
    search.num_candidates = std::max(search.num_candidates, kByRingKey);
    index_.emplace(search);
    for (std::size_t r = 0; r < all.size(); ++r)
      for (std::uint32_t k = 0; k < all[r].map->places.size(); ++k)
        index_->add({id_of(r), k}, all[r].map->places[k]);
  }

  [[nodiscard]] std::vector<LoopCandidate> to(std::size_t robot, std::uint32_t k) const {
    const Seen& seen = all_[robot];
    std::vector<LoopCandidate> found;
    for (const ScanContext& context : contexts_from(lanes_, *seen.map, k))
      for (std::size_t other = 0; other < all_.size(); ++other)
        for (const LoopCandidate& match :
             index_->best_matches({id_of(robot), k}, context, id_of(other), kByRingKey))
          if ((all_[other].positions[match.match.index] - seen.positions[k]).norm() > kElsewhere)
            found.push_back(match);
    std::ranges::sort(found, {}, [](const LoopCandidate& c) { return std::tuple(c.distance, c.match); });
    std::vector<LoopCandidate> most;
    for (const LoopCandidate& c : found) {
      if (most.size() == kMostAlike) break;
      // The most similar one stands for its neighbours.
      const bool is_near = std::ranges::any_of(most, [&](const LoopCandidate& other) {
        return (position(c) - position(other)).norm() < kSamePlace;
      });
      if (!is_near) most.push_back(c);
    }
    return most;
  }

 private:
  static RobotId id_of(std::size_t robot) { return {static_cast<std::uint8_t>(robot)}; }
  [[nodiscard]] const Vector3& position(const LoopCandidate& c) const {
    return all_[c.match.robot.value].positions[c.match.index];
  }

  const std::vector<Seen>& all_;
  Lanes lanes_;
  std::optional<PlaceIndex> index_;
};

/// Whether registration can align the two scans such that they do not differ.
bool are_alike(const Seen& a, std::uint32_t i, const Seen& b, std::uint32_t j,
               const RegistrationConfig& config) {
  const Registration found = register_features(a.features->at(i), b.features->at(j), config);
  if (found.verdict != LoopVerdict::accepted) return false;
  const LocalFit fit = fit_near(a.discernment->surfaces().at(i), b.discernment->surfaces().at(j),
                                *found.T_a_b, a.discernment->limit(), config);
  return !a.discernment->differ(fit.agreement);
}

/// The sampled places of `all[robot]` that are distinctive, as positions in the world frame.
std::vector<Vector3> distinctive_in(std::vector<Seen>& all, std::size_t robot, const MostAlike& most_alike,
                                    const RegistrationConfig& config, const Phase& phase) {
  struct Place {
    std::uint32_t keyframe;
    std::vector<LoopCandidate> others;
    bool has_equal = false;
  };
  const std::vector<std::uint32_t> samples = sampled(all[robot]);
  const std::vector<bool> is_distinctive = all[robot].discernment->distinctive(samples);
  std::vector<Place> open;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (is_distinctive[i]) open.push_back({samples[i], {}, false});
  parallel_for_each(open.size(),
                    [&](std::size_t i) { open[i].others = most_alike.to(robot, open[i].keyframe); });
  // One candidate per place and pass: in a world of tiles the first one settles most places.
  for (std::size_t attempt = 0; attempt < kMostAlike; ++attempt) {
    std::vector<std::vector<std::uint32_t>> used(all.size());
    for (const Place& place : open) {
      if (attempt >= place.others.size()) continue;
      const KeyframeId other = place.others[attempt].match;
      used[robot].push_back(place.keyframe);
      used[other.robot.value].push_back(other.index);
    }
    for (std::size_t r = 0; r < all.size(); ++r) {
      all[r].features->prepare(used[r]);
      all[r].discernment->surfaces().prepare(used[r]);
    }
    parallel_for_each(open.size(), [&](std::size_t i) {
      Place& place = open[i];
      if (attempt >= place.others.size()) return;
      const KeyframeId other = place.others[attempt].match;
      place.has_equal = are_alike(all[robot], place.keyframe, all[other.robot.value], other.index, config);
    });
    std::erase_if(open, [](const Place& place) { return place.has_equal; });
    phase.advance();
  }
  std::vector<Vector3> positions;
  for (const Place& place : open) positions.push_back(all[robot].positions[place.keyframe]);
  return positions;
}

int num_of_both(const std::vector<Vector3>& places_a, const std::vector<Vector3>& places_b) {
  return static_cast<int>(std::ranges::count_if(places_a, [&](const Vector3& a) {
    return std::ranges::any_of(places_b, [&](const Vector3& b) { return (a - b).norm() < 0.5 * kEvery; });
  }));
}

}  // namespace

Result<DistinctivePlaces> distinctive_places(const std::vector<RobotRun>& runs, const SlamConfig& config) {
  std::vector<Seen> all;
  for (const RobotRun& run : runs) {
    Result<Seen> seen = seen_by(run, config);
    if (!seen) return tl::unexpected(seen.error());
    all.push_back(std::move(*seen));
  }
  const Phase phase("looking for distinctive places", all.size() * kMostAlike);
  const MostAlike most_alike(all, config);
  std::vector<std::vector<Vector3>> places;
  for (std::size_t robot = 0; robot < all.size(); ++robot)
    places.push_back(distinctive_in(all, robot, most_alike, config.loops.adaptive.registration, phase));
  DistinctivePlaces shared(all.size(), std::vector<int>(all.size(), 0));
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b)
      shared[a][b] = shared[b][a] = num_of_both(places[a], places[b]);
  return shared;
}

}  // namespace adit
