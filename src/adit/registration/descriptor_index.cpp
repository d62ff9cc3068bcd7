// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/descriptor_index.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

constexpr std::uint32_t kMaxSquaredDistance = std::numeric_limits<std::uint16_t>::max();

using DescriptorVector = Eigen::Matrix<float, kDescriptorSize, 1>;

DescriptorVector vector_of(const Descriptor& descriptor) {
  return Eigen::Map<const Eigen::Matrix<std::uint8_t, kDescriptorSize, 1>>(descriptor.data()).cast<float>();
}

/// The directions of largest variance of a sample, one per column; approximate ones cost time, not exactness.
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

/// A box's squared distance, rounded down, and below it the number of the box: the least key is the nearest
/// box.
constexpr unsigned kIndexBits = 15;
constexpr std::uint32_t kDone = ~std::uint32_t{0};
constexpr std::uint32_t index_in(std::uint32_t key) { return key & ((1U << kIndexBits) - 1U); }
constexpr std::size_t kBoxes = 16;
constexpr std::size_t kAxes = 4;

/// The keys of sixteen boxes; `low` and `high` hold sixteen values per direction.
ADIT_WIDE_VECTORS void box_keys(const float* low, const float* high, const float* at,
                                std::uint32_t first_index, std::uint32_t* keys) {
  constexpr float kFar = 131071.0F;  // all the other bits
  for (std::uint32_t b = 0; b < kBoxes; ++b) {
    float sum = 0.0F;
    for (std::size_t d = 0; d < kAxes; ++d) {
      const float below = low[d * kBoxes + b] - at[d];
      const float above = at[d] - high[d * kBoxes + b];
      float gap = below > above ? below : above;
      gap = gap > 0.0F ? gap : 0.0F;
      sum += gap * gap;
    }
    sum = sum < kFar ? sum : kFar;
    keys[b] = static_cast<std::uint32_t>(static_cast<std::int32_t>(sum)) << kIndexBits | (first_index + b);
  }
}

ADIT_WIDE_VECTORS std::uint32_t least(const std::uint32_t* keys, std::size_t n) {
  std::uint32_t out = kDone;
  for (std::size_t k = 0; k < n; ++k) out = keys[k] < out ? keys[k] : out;
  return out;
}

template <class Visitor>
void visit(const DescriptorBlock& block, const DescriptorQuery& query, Visitor& visitor) {
  std::array<std::uint16_t, DescriptorBlock::kLanes> distances;
  const auto bound = static_cast<std::uint16_t>(std::min(visitor.bound, kMaxSquaredDistance));
  for (std::uint32_t near = near_lanes(block, query, bound, distances); near != 0; near &= near - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(near));
    if (distances[lane] <= visitor.bound) visitor.found(block.indices[lane], distances[lane]);
  }
}

}  // namespace

std::uint32_t squared_distance(const Descriptor& a, const Descriptor& b) {
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < a.size(); ++d) {
    const int difference = static_cast<int>(a[d]) - static_cast<int>(b[d]);
    sum += static_cast<std::uint32_t>(difference * difference);
  }
  return sum;
}

DescriptorIndex::Shelf::Shelf() {
  for (std::size_t d = 0; d < kDirections; ++d) {
    std::ranges::fill(low[d], std::numeric_limits<float>::infinity());
    std::ranges::fill(high[d], -std::numeric_limits<float>::infinity());
  }
}

DescriptorIndex::DescriptorIndex(const std::vector<Descriptor>& descriptors) {
  if (descriptors.empty()) return;
  ADIT_CHECK(descriptors.size() <= std::size_t{1} << 23U, "groups are numbered by 15 bits");
  const Eigen::MatrixXf directions = principal_directions(descriptors, kDirections);
  for (int d = 0; d < kDescriptorSize; ++d) {
    for (std::size_t k = 0; k < kDirections; ++k)
      directions_[d][k] = directions(d, static_cast<Eigen::Index>(k));
  }
  std::vector<Item> items;
  items.reserve(descriptors.size());
  for (std::uint32_t i = 0; i < descriptors.size(); ++i) items.push_back({project(descriptors[i]), i});
  const auto parts = [](std::size_t n, std::size_t size) { return (n + size - 1) / size; };
  blocks_.resize(parts(items.size(), DescriptorBlock::kLanes));
  block_boxes_.resize(parts(blocks_.size(), kShelf));
  group_boxes_.resize(parts(block_boxes_.size(), kShelf));
  build(items, 0, static_cast<std::uint32_t>(blocks_.size()), descriptors);
}

