// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "adit/registration/features.hpp"

namespace adit {

/// Pairs of bins, the last one padded with zero: one instruction multiplies and adds a pair at once.
inline constexpr std::size_t kBinPairs = (kDescriptorSize + 1) / 2;

/// A descriptor to be compared with many blocks. Bins are at most 127, because one operand of that
/// instruction is signed.
struct DescriptorQuery {
  /// Throws ContractViolation on a bin above 127 and on a squared norm above 32767.
  explicit DescriptorQuery(const Descriptor& descriptor);

  std::array<std::uint16_t, kBinPairs> pairs;  ///< Low byte first.
  std::uint16_t squared_norm;                  ///< Of the bins, at most 32767.
};

/// Sixteen descriptors side by side, bin by bin.
struct alignas(32) DescriptorBlock {
  static constexpr std::size_t kLanes = 16;  ///< Descriptors in a block.

  std::uint8_t pairs[kBinPairs][kLanes][2] = {};  ///< Bins 2 p and 2 p + 1 of lane l in pairs[p][l].
  std::uint16_t squared_norms[kLanes] = {};       ///< Of the bins of each lane.
  std::uint32_t indices[kLanes] = {};             ///< Of the descriptors, as the caller counts them.
  std::uint32_t count = 0;                        ///< Lanes in use, the first ones.

  /// Squared norm at most 32767, as in DescriptorIndex. Throws ContractViolation where all lanes are in use.
  void append(const Descriptor& descriptor, std::uint32_t index);
};

/// Fills in the squared distances of the query to all lanes, and sets bit l of the result where lane l is in
/// use and no farther than `bound`.
[[nodiscard]] std::uint32_t near_lanes(const DescriptorBlock& block, const DescriptorQuery& query,
                                       std::uint16_t bound,
                                       std::array<std::uint16_t, DescriptorBlock::kLanes>& squared_distances);

/// The same in plain code: for processors without that instruction, and the oracle in tests.
[[nodiscard]] std::uint32_t near_lanes_by_definition(
    const DescriptorBlock& block, const DescriptorQuery& query, std::uint16_t bound,
    std::array<std::uint16_t, DescriptorBlock::kLanes>& squared_distances);

}  // namespace adit
