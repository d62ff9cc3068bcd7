// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

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

/// Exact nearest neighbours among descriptors. They are sorted along the direction in which they vary most
/// (two thirds of the variance of real scans) and compared in blocks, outward from the query's place, until
/// the distance along that direction alone exceeds the bound. In 33 dimensions this beats a tree: no
/// branching, and a block is a few vector instructions. Among equally near ones the smaller index wins.
/// Immutable; searches are thread-safe.
class DescriptorIndex {
 public:
  /// Throws ContractViolation when a descriptor has a squared norm above 32767 (three histograms of sum 100
  /// have at most 30000): squared distances then fit 16 bits.
  explicit DescriptorIndex(const std::vector<Descriptor>& descriptors);

  /// The nearest two with a squared distance of at most `bound`; none when there is none so near.
  [[nodiscard]] std::optional<NearestTwo> nearest_two(const Descriptor& query, std::uint32_t bound) const;
  /// Whether any descriptor but number `except` is nearer than `distance` (squared), or as near with a
  /// smaller index.
  [[nodiscard]] bool any_nearer(const Descriptor& query, std::uint32_t distance, std::uint32_t except) const;

 private:
  static constexpr std::size_t kLanes = 16;
  /// One vector register (a type of GCC and Clang on every processor); arrays would be summed in memory.
  using Lanes [[gnu::vector_size(16)]] = std::uint16_t;
  struct Block {
    Lanes bins[kDescriptorSize][2];
    std::uint32_t indices[kLanes];
    std::uint32_t count;
    float first;  ///< Smallest and largest projection in the block.
    float last;
  };
  [[nodiscard]] float project(const Descriptor& descriptor) const;
  template <class Visitor>
  void visit_block(const Block& block, const Descriptor& query, Visitor& visitor) const;
  template <class Visitor>
  void search(const Descriptor& query, Visitor& visitor) const;

  std::array<float, kDescriptorSize> direction_{};
  std::vector<Block> blocks_;
};

}  // namespace adit
