// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/descriptor_block.hpp"

#include <algorithm>

#if defined(__SSSE3__)
#include <immintrin.h>
#endif

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Distances = std::array<std::uint16_t, DescriptorBlock::kLanes>;

std::uint16_t squared_norm_of(const Descriptor& descriptor) {
  std::uint32_t sum = 0;
  for (const std::uint8_t bin : descriptor) sum += std::uint32_t{bin} * bin;
  ADIT_CHECK(sum <= 32767, "descriptor too long");
  return static_cast<std::uint16_t>(sum);
}

std::uint32_t lanes_in_use(const DescriptorBlock& block) { return (1U << block.count) - 1U; }

// |q - d|^2 = |q|^2 + |d|^2 - 2 q.d, all modulo 2^16, which the result fits.
#if defined(__SSSE3__)

/// Eight lanes, from lane 8 `half` on. Neither a pair's products nor their sum over all bins exceed |q| |d|,
/// so nothing saturates.
std::uint32_t near_half(const DescriptorBlock& block, const DescriptorQuery& query, std::uint16_t bound,
                        int half, std::uint16_t* squared_distances) {
  __m128i dots = _mm_setzero_si128();
  for (std::size_t p = 0; p < kBinPairs; ++p) {
    const auto* bins = reinterpret_cast<const __m128i*>(block.pairs[p]) + half;
    const __m128i pair = _mm_set1_epi16(static_cast<short>(query.pairs[p]));
    dots = _mm_add_epi16(dots, _mm_maddubs_epi16(_mm_load_si128(bins), pair));
  }
  const __m128i norms = _mm_load_si128(reinterpret_cast<const __m128i*>(block.squared_norms) + half);
  const __m128i both = _mm_add_epi16(norms, _mm_set1_epi16(static_cast<short>(query.squared_norm)));
  const __m128i distances = _mm_sub_epi16(both, _mm_add_epi16(dots, dots));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(squared_distances) + half, distances);
  const __m128i excess = _mm_subs_epu16(distances, _mm_set1_epi16(static_cast<short>(bound)));
  const __m128i near = _mm_cmpeq_epi16(excess, _mm_setzero_si128());
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(near, _mm_setzero_si128())));
}

std::uint32_t near_lanes_128(const DescriptorBlock& block, const DescriptorQuery& query, std::uint16_t bound,
                             Distances& squared_distances) {
  const std::uint32_t low = near_half(block, query, bound, 0, squared_distances.data());
  const std::uint32_t high = near_half(block, query, bound, 1, squared_distances.data());
  return (low | high << 8U) & lanes_in_use(block);
}

__attribute__((target("avx2"))) std::uint32_t near_lanes_256(const DescriptorBlock& block,
                                                             const DescriptorQuery& query,
                                                             std::uint16_t bound,
                                                             Distances& squared_distances) {
  __m256i dots = _mm256_setzero_si256();
  for (std::size_t p = 0; p < kBinPairs; ++p) {
    const __m256i bins = _mm256_load_si256(reinterpret_cast<const __m256i*>(block.pairs[p]));
    const __m256i pair = _mm256_set1_epi16(static_cast<short>(query.pairs[p]));
    dots = _mm256_add_epi16(dots, _mm256_maddubs_epi16(bins, pair));
  }
  const __m256i norms = _mm256_load_si256(reinterpret_cast<const __m256i*>(block.squared_norms));
  const __m256i both = _mm256_add_epi16(norms, _mm256_set1_epi16(static_cast<short>(query.squared_norm)));
  const __m256i distances = _mm256_sub_epi16(both, _mm256_add_epi16(dots, dots));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(squared_distances.data()), distances);
  const __m256i excess = _mm256_subs_epu16(distances, _mm256_set1_epi16(static_cast<short>(bound)));
  const __m256i near = _mm256_cmpeq_epi16(excess, _mm256_setzero_si256());
  const __m128i bytes = _mm_packs_epi16(_mm256_castsi256_si128(near), _mm256_extracti128_si256(near, 1));
  return static_cast<std::uint32_t>(_mm_movemask_epi8(bytes)) & lanes_in_use(block);
}

#endif

}  // namespace

DescriptorQuery::DescriptorQuery(const Descriptor& descriptor) : squared_norm(squared_norm_of(descriptor)) {
  ADIT_CHECK(std::ranges::max(descriptor) <= 127, "a histogram of sum 100 has no such bin");
  for (std::size_t p = 0; p < kBinPairs; ++p) {
    const std::uint16_t high = 2 * p + 1 < descriptor.size() ? descriptor[2 * p + 1] : std::uint8_t{0};
    pairs[p] = static_cast<std::uint16_t>(descriptor[2 * p] | high << 8U);
  }
}

void DescriptorBlock::append(const Descriptor& descriptor, std::uint32_t index) {
  ADIT_CHECK(count < kLanes, "the block is full");
  for (std::size_t d = 0; d < descriptor.size(); ++d) pairs[d / 2][count][d % 2] = descriptor[d];
  squared_norms[count] = squared_norm_of(descriptor);
  indices[count++] = index;
}

std::uint32_t near_lanes_by_definition(const DescriptorBlock& block, const DescriptorQuery& query,
                                       std::uint16_t bound, Distances& squared_distances) {
  std::uint32_t near = 0;
  for (std::size_t lane = 0; lane < DescriptorBlock::kLanes; ++lane) {
    std::uint32_t dot = 0;
    for (std::size_t p = 0; p < kBinPairs; ++p) {
      const std::uint8_t* bins = block.pairs[p][lane];
      dot += bins[0] * (query.pairs[p] & 0xffU) + bins[1] * (std::uint32_t{query.pairs[p]} >> 8U);
    }
    const std::uint32_t distance = query.squared_norm + block.squared_norms[lane] - 2U * dot;
    squared_distances[lane] = static_cast<std::uint16_t>(distance);
    near |= static_cast<std::uint32_t>(squared_distances[lane] <= bound) << lane;
  }
  return near & lanes_in_use(block);
}

std::uint32_t near_lanes(const DescriptorBlock& block, const DescriptorQuery& query, std::uint16_t bound,
                         Distances& squared_distances) {
#if defined(__SSSE3__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  return has_avx2 ? near_lanes_256(block, query, bound, squared_distances)
                  : near_lanes_128(block, query, bound, squared_distances);
#else
  return near_lanes_by_definition(block, query, bound, squared_distances);
#endif
}

}  // namespace adit
