// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// Sets of small numbers as bits, 64 per word.
namespace bits {

/// Part of a set: whether it has each of 64 numbers.
using Word = std::uint64_t;
constexpr std::size_t kWordBits = 64;  ///< Numbers per word.

/// How many words a set of numbers below `n` takes.
constexpr std::size_t words_for(std::size_t n) { return (n + kWordBits - 1) / kWordBits; }
/// The bit of number `i` in its word, which is word i / kWordBits.
constexpr Word bit(std::size_t i) { return Word{1} << (i % kWordBits); }
/// Of a word that is not 0.
constexpr std::size_t lowest(Word word) { return static_cast<std::size_t>(std::countr_zero(word)); }
/// How many numbers the set has.
///@{
constexpr std::size_t count(Word word) { return static_cast<std::size_t>(std::popcount(word)); }
constexpr std::size_t count(std::span<const Word> words) {
  std::size_t sum = 0;
  for (const Word word : words) sum += count(word);
  return sum;
}
///@}
/// Puts the number `i` into the set, or takes it out. `words` must have a bit for it.
///@{
constexpr void set(Word* words, std::size_t i) { words[i / kWordBits] |= bit(i); }
constexpr void reset(Word* words, std::size_t i) { words[i / kWordBits] &= ~bit(i); }
///@}
/// The set {0, ..., n - 1}.
inline std::vector<Word> first(std::size_t n) {
  std::vector<Word> words(words_for(n), ~Word{0});
  if (n % kWordBits != 0) words.back() = bit(n) - 1;
  return words;
}
/// Calls `visit(i)` for every i of the set, ascending.
template <class Visit>
void for_each(std::span<const Word> words, const Visit& visit) {
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (Word left = words[w]; left != 0; left &= left - 1) visit(w * kWordBits + lowest(left));
  }
}

}  // namespace bits

/// An undirected graph of a few thousand vertices as a square table of bits.
class BitGraph {
 public:
  /// Without edges.
  explicit BitGraph(std::size_t num_vertices)
      : num_vertices_(num_vertices), words_(bits::words_for(num_vertices)), bits_(num_vertices * words_, 0) {}

  /// Between two different vertices. Once or more is the same.
  void add_edge(std::size_t a, std::size_t b) {
    bits::set(row(a).data(), b);
    bits::set(row(b).data(), a);
  }
  /// Whether `b` is in the row of `a`.
  [[nodiscard]] bool has_edge(std::size_t a, std::size_t b) const {
    return (row(a)[b / bits::kWordBits] & bits::bit(b)) != 0;
  }
  /// Vertices are the numbers below this.
  [[nodiscard]] std::size_t num_vertices() const { return num_vertices_; }
  /// How long each `row` is.
  [[nodiscard]] std::size_t words_per_row() const { return words_; }
  /// The neighbours of a vertex.
  [[nodiscard]] std::span<const bits::Word> row(std::size_t v) const {
    return {bits_.data() + v * words_, words_};
  }
  /// The same to write to. Who writes there keeps the rows of the neighbours in step.
  [[nodiscard]] std::span<bits::Word> row(std::size_t v) { return {bits_.data() + v * words_, words_}; }
  /// Goes through all rows.
  [[nodiscard]] std::size_t num_edges() const { return bits::count(bits_) / 2; }

 private:
  std::size_t num_vertices_;
  std::size_t words_;
  std::vector<bits::Word> bits_;
};

}  // namespace adit
