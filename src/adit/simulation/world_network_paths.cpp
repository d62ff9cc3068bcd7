// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Paths of robots through a network: random walks, of which those are chosen whose common stretches are as
/// long as was drawn.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "adit/core/angles.hpp"
#include "adit/simulation/world_network.hpp"

namespace adit {
namespace {

constexpr double kShortest = 150.0;  // Metres.
constexpr double kLongest = 350.0;
constexpr double kFromEnd = 4.0;               // From where a tunnel ends to where a robot starts or stops.
constexpr double kSharpest = 110.0 * kDegree;  // Turn at a junction: loaders back up where it is sharper.
constexpr double kLeastShared = 20.0;
constexpr double kLeastRock = 10.0;

/// The stretch of an edge that a path runs along, metres from the edge's beginning.
struct Span {
  std::size_t edge = 0;
  double begin = 0.0;
  double end = 0.0;
};

std::vector<Span> spans_of(const Network& network, const NetworkPath& path) {
  std::vector<Span> spans;
  double begin = path.begin;
  double left = path.length;
  for (const Step& step : path.steps) {
    const double length = length_of(network.edges[step.edge].line);
    const double end = std::min(length, begin + left);
    spans.push_back(step.forward ? Span{step.edge, begin, end}
                                 : Span{step.edge, length - end, length - begin});
    left -= end - begin;
    begin = 0.0;
  }
  return spans;
}

std::size_t end_of(const Network& network, const Step& step) {
  return step.forward ? network.edges[step.edge].to : network.edges[step.edge].from;
}

double turn_at(const Network& network, std::size_t node, std::size_t from, std::size_t to) {
  const double cosine = -direction_at(network.edges[from], node).dot(direction_at(network.edges[to], node));
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

/// Where a path can go on: not through a tunnel that it has driven, nor around too sharp a corner.
std::vector<Step> continuations(const Network& network, const NetworkPath& path) {
  const Step& last = path.steps.back();
  const std::size_t node = end_of(network, last);
  std::vector<Step> steps;
  for (const std::size_t edge : network.edges_at(node)) {
    const bool is_new = std::ranges::none_of(path.steps, [&](const Step& s) { return s.edge == edge; });
    if (is_new && turn_at(network, node, last.edge, edge) <= kSharpest)
      steps.push_back({edge, network.edges[edge].from == node});
  }
  return steps;
}

/// A random walk from a portal or dead end; its length is 0 when it comes out too short.
NetworkPath draw_walk(const Network& network, std::size_t start, Rng& rng) {
  constexpr double kLeastOfStep = 10.0;  // A robot does not stop within a junction.
  const double wanted = rng.uniform(kShortest + 10.0, kLongest);
  const std::size_t first = network.edges_at(start).front();
  NetworkPath path{{{first, network.edges[first].from == start}}, kFromEnd, 0.0, 1.5, 0.0};
  double length = length_of(network.edges[first].line) - kFromEnd;
  while (length < wanted) {
    const std::vector<Step> next = continuations(network, path);
    if (next.empty()) break;
    const double before = length;
    path.steps.push_back(next[rng.below(next.size())]);
    length += length_of(network.edges[path.steps.back().edge].line);
    if (wanted - before >= kLeastOfStep) continue;
    path.steps.pop_back();
    length = before;
    break;
  }
  const bool ends_in_the_open = network.edges_at(end_of(network, path.steps.back())).size() > 1;
  path.length = std::min(wanted, length - (ends_in_the_open ? 0.0 : kFromEnd));
  if (path.length < kShortest) path.length = 0.0;
  return path;
}

/// Walks from all ends of the network, as many from each.
std::vector<NetworkPath> draw_walks(const Network& network, Rng& rng) {
  constexpr int kWalksPerStart = 50;
  std::vector<NetworkPath> walks;
  for (std::size_t node = 0; node < network.nodes.size(); ++node) {
    if (network.edges_at(node).size() != 1) continue;
    for (int k = 0; k < kWalksPerStart; ++k)
      if (NetworkPath walk = draw_walk(network, node, rng); walk.length > 0.0)
        walks.push_back(std::move(walk));
  }
  for (std::size_t i = walks.size(); i > 1; --i) std::swap(walks[i - 1], walks[rng.below(i)]);
  return walks;
}

bool starts_elsewhere(const NetworkPath& a, const NetworkPath& b) {
  return a.steps[0].edge != b.steps[0].edge || a.steps[0].forward != b.steps[0].forward;
}

/// A pair shares a stretch that is worth the name, or it stays apart.
bool is_clear_case(const Relation& relation) {
  return relation.shared >= kLeastShared || relation.apart >= kLeastRock;
}

/// How much a pair is to share, metres.
struct Wish {
  double least = 0.0;
  double most = 0.0;
};

Wish draw_wish(double shorter, bool apart, Rng& rng) {
  const double draw = rng.uniform();
  if (apart || draw < 0.3) return {0.0, 0.0};
  if (draw < 0.5) return {kLeastShared, 60.0};
  if (draw < 0.75) return {60.0, 0.6 * shorter};
  return {0.6 * shorter, shorter};
}

/// The first walk that is a clear case with all chosen ones and has the wish fulfilled with `partner`; else
/// the first that is a clear case with all. `walks` has been drawn in random order.
const NetworkPath* choose(const Network& network, const std::vector<NetworkPath>& walks,
                          const std::vector<NetworkPath>& chosen, bool apart, Rng& rng) {
  const std::size_t partner = rng.below(chosen.size());
  const Wish wish = draw_wish(chosen[partner].length, apart, rng);
  const NetworkPath* second_best = nullptr;
  for (const NetworkPath& walk : walks) {
    bool is_clear = true;
    double shared = 0.0;
    for (std::size_t k = 0; k < chosen.size() && is_clear; ++k) {
      is_clear = starts_elsewhere(walk, chosen[k]);
      if (!is_clear) break;
      const Relation relation = relation_of(network, walk, chosen[k]);
      is_clear = is_clear_case(relation) && !(apart && relation.shared > 0.0);
      if (k == partner) shared = relation.shared;
    }
    if (!is_clear) continue;
    if (shared >= wish.least && shared <= wish.most) return &walk;
    if (second_best == nullptr) second_best = &walk;
  }
  return second_best;
}

bool any_pair_shares(const Network& network, const std::vector<NetworkPath>& paths) {
  for (std::size_t a = 0; a < paths.size(); ++a)
    for (std::size_t b = a + 1; b < paths.size(); ++b)
      if (relation_of(network, paths[a], paths[b]).shared > 0.0) return true;
  return false;
}

double narrowest_of(const Network& network, const NetworkPath& path) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const Step& step : path.steps) {
    const Section& section = network.edges[step.edge].section;
    for (const double side : {1.0, -1.0})
      for (const double above : {0.1, 1.2}) narrowest = std::min(narrowest, half_width(section, above, side));
  }
  return narrowest;
}

/// Least rock between two stretches that share no tunnel.
double rock_between(const Network& network, const Span& a, const Span& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto points = [&](const Span& span) {
    const Polyline& line = network.edges[span.edge].line;
    std::vector<std::size_t> within;
    double at = 0.0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (i > 0) at += (line[i] - line[i - 1]).norm();
      if (at >= span.begin - 1.5 && at <= span.end + 1.5) within.push_back(i);
    }
    return within;
  };
  const std::vector<std::size_t> of_a = points(a);
  const std::vector<std::size_t> of_b = points(b);
  for (std::size_t i = 0; i < of_a.size(); i += 2)
    for (std::size_t j = 0; j < of_b.size(); j += 2)
      least =
          std::min(least, adit::rock_between(network.edges[a.edge], of_a[i], network.edges[b.edge], of_b[j]));
  return least;
}

}  // namespace

