// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/route_walks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr std::size_t kCandidates =
    1000;  ///< Walks that are drawn for a robot, each time that it is its turn.
constexpr int kRounds = 4;
constexpr double kSharpestTurn = -0.2;  ///< Cosine of the sharpest turn at a place: 100 degrees.
constexpr double kStraightness = 2.0;   ///< A way straight on is e^2 times as likely as one to the side.
constexpr double kKnownWay = 0.1;       ///< A place where the robot was before is so much less likely.
constexpr double kStartsApart = 25.0;   ///< Metres that robots should start apart.
constexpr double kSharedCounts =
    4.0;  ///< A metre that a pair lacks in common is worth so many that are covered.
constexpr double kStartCounts = 100.0;  ///< Two robots that start at one place are as bad as so many metres.
constexpr double kEndCounts = 20.0;     ///< So many metres is it worth to begin at the end of a passage.

/// A robot's walk as it is drawn.
class Walker {
 public:
  Walker(const RouteNetwork& network, double length, std::uint32_t start)
      : network_(network), left_(length), walk_{start}, times_(network.places.size(), 0) {
    times_[start] = 1;
  }

  /// To a neighbouring place; false where it is too far or the turn too sharp.
  bool go(std::uint32_t to) {
    const auto& ways = network_.places[walk_.back()].ways;
    const auto way = std::ranges::find(ways, to, &RouteEdge::to);
    if (way == ways.end() || way->length_m > left_ || cosine_to(to) < kSharpestTurn) return false;
    left_ -= way->length_m;
    walk_.push_back(to);
    ++times_[to];
    return true;
  }

  void wander(Rng& rng) {
    while (const std::optional<std::uint32_t> next = draw_next(rng))
      if (!go(*next)) break;
  }

  [[nodiscard]] const Walk& walk() const { return walk_; }

 private:
  [[nodiscard]] double cosine_to(std::uint32_t to) const {
    if (walk_.size() < 2) return 1.0;
    const Vector3& here = network_.places[walk_.back()].position;
    const Vector3 before = here - network_.places[walk_[walk_.size() - 2]].position;
    return before.normalized().dot((network_.places[to].position - here).normalized());
  }

  [[nodiscard]] std::optional<std::uint32_t> draw_next(Rng& rng) const {
    const auto& ways = network_.places[walk_.back()].ways;
    const auto weight = [&](const RouteEdge& way) {
      const double cosine = cosine_to(way.to);
      if (way.length_m > left_ || cosine < kSharpestTurn) return 0.0;
      return std::exp(kStraightness * cosine) * std::pow(kKnownWay, times_[way.to]);
    };
    double total = 0.0;
    for (const RouteEdge& way : ways) total += weight(way);
    double draw = rng.uniform() * total;
    for (const RouteEdge& way : ways) {
      draw -= weight(way);
      if (draw < 0.0) return way.to;
    }
    return std::nullopt;
  }

  const RouteNetwork& network_;
  double left_;
  Walk walk_;
  std::vector<int> times_;  ///< How often each place was passed.
};

/// Where robots may begin.
struct Starts {
  std::vector<std::uint32_t> ends;  ///< Of passages; where there is none, all places.
  std::vector<std::uint32_t> all;
};

Starts starts_of(const RouteNetwork& network) {
  Starts starts;
  for (std::uint32_t place = 0; place < network.places.size(); ++place) {
    if (network.places[place].ways.empty()) continue;
    starts.all.push_back(place);
    if (network.is_end(place)) starts.ends.push_back(place);
  }
  if (starts.ends.empty()) starts.ends = starts.all;
  return starts;
}

/// Places from `from` to `to` by the shortest way, without `from`.
Walk way_between(const RouteNetwork& network, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> before;
  if (!std::isfinite(distances_from(network, from, &before)[to])) return {};
  Walk way;
  for (std::uint32_t place = to; place != from; place = before[place]) way.push_back(place);
  std::ranges::reverse(way);
  return way;
}

/// From a start to a place of `other`, along it for about what two robots should share, and on at random.
Walk meeting_walk(const RouteNetwork& network, const Walk& other, std::uint32_t start,
                  const RouteConfig& config, Rng& rng) {
  Walker walker(network, config.length_m, start);
  const std::size_t meeting = rng.below(other.size());
  for (const std::uint32_t place : way_between(network, start, other[meeting]))
    if (!walker.go(place)) return walker.walk();
  const bool forward = rng.below(2) == 0;
  const double to_share = rng.uniform(0.8, 1.5) * config.shared_m;
  double shared = 0.0;
  for (std::size_t i = meeting; shared < to_share;) {
    if (forward ? i + 1 == other.size() : i == 0) break;
    const std::size_t next = forward ? i + 1 : i - 1;
    shared += (network.places[other[next]].position - network.places[other[i]].position).norm();
    if (!walker.go(other[next])) break;
    i = next;
  }
  walker.wander(rng);
  return walker.walk();
}

