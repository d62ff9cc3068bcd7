// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_advice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/search/path.hpp"

namespace adit {
namespace {

constexpr double kFarthest = 100.0;      // metres along the path that a drive is asked for, at most
constexpr std::size_t kMostPlaces = 70;  // that are asked about: 33 beyond each end, and what rounding adds
constexpr double kBeen = 5.0;            // metres, a tunnel's width: a robot this near has been there
constexpr double kOnePart = 20.0;        // metres: places of one stretch are not farther apart along the path
constexpr double kLandmark = 60.0;       // metres that a robot is asked to drive to be recognised

/// Own keyframes beyond an end of what both drove, in the order in which they would be passed.
struct Way {
  std::uint32_t end = 0;
  std::vector<std::uint32_t> places;
};

/// What agreement at a place would be worth.
struct Worth {
  bool is_distinctive = false;
  bool differs_from_rivals = false;  ///< Scans differ from those where the rival puts the place.
};

class DriveSearch {
 public:
  DriveSearch(const UndecidedStretch& stretch, const OdometryChain& own, const OdometryChain& theirs,
              double spacing_m)
      : stretch_(stretch), own_(own), path_m_(own.path_m()), spacing_m_(spacing_m) {
    const std::vector<double>& their_path_m = theirs.path_m();
    for (std::size_t j = 0; j < theirs.size(); ++j) {
      const PcmLoop& loop = nearest_loop(stretch.loops, their_path_m, j);
      const Vector3 from_loop = (loop.T_a_b * theirs.between(loop.b, j)).translation();
      their_positions_.push_back(own.pose(loop.a) * from_loop);
    }
  }

  [[nodiscard]] std::vector<Way> ways() const {
    std::vector<Way> out;
    for (const auto& [first, last] : parts()) {
      out.push_back(beyond(first, -1));
      out.push_back(beyond(last, 1));
    }
    std::erase_if(out, [](const Way& way) { return way.places.empty(); });
    for (Way& way : out) way.places.resize(std::min(way.places.size(), kMostPlaces / out.size()));
    return out;
  }

  /// The shortest part of the way that brings what is missing, or all of it; none if it brings nothing.
  [[nodiscard]] std::optional<MergeAdvice> along(const Way& way, const std::vector<Worth>& worth) const {
    std::vector<TestedPlace> places = stretch_.places;
    MergeAdvice out;
    out.from_m = path_m_[way.end];
    out.from = own_.pose(way.end).translation();
    out.missing = stretch_.missing;
    double lost_by_rival = 0.0;
    for (std::size_t i = 0; i < way.places.size() && !is_decided(out); ++i) {
      const bool lacks_metres_alone = out.gain >= out.missing;
      if (!worth[i].is_distinctive && !lacks_metres_alone) continue;
      if (worth[i].is_distinctive) places.push_back({way.places[i], 0, PlaceOutcome::distinctive});
      if (worth[i].is_distinctive && worth[i].differs_from_rivals) lost_by_rival += loss_where_it_differs();
      out.to_m = path_m_[way.places[i]];
      out.gain = evidence_at(places) - evidence_at(stretch_.places) + lost_by_rival;
    }
    return out.gain > 0.0 ? std::optional(out) : std::nullopt;
  }

  [[nodiscard]] bool is_decided(const MergeAdvice& advice) const {
    return advice.gain >= stretch_.missing && std::abs(advice.to_m - advice.from_m) >= stretch_.least_m &&
           advice.gain > 0.0;
  }

  /// The own keyframe where the rival puts a place; none where the own robot has not been there.
  [[nodiscard]] std::optional<OwnComparison> of_rival(std::uint32_t place, const Pose& T_rival_best) const {
    const Vector3 there = T_rival_best * own_.pose(place).translation();
    const auto nearest = nearest_beside(own_, there, [](std::uint32_t) { return true; });
    if (!nearest) return {};
    return OwnComparison{place, *nearest,
                         own_.pose(place).inverse() * T_rival_best.inverse() * own_.pose(*nearest)};
  }

 private:
  /// First and last keyframe of each stretch that both drove.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> parts() const {
    std::vector<std::uint32_t> shared = stretch_.shared;
    std::ranges::sort(shared);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
    for (const std::uint32_t k : shared) {
      if (out.empty() || path_m_[k] - path_m_[out.back().second] > kOnePart) out.emplace_back(k, k);
      out.back().second = k;
    }
    return out;
  }

