// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_floors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

std::vector<Vector3> drawn_line(Rng& rng) {
  std::vector<Vector3> line{Vector3(rng.uniform(-60.0, 60.0), rng.uniform(-60.0, 60.0), 0.0)};
  for (int i = 0; i < 30; ++i) {
    const double dx = rng.uniform(0.5, 2.0);
    const double dy = rng.uniform(-1.0, 1.0);
    line.emplace_back(line.back() + Vector3(dx, dy, rng.uniform(-0.2, 0.2)));
  }
  return line;
}

/// Height of the nearest of many points along the lines.
double sampled_height(const std::vector<std::vector<Vector3>>& lines, const Vector3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  double height = 0.0;
  for (const std::vector<Vector3>& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i)
      for (int k = 0; k <= 400; ++k) {
        const Vector3 q = line[i - 1] + (line[i] - line[i - 1]) * (k / 400.0);
        const double distance = (q - p).head<2>().squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          height = q.z();
        }
      }
  return height;
}

TEST(Floors, TakeTheHeightOfTheNearestLine) {
  Rng rng(3);
  std::vector<std::vector<Vector3>> lines;
  Floors floors;
  for (int i = 0; i < 3; ++i) {
    lines.push_back(drawn_line(rng));
    floors.add(lines.back());
  }
  for (int i = 0; i < 200; ++i) {
    const double x = rng.uniform(-100.0, 100.0);  // Far from all lines too.
    const double y = rng.uniform(-100.0, 100.0);
    const Vector3 p(x, y, rng.uniform(-5.0, 5.0));
    EXPECT_NEAR(floors.height(p), sampled_height(lines, p), 2e-3) << p.transpose();
  }
}

TEST(Floors, ATiltAddsToTheLines) {
  Floors floors;
  EXPECT_EQ(floors.height(Vector3(3.0, 4.0, 5.0)), 0.0);
  floors.set_tilt({0.1, -0.02});
  EXPECT_DOUBLE_EQ(floors.height(Vector3(10.0, 5.0, 9.0)), 0.9);
  floors.add(std::vector<Vector3>{{0.0, 0.0, 2.0}, {20.0, 0.0, 4.0}});
  EXPECT_DOUBLE_EQ(floors.height(Vector3(10.0, 5.0, 9.0)), 3.9);
}

}  // namespace
}  // namespace adit
