// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/place/scan_context.hpp"

namespace adit {

/// Lower bounds of the distance of one context to many others, over all shifts at once.
///
/// The cosines of all sectors at shift k add up to a circular correlation of unit columns, which in the
/// frequencies w along the sectors is sum over w of Re(<f_w, g_w> e^(2 pi i w k / n)), with f_w a vector of
/// as many complex numbers as there are rings. Whatever the shift, a frequency contributes at most |<f_w,
/// g_w>|, and all those not looked at together at most the product of the lengths that the two contexts have
/// in them. Places that look different differ in a few frequencies already, so a few leave few candidates.
class ContextSpectra {
 public:
  /// Of contexts of one grid size.
  ContextSpectra(int num_rings, int num_sectors);

  /// Before the context that has number `position` now.
  void insert(std::size_t position, const ScanContext& context);

  [[nodiscard]] std::size_t size() const { return num_seen_.size(); }

  /// The context that the others are compared with.
  struct Query {
    std::vector<std::size_t> frequencies;  ///< Those after 0, the query's strongest first.
    std::vector<std::int16_t> records;     ///< As of the others.
    std::vector<std::int16_t> turned;      ///< The same times the imaginary unit.
    std::vector<float> left;  ///< Squared length beyond frequency 0, beyond the first of those, ...
    float num_seen = 0.0F;
  };
  [[nodiscard]] Query query_of(const ScanContext& context) const;

  struct Candidate {
    std::uint32_t position;
    float bound;   ///< The distance is at least this.
    float most;    ///< Sum of the cosines at most, of the frequencies looked at so far.
    float left;    ///< Squared length in those not looked at.
    float shared;  ///< Sectors that both saw, at least.
  };
  /// Those that may be no farther than `max_distance` by frequency 0. Empty contexts are none.
  [[nodiscard]] std::vector<Candidate> candidates(const Query& query, float max_distance) const;
  /// Leaves those that may be no farther than `max_distance`, by the query's frequency number `step` too; all
  /// before it have been looked at.
  void narrow(const Query& query, std::size_t step, float max_distance,
              std::vector<Candidate>& candidates) const;

  /// Says that `most_by_shift` of this context will be asked for next.
  void prefetch(std::size_t position) const;
  /// The sum of the cosines at most, shift by shift, of one context.
  [[nodiscard]] std::vector<float> most_by_shift(const Query& query, std::size_t position) const;

 private:
  struct Spectrum {
    std::vector<std::int16_t> records;
    std::vector<float> energies;  ///< By frequency: squared length.
    float num_seen = 0.0F;
  };
  [[nodiscard]] std::size_t num_frequencies() const { return records_.size(); }
  [[nodiscard]] std::size_t width(std::size_t frequency) const { return frequency == 0 ? width_0_ : width_; }
  [[nodiscard]] std::size_t place_of(std::size_t frequency) const {
    return frequency == 0 ? 0 : width_0_ + (frequency - 1) * width_;
  }
  [[nodiscard]] Spectrum spectrum_of(const ScanContext& context) const;

  std::size_t num_rings_;
  std::size_t num_sectors_;
  std::size_t width_0_;  ///< Numbers a record, padded to whole vector registers.
  std::size_t width_;
  float scale_;                              ///< Of the integers.
  float slack_;                              ///< What rounding may hide in a sum of cosines.
  std::vector<std::vector<float>> cosines_;  ///< Of 2 pi w k / num_sectors, by frequency w and shift k.
  std::vector<std::vector<float>> sines_;
  /// By frequency, context after context: the real parts ring by ring, the imaginary ones, and at the very
  /// end their energy as a float; a query has zeros there. What is needed together is fetched together.
  std::vector<std::vector<std::int16_t>> records_;
  std::vector<float> num_seen_;  ///< Sectors that are not empty: the squared length of all frequencies.
};

}  // namespace adit
