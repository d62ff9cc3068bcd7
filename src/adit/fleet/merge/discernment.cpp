// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/discernment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/fleet/merge/look_alike_walks.hpp"
#include "adit/fleet/search/path.hpp"

namespace adit {

Discernment::Discernment(const std::shared_ptr<const RobotMap>& map, OdometryChain chain,
                         FindLookAlikes find_look_alikes, std::shared_ptr<FeatureStore> features,
                         const AdaptiveConfig& config)
    : config_(config),
      chain_(std::move(chain)),
      find_look_alikes_(std::move(find_look_alikes)),
      features_(std::move(features)),
      views_(map, config.registration, config.view),
      scans_(map, config.registration) {
  const EvidenceModel& model = config_.merge_check.evidence;
  const double voxel = config_.registration.voxel_size;
  // Neighbours that agree perfectly have a usual difference, too: none.
  if (const std::optional<double> usual = usual_difference())
    limit_ = std::max(model.allowance * *usual, model.least_difference_m2 / (voxel * voxel));
}

const Measured& Discernment::measured() {
  if (measured_) return *measured_;
  const EvidenceModel& model = config_.merge_check.evidence;
  Measured measured{LookAlikes(model), EqualSignShares(model.walls)};
  measured.walls.set_same(compare_own_walls().counted());
  LookAlikeWalks walks(*this, chain_, *features_, config_);
  walks.start(find_look_alikes_());
  walks.follow(measured);
  measured.walls.add_other(compare_displaced_walls().counted());
  measured_ = std::move(measured);
  return *measured_;
}

double Discernment::reach_m() {
  if (!reach_m_) reach_m_ = measure_reach();
  return *reach_m_;
}

std::vector<LocalFit> Discernment::compare(const std::vector<OwnComparison>& asked, FitFrom from) {
  return compare(asked, from, limit_);
}

std::vector<LocalFit> Discernment::compare(const std::vector<OwnComparison>& asked, FitFrom from,
                                           double good_enough) {
  std::vector<std::uint32_t> used;
  for (const OwnComparison& one : asked) used.insert(used.end(), {one.a, one.b});
  views_.prepare(used);
  std::vector<LocalFit> out(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    const auto& [a, b, T_a_b] = asked[i];
    out[i] = fit_near(views_.at(a), views_.at(b), T_a_b, good_enough, config_.registration, from);
  });
  return out;
}

std::vector<std::uint32_t> Discernment::sampled() const {
  return evenly_spread(chain_.path_m().size(),
                       static_cast<std::size_t>(config_.merge_check.discernment.samples));
}

std::optional<double> Discernment::usual_difference() {
  std::vector<OwnComparison> pairs;
  for (const std::uint32_t k : sampled())
    for (const double metres : kComparedApart)
      if (const auto next = keyframe_at(chain_.path_m(), chain_.path_m()[k] + metres))
        pairs.push_back({k, *next, chain_.between(k, *next)});
  std::vector<double> differences;
  for (const LocalFit& fit : compare(pairs, FitFrom::guess, std::numeric_limits<double>::infinity()))
    if (fit.agreement.is_comparable()) differences.push_back(fit.agreement.largest_difference);
  if (differences.empty()) return std::nullopt;
  const double share = config_.merge_check.evidence.usual_share;
  const auto usual = std::lround(share * static_cast<double>(differences.size() - 1));
  std::ranges::nth_element(differences, differences.begin() + usual);
  return differences[static_cast<std::size_t>(usual)];
}

/// Compares each sampled place twice, as maps are compared: by scans that are part of one comparison only,
/// and so far apart that the beams fall elsewhere.
WallOffsets Discernment::compare_own_walls() {
  constexpr double kStep = 1.5;  // metres between two scans that are compared, and to the next two
  std::vector<OwnComparison> pairs;
  for (const std::uint32_t k : sampled()) {
    std::optional<std::uint32_t> a = k;
    for (int pair = 0; pair < 2 && a; ++pair) {
      const auto b = keyframe_at(chain_.path_m(), chain_.path_m()[*a] + kStep);
      if (!b) break;
      pairs.push_back({*a, *b, chain_.between(*a, *b)});
      a = keyframe_at(chain_.path_m(), chain_.path_m()[*b] + kStep);
    }
  }
  return offsets_between(pairs);
}

/// The walls of a tunnel that looks alike all along are other walls a few metres on.
WallOffsets Discernment::compare_displaced_walls() {
  constexpr double kStep = 1.5;  // metres from one pair to the next, which see the same patches
  const double displacement_m = config_.merge_check.discernment.displacement_m;
  std::vector<OwnComparison> pairs;
  for (const std::uint32_t k : sampled()) {
    for (int pair = 0; pair < 3; ++pair) {
      const auto a = keyframe_at(chain_.path_m(), chain_.path_m()[k] + kStep * pair);
      const auto b = a ? keyframe_at(chain_.path_m(), chain_.path_m()[*a] + displacement_m) : std::nullopt;
      if (b) pairs.push_back({*a, *b, Pose()});
    }
  }
  return offsets_between(pairs);
}

WallOffsets Discernment::offsets_between(const std::vector<OwnComparison>& pairs) {
  WallOffsets offsets(config_.registration.relief);
  for (const std::vector<PatchOffset>& of_pair : walls_of(pairs, compare(pairs, FitFrom::guess)))
    if (!of_pair.empty()) offsets.add(of_pair);
  return offsets;
}

