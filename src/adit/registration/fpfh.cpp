// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/fpfh.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

constexpr int kBins = 11;
constexpr int kNoBin = kBins;     ///< The bin of a pair without features.
constexpr int kPart = kBins + 1;  ///< One of the three histograms, with a bin for such pairs.
/// The three, padded to whole vector registers.
constexpr std::size_t kHistogram = 40;

struct alignas(32) Histogram {
  float bins[kHistogram] = {};
};

/// A point that takes part, in half a cache line.
struct alignas(32) OrientedPoint {
  float position[3];
  float is_valid;
  float normal[3];
  float padding;
};

/// A list of points, coordinate by coordinate.
struct Columns {
  std::vector<float> position[3];
  std::vector<float> normal[3];
  std::vector<int> bins[3];

  void resize(std::size_t n) {
    for (int d = 0; d < 3; ++d) {
      position[d].resize(n);
      normal[d].resize(n);
      bins[d].resize(n);
    }
  }
};

/// The bin of a value in [-1, 1].
inline int bin_of_cosine(float value) {
  const float at = static_cast<float>(kBins) * 0.5F * (value + 1.0F);
  const float below = at < static_cast<float>(kBins - 1) ? at : static_cast<float>(kBins - 1);
  return static_cast<int>(below > 0.0F ? below : 0.0F);
}

/// The bin of atan2(y, x) among 11 equal ones over [-pi, pi], without an arc tangent: bin 5 is centred on 0,
/// and the angle of (x, |y|) exceeds a border b in (0, pi) exactly when sin(angle - b) > 0.
inline int bin_of_angle(float y, float x) {
  // cos and sin of (2 k + 1) pi / 11
  constexpr float kCos[5] = {0.959492974F, 0.654860734F, 0.142314838F, -0.415415013F, -0.841253533F};
  constexpr float kSin[5] = {0.281732557F, 0.755749574F, 0.989821442F, 0.909631995F, 0.540640817F};
  const float up = std::abs(y);
  int passed = 0;
  for (int k = 0; k < 5; ++k) passed += up * kCos[k] - x * kSin[k] > 0.0F ? 1 : 0;
  return y < 0.0F ? 5 - passed : 5 + passed;
}

/// The pair features of point i with each of n others, without a branch.
ADIT_WIDE_VECTORS void pair_bins(const OrientedPoint& i, const float* x, const float* y, const float* z,
                                 const float* nx, const float* ny, const float* nz, std::size_t n, int* theta,
                                 int* alpha, int* phi) {
  const float* p = i.position;
  const float* m = i.normal;
  for (std::size_t k = 0; k < n; ++k) {
    const float dx = x[k] - p[0];
    const float dy = y[k] - p[1];
    const float dz = z[k] - p[2];
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float cos_i = (m[0] * dx + m[1] * dy + m[2] * dz) / distance;
    const float cos_j = (nx[k] * dx + ny[k] * dy + nz[k] * dz) / distance;
    const bool i_is_source = std::abs(cos_i) >= std::abs(cos_j);
    // the line from source u to target t
    const float ux = i_is_source ? m[0] : nx[k];
    const float uy = i_is_source ? m[1] : ny[k];
    const float uz = i_is_source ? m[2] : nz[k];
    const float tx = i_is_source ? nx[k] : m[0];
    const float ty = i_is_source ? ny[k] : m[1];
    const float tz = i_is_source ? nz[k] : m[2];
    const float along = i_is_source ? 1.0F : -1.0F;
    const float line_x = along * dx;
    const float line_y = along * dy;
    const float line_z = along * dz;
    const float cos_u = i_is_source ? cos_i : -cos_j;
    // v = line x u, still of the pair's distance times its own length
    const float vx = line_y * uz - line_z * uy;
    const float vy = line_z * ux - line_x * uz;
    const float vz = line_x * uy - line_y * ux;
    const float v_norm = std::sqrt(vx * vx + vy * vy + vz * vz);
    const float v_dot_t = (vx * tx + vy * ty + vz * tz) / v_norm;
    // theta needs only the direction of (w . t, u . t), w = u x v with v of unit length
    const float wx = uy * vz - uz * vy;
    const float wy = uz * vx - ux * vz;
    const float wz = ux * vy - uy * vx;
    const float w_dot_t = (wx * tx + wy * ty + wz * tz) / v_norm;
    const float u_dot_t = ux * tx + uy * ty + uz * tz;
    const bool has_frame = v_norm > 0.0F;
    theta[k] = has_frame ? bin_of_angle(w_dot_t, u_dot_t) : kNoBin;
    alpha[k] = has_frame ? bin_of_cosine(v_dot_t) : kNoBin;
    phi[k] = has_frame ? bin_of_cosine(cos_u) : kNoBin;
  }
}

