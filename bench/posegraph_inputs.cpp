// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "posegraph_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/io/g2o.hpp"
#include "harness/bench_case.hpp"

namespace adit::bench {

std::variant<PoseGraph, PoseGraph2> shared_graph(const std::string& name) {
  auto file = read_g2o(shared_data("g2o/single/" + name + ".g2o"));
  if (!file) throw Skipped{file.error().message};
  if (name == "cubicle") {
    for (auto& edge : std::get<PoseGraph>(file->graph).edges) {
      edge.information.topRightCorner<3, 3>().setZero();
      edge.information.bottomLeftCorner<3, 3>().setZero();
    }
  }
  return file->graph;
}

PoseGraph wandering_graph(std::size_t num_keyframes) {
  constexpr int kStreets = 24;
  constexpr int kBlock = 12;  // metres, and keyframes
  constexpr std::size_t kEvery = 10;
  constexpr double kOdometryNoise = 0.01;
  constexpr double kLoopNoise = 0.03;
  Rng rng(11);
  const auto noise = [&](double size) {
    Vector6 v;
    for (double& x : v) x = size * rng.normal();
    v.tail<3>() *= 0.1;
    return Pose::exp(v);
  };
  Vector6 weights;
  weights << Vector3::Ones(), Vector3::Constant(100.0);
  const auto information = [&](double size) { return Matrix6((weights / (size * size)).asDiagonal()); };
  PoseGraph graph;
  std::vector<Pose> truth;
  std::map<std::pair<int, int>, std::size_t> first_visit;
  std::size_t since_loop = 0;
  int x = 0;
  int y = 0;
  int heading = 0;  // quarter turns
  for (std::size_t i = 0; i < num_keyframes; ++i) {
    truth.push_back(
        Pose::planar(x, y, 0.5 * std::numbers::pi * heading, std::sin(0.02 * x) + std::cos(0.03 * y)));
    if (i == 0) {
      graph.nodes.push_back({0, truth[0]});
    } else {
      const Pose step = truth[i - 1].inverse() * truth[i] * noise(kOdometryNoise);
      graph.nodes.push_back({i, graph.nodes.back().pose * step});
      graph.edges.push_back({i - 1, i, step, information(kOdometryNoise), EdgeKind::odometry});
    }
    const auto [visit, is_new] = first_visit.try_emplace({x, y}, i);
    if (!is_new && ++since_loop >= kEvery && visit->second + 50 < i) {
      since_loop = 0;
      graph.edges.push_back({visit->second, i, truth[visit->second].inverse() * truth[i] * noise(kLoopNoise),
                             information(kLoopNoise), EdgeKind::loop});
    }
    if (x % kBlock == 0 && y % kBlock == 0) {
      const auto leads_on = [&](int h) {
        const int to_x = x + (h == 0 ? kBlock : h == 2 ? -kBlock : 0);
        const int to_y = y + (h == 1 ? kBlock : h == 3 ? -kBlock : 0);
        return std::min(to_x, to_y) >= 0 && std::max(to_x, to_y) <= kStreets * kBlock;
      };
      int turn = static_cast<int>(rng.below(3)) + 3;  // left, ahead, right
      while (!leads_on((heading + turn) % 4)) turn = static_cast<int>(rng.below(4));
      heading = (heading + turn) % 4;
    }
    x += heading == 0 ? 1 : heading == 2 ? -1 : 0;
    y += heading == 1 ? 1 : heading == 3 ? -1 : 0;
  }
  return graph;
}

}  // namespace adit::bench