std::vector<std::vector<PatchOffset>> Discernment::walls_of(const std::vector<OwnComparison>& asked,
                                                            const std::vector<LocalFit>& found) {
  std::vector<std::size_t> agreeing;
  std::vector<std::uint32_t> used;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (differ(found[i].agreement)) continue;
    agreeing.push_back(i);
    used.insert(used.end(), {asked[i].a, asked[i].b});
  }
  scans_.prepare(used);
  std::vector<std::vector<PatchOffset>> out(asked.size());
  parallel_for_each(agreeing.size(), [&](std::size_t k) {
    const std::size_t i = agreeing[k];
    const auto& [a, b, T_a_b] = asked[i];
    out[i] = patch_offsets(scans_.at(a), scans_.at(b), found[i].T_a_b, chain_.pose(a), config_.registration);
  });
  return out;
}

double Discernment::measure_reach() {
  constexpr double kBaseline = 12.0;        // metres, over which scans see enough of the same
  constexpr double kShare = 0.9;            // of the headings,
  constexpr double kSigmasOfShare = 1.645;  // which for normal ones lies within so many sigmas
  constexpr std::size_t kLeastHeadings = 10;
  const DiscernmentConfig& config = config_.merge_check.discernment;
  std::vector<OwnComparison> pairs;
  for (const std::uint32_t k : sampled())
    if (const auto next = keyframe_at(chain_.path_m(), chain_.path_m()[k] + kBaseline))
      pairs.push_back({k, *next, chain_.between(k, *next)});
  const std::vector<LocalFit> found = compare(pairs, FitFrom::guess);
  std::vector<double> headings;  // by which odometry is off, radians
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!differ(found[i].agreement))
      headings.push_back(std::abs((pairs[i].T_a_b.inverse() * found[i].T_a_b).log()[5]));
  if (headings.size() < kLeastHeadings) return config.shortest_reach_m;
  const auto nth = headings.begin() + std::lround(kShare * static_cast<double>(headings.size() - 1));
  std::ranges::nth_element(headings, nth);
  // The headings of two robots wander apart as random walks: d metres on they are
  // sqrt(2) sigma sqrt(d / kBaseline) d / sqrt(3) apart to the side.
  const double sigma = std::max(*nth / kSigmasOfShare, 1e-6);
  return std::clamp(std::cbrt(1.5 * kBaseline * std::pow(config.reach_off_m / sigma, 2)),
                    config.shortest_reach_m, config.longest_reach_m);
}

std::vector<bool> Discernment::distinctive(const std::vector<std::uint32_t>& keyframes) {
  std::vector<bool> out;
  for (const DisplacementSigns& signs : displacement_signs(keyframes)) out.push_back(!signs.empty());
  return out;
}

std::vector<Vector3> Discernment::differing(std::uint32_t keyframe, const Agreement& agreement) const {
  std::vector<Vector3> places;
  for (const DifferingPatch& patch : agreement.structures)
    if (patch.num_points > limit_) places.push_back(chain_.pose(keyframe) * patch.position);
  if (places.empty()) places.push_back(chain_.pose(keyframe).translation());  // nothing in common
  return places;
}

std::vector<std::uint32_t> Discernment::displaced_from(std::uint32_t keyframe) const {
  const double displacement_m = config_.merge_check.discernment.displacement_m;
  std::vector<std::uint32_t> displaced;
  for (const double by : {-displacement_m, displacement_m})
    if (const auto other = keyframe_at(chain_.path_m(), chain_.path_m()[keyframe] + by))
      displaced.push_back(*other);
  return displaced;
}

std::vector<DisplacementSigns> Discernment::displacement_signs(const std::vector<std::uint32_t>& keyframes) {
  constexpr std::uint32_t kTogether = 3;  // keyframes, a metre, that the middle one speaks for
  const auto last = static_cast<std::uint32_t>(chain_.path_m().size() - 1);
  const auto speaker_of = [&](std::uint32_t k) { return std::min(k - k % kTogether + kTogether / 2, last); };
  std::map<std::uint32_t, DisplacementSigns> found_now;  // all of them or, where one comparison throws, none
  std::vector<std::uint32_t> open;
  for (const std::uint32_t k : keyframes)
    if (!signs_.contains(speaker_of(k)) && found_now.try_emplace(speaker_of(k)).second)
      open.push_back(speaker_of(k));
  const double displacement_m = config_.merge_check.discernment.displacement_m;
  // Both ways: the end of a niche may show one way and not the other.
  for (const double by : {-displacement_m, displacement_m}) {
    std::vector<OwnComparison> displaced;
    for (const std::uint32_t k : open)
      if (const auto other = keyframe_at(chain_.path_m(), chain_.path_m()[k] + by))
        displaced.push_back({k, *other, Pose()});
    const std::vector<LocalFit> found = compare(displaced, FitFrom::guess);
    for (std::size_t i = 0; i < displaced.size(); ++i) {
      const std::uint32_t k = displaced[i].a;
      if (differ(found[i].agreement)) {
        found_now[k].push_back(differing(k, found[i].agreement));
      } else {
        found_now[k].clear();
        std::erase(open, k);
      }
    }
  }
  signs_.merge(found_now);
  std::vector<DisplacementSigns> out;
  for (const std::uint32_t k : keyframes) out.push_back(signs_.at(speaker_of(k)));
  return out;
}

}  // namespace adit