  /// Ends where the own path comes back to where one of them has been: what lies beyond is reached otherwise.
  [[nodiscard]] Way beyond(std::uint32_t end, int step) const {
    Way way{end, {}};
    double last_m = path_m_[end];
    for (auto k = static_cast<std::ptrdiff_t>(end); k >= 0 && k < std::ssize(path_m_); k += step) {
      const auto place = static_cast<std::uint32_t>(k);
      const bool has_come_back = !way.places.empty() && std::abs(path_m_[place] - last_m) > kOnePart;
      if (has_come_back || std::abs(path_m_[place] - path_m_[end]) > kFarthest) break;
      if (std::abs(path_m_[place] - last_m) < spacing_m_ || has_been(way, place)) continue;
      way.places.push_back(place);
      last_m = path_m_[place];
    }
    return way;
  }

  /// The other robot has been there, or would pass it twice, as where the own one turned.
  [[nodiscard]] bool has_been(const Way& way, std::uint32_t place) const {
    constexpr double kDetour = 2.0;  // path over distance, of what is no way on
    const Vector3 position = own_.pose(place).translation();
    const auto is_there = [&](const Vector3& other) { return (other - position).norm() < kBeen; };
    const auto is_again = [&](std::uint32_t k) {
      const Vector3 other = own_.pose(k).translation();
      return is_there(other) && std::abs(path_m_[k] - path_m_[place]) >
                                    kDetour * std::max((other - position).norm(), kSideBySide);
    };
    return std::ranges::any_of(their_positions_, is_there) || std::ranges::any_of(way.places, is_again);
  }

  [[nodiscard]] double evidence_at(std::vector<TestedPlace> places) const {
    std::ranges::stable_sort(places, {}, &TestedPlace::a);
    return stretch_.evidence(places);
  }

  [[nodiscard]] double loss_where_it_differs() const {
    return -evidence_at_places({{0, 0, PlaceOutcome::differs}}, stretch_.chances).front();
  }