/// How good a set of walks is, in metres of covered network. A place stands for the metres around it.
class Judge {
 public:
  Judge(const RouteNetwork& network, const RouteConfig& config)
      : network_(network), shared_m_(config.shared_m), metres_(network.places.size(), 0.0) {
    for (std::size_t place = 0; place < metres_.size(); ++place) {
      const auto& ways = network.places[place].ways;
      for (const RouteEdge& way : ways) metres_[place] += way.length_m / static_cast<double>(ways.size());
    }
  }

  using Places = std::vector<bool>;
  [[nodiscard]] Places places_of(const Walk& walk) const {
    Places places(metres_.size(), false);
    for (const std::uint32_t place : walk) places[place] = true;
    return places;
  }

  /// What `walk` adds to the other ones.
  [[nodiscard]] double worth(const Walk& walk, const std::vector<Walk>& others,
                             const std::vector<Places>& of_others) const {
    const Places own = places_of(walk);
    double score = network_.is_end(walk.front()) ? 0.0 : -kEndCounts;
    std::vector<double> shared(others.size(), 0.0);
    for (std::size_t place = 0; place < own.size(); ++place) {
      if (!own[place]) continue;
      bool is_new = true;
      for (std::size_t other = 0; other < others.size(); ++other) {
        if (!of_others[other][place]) continue;
        is_new = false;
        shared[other] += metres_[place];
      }
      if (is_new) score += metres_[place];
    }
    for (std::size_t other = 0; other < others.size(); ++other) {
      score += kSharedCounts * std::min(shared[other], shared_m_);
      const double apart =
          (network_.places[walk.front()].position - network_.places[others[other].front()].position).norm();
      score -= kStartCounts * std::max(0.0, 1.0 - apart / kStartsApart);
    }
    return score;
  }

 private:
  const RouteNetwork& network_;
  double shared_m_;
  std::vector<double> metres_;
};

/// The best of many walks beside the others; `present` stays where none is better.
Walk best_walk(const RouteNetwork& network, const Judge& judge, const Walk& present,
               const std::vector<Walk>& others, const RouteConfig& config, std::uint64_t seed) {
  const Starts starts = starts_of(network);
  std::vector<Walk> candidates(kCandidates);
  std::vector<double> worth(kCandidates);
  std::vector<Judge::Places> of_others;
  for (const Walk& other : others) of_others.push_back(judge.places_of(other));
  parallel_for_each(kCandidates, [&](std::size_t k) {
    Rng rng(mix64(seed, k));
    const std::vector<std::uint32_t>& from = k % 3 == 0 ? starts.all : starts.ends;
    const std::uint32_t start = from[rng.below(from.size())];
    if (!others.empty() && k % 4 != 0) {
      candidates[k] = meeting_walk(network, others[rng.below(others.size())], start, config, rng);
    } else {
      Walker walker(network, config.length_m, start);
      walker.wander(rng);
      candidates[k] = walker.walk();
    }
    worth[k] = judge.worth(candidates[k], others, of_others);
  });
  const auto best = static_cast<std::size_t>(std::ranges::max_element(worth) - worth.begin());
  const bool keeps = !present.empty() && judge.worth(present, others, of_others) >= worth[best];
  return keeps ? present : candidates[best];
}

}  // namespace

std::vector<Walk> choose_walks(const RouteNetwork& network, std::size_t num_robots,
                               const RouteConfig& config) {
  if (starts_of(network).all.empty()) return {};
  const Phase phase("choosing routes", kRounds * num_robots);
  const Judge judge(network, config);
  std::vector<Walk> walks(num_robots);
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    for (std::size_t robot = 0; robot < num_robots; ++robot) {
      std::vector<Walk> others;
      for (std::size_t other = 0; other < num_robots; ++other)
        if (other != robot && !walks[other].empty()) others.push_back(walks[other]);
      walks[robot] = best_walk(network, judge, walks[robot], others, config,
                               mix64(config.seed, round * num_robots + robot));
      phase.advance();
    }
  }
  return walks;
}

}  // namespace adit