Relation relation_of(const Network& network, const NetworkPath& a, const NetworkPath& b) {
  const std::vector<Span> of_a = spans_of(network, a);
  const std::vector<Span> of_b = spans_of(network, b);
  Relation relation{0.0, std::numeric_limits<double>::infinity()};
  for (const Span& s : of_a)
    for (const Span& t : of_b)
      if (s.edge == t.edge)
        relation.shared += std::max(0.0, std::min(s.end, t.end) - std::max(s.begin, t.begin));
  for (const Span& s : of_a)
    for (const Span& t : of_b) {
      if (relation.shared > 0.0 || relation.apart == 0.0) return {relation.shared, 0.0};
      relation.apart = std::min(relation.apart, rock_between(network, s, t));
    }
  return relation;
}

std::vector<NetworkPath> draw_paths(const Network& network, const WorldConfig& config, Rng& rng) {
  const bool apart = config.routes == "apart";
  const std::uint64_t wanted = 3 + rng.below(4);
  const std::vector<NetworkPath> walks = draw_walks(network, rng);
  std::vector<NetworkPath> chosen;
  if (walks.empty()) return chosen;
  chosen.push_back(walks.front());
  while (chosen.size() < wanted) {
    const NetworkPath* next = choose(network, walks, chosen, apart, rng);
    if (next == nullptr) break;
    chosen.push_back(*next);
  }
  for (NetworkPath& path : chosen) {
    path.speed_mps = rng.uniform(1.2, 1.9);
    const double room = std::clamp(narrowest_of(network, path) - 1.9, 0.0, 0.8);
    path.lane = room * rng.uniform(-1.0, 1.0);
  }
  if (!apart && !any_pair_shares(network, chosen)) chosen.clear();
  return chosen;
}

Polyline line_of(const Network& network, const NetworkPath& path) {
  std::vector<Polyline> parts;
  const std::vector<Span> spans = spans_of(network, path);
  for (std::size_t i = 0; i < spans.size(); ++i) {
    Polyline part = part_of(network.edges[spans[i].edge].line, spans[i].begin, spans[i].end);
    parts.push_back(path.steps[i].forward ? std::move(part) : reversed_line(std::move(part)));
  }
  const double corner = std::clamp(1.6 * narrowest_of(network, path), 2.6, 6.0);
  return offset_line(rounded(parts, corner), path.lane);
}

}  // namespace adit
