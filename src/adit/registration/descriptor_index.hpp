// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/simd.hpp"
#include "adit/registration/descriptor_block.hpp"
#include "adit/registration/features.hpp"

namespace adit {

/// The squared distance of two descriptors.
[[nodiscard]] std::uint32_t squared_distance(const Descriptor& a, const Descriptor& b);

/// The nearest descriptor and how far the second nearest is.
struct NearestTwo {
  std::uint32_t index = 0;                    ///< Of the nearest one in the list that was indexed.
  std::uint32_t squared_distance = 0;         ///< To the nearest one.
  std::uint32_t second_squared_distance = 0;  ///< The search's bound where no second one is nearer.
  bool operator==(const NearestTwo&) const = default;
};

/// Exact nearest neighbours among descriptors. Sixteen descriptors make a block and are compared at once;
/// sixteen blocks make a group. Each has its box in the four directions in which descriptors vary most (nine
/// tenths of the variance of real scans). Distances to boxes are found without a branch, and boxes are
/// visited in ascending order of distance. Among equally near descriptors the smaller index wins. Immutable;
/// searches are thread-safe.
class DescriptorIndex {
 public:
  /// Throws ContractViolation when a descriptor has a squared norm above 32767 (three histograms of sum 100
  /// have at most 30000): squared distances then fit 16 bits.
  explicit DescriptorIndex(const std::vector<Descriptor>& descriptors);

  /// The nearest two with a squared distance of at most `bound`; none when no descriptor is that near. Throws
  /// ContractViolation when a bin of `query` is above 127.
  [[nodiscard]] std::optional<NearestTwo> nearest_two(const Descriptor& query, std::uint32_t bound) const;
  /// Whether any descriptor but number `except` is nearer than `distance` (squared), or as near with a
  /// smaller index.
  [[nodiscard]] bool any_nearer(const Descriptor& query, std::uint32_t distance, std::uint32_t except) const;

 private:
  static constexpr std::size_t kDirections = 4;
  static constexpr std::uint32_t kShelf = 16;
  using Projection = simd::Float4;
  static_assert(sizeof(Projection) == kDirections * sizeof(float));
  struct Item {
    Projection at;
    std::uint32_t index;
  };
  /// Sixteen boxes side by side, for vector registers.
  struct Shelf {
    Shelf();  ///< Of empty boxes, infinitely far from everything.

    float low[kDirections][kShelf];
    float high[kDirections][kShelf];
  };
  static void enclose(std::vector<Shelf>& shelves, std::size_t box, Projection low, Projection high);
  [[nodiscard]] Projection project(const Descriptor& descriptor) const;
  void build(std::span<Item> items, std::uint32_t first_block, std::uint32_t last_block,
             const std::vector<Descriptor>& descriptors);
  template <class Visitor>
  void search(const Descriptor& query, Visitor& visitor) const;

  Projection directions_[kDescriptorSize] = {};
  std::vector<Shelf> group_boxes_;
  std::vector<Shelf> block_boxes_;  ///< One per group.
  std::vector<DescriptorBlock> blocks_;
};

}  // namespace adit
