// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/max_clique.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <type_traits>
#include <utility>

#include "adit/geometry/clique_local_search.hpp"
#include "adit/geometry/packed_subgraph.hpp"

namespace adit {
namespace {

using bits::Word;
using Vertex = std::uint32_t;

constexpr std::uint64_t kFirstSteps = 200;  // of local search, before anything else
constexpr std::uint64_t kNodesBeforeMore =
    16384;  // then it goes on each time that the nodes are four times as many,
constexpr std::uint64_t kNodesPerStep = 4;  // for a quarter of them
constexpr std::size_t kMostDoomed = 8;      // with more branches left, unit propagation seldom closes a node
constexpr std::size_t kWorthPacking = 2;    // branches
constexpr std::size_t kDegreePerNeed = 6;   // from here on the search below is long enough to order first

/// A set of vertices of a PackedSubgraph; the number of its words is known when compiled, or 0.
template <std::size_t kWords>
class Set {
 public:
  explicit Set(std::size_t words) {
    if constexpr (kWords == 0) words_.resize(words);
  }
  Word& operator[](std::size_t w) { return words_[w]; }
  const Word& operator[](std::size_t w) const { return words_[w]; }
  [[nodiscard]] Word* data() { return words_.data(); }
  [[nodiscard]] const Word* data() const { return words_.data(); }
  [[nodiscard]] std::size_t words() const { return words_.size(); }
  [[nodiscard]] std::size_t count() const { return bits::count(words_); }

 private:
  std::conditional_t<kWords == 0, std::vector<Word>, std::array<Word, kWords>> words_;
};

/// Calls `visit(w)` for each word; unrolled where their number is known, so that they stay in registers.
template <std::size_t kWords, class Visit>
inline void for_each_word(const Visit& visit) {
  [&]<std::size_t... w>(std::index_sequence<w...>) { (visit(w), ...); }
  (std::make_index_sequence<kWords>());
}

class Search {
 public:
  Search(const BitGraph& graph, std::uint64_t budget)
      : graph_(graph), budget_(budget), best_(greedy_clique(graph)), local_search_(graph, best_) {}

  Clique run() {
    search_locally(kFirstSteps);
    parts_.emplace_back().assign(graph_, degeneracy_order(graph_, best_.size()));
    search_part(0);
    Clique out{{best_.begin(), best_.end()}, !exhausted_, visited_};
    std::ranges::sort(out.vertices);
    return out;
  }

 private:
  void search_locally(std::uint64_t num_steps) {
    num_steps = std::min(num_steps, budget_ - visited_);
    local_search_.run(num_steps, best_);
    visited_ += num_steps;
  }

  /// Whether the budget allows for one more node.
  bool visit() {
    if (visited_ >= next_local_search_) {
      search_locally(visited_ / kNodesPerStep);
      next_local_search_ = 4 * visited_;
    }
    exhausted_ = exhausted_ || visited_ >= budget_;
    visited_ += exhausted_ ? 0 : 1;
    return !exhausted_;
  }

  /// How many vertices must follow those on the path, and one more, for a larger clique than the best.
  [[nodiscard]] std::size_t need() const { return best_.size() - path_.size(); }

  void search_part(std::size_t level) {
    const std::size_t words = parts_[level].words();
    if (words == 1) return search_whole<1>(level);
    if (words == 2) return search_whole<2>(level);
    if (words == 3) return search_whole<3>(level);
    if (words == 4) return search_whole<4>(level);
    if (words > 4) return search_whole<0>(level);
  }

  template <std::size_t kWords>
  void search_whole(std::size_t level) {
    const std::vector<Word> all = bits::first(parts_[level].size());
    Set<kWords> candidates(all.size());
    std::ranges::copy(all, candidates.data());
    Set<kWords> branches(all.size());
    if (bound<kWords>(parts_[level], candidates, parts_[level].size(), branches))
      expand<kWords>(level, candidates, branches);
  }

  /// Packs the candidates into a part of their own and searches that.
  void search_packed(std::size_t level, const Word* candidates) {
    if (parts_.size() == level + 1) parts_.emplace_back();
    PackedSubgraph& part = parts_[level + 1];
    part.assign(parts_[level], candidates);
    if (level == 0 && part.mean_degree() > kDegreePerNeed * need()) part.reorder();
    search_part(level + 1);
  }

  /// Looks for a clique of more than need() candidates, each of which has a vertex of `branches`.
  template <std::size_t kWords>
  void expand(std::size_t level, Set<kWords> candidates, Set<kWords> branches) {
    const PackedSubgraph& part = parts_[level];
    Set<kWords> next(part.words());
    Set<kWords> next_branches(part.words());
    for (std::size_t w = part.words(); w-- > 0;) {
      while (branches[w] != 0) {
        const std::size_t v = w * bits::kWordBits + bits::highest(branches[w]);
        bits::reset(branches.data(), v);
        bits::reset(candidates.data(), v);
        const Word* strangers = part.strangers(v);
        for (std::size_t q = 0; q < candidates.words(); ++q) next[q] = candidates[q] & ~strangers[q];
        const std::size_t num_next = next.count();
        if (num_next < need()) continue;
        if (!visit()) return;
        const std::size_t size_before = best_.size();
        path_.push_back(part.name(v));
        descend<kWords>(level, next, num_next, next_branches);
        path_.pop_back();
        if (best_.size() == size_before) continue;
        if (!bound<kWords>(part, candidates, candidates.count(), branches)) return;
        w = part.words();  // from the last branch on again
        break;
      }
    }
  }

