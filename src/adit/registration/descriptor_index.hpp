// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/registration/descriptor_block.hpp"
#include "adit/registration/features.hpp"

namespace adit {

/// The squared distance of two descriptors.
[[nodiscard]] std::uint32_t squared_distance(const Descriptor& a, const Descriptor& b);

/// The nearest descriptor and how far the second nearest is.
struct NearestTwo {
  std::uint32_t index = 0;
  std::uint32_t squared_distance = 0;
  std::uint32_t second_squared_distance = 0;  ///< The search's bound where no second one is nearer.
  bool operator==(const NearestTwo&) const = default;
};

/// Exact nearest neighbours among descriptors: a tree of boxes in the four directions in which they vary most
/// (nine tenths of the variance of real scans), with sixteen descriptors a leaf that are compared at once.
/// Among equally near ones the smaller index wins. Immutable; searches are thread-safe.
class DescriptorIndex {
 public:
  /// Throws ContractViolation when a descriptor has a squared norm above 32767 (three histograms of sum 100
  /// have at most 30000): squared distances then fit 16 bits.
  explicit DescriptorIndex(const std::vector<Descriptor>& descriptors);

  /// The nearest two with a squared distance of at most `bound`; none when there is none so near. Throws
  /// ContractViolation when a bin of `query` is above 127.
  [[nodiscard]] std::optional<NearestTwo> nearest_two(const Descriptor& query, std::uint32_t bound) const;
  /// Whether any descriptor but number `except` is nearer than `distance` (squared), or as near with a
  /// smaller index.
  [[nodiscard]] bool any_nearer(const Descriptor& query, std::uint32_t distance, std::uint32_t except) const;

 private:
  static constexpr int kDirections = 4;
  /// One vector register (a type of GCC and Clang on every processor).
  using Projection [[gnu::vector_size(4 * kDirections)]] = float;
  struct Item {
    Projection at;
    std::uint32_t index;
  };
  /// In preorder: the left child of a node follows it, the right child follows the left one's subtree, which
  /// has one node less than twice its leaves.
  struct Box {
    Projection low;
    Projection high;
  };
  [[nodiscard]] Projection project(const Descriptor& descriptor) const;
  void build(std::span<Item> items, std::uint32_t first_leaf, std::uint32_t last_leaf,
             const std::vector<Descriptor>& descriptors);
  template <class Visitor>
  void search(const Descriptor& query, Visitor& visitor) const;

  Projection directions_[kDescriptorSize] = {};
  std::vector<Box> boxes_;
  std::vector<DescriptorBlock> leaves_;
};

}  // namespace adit
