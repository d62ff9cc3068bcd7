// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/fleet/agent.hpp"
#include "adit/registration/icp_refine.hpp"

namespace adit {
namespace {

constexpr double kTrueCheck = 0.9;      // chance that a place agrees where the alignment is true
constexpr double kTrueLoop = 0.5;       // chance that registration accepts a true candidate
constexpr double kSide = 3.0;           // metres between two keyframes that are compared
constexpr double kReach = 50.0;         // metres along odometry, from the nearest loop
constexpr double kOtherPlace = 15.0;    // metres between two places of one map that share little
constexpr std::size_t kSamples = 32;    // of one's own map
constexpr std::size_t kMatches = 32;    // among which the nearest other place is looked for
constexpr double kMaxCorrection = 2.0;  // metres

// Way driven up to each keyframe.
std::vector<double> way_along(const OdometryChain& chain) {
  std::vector<double> way(chain.size(), 0.0);
  for (std::size_t k = 1; k < way.size(); ++k)
    way[k] = way[k - 1] + chain.between(k - 1, k).translation().norm();
  return way;
}

OdometryChain chain_of(const RobotMap& map) {
  std::vector<Pose> poses;
  for (const Keyframe& keyframe : map.keyframes) poses.push_back(keyframe.T_odom_base);
  return {
      std::move(poses),
      {map.step_covariances.begin() + (map.step_covariances.empty() ? 0 : 1), map.step_covariances.end()}};
}

std::optional<std::uint32_t> keyframe_at(const std::vector<double>& way, double metres) {
  if (way.empty() || metres < 0.0 || metres > way.back()) return {};
  return static_cast<std::uint32_t>(std::ranges::lower_bound(way, metres) - way.begin());
}

std::vector<std::uint32_t> evenly(std::size_t n, std::size_t samples) {
  std::vector<std::uint32_t> out;
  const std::size_t num = std::min(n, samples);
  for (std::size_t i = 0; i < num; ++i)
    out.push_back(static_cast<std::uint32_t>((2 * i + 1) * n / (2 * num)));
  return out;
}

struct Sample {
  std::uint32_t a;
  std::uint32_t b;
  Pose T_a_b;
};

std::vector<Agreement> agreements(const std::vector<Sample>& samples, FeatureStore& features,
                                  const RegistrationConfig& config) {
  std::vector<std::uint32_t> used;
  for (const Sample& sample : samples) used.insert(used.end(), {sample.a, sample.b});
  features.prepare(used);
  std::vector<Agreement> out(samples.size());
  parallel_for_each(samples.size(), [&](std::size_t i) {
    out[i] = agreement_near(features.at(samples[i].a), features.at(samples[i].b), samples[i].T_a_b, config);
  });
  return out;
}

// The agreement that all but a tenth of the pairs of keyframes at this distance reach.
double agreement_at(double distance, const OdometryChain& chain, const std::vector<double>& way,
                    FeatureStore& features, const RegistrationConfig& config) {
  std::vector<Sample> samples;
  for (const std::uint32_t k : evenly(way.size(), kSamples)) {
    if (const auto next = keyframe_at(way, way[k] + distance))
      samples.push_back({k, *next, chain.between(k, *next)});
  }
  if (samples.empty()) return 1.0;
  std::vector<double> confirmed;
  for (const Agreement& one : agreements(samples, features, config)) confirmed.push_back(one.confirmed);
  const auto low = static_cast<std::ptrdiff_t>((1.0 - kTrueCheck) * static_cast<double>(confirmed.size()));
  std::ranges::nth_element(confirmed, confirmed.begin() + low);
  return confirmed[static_cast<std::size_t>(low)];
}

// Which places of one's own map look like others that odometry keeps apart from them.
class OtherPlaces {
 public:
  OtherPlaces(const RobotMap& map, PlaceIndexConfig config)
      : map_(map), chain_(chain_of(map)), way_(way_along(chain_)), index_(widened(std::move(config))) {
    for (std::uint32_t k = 0; k < map.places.size(); ++k) index_.add({map.id, k}, map.places[k]);
  }
  /// The most similar one.
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k) const {
    for (const LoopCandidate& match : index_.best_matches({map_.id, k}, map_.places[k], map_.id, kMatches))
      if (is_elsewhere(k, match.match.index)) return match;
    return {};
  }

