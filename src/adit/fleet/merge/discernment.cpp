// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/discernment.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "adit/fleet/search/revisits.hpp"
#include "adit/fleet/search/segments.hpp"
#include "adit/registration/registration.hpp"

namespace adit {
namespace {

constexpr double kOtherPlace = 15.0;  // metres between two places of one map that share little
constexpr std::size_t kMatches = 32;  // among which the nearest other place is looked for
constexpr double kUsual = 0.9;        // share of the pairs of one place whose difference is usual
constexpr double kFollowed = 60.0;    // metres, each way, along a look-alike
constexpr std::size_t kTried = 4;     // candidates of a stretch, until one can be followed
// What is believed before anything is measured, worth as many steps: look-alikes go on half the time.
constexpr double kPriorChance = 0.5;
constexpr double kPriorSteps = 8.0;

std::vector<std::uint32_t> evenly(std::size_t n, std::size_t samples) {
  std::vector<std::uint32_t> out;
  const std::size_t num = std::min(n, samples);
  for (std::size_t i = 0; i < num; ++i)
    out.push_back(static_cast<std::uint32_t>((2 * i + 1) * n / (2 * num)));
  return out;
}

PlaceIndexConfig for_other_places(PlaceIndexConfig config) {
  config.max_distance = 1.0;
  config.exclude_recent = 0;
  config.num_candidates = std::max(config.num_candidates, static_cast<int>(4 * kMatches));
  return config;
}

}  // namespace

std::vector<double> way_along(const OdometryChain& chain) {
  std::vector<double> way(chain.size(), 0.0);
  for (std::size_t k = 1; k < way.size(); ++k)
    way[k] = way[k - 1] + chain.between(k - 1, k).translation().norm();
  return way;
}

std::optional<std::uint32_t> keyframe_at(const std::vector<double>& way, double metres) {
  if (way.empty() || metres < 0.0 || metres > way.back()) return {};
  return static_cast<std::uint32_t>(std::ranges::lower_bound(way, metres) - way.begin());
}

OtherPlaces::OtherPlaces(std::shared_ptr<const RobotMap> map, const OdometryChain& chain,
                         PlaceIndexConfig config)
    : map_(std::move(map)),
      chain_(chain),
      way_(way_along(chain_)),
      index_(for_other_places(std::move(config))) {
  for (std::uint32_t k = 0; k < map_->places.size(); ++k) index_.add({map_->id, k}, map_->places[k]);
}

std::optional<LoopCandidate> OtherPlaces::most_similar(std::uint32_t k, const ScanContext& context) const {
  for (const LoopCandidate& match : index_.best_matches({map_->id, k}, context, map_->id, kMatches))
    if (is_elsewhere(k, match.match.index)) return match;
  return {};
}

std::vector<LoopCandidate> OtherPlaces::look_alikes(const Lanes& lanes) const {
  constexpr std::uint32_t kEvery = 3;  // keyframes: several still fall into a bin of a segment
  std::vector<std::vector<LoopCandidate>> similar((map_->keyframes.size() + kEvery - 1) / kEvery);
  parallel_for_each(similar.size(), [&](std::size_t i) {
    const auto k = static_cast<std::uint32_t>(kEvery * i);
    similar[i] = most_similar_from(lanes, *map_, k,
                                   [&](const ScanContext& context) { return most_similar(k, context); });
  });
  std::vector<LoopCandidate> found;
  for (const std::vector<LoopCandidate>& of_one : similar)
    for (const LoopCandidate& candidate : of_one)
      if (candidate.query < candidate.match) found.push_back(candidate);
  return found;
}

std::vector<double> OtherPlaces::likeness() const {
  std::vector<double> likeness(map_->keyframes.size(), 1.0);
  parallel_for_each(
      likeness.size(),
      [&](std::size_t k) {
        if (const auto match = most_similar(static_cast<std::uint32_t>(k))) likeness[k] = match->distance;
      },
      16);
  return likeness;
}

bool OtherPlaces::is_elsewhere(std::uint32_t k, std::uint32_t other) const {
  if (std::abs(way_[k] - way_[other]) < kOtherPlace) return false;
  const double drift = std::sqrt(chain_.covariance(k, other).topLeftCorner<3, 3>().trace());
  return chain_.between(k, other).translation().norm() > kOtherPlace + 3.0 * drift;
}

// Two places that look alike, followed one way.
struct Discernment::Walk {
  std::uint32_t a;
  std::uint32_t b;
  Pose T_a_b;
  double way = 0.0;        // the next step, metres from a, negative against the drive
  double direction = 1.0;  // or -1
  std::size_t look_alike = 0;
  std::size_t num_passed = 0;
  bool is_over = false;
};

void LookAlikes::add(std::size_t passed, bool went_on) {
  Phase& phase = phases_[std::min<std::size_t>(std::bit_width(passed + 1), phases_.size()) - 1];
  ++phase.num_steps;
  if (!went_on) ++phase.num_ended;
}

ChancesToGoOn LookAlikes::chances() const {
  ChancesToGoOn chances{};
  double chance = kPriorChance;
  for (std::size_t p = 0; p < phases_.size(); ++p) {
    const auto steps = static_cast<double>(phases_[p].num_steps);
    const auto went_on = steps - static_cast<double>(phases_[p].num_ended);
    const double measured = (went_on + chance * kPriorSteps) / (steps + kPriorSteps);
    chance = p == 0 ? measured : std::max(chance, measured);
    chances[p] = chance;
  }
  return chances;
}

Discernment::Discernment(const std::shared_ptr<const RobotMap>& map, OdometryChain chain,
                         FindLookAlikes find_look_alikes, std::shared_ptr<FeatureStore> features,
                         const RegistrationConfig& registration, const DiscernmentConfig& config)
    : registration_(registration),
      config_(config),
      chain_(std::move(chain)),
      way_(way_along(chain_)),
      find_look_alikes_(std::move(find_look_alikes)),
      features_(std::move(features)),
      surfaces_(map, registration) {
  limit_ = config_.allowance * usual_difference();
}

const Measured& Discernment::measured() {
  if (!measured_) {
    Measured measured{.look_alikes = {}, .walls = StandingShares(registration_.relief)};
    measured.walls.set_same(compare_own_walls().counted());
    follow(walks_from(find_look_alikes_()), measured);
    measured_ = measured;
  }
  return *measured_;
}

double Discernment::reach_m() {
  if (!reach_m_) reach_m_ = measure_reach();
  return *reach_m_;
}

std::vector<LocalFit> Discernment::fits(const std::vector<Fit>& asked, double enough, FitFrom from) {
  std::vector<std::uint32_t> used;
  for (const Fit& fit : asked) used.insert(used.end(), {fit.a, fit.b});
  surfaces_.prepare(used);
  std::vector<LocalFit> out(asked.size());
  parallel_for_each(asked.size(), [&](std::size_t i) {
    const auto& [a, b, T_a_b] = asked[i];
    out[i] = fit_near(surfaces_.at(a), surfaces_.at(b), T_a_b, enough, registration_, from);
  });
  return out;
}

double Discernment::usual_difference() {
  std::vector<Fit> pairs;
  for (const std::uint32_t k : evenly(way_.size(), static_cast<std::size_t>(config_.samples)))
    for (const double distance : kDistances)
      if (const auto next = keyframe_at(way_, way_[k] + distance))
        pairs.push_back({k, *next, chain_.between(k, *next)});
  std::vector<double> differences;
  for (const LocalFit& fit : fits(pairs, std::numeric_limits<double>::infinity(), FitFrom::guess))
    if (fit.agreement.is_comparable()) differences.push_back(fit.agreement.largest_difference);
  // A map that is too short to measure on allows nothing.
  if (differences.empty()) return 0.0;
  const auto usual = std::lround(kUsual * static_cast<double>(differences.size() - 1));
  std::ranges::nth_element(differences, differences.begin() + usual);
  return differences[static_cast<std::size_t>(usual)];
}

// At each place twice, as maps are compared: by scans that are part of one comparison only, and from places
// so far apart that the beams fall elsewhere.
StandingOffsets Discernment::compare_own_walls() {
  constexpr double kApart = 1.5;  // metres between two scans that are compared, and to the next two
  std::vector<Fit> pairs;
  for (const std::uint32_t k : evenly(way_.size(), static_cast<std::size_t>(config_.samples))) {
    std::optional<std::uint32_t> a = k;
    for (int pair = 0; pair < 2 && a; ++pair) {
      const auto b = keyframe_at(way_, way_[*a] + kApart);
      if (!b) break;
      pairs.push_back({*a, *b, chain_.between(*a, *b)});
      a = keyframe_at(way_, way_[*b] + kApart);
    }
  }
  const std::vector<LocalFit> found = fits(pairs, limit_, FitFrom::guess);
  StandingOffsets offsets;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!differ(found[i].agreement))
      offsets.add(patch_offsets(surfaces_.at(pairs[i].a), surfaces_.at(pairs[i].b), found[i].T_a_b,
                                chain_.pose(pairs[i].a), registration_.relief));
  return offsets;
}

