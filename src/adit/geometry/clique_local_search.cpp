// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/clique_local_search.hpp"

#include <algorithm>

namespace adit {
namespace {

using bits::Word;

constexpr std::uint64_t kTenure = 7;       // steps that a vertex stays out at least
constexpr std::uint64_t kPatience = 1000;  // steps without a larger clique before a new start

void keep_common(std::vector<Word>& set, std::span<const Word> row) {
  for (std::size_t w = 0; w < set.size(); ++w) set[w] &= row[w];
}

std::size_t num_common(std::span<const Word> a, std::span<const Word> b) {
  std::size_t sum = 0;
  for (std::size_t w = 0; w < a.size(); ++w) sum += bits::count(a[w] & b[w]);
  return sum;
}

std::vector<std::uint32_t> members(const std::vector<Word>& set) {
  std::vector<std::uint32_t> out;
  bits::for_each(set, [&](std::size_t v) { out.push_back(static_cast<std::uint32_t>(v)); });
  return out;
}

}  // namespace

std::vector<std::uint32_t> greedy_clique(const BitGraph& graph) {
  std::vector<Word> candidates = bits::first(graph.num_vertices());
  std::vector<Word> clique(candidates.size(), 0);
  for (std::size_t left = graph.num_vertices(); left > 0; left = bits::count(candidates)) {
    std::size_t best = 0;
    std::size_t most = 0;
    std::vector<std::size_t> joined_to_all;
    bits::for_each(candidates, [&](std::size_t v) {
      const std::size_t num = 1 + num_common(graph.row(v), candidates);
      if (num == left) joined_to_all.push_back(v);
      if (num > most) {
        most = num;
        best = v;
      }
    });
    if (joined_to_all.empty()) joined_to_all.push_back(best);
    for (const std::size_t v : joined_to_all) {
      bits::set(clique.data(), v);
      bits::reset(candidates.data(), v);
      keep_common(candidates, graph.row(v));
    }
  }
  return members(clique);
}

CliqueLocalSearch::CliqueLocalSearch(const BitGraph& graph, const std::vector<std::uint32_t>& clique)
    : graph_(graph),
      all_(bits::first(graph.num_vertices())),
      inside_(all_.size()),
      tabu_(all_.size()),
      choice_(all_.size()),
      carry_(all_.size()) {
  clear();
  for (const std::uint32_t v : clique) add(v);
}

void CliqueLocalSearch::clear() {
  std::ranges::fill(inside_, 0);
  std::ranges::fill(tabu_, 0);
  tabu_list_.clear();
  missing_.clear();
  size_ = 0;
  largest_ = 0;
  last_gain_ = step_;
}

/// All counters at once: a ripple through the planes.
void CliqueLocalSearch::count_missing(std::size_t v, bool more) {
  const auto row = graph_.row(v);
  for (std::size_t w = 0; w < carry_.size(); ++w) carry_[w] = all_[w] & ~row[w];
  bits::reset(carry_.data(), v);
  if (size_ >> missing_.size() != 0) missing_.emplace_back(all_.size(), 0);
  const Word flip = more ? 0 : ~Word{0};
  for (std::vector<Word>& plane : missing_) {
    for (std::size_t w = 0; w < carry_.size(); ++w) {
      const Word before = plane[w];
      plane[w] ^= carry_[w];
      carry_[w] &= before ^ flip;
    }
  }
}

void CliqueLocalSearch::add(std::size_t v) {
  bits::set(inside_.data(), v);
  ++size_;
  count_missing(v, true);
  if (size_ > largest_) {
    largest_ = size_;
    last_gain_ = step_;
  }
}

void CliqueLocalSearch::drop(std::size_t v, std::uint64_t num_steps) {
  bits::reset(inside_.data(), v);
  count_missing(v, false);
  --size_;
  bits::set(tabu_.data(), v);
  tabu_list_.push_back({v, step_ + num_steps});
}

std::size_t CliqueLocalSearch::choose_from_missing(std::size_t num_missing) {
  const Word flip = num_missing == 0 ? ~Word{0} : 0;
  for (std::size_t w = 0; w < choice_.size(); ++w) {
    choice_[w] = all_[w] & ~inside_[w] & ~tabu_[w] & (missing_[0][w] ^ flip);
  }
  for (std::size_t p = 1; p < missing_.size(); ++p) {
    for (std::size_t w = 0; w < choice_.size(); ++w) choice_[w] &= ~missing_[p][w];
  }
  return bits::count(choice_);
}

std::size_t CliqueLocalSearch::pick(std::size_t n) {
  std::size_t skip = rng_.below(n);
  std::size_t w = 0;
  for (; skip >= bits::count(choice_[w]); ++w) skip -= bits::count(choice_[w]);
  Word left = choice_[w];
  for (; skip > 0; --skip) left &= left - 1;
  return w * bits::kWordBits + bits::lowest(left);
}

void CliqueLocalSearch::step() {
  if (size_ == 0) {
    choice_ = all_;
    return add(pick(graph_.num_vertices()));
  }
  if (const std::size_t n = choose_from_missing(0); n > 0) return add(pick(n));
  if (const std::size_t n = choose_from_missing(1); n > 0) {
    const std::size_t v = pick(n);
    const auto row = graph_.row(v);
    std::size_t w = 0;
    while ((inside_[w] & ~row[w]) == 0) ++w;
    drop(w * bits::kWordBits + bits::lowest(inside_[w] & ~row[w]), kTenure + rng_.below(n));
    return add(v);
  }
  choice_ = inside_;
  drop(pick(size_), kTenure);
}

void CliqueLocalSearch::run(std::uint64_t num_steps, std::vector<std::uint32_t>& best) {
  for (const std::uint64_t end = step_ + num_steps; step_ < end; ++step_) {
    std::erase_if(tabu_list_, [&](const Tabu& tabu) {
      if (tabu.until > step_) return false;
      bits::reset(tabu_.data(), tabu.vertex);
      return true;
    });
    if (step_ >= last_gain_ + kPatience) clear();
    step();
    if (size_ > best.size()) best = members(inside_);
  }
}

}  // namespace adit