/// sum += the others' histograms, their sums += this one's, by weight.
ADIT_WIDE_VECTORS void add_weighted(const Histogram& own, Histogram& sum, const Histogram* others,
                                    Histogram* sums, const std::uint32_t* indices, const float* weights,
                                    std::size_t n) {
  Histogram total = sum;
  for (std::size_t k = 0; k < n; ++k) {
    const float weight = weights[k];
    const Histogram& other = others[indices[k]];
    Histogram& other_sum = sums[indices[k]];
    for (std::size_t b = 0; b < kHistogram; ++b) {
      total.bins[b] += weight * other.bins[b];
      other_sum.bins[b] += weight * own.bins[b];
    }
  }
  sum = total;
}

/// Simplified histograms: how often each bin was hit by the pairs of a point (Rusu 2009, step 1), in per
/// cent.
struct SimplifiedHistograms {
  std::vector<Histogram> bins;
  std::vector<std::uint32_t> num_pairs;
};

class PairCounter {
 public:
  PairCounter(const std::vector<Eigen::Vector3f>& points, const std::vector<SurfacePoint>& surface) {
    points_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3f& p = points[i];
      const Eigen::Vector3f& n = surface[i].normal;
      points_.push_back({{p.x(), p.y(), p.z()}, surface[i].valid ? 1.0F : 0.0F, {n.x(), n.y(), n.z()}, 0.0F});
    }
    counts_.resize(points.size());
  }

  void count(std::size_t i, std::span<const Neighbor> neighbors) {
    if (points_[i].is_valid == 0.0F) return;
    gather(neighbors);
    const auto& [x, y, z] = columns_.position;
    const auto& [nx, ny, nz] = columns_.normal;
    auto& [theta, alpha, phi] = columns_.bins;
    pair_bins(points_[i], x.data(), y.data(), z.data(), nx.data(), ny.data(), nz.data(), size_, theta.data(),
              alpha.data(), phi.data());
    Counts& own = counts_[i];
    for (std::size_t k = 0; k < size_; ++k) {
      Counts& other = counts_[indices_[k]];
      for (std::size_t part = 0; part < 3; ++part) {
        const std::size_t bin = std::size_t{kPart} * part + static_cast<std::size_t>(columns_.bins[part][k]);
        ++own[bin];
        ++other[bin];
      }
    }
  }

  [[nodiscard]] SimplifiedHistograms histograms() const {
    SimplifiedHistograms out{std::vector<Histogram>(counts_.size()), {}};
    out.num_pairs.reserve(counts_.size());
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      std::uint32_t num_pairs = 0;
      for (int b = 0; b < kBins; ++b) num_pairs += counts_[i][static_cast<std::size_t>(b)];
      out.num_pairs.push_back(num_pairs);
      if (num_pairs == 0) continue;
      const float share = 100.0F / static_cast<float>(num_pairs);
      for (std::size_t b = 0; b < counts_[i].size(); ++b)
        out.bins[i].bins[b] = b % kPart == kNoBin ? 0.0F : static_cast<float>(counts_[i][b]) * share;
    }
    return out;
  }

 private:
  using Counts = std::array<std::uint32_t, 3 * std::size_t{kPart}>;

  /// The neighbours that take part.
  void gather(std::span<const Neighbor> neighbors) {
    if (indices_.size() < neighbors.size()) {
      indices_.resize(neighbors.size());
      columns_.resize(neighbors.size());
    }
    size_ = 0;
    for (const Neighbor& neighbor : neighbors) {
      const OrientedPoint& point = points_[neighbor.index];
      indices_[size_] = neighbor.index;
      for (int d = 0; d < 3; ++d) {
        columns_.position[d][size_] = point.position[d];
        columns_.normal[d][size_] = point.normal[d];
      }
      size_ += point.is_valid != 0.0F ? 1 : 0;
    }
  }

  std::vector<OrientedPoint> points_;
  std::vector<Counts> counts_;
  std::vector<std::uint32_t> indices_;
  Columns columns_;
  std::size_t size_ = 0;
};