double Discernment::measure_reach() {
  constexpr double kWay = 12.0;        // metres, over which scans see enough of the same
  constexpr double kShare = 0.9;       // of the headings,
  constexpr double kSigmas = 1.645;    // which for normal ones lies within so many sigmas
  constexpr double kMayBeOff = 0.5;    // metres to the side
  constexpr double kShortest = 50.0;   // metres
  constexpr double kLongest = 150.0;   // metres
  constexpr std::size_t kEnough = 10;  // headings
  std::vector<Fit> pairs;
  for (const std::uint32_t k : evenly(way_.size(), static_cast<std::size_t>(config_.samples)))
    if (const auto next = keyframe_at(way_, way_[k] + kWay))
      pairs.push_back({k, *next, chain_.between(k, *next)});
  const std::vector<LocalFit> found = fits(pairs, limit_, FitFrom::guess);
  std::vector<double> off;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!differ(found[i].agreement))
      off.push_back(std::abs((pairs[i].T_a_b.inverse() * found[i].T_a_b).log()[5]));
  if (off.size() < kEnough) return kShortest;
  const auto nth = off.begin() + std::lround(kShare * static_cast<double>(off.size() - 1));
  std::ranges::nth_element(off, nth);
  // The headings of two robots wander apart as random walks; to the side that makes, after d metres,
  // sqrt(2) sigma sqrt(d / kWay) d / sqrt(3).
  const double sigma = std::max(*nth / kSigmas, 1e-6);
  return std::clamp(std::cbrt(1.5 * kWay * std::pow(kMayBeOff / sigma, 2)), kShortest, kLongest);
}

