// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/packed_subgraph.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/vectors.hpp"

namespace adit {
namespace {

using bits::Word;
using Vertex = std::uint32_t;

// Squares of 64 x 64 bits side by side: a row of all of them fits a vector register.
constexpr std::size_t kSquares = 4;
// Not `using`: GCC 12 then drops the size.
typedef Word SquareRow  // NOLINT(modernize-use-using)
    __attribute__((vector_size(kSquares * sizeof(Word))));
using Squares = std::array<SquareRow, bits::kWordBits>;

void load(const Word* words, std::size_t n, SquareRow& row) {
  if (n == kSquares) {
    std::memcpy(&row, words, sizeof(SquareRow));
  } else {
    row = SquareRow{};
    for (std::size_t q = 0; q < n; ++q) row[q] = words[q];
  }
}

/// Among rows that are `kStride` apart, eight at a time, blocks of 4, 2 and 1 times `kStride` bits change
/// places across the diagonal.
template <unsigned kStride>
[[gnu::always_inline]] inline void exchange(SquareRow* first) {
  SquareRow rows[8];
  for (unsigned i = 0; i < 8; ++i) rows[i] = first[i * kStride];
  for (unsigned half = 4; half > 0; half /= 2) {
    const unsigned shift = half * kStride;
    const Word low = ~Word{0} / ((Word{1} << shift) + 1);  // blocks of `shift` bits, every other one set
    for (unsigned i = 0; i < 8; ++i) {
      if ((i & half) != 0) continue;
      const SquareRow changes = ((rows[i] >> shift) ^ rows[i + half]) & low;
      rows[i + half] ^= changes;
      rows[i] ^= changes << shift;
    }
  }
  for (unsigned i = 0; i < 8; ++i) first[i * kStride] = rows[i];
}

/// Turns each over its diagonal: quarters change places, then their quarters, down to single bits (Warren,
/// "Hacker's Delight", 7-3), three of these six steps at a time.
ADIT_WIDE_VECTORS void transpose(Squares& squares) {
  for (std::size_t r = 0; r < 8; ++r) exchange<8>(&squares[r]);
  for (std::size_t r = 0; r < 64; r += 8) exchange<1>(&squares[r]);
}

constexpr Vertex kGone = std::numeric_limits<Vertex>::max();
constexpr Vertex kOneNeighbour =
    0x10000;  // the key of a vertex: its degree in the upper half, itself in the lower

constexpr auto kHalfWord = [] {
  std::array<Vertex, 32> bits{};
  for (unsigned i = 0; i < 32; ++i) bits[i] = 1U << i;
  return bits;
}();

ADIT_WIDE_VECTORS Vertex least_of(const Vertex* keys, std::size_t n) {
  Vertex least = kGone;
  for (std::size_t i = 0; i < n; ++i) least = std::min(least, keys[i]);
  return least;
}

/// Takes a neighbour off every vertex of the row. Keys of vertices that are gone sink, but stay above all
/// others.
ADIT_WIDE_VECTORS void lose_neighbour(Vertex* keys, const Word* row, std::size_t words) {
  for (std::size_t half = 0; half < 2 * words; ++half, keys += 32) {
    const auto in = static_cast<Vertex>(row[half / 2] >> (half % 2 * 32));
    for (std::size_t i = 0; i < 32; ++i) keys[i] -= (in & kHalfWord[i]) != 0 ? kOneNeighbour : 0;
  }
}

}  // namespace

std::vector<Vertex> degeneracy_order(const BitGraph& graph, std::size_t min_core) {
  const std::size_t n = graph.num_vertices();
  ADIT_CHECK(n < kOneNeighbour / 2, "a vertex and its degree have 15 bits each");
  std::vector<Vertex> keys(graph.words_per_row() * bits::kWordBits, kGone);
  for (std::size_t v = 0; v < n; ++v) {
    keys[v] = static_cast<Vertex>(bits::count(graph.row(v)) * kOneNeighbour + v);
  }
  std::vector<Vertex> order;
  order.reserve(n);
  std::size_t core = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Vertex least = least_of(keys.data(), keys.size());
    const Vertex v = least % kOneNeighbour;
    core = std::max<std::size_t>(core, least / kOneNeighbour);
    if (core >= min_core) order.push_back(v);
    lose_neighbour(keys.data(), graph.row(v).data(), graph.words_per_row());
    keys[v] = kGone;
  }
  std::ranges::reverse(order);
  return order;
}