  const UndecidedStretch& stretch_;
  const OdometryChain& own_;
  const std::vector<double>& path_m_;
  double spacing_m_;
  std::vector<Vector3> their_positions_;  ///< In the own odometry frame, if the hypothesis is true.
};

/// The pose of their odometry frame in the own one, by a loop.
Pose frame_by(const PcmLoop& loop, const OdometryChain& own, const OdometryChain& theirs) {
  return own.pose(loop.a) * loop.T_a_b * theirs.pose(loop.b).inverse();
}

/// From where the hypothesis puts what the other robot passes to where its rival does, near an own keyframe.
Pose rival_from_best(const UndecidedStretch& stretch, const OdometryChain& own, const OdometryChain& theirs,
                     std::uint32_t near) {
  const auto keyframes_off = [&](const PcmLoop& loop) {
    return loop.a > near ? loop.a - near : near - loop.a;
  };
  const PcmLoop& best = *std::ranges::min_element(stretch.loops, {}, keyframes_off);
  const PcmLoop& rival = nearest_loop(stretch.rival_loops, theirs.path_m(), best.b);
  return frame_by(rival, own, theirs) * frame_by(best, own, theirs).inverse();
}

/// A place that looks the same where the rival puts it decides nothing between the two.
void weigh_against_rival(const DriveSearch& search, const Way& way, const Pose& T_rival_best,
                         const OwnMapKnows& own_map, std::vector<Worth>& worth) {
  std::vector<OwnComparison> asked;
  std::vector<std::size_t> of_place;
  for (std::size_t i = 0; i < way.places.size(); ++i) {
    const std::optional<OwnComparison> pair = search.of_rival(way.places[i], T_rival_best);
    if (!pair) continue;
    asked.push_back(*pair);
    of_place.push_back(i);
  }
  const std::vector<bool> differ = own_map.differ(asked);
  for (std::size_t p = 0; p < asked.size(); ++p) {
    worth[of_place[p]].differs_from_rivals = differ[p];
    if (!differ[p]) worth[of_place[p]].is_distinctive = false;
  }
}

bool is_better(const MergeAdvice& one, const MergeAdvice& other, const DriveSearch& search) {
  const bool both = search.is_decided(one) && search.is_decided(other);
  if (both) return std::abs(one.to_m - one.from_m) < std::abs(other.to_m - other.from_m);
  return search.is_decided(one) || (!search.is_decided(other) && one.gain > other.gain);
}

/// The own path but for what is near one of the `shared` keyframes: stretches of places.
std::vector<std::vector<std::uint32_t>> stretches_apart_from(const std::vector<std::uint32_t>& shared,
                                                             const OdometryChain& own, double spacing_m) {
  const std::vector<double>& path_m = own.path_m();
  const auto is_shared = [&](std::uint32_t k) {
    const Vector3 position = own.pose(k).translation();
    return std::ranges::any_of(shared, [&](std::uint32_t other) {
      return (own.pose(other).translation() - position).norm() < kBeen;
    });
  };
  std::vector<std::vector<std::uint32_t>> out(1);
  for (std::uint32_t k = 0; k < own.size(); ++k) {
    const bool is_on = !out.back().empty();
    if (is_on && path_m[k] - path_m[out.back().back()] < spacing_m) continue;
    if (is_shared(k)) {
      if (is_on) out.emplace_back();
      continue;
    }
    if (is_on && path_m[k] - path_m[out.back().back()] > kOnePart) out.emplace_back();
    out.back().push_back(k);
  }
  return out;
}

/// Places in a row along at most `kLandmark` whose distances from look-alikes sum up to most; at least two.
std::vector<std::uint32_t> most_outstanding(const std::vector<std::vector<std::uint32_t>>& stretches,
                                            const std::vector<double>& path_m,
                                            const std::vector<double>& distances) {
  std::vector<std::uint32_t> best;
  double most = 0.0;
  for (const std::vector<std::uint32_t>& stretch : stretches) {
    double sum = 0.0;
    std::size_t begin = 0;
    for (std::size_t last = 0; last < stretch.size(); ++last) {
      sum += distances[stretch[last]];
      for (; path_m[stretch[last]] - path_m[stretch[begin]] > kLandmark; ++begin)
        sum -= distances[stretch[begin]];
      if (sum <= most || begin == last) continue;
      most = sum;
      best.assign(stretch.begin() + static_cast<std::ptrdiff_t>(begin),
                  stretch.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    }
  }
  return best;
}

std::function<std::vector<bool>(const std::vector<std::uint32_t>&)> asked_of(Discernment& discernment) {
  return [&discernment](const std::vector<std::uint32_t>& keyframes) {
    return discernment.distinctive(keyframes);
  };
}

}  // namespace

OwnLandmarks landmarks_of(std::vector<double> distances, Discernment& discernment) {
  return {std::move(distances), discernment.measured().look_alikes.chances(), asked_of(discernment)};
}

OwnMapKnows what_own_map_knows(Discernment& discernment) {
  const auto differ = [&discernment](const std::vector<OwnComparison>& pairs) {
    std::vector<bool> out;
    for (const LocalFit& fit : discernment.compare(pairs, FitFrom::guess))
      out.push_back(discernment.differ(fit.agreement));
    return out;
  };
  return {asked_of(discernment), differ};
}

std::optional<MergeAdvice> where_to_drive(const UndecidedStretch& stretch, const OdometryChain& own,
                                          const OdometryChain& theirs, double spacing_m,
                                          const OwnMapKnows& own_map) {
  const DriveSearch search(stretch, own, theirs, spacing_m);
  std::optional<MergeAdvice> best;
  for (const Way& way : search.ways()) {
    const std::vector<bool> distinctive = own_map.distinctive(way.places);
    std::vector<Worth> worth;
    for (const bool is_distinctive : distinctive) worth.push_back({is_distinctive, false});
    if (!stretch.rival_loops.empty())
      weigh_against_rival(search, way, rival_from_best(stretch, own, theirs, way.end), own_map, worth);
    const std::optional<MergeAdvice> found = search.along(way, worth);
    if (found && (!best || is_better(*found, *best, search))) best = found;
  }
  return best;
}

std::optional<MergeAdvice> where_to_be_recognised(const OdometryChain& own,
                                                  const std::vector<std::uint32_t>& shared, double missing,
                                                  double spacing_m, const OwnLandmarks& landmarks) {
  const std::vector<std::uint32_t> places =
      most_outstanding(stretches_apart_from(shared, own, spacing_m), own.path_m(), landmarks.distances);
  if (places.empty()) return {};
  const std::vector<bool> distinctive = landmarks.distinctive(places);
  MergeAdvice out;
  out.from_m = own.path_m()[places.front()];
  out.from = own.pose(places.front()).translation();
  out.missing = missing;
  std::size_t num_agreed = 0;
  // From one place to another, at least.
  for (std::size_t i = 0; i < places.size() && (i < 2 || out.gain < missing); ++i) {
    out.to_m = own.path_m()[places[i]];
    if (distinctive[i]) out.gain += evidence_of_agreement(landmarks.chances, num_agreed++);
  }
  return out.gain > 0.0 ? std::optional(out) : std::nullopt;
}

std::string in_words(const MergeAdvice& advice, std::string_view name_a, std::string_view name_b) {
  return format(
      "let {} drive along the path of {} from {:.0f} m (x {:.1f}, y {:.1f} m of its odometry) {} {:.0f} m: "
      "these {:.0f} m are worth {:.1f}, where {:.1f} is missing",
      name_b, name_a, advice.from_m, advice.from.x(), advice.from.y(),
      advice.to_m < advice.from_m ? "back to" : "to", advice.to_m, std::abs(advice.to_m - advice.from_m),
      advice.gain, advice.missing);
}

}  // namespace adit