std::vector<Discernment::Walk> Discernment::walks_from(const std::vector<LoopCandidate>& similar) const {
  const std::vector<Segment> stretches =
      agreeing_segments(chain_, chain_, similar, static_cast<std::size_t>(config_.look_alikes));
  // Of each stretch the first candidate that can be followed; the next ones are tried only where it cannot.
  std::vector<std::optional<Walk>> found(stretches.size());
  for (std::size_t attempt = 0; attempt < kTried; ++attempt) {
    std::vector<std::size_t> open;
    std::vector<std::uint32_t> used;
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      if (found[s] || attempt >= stretches[s].candidates.size()) continue;
      const LoopCandidate& candidate = stretches[s].candidates[attempt];
      used.insert(used.end(), {candidate.query.index, candidate.match.index});
      open.push_back(s);
    }
    features_->prepare(used);
    parallel_for_each(open.size(), [&](std::size_t i) {
      found[open[i]] = walk_from(stretches[open[i]].candidates[attempt]);
    });
  }
  std::vector<Walk> walks;
  for (const std::optional<Walk>& walk : found) {
    if (!walk) continue;
    const std::size_t num_look_alikes = walks.size() / 2;
    for (const double direction : {1.0, -1.0}) {
      walks.push_back(*walk);
      walks.back().direction = direction;
      walks.back().look_alike = num_look_alikes;
    }
  }
  return walks;
}

// None where registration finds no way to lay one over the other, and where odometry does not exclude that
// it is one place: scans from afar that see the same walls.
std::optional<Discernment::Walk> Discernment::walk_from(const LoopCandidate& candidate) const {
  const std::uint32_t a = candidate.query.index;
  const std::uint32_t b = candidate.match.index;
  const Registration found = register_features(features_->at(a), features_->at(b), registration_);
  if (found.verdict != LoopVerdict::accepted || found.weak_axis < kWeakAxis ||
      fits_odometry(chain_, {a, b, *found.T_a_b}))
    return {};
  return Walk{a, b, *found.T_a_b};
}