 private:
  static PlaceIndexConfig widened(PlaceIndexConfig config) {
    config.max_distance = 1.0;
    config.exclude_recent = 0;
    config.num_candidates = std::max(config.num_candidates, static_cast<int>(4 * kMatches));
    return config;
  }
  [[nodiscard]] bool is_elsewhere(std::uint32_t k, std::uint32_t other) const {
    if (std::abs(way_[k] - way_[other]) < kOtherPlace) return false;
    const double drift = std::sqrt(chain_.covariance(k, other).topLeftCorner<3, 3>().trace());
    return chain_.between(k, other).translation().norm() > kOtherPlace + 3.0 * drift;
  }

  const RobotMap& map_;
  OdometryChain chain_;
  std::vector<double> way_;
  PlaceIndex index_;
};

}  // namespace

std::vector<double> likeness_of_other_places(const RobotMap& map, const PlaceIndexConfig& place) {
  const OtherPlaces others(map, place);
  std::vector<double> likeness(map.keyframes.size(), 1.0);
  parallel_for_each(
      likeness.size(),
      [&](std::size_t k) {
        if (const auto match = others.most_similar(static_cast<std::uint32_t>(k)))
          likeness[k] = match->distance;
      },
      16);
  return likeness;
}

Agreement agreement_near(const OrientedPoints& a, const OrientedPoints& b, const Pose& T_a_b,
                         const RegistrationConfig& config) {
  if (a.empty() || b.empty()) return {};
  const KdTree tree_a(a.points);
  const KdTree tree_b(b.points);
  RegistrationConfig wide = config;
  wide.refine_distance_voxels *= 2.5;
  Pose T = align_to_planes(a, tree_a, b, T_a_b, wide);
  T = align_to_planes(a, tree_a, b, T, config);
  if (!((T.translation() - T_a_b.translation()).norm() < kMaxCorrection)) return {};
  return agreement(a, tree_a, b, tree_b, T, config);
}

Discernment discernment(const RobotMap& map, FeatureStore& features, const PlaceIndexConfig& place,
                        const RegistrationConfig& registration, const MergeCheckConfig& config) {
  Discernment out;
  const OdometryChain chain = chain_of(map);
  const std::vector<double> way = way_along(chain);
  for (std::size_t r = 0; r < out.ranges.size(); ++r)
    out.ranges[r].threshold = agreement_at(Discernment::kDistances[r], chain, way, features, registration);
  const OtherPlaces others(map, place);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::uint32_t> used;
  for (const std::uint32_t k : evenly(map.keyframes.size(), kSamples)) {
    const auto match = others.most_similar(k);
    if (!match) continue;
    pairs.emplace_back(k, match->match.index);
    used.insert(used.end(), {k, match->match.index});
  }
  features.prepare(used);
  std::vector<Registration> found(pairs.size());
  parallel_for_each(pairs.size(), [&](std::size_t i) {
    found[i] = register_features(features.at(pairs[i].first), features.at(pairs[i].second), registration);
  });
  std::vector<Sample> next;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (found[i].verdict != LoopVerdict::accepted) continue;
    const auto [a, b] = pairs[i];
    // The two drives run the same way along the look-alike, or one against the other.
    const Pose& T_a_b = *found[i].T_a_b;
    const double sense = (T_a_b.rotation_matrix() * Vector3::UnitX()).x() > 0.0 ? 1.0 : -1.0;
    for (const double steps : {-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0}) {
      // At one of the distances in turn: keyframe b stands T_a_b.x ahead of a already.
      const double apart = Discernment::kDistances[next.size() % Discernment::kDistances.size()];
      const double ahead = steps * config.spacing_m;
      const auto next_a = keyframe_at(way, way[a] + ahead);
      const auto next_b = keyframe_at(way, way[b] + sense * (ahead + apart - T_a_b.translation().x()));
      if (!next_a || !next_b) continue;
      next.push_back({*next_a, *next_b, chain.between(*next_a, a) * T_a_b * chain.between(b, *next_b)});
    }
  }
  const std::vector<Agreement> agreed = agreements(next, features, registration);
  for (std::size_t i = 0; i < next.size(); ++i) {
    auto& range = const_cast<Discernment::Range&>(out.at(next[i].T_a_b.translation().norm()));
    ++range.num_checked;
    range.num_passed += agreed[i].confirmed >= range.threshold ? 1 : 0;
  }
  return out;
}

