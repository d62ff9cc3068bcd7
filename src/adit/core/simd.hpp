// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Vector registers: the types and helpers of all kernels that are written lane by lane, and the switch that
/// compiles plain loops for wider registers. Types are those of GCC and Clang, on every processor.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

/// ADIT_WIDE_VECTORS before a function definition: the compiler makes two versions of it, one for AVX2, and
/// the program takes the widest that the machine has. Meant for plain loops over arrays without aliasing, and
/// for searches whose helpers are all `always_inline`, as others stay narrow; only where each output is
/// computed on its own (no reordered sums) are the bytes the same on all machines.
/// Sanitizers do not survive the resolver functions that run before them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ADIT_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define ADIT_WIDE_VECTORS
#endif

namespace adit::simd {

/// Four floats or four integers: one register of 16 bytes, aligned to it.
///@{
using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = std::int32_t;
///@}

/// `N` values of type T anywhere in memory, so that an array of T can be read and written through it.
/// Not `using`: GCC 12 then drops the size.
template <class T, std::size_t N>
struct Unaligned {
  /// The vector, aligned as a single T is.
  typedef T Type  // NOLINT(modernize-use-using)
      __attribute__((vector_size(N * sizeof(T)), aligned(alignof(T)), may_alias));
};
/// Four doubles anywhere in memory. Sums of four lanes have the same order of additions, and so the same
/// bytes, on every machine, whether it has registers of 32 bytes or not.
using Double4 = Unaligned<double, 4>::Type;

/// Eight floats or integers of 32 bits anywhere in memory: one register where the machine has AVX2 and the
/// function is compiled for it (ADIT_WIDE_VECTORS), else two. Not to be passed or returned by value.
///@{
using Float8 = Unaligned<float, 8>::Type;
using Int8 = Unaligned<std::int32_t, 8>::Type;
///@}

/// Four floats from anywhere in memory.
[[nodiscard]] inline Float4 load4(const float* x) {
  return Float4(*reinterpret_cast<const Unaligned<float, 4>::Type*>(x));
}
/// The same value in every lane.
[[nodiscard]] inline Float4 all4(float x) { return Float4{x, x, x, x}; }
/// Lane by lane. Where `a` is NaN: `min` gives b, `max` a.
///@{
[[nodiscard]] inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
[[nodiscard]] inline Float4 max(Float4 a, Float4 b) { return a < b ? b : a; }
///@}

/// Over the lanes, always in this order.
///@{
[[nodiscard]] inline float sum(Float4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }
[[nodiscard]] inline double sum(const Double4& v) { return (v[0] + v[1]) + (v[2] + v[3]); }
///@}
/// The smallest of the four; no lane is NaN.
[[nodiscard]] inline float least(Float4 v) {
  const Float4 half = min(v, Float4{v[2], v[3], v[0], v[1]});
  return std::min(half[0], half[1]);
}
/// Whether any lane of a comparison is true.
[[nodiscard]] inline bool any(Int4 mask) {
  using Halves [[gnu::vector_size(16)]] = std::uint64_t;
  const auto halves = reinterpret_cast<Halves>(mask);
  return (halves[0] | halves[1]) != 0;
}

/// The same of eight lanes.
[[nodiscard, gnu::always_inline]] inline bool any(const Int8& mask) {
  using Words [[gnu::vector_size(32)]] = std::uint64_t;
  const auto words = reinterpret_cast<Words>(mask);
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

/// The values of an array, four at a time.
template <std::size_t N>
[[nodiscard]] const Double4* fours(const std::array<double, N>& values) {
  static_assert(N % 4 == 0);
  return reinterpret_cast<const Double4*>(values.data());
}

}  // namespace adit::simd