void DescriptorIndex::enclose(std::vector<Shelf>& shelves, std::size_t box, Projection low, Projection high) {
  Shelf& shelf = shelves[box / kShelf];
  for (std::size_t d = 0; d < kDirections; ++d) {
    shelf.low[d][box % kShelf] = std::min(shelf.low[d][box % kShelf], low[d]);
    shelf.high[d][box % kShelf] = std::max(shelf.high[d][box % kShelf], high[d]);
  }
}

/// Splits in the direction of the widest extent, at a border of blocks and, while there are several, of
/// groups.
void DescriptorIndex::build(std::span<Item> items, std::uint32_t first_block, std::uint32_t last_block,
                            const std::vector<Descriptor>& descriptors) {
  Projection low = items.front().at;
  Projection high = items.front().at;
  for (const Item& item : items) {
    low = item.at < low ? item.at : low;
    high = item.at > high ? item.at : high;
  }
  if (last_block - first_block == 1) {
    enclose(block_boxes_, first_block, low, high);
    enclose(group_boxes_, first_block / kShelf, low, high);
    for (const Item& item : items) blocks_[first_block].append(descriptors[item.index], item.index);
    return;
  }
  const Projection extent = high - low;
  std::size_t widest = 0;
  for (std::size_t d = 1; d < kDirections; ++d) widest = extent[d] > extent[widest] ? d : widest;
  std::uint32_t half = (last_block - first_block) / 2;
  if (last_block - first_block > kShelf) half = std::max(half / kShelf, 1U) * kShelf;
  const std::size_t middle = half * DescriptorBlock::kLanes;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [widest](const Item& a, const Item& b) { return a.at[widest] < b.at[widest]; });
  build(items.first(middle), first_block, first_block + half, descriptors);
  build(items.subspan(middle), first_block + half, last_block, descriptors);
}

DescriptorIndex::Projection DescriptorIndex::project(const Descriptor& descriptor) const {
  Projection sum = {};
  for (std::size_t d = 0; d < descriptor.size(); ++d)
    sum += directions_[d] * static_cast<float>(descriptor[d]);
  return sum;
}

template <class Visitor>
void DescriptorIndex::search(const Descriptor& descriptor, Visitor& visitor) const {
  const DescriptorQuery query(descriptor);
  const Projection projection = project(descriptor);
  float at[kDirections];
  std::memcpy(at, &projection, sizeof(at));
  // Distances are whole numbers, and rounding in a box's distance errs by less than 1/4 + a 10,000th.
  const auto is_beyond = [&](std::uint32_t key) {
    return key >> kIndexBits > visitor.bound + (visitor.bound >> 11U);
  };
  std::vector<std::uint32_t> group_keys(group_boxes_.size() * kShelf);
  for (std::uint32_t s = 0; s < group_boxes_.size(); ++s) {
    const Shelf& shelf = group_boxes_[s];
    box_keys(shelf.low[0], shelf.high[0], at, s * kShelf, &group_keys[std::size_t{s} * kShelf]);
  }
  while (true) {
    const std::uint32_t group_key = least(group_keys.data(), group_keys.size());
    if (is_beyond(group_key)) return;
    const std::uint32_t group = index_in(group_key);
    group_keys[group] = kDone;
    std::uint32_t block_keys[kShelf];
    const Shelf& shelf = block_boxes_[group];
    box_keys(shelf.low[0], shelf.high[0], at, 0, block_keys);
    while (true) {
      const std::uint32_t block_key = least(block_keys, kShelf);
      if (is_beyond(block_key)) break;
      block_keys[index_in(block_key)] = kDone;
      const DescriptorBlock& block = blocks_[group * kShelf + index_in(block_key)];
      visit(block, query, visitor);
      if (visitor.is_done()) return;
    }
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
