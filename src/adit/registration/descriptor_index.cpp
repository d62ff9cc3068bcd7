// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/descriptor_index.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <limits>

namespace adit {
namespace {

constexpr std::uint32_t kMaxSquaredDistance = std::numeric_limits<std::uint16_t>::max();

using DescriptorVector = Eigen::Matrix<float, kDescriptorSize, 1>;

DescriptorVector vector_of(const Descriptor& descriptor) {
  return Eigen::Map<const Eigen::Matrix<std::uint8_t, kDescriptorSize, 1>>(descriptor.data()).cast<float>();
}

/// The directions of largest variance of a sample, one a column; approximate ones cost time, not exactness.
Eigen::MatrixXf principal_directions(const std::vector<Descriptor>& descriptors, int num_directions) {
  constexpr std::size_t kSample = 512;
  const std::size_t step = descriptors.size() / kSample + 1;
  Eigen::Matrix<float, kDescriptorSize, Eigen::Dynamic> sample(
      kDescriptorSize, static_cast<Eigen::Index>((descriptors.size() + step - 1) / step));
  for (Eigen::Index i = 0; i < sample.cols(); ++i) {
    sample.col(i) = vector_of(descriptors[static_cast<std::size_t>(i) * step]);
  }
  const DescriptorVector mean = sample.rowwise().mean();
  sample.colwise() -= mean;
  using Covariance = Eigen::Matrix<float, kDescriptorSize, kDescriptorSize>;
  const Eigen::SelfAdjointEigenSolver<Covariance> solver(sample * sample.transpose());
  return solver.eigenvectors().rightCols(num_directions);
}

struct NearestTwoVisitor {
  std::uint32_t bound;
  bool found_any = false;
  NearestTwo best{};

  [[nodiscard]] static bool is_done() { return false; }
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

  [[nodiscard]] bool is_done() const { return found_any; }
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
  const Eigen::MatrixXf directions = principal_directions(descriptors, kDirections);
  for (int d = 0; d < kDescriptorSize; ++d) {
    for (int k = 0; k < kDirections; ++k) directions_[d][k] = directions(d, k);
  }
  std::vector<Item> items;
  items.reserve(descriptors.size());
  for (std::uint32_t i = 0; i < descriptors.size(); ++i) items.push_back({project(descriptors[i]), i});
  leaves_.resize((items.size() + DescriptorBlock::kLanes - 1) / DescriptorBlock::kLanes);
  boxes_.reserve(2 * leaves_.size());
  build(items, 0, static_cast<std::uint32_t>(leaves_.size()), descriptors);
}

void DescriptorIndex::build(std::span<Item> items, std::uint32_t first_leaf, std::uint32_t last_leaf,
                            const std::vector<Descriptor>& descriptors) {
  Box box{items.front().at, items.front().at};
  for (const Item& item : items) {
    box.low = item.at < box.low ? item.at : box.low;
    box.high = item.at > box.high ? item.at : box.high;
  }
  boxes_.push_back(box);
  if (last_leaf - first_leaf == 1) {
    for (const Item& item : items) leaves_[first_leaf].append(descriptors[item.index], item.index);
    return;
  }
  const Projection extent = box.high - box.low;
  int axis = 0;
  for (int k = 1; k < kDirections; ++k) axis = extent[k] > extent[axis] ? k : axis;
  const std::uint32_t middle_leaf = first_leaf + (last_leaf - first_leaf) / 2;
  const std::size_t middle = (middle_leaf - first_leaf) * DescriptorBlock::kLanes;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [axis](const Item& a, const Item& b) { return a.at[axis] < b.at[axis]; });
  build(items.first(middle), first_leaf, middle_leaf, descriptors);
  build(items.subspan(middle), middle_leaf, last_leaf, descriptors);
}

DescriptorIndex::Projection DescriptorIndex::project(const Descriptor& descriptor) const {
  Projection sum = {};
  for (std::size_t d = 0; d < descriptor.size(); ++d)
    sum += directions_[d] * static_cast<float>(descriptor[d]);
  return sum;
}

template <class Visitor>
void DescriptorIndex::search(const Descriptor& descriptor, Visitor& visitor) const {
  if (leaves_.empty()) return;
  const DescriptorQuery query(descriptor);
  const Projection at = project(descriptor);
  // rounding errs by less than that, so nothing that is near enough is passed over
  const auto is_beyond = [&](float squared_gap) {
    return squared_gap > 1.0001F * static_cast<float>(visitor.bound) + 0.25F;
  };
  const auto squared_gap_to = [&](std::uint32_t node) {
    const Box& box = boxes_[node];
    const Projection below = box.low - at;
    const Projection above = at - box.high;
    Projection gap = below > above ? below : above;
    gap = gap > 0.0F ? gap : Projection{};
    gap *= gap;
    return gap[0] + gap[1] + gap[2] + gap[3];
  };
  struct Subtree {
    std::uint32_t node;
    std::uint32_t first;  // leaves [first, last)
    std::uint32_t last;
    float squared_gap;
  };
  std::array<Subtree, 32> waiting;
  std::size_t num_waiting = 0;
  Subtree now{0, 0, static_cast<std::uint32_t>(leaves_.size()), squared_gap_to(0)};
  std::array<std::uint16_t, DescriptorBlock::kLanes> distances;
  while (true) {
    while (now.last - now.first > 1 && !is_beyond(now.squared_gap)) {
      const std::uint32_t middle = now.first + (now.last - now.first) / 2;
      const std::uint32_t right = now.node + 2 * (middle - now.first);
      const Subtree children[2] = {{now.node + 1, now.first, middle, squared_gap_to(now.node + 1)},
                                   {right, middle, now.last, squared_gap_to(right)}};
      const bool left_is_nearer = children[0].squared_gap <= children[1].squared_gap;
      now = children[left_is_nearer ? 0 : 1];
      waiting[num_waiting++] = children[left_is_nearer ? 1 : 0];
    }
    if (!is_beyond(now.squared_gap)) {
      const DescriptorBlock& block = leaves_[now.first];
      const auto bound = static_cast<std::uint16_t>(std::min(visitor.bound, kMaxSquaredDistance));
      for (std::uint32_t near = near_lanes(block, query, bound, distances); near != 0; near &= near - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(near));
        if (distances[lane] <= visitor.bound) visitor.found(block.indices[lane], distances[lane]);
      }
    }
    if (num_waiting == 0 || visitor.is_done()) return;
    now = waiting[--num_waiting];
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