/// Weighted sums of the neighbours' histograms (step 2); the weight of a neighbour is the inverse of its
/// distance.
std::vector<Histogram> neighborhood_histograms(const SimplifiedHistograms& own, const NeighborPairs& pairs) {
  std::vector<Histogram> sums(own.bins.size());
  std::vector<std::uint32_t> indices;
  std::vector<float> weights;
  for (std::size_t i = 0; i < own.bins.size(); ++i) {
    if (own.num_pairs[i] == 0) continue;
    indices.clear();
    weights.clear();
    for (const Neighbor& neighbor : pairs.row(i)) {
      if (own.num_pairs[neighbor.index] == 0 || neighbor.squared_distance <= 0.0F) continue;
      indices.push_back(neighbor.index);
      weights.push_back(1.0F / std::sqrt(neighbor.squared_distance));
    }
    add_weighted(own.bins[i], sums[i], own.bins.data(), sums.data(), indices.data(), weights.data(),
                 indices.size());
  }
  return sums;
}

/// Each of the three histograms scaled to sum 100 and rounded.
Descriptor quantized(const Histogram& histogram) {
  Descriptor out{};
  for (std::size_t part = 0; part < 3; ++part) {
    const float* bins = histogram.bins + part * kPart;
    float sum = 0.0F;
    for (int b = 0; b < kBins; ++b) sum += bins[b];
    if (!(sum > 0.0F)) continue;
    // Never negative. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    const auto rounded = [&](float bin) { return static_cast<std::uint8_t>(bin * (100.0F / sum) + 0.5F); };
    for (std::size_t b = 0; b < kBins; ++b) out[part * kBins + b] = rounded(bins[b]);
  }
  return out;
}

}  // namespace

std::optional<std::array<int, 3>> pair_feature_bins(const Eigen::Vector3f& point_i,
                                                    const Eigen::Vector3f& normal_i,
                                                    const Eigen::Vector3f& point_j,
                                                    const Eigen::Vector3f& normal_j) {
  const OrientedPoint i{
      {point_i.x(), point_i.y(), point_i.z()}, 1.0F, {normal_i.x(), normal_i.y(), normal_i.z()}, 0.0F};
  std::array<int, 3> bins{};
  pair_bins(i, &point_j.x(), &point_j.y(), &point_j.z(), &normal_j.x(), &normal_j.y(), &normal_j.z(), 1,
            &bins[0], &bins[1], &bins[2]);
  return bins[0] == kNoBin ? std::nullopt : std::optional(bins);
}

FpfhResult compute_fpfh(const std::vector<Eigen::Vector3f>& points, const std::vector<SurfacePoint>& surface,
                        const NeighborPairs& pairs) {
  ADIT_CHECK(points.size() == surface.size(), "one surface per point");
  ADIT_CHECK(points.size() == pairs.num_points(), "the pairs belong to these points");
  constexpr std::uint32_t kMinPairs = 3;
  PairCounter counter(points, surface);
  for (std::size_t i = 0; i < points.size(); ++i) counter.count(i, pairs.row(i));
  const SimplifiedHistograms own = counter.histograms();
  std::vector<Histogram> sums = neighborhood_histograms(own, pairs);
  FpfhResult out;
  out.descriptors.reserve(points.size());
  out.usable.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float share = 1.0F / static_cast<float>(std::max(own.num_pairs[i], 1U));
    for (std::size_t b = 0; b < kHistogram; ++b)
      sums[i].bins[b] = own.bins[i].bins[b] + share * sums[i].bins[b];
    out.descriptors.push_back(quantized(sums[i]));
    out.usable.push_back(own.num_pairs[i] >= kMinPairs);
  }
  return out;
}

}  // namespace adit