  template <std::size_t kWords>
  void descend(std::size_t level, Set<kWords>& candidates, std::size_t num, Set<kWords>& branches) {
    const PackedSubgraph& part = parts_[level];
    if (path_.size() > best_.size()) best_ = path_;
    if (num == 0) return;
    const bool narrower = kWords != 1 && 2 * bits::words_for(num) <= part.words();
    if (kWords == 0 && narrower) return search_packed(level, candidates.data());
    if (!bound<kWords>(part, candidates, num, branches)) return;
    if (narrower && branches.count() >= kWorthPacking) return search_packed(level, candidates.data());
    expand<kWords>(level, candidates, branches);
  }

  /// Fills `branches` with candidates such that the others hold no clique of more than need(). False when no
  /// branch is left. Candidates that are in no such clique may be taken out.
  template <std::size_t kWords>
  bool bound(const PackedSubgraph& part, Set<kWords>& candidates, std::size_t num, Set<kWords>& branches) {
    if (part.mean_degree() * num < need() * part.size()) num = drop_loose<kWords>(part, candidates, num);
    if (num <= need()) return false;
    branches = candidates;
    if (need() == 0) return true;
    colour<kWords>(part, branches);
    const std::size_t left = branches.count();
    if (left == 0 || left > kMostDoomed || need() > kMostColours) return left > 0;
    return absorb<kWords>(part, candidates, branches);
  }

  /// Takes out the candidates with less than need() neighbours among them. Returns how many stay.
  template <std::size_t kWords>
  std::size_t drop_loose(const PackedSubgraph& part, Set<kWords>& candidates, std::size_t num) {
    Set<kWords> kept(part.words());
    for (std::size_t w = 0; w < candidates.words(); ++w) {
      kept[w] = 0;
      for (Word left = candidates[w]; left != 0; left &= left - 1) {
        const Word* strangers = part.strangers(w * bits::kWordBits + bits::lowest(left));
        std::size_t apart = 1;  // itself
        for (std::size_t q = 0; q < candidates.words(); ++q)
          apart += bits::count(strangers[q] & candidates[q]);
        if (num >= apart + need()) kept[w] |= left & -left;
      }
    }
    candidates = kept;
    return kept.count();
  }

  /// Takes need() greedy colour classes out of `rest`, each of mutual strangers, the lowest vertices first.
  /// rests_ keeps what is left after each.
  template <std::size_t kWords>
  void colour(const PackedSubgraph& part, Set<kWords>& rest) {
    rests_.resize(std::max(rests_.size(), need() * part.words()));
    Word* after = rests_.data();
    if constexpr (kWords == 0) {
      Set<0> free = rest;
      for (std::size_t k = 0; k < need(); ++k, after += part.words(), free = rest) {
        for (std::size_t w = 0; w < free.words(); ++w) {
          while (free[w] != 0) {
            const Word* strangers = part.strangers(w * bits::kWordBits + bits::lowest(free[w]));
            rest[w] ^= free[w] & -free[w];
            for (std::size_t q = w; q < free.words(); ++q) free[q] &= strangers[q];
          }
        }
        std::copy_n(rest.data(), rest.words(), after);
      }
    } else {
      colour_narrow<kWords>(part, rest, need(), after);
    }
  }

  /// The same, a vertex a turn: where a class ends no branch can foresee, so it is no branch.
  template <std::size_t kWords>
  static void colour_narrow(const PackedSubgraph& part, Set<kWords>& out, std::size_t num_classes,
                            Word* after) {
    const Word* const strangers = part.strangers(0);
    Set<kWords> rest = out;
    Set<kWords> free = out;
    for (;;) {
      Word any_free = 0;
      Word any_rest = 0;
      for_each_word<kWords>([&](std::size_t w) {
        any_free |= free[w];
        any_rest |= rest[w];
      });
      const bool full = any_free == 0;
      num_classes -= full ? 1 : 0;
      after += full ? kWords : 0;
      for_each_word<kWords>([&](std::size_t w) { free[w] = full ? rest[w] : free[w]; });
      if (num_classes == 0 || any_rest == 0) break;
      std::size_t at = 0;
      Word here = free[0];
      for_each_word<kWords - 1>([&](std::size_t w) {
        at = here == 0 ? w + 1 : at;
        here = here == 0 ? free[w + 1] : here;
      });
      const Word* row = strangers + (at * bits::kWordBits + bits::lowest(here)) * kWords;
      for_each_word<kWords>([&](std::size_t w) {
        rest[w] ^= w == at ? here & -here : 0;
        free[w] &= row[w];
        after[w] = rest[w];
      });
    }
    out = rest;
  }

