// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Parallel tubes with cross passages.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "adit/simulation/world_network_grow.hpp"

namespace adit::layouts {
namespace {

struct Tubes {
  std::vector<Polyline> lines;
  /// Of each tube: the nodes along it by distance from its beginning.
  std::vector<std::map<double, std::size_t>> nodes;
};

Tubes draw_tubes(const NetworkStyle& style, const WorldConfig& config, Rng& rng) {
  const std::size_t num = chance(rng, 0.65) ? 2 : 3;
  const double length = std::clamp(style.total_length / static_cast<double>(num) * 0.85, 210.0, 420.0);
  const double amplitude = config.curvature_factor * rng.uniform(0.0, 14.0);
  const double wavelength = rng.uniform(220.0, 500.0);
  const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  Polyline middle;
  for (double x = 0.0; x <= length; x += 1.5)
    middle.emplace_back(x, amplitude * std::sin(2.0 * std::numbers::pi * x / wavelength + phase), 0.0);
  Tubes tubes;
  double left = 0.0;
  for (std::size_t i = 0; i < num; ++i) {
    tubes.lines.push_back(offset_line(middle, left));
    tubes.nodes.emplace_back();
    left += style.width * (1.0 + style.variation) + rng.uniform(11.0, 32.0);
  }
  return tubes;
}

bool is_free(const std::map<double, std::size_t>& nodes, double at, double gap) {
  return std::ranges::none_of(nodes, [&](const auto& node) { return std::abs(node.first - at) < gap; });
}

struct Passage {
  std::size_t from;
  std::size_t to;
};

std::vector<Passage> draw_passages(Tubes& tubes, const NetworkStyle& style, Grower& grower, Rng& rng) {
  const double gap = 2.0 * style.width + 8.0;
  const double mean = rng.uniform(gap + 6.0, 80.0);  // Metro and service passages; road tunnels have fewer.
  std::vector<Passage> passages;
  for (std::size_t i = 0; i + 1 < tubes.lines.size(); ++i) {
    const double skew = rng.uniform(-0.5, 0.5) * (tubes.lines[i + 1][0] - tubes.lines[i][0]).norm();
    double at = 24.0 + mean * rng.uniform(0.0, 0.5);
    while (true) {
      const double turn = style.repeats ? skew : skew * rng.uniform(-1.0, 1.0);
      const double to = at + turn;
      if (std::max(at, to) > std::min(length_of(tubes.lines[i]), length_of(tubes.lines[i + 1])) - 20.0) break;
      if (to > 20.0 && is_free(tubes.nodes[i], at, gap) && is_free(tubes.nodes[i + 1], to, gap)) {
        const std::size_t a = grower.add_node(point_at(tubes.lines[i], at).position, 0);
        const std::size_t b = grower.add_node(point_at(tubes.lines[i + 1], to).position, 0);
        tubes.nodes[i][at] = a;
        tubes.nodes[i + 1][to] = b;
        passages.push_back({a, b});
      }
      at += style.repeats ? mean : mean * rng.uniform(0.5, 1.5);
    }
  }
  return passages;
}

}  // namespace

bool lay_tubes(Network& network, Grower& grower, const WorldConfig& config, Rng& rng) {
  network.style.pillar = 8.0;
  const NetworkStyle& style = network.style;
  Tubes tubes = draw_tubes(style, config, rng);
  const std::vector<Passage> passages = draw_passages(tubes, style, grower, rng);
  if (passages.size() < tubes.lines.size()) return false;
  for (std::size_t i = 0; i < tubes.lines.size(); ++i) {
    const Polyline& line = tubes.lines[i];
    tubes.nodes[i][0.0] = grower.add_node(line.front(), 0);
    tubes.nodes[i][length_of(line)] = grower.add_node(line.back(), 0);
    const Section section = grower.draw_section();
    auto before = tubes.nodes[i].begin();
    for (auto after = std::next(before); after != tubes.nodes[i].end(); before = after++) {
      Polyline part = stretch_of(line, before->first, after->first);
      const Copy copy = !style.repeats ? Copy::own : chance(rng, 0.6) ? Copy::same : Copy::changed;
      if (!grower.try_edge(
              {before->second, after->second, std::move(part), section, {}, copy, style.repeats ? 1 : 0}, 0))
        return false;
    }
  }
  const Section module = grower.draw_section(0.7);
  for (const auto& [a, b] : passages) {
    Polyline line = shaped_line(network.nodes[a].at, network.nodes[b].at, {});
    NetworkEdge edge{a,
                     b,
                     std::move(line),
                     style.repeats ? module : grower.draw_section(0.7),
                     {},
                     style.repeats ? Copy::same : Copy::own,
                     style.repeats ? 2 : 0};
    if (!grower.try_edge(std::move(edge), 0)) return false;
  }
  return true;
}

}  // namespace adit::layouts
