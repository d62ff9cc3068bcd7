// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/correspondence_graph.hpp"

#include <algorithm>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

/// Coordinates in rows, so that one correspondence meets a whole block of others in vector registers.
using Rows = Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>;
constexpr Eigen::Index kBlock = 64;
using BlockArray = Eigen::Array<float, 1, kBlock>;

/// Padded with NaN, which is consistent with nothing.
Rows rows_of(std::span<const Eigen::Vector3f> points) {
  const auto padded = static_cast<Eigen::Index>((points.size() + kBlock - 1) / kBlock * kBlock);
  Rows rows = Rows::Constant(3, padded, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < points.size(); ++k) rows.col(static_cast<Eigen::Index>(k)) = points[k];
  return rows;
}

BlockArray squared_distances(const Rows& rows, Eigen::Index from, Eigen::Index block) {
  const auto x = rows.row(0).segment<kBlock>(block).array() - rows(0, from);
  const auto y = rows.row(1).segment<kBlock>(block).array() - rows(1, from);
  const auto z = rows.row(2).segment<kBlock>(block).array() - rows(2, from);
  return x * x + y * y + z * z;
}

std::uint64_t mask_of(const float* excess, const float* slack) {
  std::uint64_t mask = 0;
  for (unsigned k = 0; k < 64; ++k) {
    mask |= static_cast<std::uint64_t>(excess[k] <= slack[k]) << k;
  }
  return mask;
}

/// Without a square root: |da - db| <= c  <=>  s <= 0 or s^2 <= 4 da^2 db^2, with s = da^2 + db^2 - c^2.
std::uint64_t consistent_in_block(const Rows& a, const Rows& b, Eigen::Index from, Eigen::Index block,
                                  float bound) {
  const BlockArray da = squared_distances(a, from, block);
  const BlockArray db = squared_distances(b, from, block);
  const BlockArray s = (da + db - bound * bound).max(0.0F);
  const BlockArray excess = s * s;
  const BlockArray slack = 4.0F * da * db;
  return mask_of(excess.data(), slack.data());
}

}  // namespace

BitGraph consistency_graph(std::span<const Eigen::Vector3f> points_a,
                           std::span<const Eigen::Vector3f> points_b, float noise_bound) {
  ADIT_CHECK(points_a.size() == points_b.size(), "a correspondence has a point in either cloud");
  const Rows a = rows_of(points_a);
  const Rows b = rows_of(points_b);
  BitGraph graph(points_a.size());
  parallel_for_each(
      points_a.size(),
      [&](std::size_t v) {
        const std::span<bits::Word> row = graph.row(v);
        for (std::size_t w = 0; w < row.size(); ++w) {
          row[w] = consistent_in_block(a, b, static_cast<Eigen::Index>(v),
                                       static_cast<Eigen::Index>(w) * kBlock, noise_bound);
        }
        bits::reset(row.data(), v);  // not with itself
      },
      64);
  return graph;
}

/// Peels off the vertex of least degree again and again, vertices held in buckets by degree (Batagelj and
/// Zaversnik).
std::vector<std::uint32_t> max_core(const BitGraph& graph) {
  const std::size_t n = graph.num_vertices();
  std::vector<std::size_t> degree(n);
  std::vector<std::vector<std::uint32_t>> buckets;
  for (std::uint32_t v = 0; v < n; ++v) {
    degree[v] = bits::count(graph.row(v));
    if (degree[v] >= buckets.size()) buckets.resize(degree[v] + 1);
    buckets[degree[v]].push_back(v);
  }
  std::vector<std::size_t> core(n, 0);
  std::vector<bool> peeled(n, false);
  std::size_t k = 0;
  for (std::size_t d = 0; d < buckets.size();) {
    if (buckets[d].empty()) {
      ++d;
      continue;
    }
    const std::uint32_t v = buckets[d].back();
    buckets[d].pop_back();
    if (peeled[v] || degree[v] != d) continue;  // an entry from before its degree fell
    peeled[v] = true;
    k = std::max(k, d);
    core[v] = k;
    bits::for_each(graph.row(v), [&](std::size_t w) {
      if (!peeled[w] && degree[w] > d) buckets[--degree[w]].push_back(static_cast<std::uint32_t>(w));
    });
  }
  std::vector<std::uint32_t> innermost;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (core[v] == k) innermost.push_back(v);
  }
  return innermost;
}

}  // namespace adit