void PackedSubgraph::pick(const Word* table, std::size_t words_per_row) {
  const std::size_t n = vertices_.size();
  by_column_.resize(n);
  std::iota(by_column_.begin(), by_column_.end(), 0U);
  if (!std::ranges::is_sorted(vertices_)) {
    std::ranges::sort(by_column_, {}, [&](Vertex i) { return vertices_[i]; });
  }
  words_ = bits::words_for(n);
  strangers_.resize(n * words_);
  Squares squares;
  // Columns are picked as rows of squares that were turned over.
  for (std::size_t next = 0; next < n;) {
    const std::size_t wanted = vertices_[by_column_[next]] / bits::kWordBits;
    const std::size_t first_word = std::min(wanted, words_per_row - std::min(words_per_row, kSquares));
    const std::size_t num_words = std::min(kSquares, words_per_row);
    const std::size_t begin = next;
    while (next < n && vertices_[by_column_[next]] < (first_word + kSquares) * bits::kWordBits) ++next;
    const std::span columns(by_column_.begin() + static_cast<std::ptrdiff_t>(begin), next - begin);
    for (std::size_t w = 0; w < words_; ++w) {
      const std::size_t num_rows = std::min(bits::kWordBits, n - w * bits::kWordBits);
      for (std::size_t r = 0; r < num_rows; ++r) {
        const Word* row = table + vertices_[w * bits::kWordBits + r] * words_per_row + first_word;
        load(row, num_words, squares[r]);
      }
      std::fill(squares.begin() + static_cast<std::ptrdiff_t>(num_rows), squares.end(), SquareRow{});
      transpose(squares);
      for (const Vertex i : columns) {
        const std::size_t column = vertices_[i] - first_word * bits::kWordBits;
        strangers_[i * words_ + w] = squares[column % bits::kWordBits][column / bits::kWordBits];
      }
    }
  }
}

void PackedSubgraph::assign(const BitGraph& graph, std::vector<Vertex> vertices) {
  vertices_ = std::move(vertices);
  pick(graph.row(0).data(), graph.words_per_row());
  names_ = vertices_;
  const std::vector<Word> all = bits::first(size());
  for (std::size_t v = 0; v < size(); ++v) {
    Word* row = strangers_.data() + v * words_;
    for (std::size_t w = 0; w < words_; ++w) row[w] = all[w] & ~row[w];
    bits::reset(row, v);
  }
  measure();
}

void PackedSubgraph::assign(const PackedSubgraph& whole, const Word* set) {
  vertices_.clear();
  names_.clear();
  bits::for_each({set, whole.words()}, [&](std::size_t v) {
    vertices_.push_back(static_cast<Vertex>(v));
    names_.push_back(whole.name(v));
  });
  pick(whole.strangers_.data(), whole.words());
  measure();
}

void PackedSubgraph::reorder() {
  BitGraph graph(size());
  const std::vector<Word> all = bits::first(size());
  for (std::size_t v = 0; v < size(); ++v) {
    for (std::size_t w = 0; w < words_; ++w) graph.row(v)[w] = all[w] & ~strangers(v)[w];
    bits::reset(graph.row(v).data(), v);
  }
  const std::vector<Vertex> before = std::move(names_);
  assign(graph, degeneracy_order(graph, 0));
  for (Vertex& name : names_) name = before[name];
}

void PackedSubgraph::measure() {
  if (size() == 0) return;
  mean_degree_ = size() - 1 - bits::count(strangers_) / size();
}

}  // namespace adit
