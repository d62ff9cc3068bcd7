// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace adit {

/// A well-mixed 64-bit hash (the finaliser of SplitMix64, Steele et al. 2014). For noise that must not depend
/// on the order or thread in which it is drawn, hash the item's own coordinates.
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}
/// Of two numbers, whose order matters.
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t a, std::uint64_t b) { return mix64(mix64(a) ^ b); }

/// A seeded random generator that gives the same numbers on every machine and compiler (the standard
/// library's distributions do not). xoshiro256++ of Blackman and Vigna.
class Rng {
 public:
  /// What `operator()` returns, by the name that the standard library asks for.
  using result_type = std::uint64_t;

  /// Every seed gives another sequence; 0 is as good as others.
  explicit Rng(std::uint64_t seed) {
    for (std::uint64_t& word : state_) word = seed = mix64(seed);
  }

  /// The range of `operator()`: all numbers of 64 bits.
  ///@{
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  ///@}

  /// The next number of the sequence. All its bits are random.
  result_type operator()() {
    const std::uint64_t out = rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotl(state_[3], 45);
    return out;
  }

  /// In [0, 1).
  double uniform() { return static_cast<double>((*this)() >> 11U) * 0x1.0p-53; }
  /// In [low, high), but for rounding, which may give `high`.
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In {0, ..., n - 1}; n > 0.
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t limit = max() - max() % n;
    std::uint64_t draw = (*this)();
    while (draw >= limit) draw = (*this)();
    return draw % n;
  }
  /// Normal with mean 0 and standard deviation 1 (Box and Muller).
  double normal() {
    const double u = 1.0 - uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Normal within two standard deviations of 0: drawn again where it is farther out.
  double normal_within_two_sigma() {
    double draw = normal();
    while (std::abs(draw) > 2.0) draw = normal();
    return draw;
  }
  /// Number of events that come one by one, `mean` of them on average (Poisson): exponential gaps are summed
  /// until they exceed it, in time that grows with it.
  std::uint64_t poisson(double mean) {
    std::uint64_t num = 0;
    for (double at = -std::log1p(-uniform()); at < mean; at -= std::log1p(-uniform())) ++num;
    return num;
  }

 private:
  static constexpr std::uint64_t rotl(std::uint64_t x, unsigned k) { return (x << k) | (x >> (64U - k)); }
  std::uint64_t state_[4];
};

}  // namespace adit
