// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/fpfh.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr int kBins = 11;
/// Padded to whole vector registers.
using Histogram = Eigen::Array<float, 36, 1>;

/// The bin of a value in [-1, 1].
int bin_of_cosine(float value) {
  return std::clamp(static_cast<int>(static_cast<float>(kBins) * 0.5F * (value + 1.0F)), 0, kBins - 1);
}

/// The bin of atan2(y, x) among 11 equal ones over [-pi, pi], without an arc tangent: bin 5 is centred on 0,
/// and the angle of (x, |y|) exceeds a border b in (0, pi) exactly when sin(angle - b) > 0.
int bin_of_angle(float y, float x) {
  // cos and sin of (2 k + 1) pi / 11
  constexpr float kCos[5] = {0.959492974F, 0.654860734F, 0.142314838F, -0.415415013F, -0.841253533F};
  constexpr float kSin[5] = {0.281732557F, 0.755749574F, 0.989821442F, 0.909631995F, 0.540640817F};
  const float up = std::abs(y);
  int passed = 0;
  for (int k = 0; k < 5; ++k) passed += static_cast<int>(up * kCos[k] - x * kSin[k] > 0.0F);
  return y < 0.0F ? 5 - passed : 5 + passed;
}

bool is_usable(const SurfacePoint& s) { return s.valid; }

/// Simplified histograms: how often each bin was hit by the pairs of a point (Rusu 2009, step 1), in per
/// cent.
struct SimplifiedHistograms {
  std::vector<Histogram> bins;
  std::vector<int> num_pairs;
};

void count_pair(Histogram& histogram, const std::array<int, 3>& hit) {
  histogram[hit[0]] += 1.0F;
  histogram[kBins + hit[1]] += 1.0F;
  histogram[2 * kBins + hit[2]] += 1.0F;
}

SimplifiedHistograms simplified_histograms(const std::vector<Eigen::Vector3f>& points,
                                           const std::vector<SurfacePoint>& surface,
                                           const NeighborPairs& pairs) {
  SimplifiedHistograms out{std::vector<Histogram>(points.size(), Histogram::Zero()),
                           std::vector<int>(points.size(), 0)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_usable(surface[i])) continue;
    for (const Neighbor& neighbor : pairs.row(i)) {
      const std::size_t j = neighbor.index;
      if (!is_usable(surface[j])) continue;
      const auto hit = pair_feature_bins(points[i], surface[i].normal, points[j], surface[j].normal);
      if (!hit) continue;
      count_pair(out.bins[i], *hit);
      count_pair(out.bins[j], *hit);
      ++out.num_pairs[i];
      ++out.num_pairs[j];
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (out.num_pairs[i] > 0) out.bins[i] *= 100.0F / static_cast<float>(out.num_pairs[i]);
  }
  return out;
}

/// Weighted sums of the neighbours' histograms (step 2); the weight of a neighbour is the inverse of its
/// distance.
std::vector<Histogram> neighborhood_histograms(const SimplifiedHistograms& own, const NeighborPairs& pairs) {
  std::vector<Histogram> sums(own.bins.size(), Histogram::Zero());
  for (std::size_t i = 0; i < own.bins.size(); ++i) {
    if (own.num_pairs[i] == 0) continue;
    Histogram sum = sums[i];
    for (const Neighbor& neighbor : pairs.row(i)) {
      const std::size_t j = neighbor.index;
      if (own.num_pairs[j] == 0 || neighbor.squared_distance <= 0.0F) continue;
      const float weight = 1.0F / std::sqrt(neighbor.squared_distance);
      sum += weight * own.bins[j];
      sums[j] += weight * own.bins[i];
    }
    sums[i] = sum;
  }
  return sums;
}

/// Each of the three histograms scaled to sum 100 and rounded.
Descriptor quantized(const Histogram& histogram) {
  Descriptor out{};
  for (int part = 0; part < 3; ++part) {
    const auto bins = histogram.segment<kBins>(part * kBins);
    const float sum = bins.sum();
    if (!(sum > 0.0F)) continue;
    for (int b = 0; b < kBins; ++b) {
      out[static_cast<std::size_t>(part * kBins + b)] =
          static_cast<std::uint8_t>(bins[b] * (100.0F / sum) + 0.5F);
    }
  }
  return out;
}

}  // namespace

std::optional<std::array<int, 3>> pair_feature_bins(const Eigen::Vector3f& point_i,
                                                    const Eigen::Vector3f& normal_i,
                                                    const Eigen::Vector3f& point_j,
                                                    const Eigen::Vector3f& normal_j) {
  const Eigen::Vector3f offset = point_j - point_i;
  const float distance = offset.norm();
  if (!(distance > 0.0F)) return std::nullopt;
  const Eigen::Vector3f line = offset / distance;
  const float cos_i = normal_i.dot(line);
  const float cos_j = normal_j.dot(line);
  const bool i_is_source = std::abs(cos_i) >= std::abs(cos_j);
  const Eigen::Vector3f& u = i_is_source ? normal_i : normal_j;
  const Eigen::Vector3f& target_normal = i_is_source ? normal_j : normal_i;
  const float phi = i_is_source ? cos_i : -cos_j;
  const Eigen::Vector3f v = i_is_source ? line.cross(u) : u.cross(line);
  const float v_norm = v.norm();
  if (!(v_norm > 0.0F)) return std::nullopt;
  // theta needs only the direction of (w . n, u . n), w = u x v with v of unit length
  const float alpha = v.dot(target_normal) / v_norm;
  const float w_dot_n = u.cross(v).dot(target_normal) / v_norm;
  return std::array<int, 3>{bin_of_angle(w_dot_n, u.dot(target_normal)), bin_of_cosine(alpha),
                            bin_of_cosine(phi)};
}

FpfhResult compute_fpfh(const std::vector<Eigen::Vector3f>& points, const std::vector<SurfacePoint>& surface,
                        const NeighborPairs& pairs) {
  ADIT_CHECK(points.size() == surface.size(), "one surface a point");
  ADIT_CHECK(points.size() == pairs.num_points(), "the pairs belong to these points");
  constexpr int kMinPairs = 3;
  const SimplifiedHistograms own = simplified_histograms(points, surface, pairs);
  const std::vector<Histogram> sums = neighborhood_histograms(own, pairs);
  FpfhResult out;
  out.descriptors.reserve(points.size());
  out.usable.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float share = 1.0F / static_cast<float>(std::max(own.num_pairs[i], 1));
    out.descriptors.push_back(quantized(own.bins[i] + share * sums[i]));
    out.usable.push_back(own.num_pairs[i] >= kMinPairs);
  }
  return out;
}

}  // namespace adit