  /// Takes branches away that no clique of more than need() can hold: unit propagation over the colour
  /// classes, of each of which it would need a vertex, ends in a class that has none left. The classes used
  /// up that way count for no other such vertex that is joined to this one. False when no branch is left.
  template <std::size_t kWords>
  bool absorb(const PackedSubgraph& part, const Set<kWords>& candidates, Set<kWords>& branches) {
    const std::size_t words = candidates.words();
    const std::size_t num_classes = need();
    for (std::size_t i = num_classes * words; i-- > 0;) {  // from what was left to what was taken
      rests_[i] ^= i >= words ? rests_[i - words] : candidates[i];
    }
    std::array<std::pair<std::size_t, Word>, kMostDoomed> absorbed;  // vertex, classes used
    std::size_t num_absorbed = 0;
    bool any_left = false;
    for (std::size_t w = 0; w < words; ++w) {
      for (Word left = branches[w]; left != 0; left &= left - 1) {
        const std::size_t v = w * bits::kWordBits + bits::lowest(left);
        const Word* strangers = part.strangers(v);
        Word open = ~Word{0} >> (kMostColours - num_classes);
        for (std::size_t i = 0; i < num_absorbed; ++i) {
          const auto& [u, used] = absorbed[i];
          if ((strangers[u / bits::kWordBits] & bits::bit(u)) == 0) open &= ~used;
        }
        if (const Word used = conflict<kWords>(part, strangers, num_classes, open); used != 0) {
          absorbed[num_absorbed++] = {v, used};
          bits::reset(branches.data(), v);
        } else {
          any_left = true;
        }
      }
    }
    return any_left;
  }

  /// The classes of which a clique of non-`strangers` cannot have a vertex each; 0 when none are found. Only
  /// `open` ones are considered.
  template <std::size_t kWords>
  Word conflict(const PackedSubgraph& part, const Word* strangers, std::size_t num_classes, Word open) {
    const std::size_t words = kWords == 0 ? part.words() : kWords;
    meets_.resize(std::max(meets_.size(), num_classes * words));
    Word* const meets = meets_.data();       // what of each class may still be in the clique
    std::array<Word, kMostColours> reasons;  // the classes because of which that is so few
    Word units = 0;                          // classes with one vertex left
    for (std::size_t i = 0; i < num_classes; ++i) {
      Word any = 0;
      Word several = 0;
      for (std::size_t w = 0; w < words; ++w) {
        const Word left = rests_[i * words + w] & ~strangers[w];
        several |= (any != 0 ? left : 0) | (left & (left - 1));
        any |= left;
        meets[i * words + w] = left;
      }
      units |= static_cast<Word>(several == 0) << i;
      reasons[i] = bits::bit(i);
    }
    for (units &= open; units != 0; units &= open) {
      const std::size_t i = bits::lowest(units);
      open &= ~bits::bit(i);
      std::size_t at = 0;
      while (meets[i * words + at] == 0) ++at;
      const Word* others = part.strangers(at * bits::kWordBits + bits::lowest(meets[i * words + at]));
      const Word reason = reasons[i];
      Word empty = 0;
      for (std::size_t j = 0; j < num_classes; ++j) {
        Word any = 0;
        Word several = 0;
        Word lost = 0;
        for (std::size_t w = 0; w < words; ++w) {
          const Word before = meets[j * words + w];
          const Word left = before & ~others[w];
          several |= (any != 0 ? left : 0) | (left & (left - 1));
          any |= left;
          lost |= before ^ left;
          meets[j * words + w] = left;
        }
        reasons[j] |= lost != 0 ? reason : 0;
        empty |= static_cast<Word>(any == 0) << j;
        units |= static_cast<Word>(several == 0) << j;
      }
      if ((empty & open) != 0) return reasons[bits::lowest(empty & open)];
    }
    return 0;
  }

  static constexpr std::size_t kMostColours = 64;  // that unit propagation keeps apart

  const BitGraph& graph_;
  std::uint64_t budget_;
  std::uint64_t visited_ = 0;
  std::uint64_t next_local_search_ = kNodesBeforeMore;
  bool exhausted_ = false;
  std::vector<Vertex> best_;
  std::vector<Vertex> path_;
  CliqueLocalSearch local_search_;
  std::deque<PackedSubgraph>
      parts_;  ///< Each packed out of the one before; the first one is the graph's core.
  std::vector<Word> rests_;
  std::vector<Word> meets_;
};

}  // namespace

Clique max_clique(const BitGraph& graph, std::uint64_t max_search_nodes) {
  if (graph.num_vertices() == 0) return {};
  return Search(graph, max_search_nodes).run();
}

}  // namespace adit