void Discernment::follow(std::vector<Walk> walks, Measured& measured) {
  std::vector<StandingOffsets> offsets(walks.size());  // of each look-alike
  while (!walks.empty()) {
    std::vector<Fit> next;
    std::vector<std::uint32_t> places;
    std::vector<std::size_t> differing;
    for (Walk& walk : walks) {
      walk.way += walk.direction * config_.spacing_m;
      const std::optional<Fit> fit = at(walk, walk.way, kDistances[next.size() % kDistances.size()]);
      walk.is_over = std::abs(walk.way) > kFollowed || !fit;
      if (walk.is_over) continue;
      next.push_back(*fit);
      places.push_back(fit->a);
    }
    std::erase_if(walks, [](const Walk& walk) { return walk.is_over; });
    const std::vector<bool> tells = distinctive(places);
    std::vector<LocalFit> found = fits(next, limit_, FitFrom::along_the_way);
    for (std::size_t w = 0; w < walks.size(); ++w)
      if (differ(found[w].agreement)) differing.push_back(w);
    if (config_.second_looks) look_again(walks, differing, next, found);
    for (std::size_t w = 0; w < walks.size(); ++w) {
      walks[w].is_over = differ(found[w].agreement);
      if (!walks[w].is_over)
        offsets[walks[w].look_alike].add(patch_offsets(surfaces_.at(next[w].a), surfaces_.at(next[w].b),
                                                       found[w].T_a_b, chain_.pose(next[w].a),
                                                       registration_.relief));
      if (walks[w].is_over || tells[w]) measured.look_alikes.add(walks[w].num_passed, !walks[w].is_over);
      if (tells[w]) ++walks[w].num_passed;
    }
    std::erase_if(walks, [](const Walk& walk) { return walk.is_over; });
  }
  for (const StandingOffsets& of_one : offsets) measured.walls.add_other(of_one.counted());
}

std::optional<Discernment::Fit> Discernment::at(const Walk& walk, double way, double apart) const {
  // The two drives run the same way along the look-alike, or one against the other; keyframe b stands
  // T_a_b.x ahead of a already.
  const double sense = (walk.T_a_b.rotation_matrix() * Vector3::UnitX()).x() > 0.0 ? 1.0 : -1.0;
  const auto a = keyframe_at(way_, way_[walk.a] + way);
  const auto b = keyframe_at(way_, way_[walk.b] + sense * (way + apart - walk.T_a_b.translation().x()));
  if (!a || !b) return {};
  return Fit{*a, *b, chain_.between(*a, walk.a) * walk.T_a_b * chain_.between(walk.b, *b)};
}

void Discernment::look_again(const std::vector<Walk>& walks, const std::vector<std::size_t>& which,
                             std::vector<Fit>& fitted, std::vector<LocalFit>& found) {
  std::vector<std::size_t> seen;
  std::vector<Fit> asked;
  for (const std::size_t w : which)
    for (const double metres : {kSecondLook, -kSecondLook}) {
      const std::optional<Fit> fit = at(walks[w], walks[w].way + metres, kDistances.front());
      if (!fit) continue;
      seen.push_back(w);
      asked.push_back(*fit);
      break;
    }
  const std::vector<LocalFit> again = fits(asked, limit_, FitFrom::along_the_way);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (differ(again[i].agreement)) continue;
    fitted[seen[i]] = asked[i];
    found[seen[i]] = again[i];
  }
}

// Both ways: an end of a niche may show one way and not the other.
std::vector<bool> Discernment::distinctive(const std::vector<std::uint32_t>& indices) {
  constexpr std::uint32_t kTogether = 3;  // keyframes, which one of them speaks for: a metre, of five
  const auto last = static_cast<std::uint32_t>(way_.size() - 1);
  const auto speaker_of = [&](std::uint32_t k) { return std::min(k - k % kTogether + kTogether / 2, last); };
  std::vector<std::uint32_t> open;
  for (const std::uint32_t k : indices)
    if (distinctive_.emplace(speaker_of(k), false).second) open.push_back(speaker_of(k));
  for (const double by : {-config_.displacement_m, config_.displacement_m}) {
    std::vector<Fit> displaced;
    for (const std::uint32_t k : open)
      if (const auto other = keyframe_at(way_, way_[k] + by)) displaced.push_back({k, *other, Pose()});
    const std::vector<LocalFit> found = fits(displaced, limit_, FitFrom::guess);
    for (std::size_t i = 0; i < displaced.size(); ++i) {
      const bool differs = differ(found[i].agreement);
      distinctive_[displaced[i].a] = differs;
      if (!differs) std::erase(open, displaced[i].a);
    }
  }
  std::vector<bool> out;
  for (const std::uint32_t k : indices) out.push_back(distinctive_.at(speaker_of(k)));
  return out;
}

}  // namespace adit
