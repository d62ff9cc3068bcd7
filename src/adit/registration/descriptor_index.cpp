// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/descriptor_index.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr std::uint32_t kMaxSquaredDistance = std::numeric_limits<std::uint16_t>::max();

using DescriptorVector = Eigen::Matrix<float, kDescriptorSize, 1>;

DescriptorVector vector_of(const Descriptor& descriptor) {
  return Eigen::Map<const Eigen::Matrix<std::uint8_t, kDescriptorSize, 1>>(descriptor.data()).cast<float>();
}

/// The direction of largest variance, by power iteration on a sample; an approximate one costs time, not
/// exactness.
DescriptorVector principal_direction(const std::vector<Descriptor>& descriptors) {
  constexpr std::size_t kSample = 512;
  constexpr int kIterations = 20;
  const std::size_t step = descriptors.size() / kSample + 1;
  Eigen::Matrix<float, kDescriptorSize, Eigen::Dynamic> sample(
      kDescriptorSize, static_cast<Eigen::Index>((descriptors.size() + step - 1) / step));
  for (Eigen::Index i = 0; i < sample.cols(); ++i) {
    sample.col(i) = vector_of(descriptors[static_cast<std::size_t>(i) * step]);
  }
  const DescriptorVector mean = sample.rowwise().mean();
  sample.colwise() -= mean;
  const Eigen::Matrix<float, kDescriptorSize, kDescriptorSize> covariance = sample * sample.transpose();
  DescriptorVector direction = DescriptorVector::Ones().normalized() + DescriptorVector::Unit(5) * 0.5F;
  for (int i = 0; i < kIterations; ++i) {
    const DescriptorVector next = covariance * direction;
    const float norm = next.norm();
    if (!(norm > 0.0F)) break;
    direction = next / norm;
  }
  return direction.normalized();
}

struct NearestTwoVisitor {
  std::uint32_t bound;
  bool found_any = false;
  NearestTwo best{};

  void found(std::uint32_t index, std::uint32_t distance) {
    const bool better = !found_any || distance < best.squared_distance ||
                        (distance == best.squared_distance && index < best.index);
    if (better) {
      if (found_any) bound = best.squared_distance;
      best = {index, distance, bound};
      found_any = true;
    } else {
      bound = std::min(bound, distance);
    }
    best.second_squared_distance = bound;
  }
};

struct NearerVisitor {
  std::uint32_t bound;
  std::uint32_t except;
  bool found_any = false;

  void found(std::uint32_t index, std::uint32_t distance) {
    if (index != except && (distance < bound || index < except)) found_any = true;
  }
};

}  // namespace

std::uint32_t squared_distance(const Descriptor& a, const Descriptor& b) {
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < a.size(); ++d) {
    const int difference = static_cast<int>(a[d]) - static_cast<int>(b[d]);
    sum += static_cast<std::uint32_t>(difference * difference);
  }
  return sum;
}

DescriptorIndex::DescriptorIndex(const std::vector<Descriptor>& descriptors) {
  if (descriptors.empty()) return;
  // shorter than 1 by more than rounding can lengthen it: a projection never exceeds the distance itself
  DescriptorVector::Map(direction_.data()) = principal_direction(descriptors) * 0.9999F;
  std::vector<std::pair<float, std::uint32_t>> order;
  order.reserve(descriptors.size());
  for (std::uint32_t i = 0; i < descriptors.size(); ++i) {
    ADIT_CHECK(squared_distance(descriptors[i], Descriptor{}) <= kMaxSquaredDistance / 2,
               "descriptor too long");
    order.emplace_back(project(descriptors[i]), i);
  }
  std::sort(order.begin(), order.end());
  blocks_.resize((order.size() + kLanes - 1) / kLanes);
  for (std::size_t k = 0; k < order.size(); ++k) {
    Block& block = blocks_[k / kLanes];
    const std::size_t lane = k % kLanes;
    if (lane == 0) block.first = order[k].first;
    block.last = order[k].first;
    block.indices[lane] = order[k].second;
    block.count = static_cast<std::uint32_t>(lane + 1);
    for (std::size_t d = 0; d < kDescriptorSize; ++d)
      block.bins[d][lane / 8][lane % 8] = descriptors[order[k].second][d];
  }
}

float DescriptorIndex::project(const Descriptor& descriptor) const {
  float sum = 0.0F;
  for (std::size_t d = 0; d < descriptor.size(); ++d)
    sum += direction_[d] * static_cast<float>(descriptor[d]);
  return sum;
}

template <class Visitor>
void DescriptorIndex::visit_block(const Block& block, const Descriptor& query, Visitor& visitor) const {
  Lanes low_sums = {};
  Lanes high_sums = {};
  for (std::size_t d = 0; d < kDescriptorSize; ++d) {
    const std::uint16_t bin = query[d];
    const Lanes low = block.bins[d][0] - bin;
    const Lanes high = block.bins[d][1] - bin;
    low_sums += low * low;
    high_sums += high * high;
  }
  const auto bound = static_cast<std::uint16_t>(std::min(visitor.bound, kMaxSquaredDistance));
  using Halves [[gnu::vector_size(16)]] = std::uint64_t;
  const auto near_enough = reinterpret_cast<Halves>((low_sums <= bound) | (high_sums <= bound));
  if ((near_enough[0] | near_enough[1]) == 0) return;
  const Lanes sums[2] = {low_sums, high_sums};
  std::uint16_t distances[kLanes];
  std::memcpy(distances, sums, sizeof(sums));
  for (std::size_t lane = 0; lane < block.count; ++lane) {
    if (distances[lane] <= visitor.bound) visitor.found(block.indices[lane], distances[lane]);
  }
}

template <class Visitor>
void DescriptorIndex::search(const Descriptor& query, Visitor& visitor) const {
  const float at = project(query);
  const auto beyond = [](float gap, std::uint32_t bound) {
    return gap > 0.0F && gap * gap > static_cast<float>(bound);
  };
  auto right = std::lower_bound(blocks_.begin(), blocks_.end(), at,
                                [](const Block& block, float value) { return block.last < value; });
  auto left = right;
  while (true) {
    const bool go_right = right != blocks_.end() && !beyond(right->first - at, visitor.bound);
    if (go_right) visit_block(*right++, query, visitor);
    const bool go_left = left != blocks_.begin() && !beyond(at - (left - 1)->last, visitor.bound);
    if (go_left) visit_block(*--left, query, visitor);
    if (!go_right && !go_left) return;
  }
}

std::optional<NearestTwo> DescriptorIndex::nearest_two(const Descriptor& query, std::uint32_t bound) const {
  NearestTwoVisitor visitor{.bound = std::min(bound, kMaxSquaredDistance)};
  search(query, visitor);
  if (!visitor.found_any) return std::nullopt;
  return visitor.best;
}

bool DescriptorIndex::any_nearer(const Descriptor& query, std::uint32_t distance,
                                 std::uint32_t except) const {
  NearerVisitor visitor{.bound = distance, .except = except};
  search(query, visitor);
  return visitor.found_any;
}

}  // namespace adit