const Discernment::Range& Discernment::at(double distance_m) const {
  std::size_t r = 0;
  while (r + 1 < ranges.size() && distance_m > 0.5 * (kDistances[r] + kDistances[r + 1])) ++r;
  return ranges[r];
}

std::vector<PlannedCheck> plan_checks(const OdometryChain& own, const OdometryChain& theirs,
                                      const std::vector<PcmLoop>& loops, const MergeCheckConfig& config) {
  const std::vector<double> own_way = way_along(own);
  const std::vector<double> their_way = way_along(theirs);
  std::vector<PlannedCheck> plan;
  double last = -config.spacing_m;
  for (std::uint32_t j = 0; j < theirs.size() && !loops.empty(); ++j) {
    if (their_way[j] - last < config.spacing_m) continue;
    const auto& loop = *std::ranges::min_element(
        loops, {}, [&](const PcmLoop& l) { return std::abs(their_way[l.b] - their_way[j]); });
    const double from_loop = std::abs(their_way[loop.b] - their_way[j]);
    if (from_loop > kReach) continue;
    const Pose T_loop_theirs = loop.T_a_b * theirs.between(loop.b, j);
    const Vector3 at = own.pose(loop.a) * T_loop_theirs.translation();
    std::optional<std::uint32_t> nearest;
    double best = kSide;
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      if (std::abs(own_way[i] - own_way[loop.a]) > from_loop + 2.0 * kSide) continue;
      const double distance = (own.pose(i).translation() - at).norm();
      if (distance < best) {
        best = distance;
        nearest = i;
      }
    }
    if (!nearest) continue;
    plan.push_back({*nearest, j, own.between(*nearest, loop.a) * T_loop_theirs});
    last = their_way[j];
  }
  const auto most = static_cast<std::size_t>(config.max_checks);
  if (plan.size() <= most) return plan;
  std::vector<PlannedCheck> some;
  for (const std::uint32_t k : evenly(plan.size(), most)) some.push_back(plan[k]);
  return some;
}

MergeCheck judge_merge(RobotId a, RobotId b, const Discernment& known, std::size_t num_rivals,
                       const std::vector<CheckedPlace>& places, const MergeCheckConfig& config) {
  MergeCheck out;
  out.a = a;
  out.b = b;
  out.needed = std::log(1.0 / config.error_rate);
  out.evidence = -std::log(static_cast<double>(num_rivals + 1));
  double by_chance = 0.0;
  for (const CheckedPlace& place : places) {
    const Discernment::Range& range = known.at(place.distance_m);
    const double if_false = std::min(range.false_check(), kTrueCheck);
    const bool passed = place.confirmed >= range.threshold;
    out.evidence +=
        passed ? std::log(kTrueCheck / if_false) : std::log((1.0 - kTrueCheck) / (1.0 - if_false));
    ++out.num_checked;
    out.num_passed += passed ? 1U : 0U;
    by_chance += if_false;
  }
  out.accepted = out.evidence >= out.needed;
  out.reason = format(
      "{} of {} places along the stretch agree, {:.0f} would where tunnels only look alike: evidence {:.1f} "
      "of "
      "{:.1f}",
      out.num_passed, out.num_checked, by_chance, out.evidence, out.needed);
  return out;
}

}  // namespace adit
