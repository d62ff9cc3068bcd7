// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/context_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <utility>

#include "adit/core/vectors.hpp"

namespace adit {
namespace {

constexpr std::size_t kLanes = 8;
constexpr std::size_t kLastFrequency = 20;
constexpr std::size_t kBlock = 256;
constexpr std::size_t kLine = 32;  ///< Numbers that memory delivers at once.
constexpr std::size_t kEnergy = sizeof(float) / sizeof(std::int16_t);

std::size_t padded(std::size_t n) { return (n + kLanes - 1) / kLanes * kLanes; }

float energy_in(const std::int16_t* record, std::size_t width) {
  float energy = 0.0F;
  std::memcpy(&energy, record + width - kEnergy, sizeof(energy));
  return energy;
}

/// The products of two vectors of 16-bit integers; `n` is a multiple of kLanes.
[[gnu::always_inline]] inline std::int32_t dot(const std::int16_t* a, const std::int16_t* b, std::size_t n) {
  std::int32_t sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += std::int32_t{a[k]} * b[k];
  return sum;
}

ADIT_WIDE_VECTORS void dots_with_each(const std::int16_t* query, const std::int16_t* others,
                                      std::size_t width, std::size_t n, float* out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(dot(query, others + i * width, width));
}

/// The absolute values of complex products. What comes in a while is fetched now: the others lie scattered in
/// more memory than caches hold.
[[gnu::always_inline]] inline void lengths(const std::int16_t* query, const std::int16_t* turned,
                                           const std::int16_t* others, std::size_t width,
                                           const std::uint32_t* positions, std::size_t n, float* out) {
  constexpr std::size_t kAhead = 12;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = positions[i + kAhead < n ? i + kAhead : n - 1];
    for (std::size_t k = 0; k < width; k += kLine) __builtin_prefetch(others + next * width + k);
    const std::int16_t* other = others + positions[i] * width;
    const auto real = static_cast<float>(dot(query, other, width));
    const auto imaginary = static_cast<float>(dot(turned, other, width));
    out[i] = std::sqrt(real * real + imaginary * imaginary);
  }
}

ADIT_WIDE_VECTORS void lengths_with_some(const std::int16_t* query, const std::int16_t* turned,
                                         const std::int16_t* others, std::size_t width,
                                         const std::uint32_t* positions, std::size_t n, float* out) {
  constexpr std::size_t kUsual = 48;  // of 20 rings
  if (width == kUsual) {
    lengths(query, turned, others, kUsual, positions, n, out);
  } else {
    lengths(query, turned, others, width, positions, n, out);
  }
}

struct Product {
  float real;
  float imaginary;
};
ADIT_WIDE_VECTORS Product complex_product(const std::int16_t* query, const std::int16_t* turned,
                                          const std::int16_t* other, std::size_t width) {
  return {static_cast<float>(dot(query, other, width)), static_cast<float>(dot(turned, other, width))};
}

/// of += real * cosines - imaginary * sines.
ADIT_WIDE_VECTORS void add_wave(float* of, const float* cosines, const float* sines, std::size_t n,
                                float real, float imaginary) {
  for (std::size_t k = 0; k < n; ++k) of[k] += real * cosines[k] - imaginary * sines[k];
}

/// Squared lengths are differences of floats up to a few hundred.
float with_rounding(float squared_length) { return (squared_length > 0.0F ? squared_length : 0.0F) + 1e-3F; }

}  // namespace

ContextSpectra::ContextSpectra(int num_rings, int num_sectors)
    : num_rings_(static_cast<std::size_t>(num_rings)),
      num_sectors_(static_cast<std::size_t>(num_sectors)),
      width_0_(padded(num_rings_ + kEnergy)),
      width_(padded(2 * num_rings_ + kEnergy)),
      // no coefficient exceeds the root of the number of sectors, and no sum of products exceeds 31 bits
      scale_(32767.0F / std::sqrt(static_cast<float>(num_sectors))),
      cosines_(std::min(kLastFrequency, num_sectors_ / 2) + 1),
      sines_(cosines_.size()),
      records_(cosines_.size()) {
  for (std::size_t w = 0; w < num_frequencies(); ++w) {
    for (std::size_t k = 0; k < num_sectors_; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(w * k % num_sectors_) / num_sectors;
      cosines_[w].push_back(static_cast<float>(std::cos(angle)));
      sines_[w].push_back(static_cast<float>(std::sin(angle)));
    }
  }
  // half a unit in each number of either vector, by Cauchy and Schwarz
  const double unit = 0.5 / static_cast<double>(scale_) * std::sqrt(2.0 * num_rings);
  const double integers = unit * 2.0 * std::sqrt(static_cast<double>(num_frequencies()) * num_sectors);
  // float sums of all cells, four at a time, as `distance_at` makes them, and the sums here
  const double num_cells = static_cast<double>(num_rings) * num_sectors;
  const double floats = (6e-8 * (num_cells / 4.0 + 8.0) + 1e-5) * num_sectors;
  slack_ = static_cast<float>(integers + floats);
}

/// Scaled so that the energies of all frequencies sum to the number of sectors that are not empty: a
/// frequency that stands for its mirror image too counts twice.
ContextSpectra::Spectrum ContextSpectra::spectrum_of(const ScanContext& context) const {
  Spectrum out;
  out.records.resize(place_of(num_frequencies()));
  std::vector<double> real(num_rings_);
  std::vector<double> imaginary(num_rings_);
  for (std::size_t w = 0; w < num_frequencies(); ++w) {
    std::ranges::fill(real, 0.0);
    std::ranges::fill(imaginary, 0.0);
    for (std::size_t s = 0; s < num_sectors_; ++s) {
      const float* column = &context.unit_columns[s * num_rings_];
      const auto cosine = static_cast<double>(cosines_[w][s]);
      const auto sine = static_cast<double>(sines_[w][s]);
      for (std::size_t r = 0; r < num_rings_; ++r) {
        real[r] += static_cast<double>(column[r]) * cosine;
        imaginary[r] -= static_cast<double>(column[r]) * sine;
      }
    }
    const bool is_own_mirror = w == 0 || 2 * w == num_sectors_;
    const double weight = std::sqrt((is_own_mirror ? 1.0 : 2.0) / static_cast<double>(num_sectors_));
    const double scale = weight * static_cast<double>(scale_);
    double energy = 0.0;
    for (std::size_t r = 0; r < num_rings_; ++r) {
      energy += weight * weight * (real[r] * real[r] + imaginary[r] * imaginary[r]);
      std::int16_t* coefficient = &out.records[place_of(w) + r];
      *coefficient = static_cast<std::int16_t>(std::lround(real[r] * scale));
      if (w > 0) coefficient[num_rings_] = static_cast<std::int16_t>(std::lround(imaginary[r] * scale));
    }
    out.energies.push_back(static_cast<float>(energy));
  }
  for (const float norm : context.norms) out.num_seen += norm > 0.0F ? 1.0F : 0.0F;
  return out;
}

void ContextSpectra::insert(std::size_t position, const ScanContext& context) {
  Spectrum spectrum = spectrum_of(context);
  const auto at = static_cast<std::ptrdiff_t>(position);
  for (std::size_t w = 0; w < num_frequencies(); ++w) {
    std::int16_t* first = &spectrum.records[place_of(w)];
    std::int16_t* last = first + width(w);
    std::memcpy(last - kEnergy, &spectrum.energies[w], sizeof(float));
    records_[w].insert(records_[w].begin() + at * (last - first), first, last);
  }
  num_seen_.insert(num_seen_.begin() + at, spectrum.num_seen);
}

ContextSpectra::Query ContextSpectra::query_of(const ScanContext& context) const {
  Spectrum spectrum = spectrum_of(context);
  Query query;
  query.records = std::move(spectrum.records);
  query.num_seen = spectrum.num_seen;
  query.turned.resize(query.records.size());
  for (std::size_t w = 1; w < num_frequencies(); ++w) {
    query.frequencies.push_back(w);
    const std::int16_t* from = &query.records[place_of(w)];
    std::int16_t* to = &query.turned[place_of(w)];
    for (std::size_t r = 0; r < num_rings_; ++r) {
      to[r] = static_cast<std::int16_t>(-from[num_rings_ + r]);
      to[num_rings_ + r] = from[r];
    }
  }
  const auto energy = [&](std::size_t w) { return spectrum.energies[w]; };
  std::ranges::stable_sort(query.frequencies, std::greater{}, energy);
  query.left.push_back(query.num_seen - energy(0));
  for (const std::size_t w : query.frequencies) query.left.push_back(query.left.back() - energy(w));
  return query;
}

std::vector<ContextSpectra::Candidate> ContextSpectra::candidates(const Query& query,
                                                                  float max_distance) const {
  std::vector<Candidate> out(size());
  const float unit = 1.0F / (scale_ * scale_);
  const float query_left = with_rounding(query.left[0]);
  const auto num_sectors = static_cast<float>(num_sectors_);
  float dots[kBlock];
  Candidate* next = out.data();
  for (std::size_t begin = 0; begin < size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, size() - begin);
    dots_with_each(query.records.data(), &records_[0][begin * width_0_], width_0_, n, dots);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = begin + k;
      const float left = num_seen_[i] - energy_in(&records_[0][i * width_0_], width_0_);
      const float most = dots[k] * unit;
      const float rest = std::sqrt(query_left * with_rounding(left)) + slack_;
      const float seen_by_both = query.num_seen + num_seen_[i] - num_sectors;
      const float shared = seen_by_both > 1.0F ? seen_by_both : 1.0F;
      const float bound = 1.0F - (most + rest) / shared;
      *next = {static_cast<std::uint32_t>(i), bound, most, left, shared};
      next += bound <= max_distance && num_seen_[i] > 0.0F ? 1 : 0;
    }
  }
  out.resize(static_cast<std::size_t>(next - out.data()));
  return out;
}

void ContextSpectra::narrow(const Query& query, std::size_t step, float max_distance,
                            std::vector<Candidate>& candidates) const {
  const std::size_t w = query.frequencies[step];
  const float unit = 1.0F / (scale_ * scale_);
  const float query_left = with_rounding(query.left[step + 1]);
  std::uint32_t positions[kBlock];
  float lengths[kBlock];
  Candidate* next = candidates.data();
  for (std::size_t begin = 0; begin < candidates.size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, candidates.size() - begin);
    for (std::size_t k = 0; k < n; ++k) positions[k] = candidates[begin + k].position;
    lengths_with_some(&query.records[place_of(w)], &query.turned[place_of(w)], records_[w].data(), width_,
                      positions, n, lengths);
    for (std::size_t k = 0; k < n; ++k) {
      Candidate candidate = candidates[begin + k];
      candidate.left -= energy_in(&records_[w][candidate.position * width_], width_);
      candidate.most += lengths[k] * unit;
      const float rest = std::sqrt(query_left * with_rounding(candidate.left)) + slack_;
      candidate.bound = 1.0F - (candidate.most + rest) / candidate.shared;
      *next = candidate;
      next += candidate.bound <= max_distance ? 1 : 0;
    }
  }
  candidates.resize(static_cast<std::size_t>(next - candidates.data()));
}

void ContextSpectra::prefetch(std::size_t position) const {
  for (std::size_t w = 0; w < num_frequencies(); ++w) {
    const std::int16_t* record = &records_[w][position * width(w)];
    for (std::size_t k = 0; k < width(w); k += kLine) __builtin_prefetch(record + k);
  }
}

std::vector<float> ContextSpectra::most_by_shift(const Query& query, std::size_t position) const {
  std::vector<float> most(num_sectors_, 0.0F);
  float left = num_seen_[position];
  const float unit = 1.0F / (scale_ * scale_);
  for (std::size_t w = 0; w < num_frequencies(); ++w) {
    const std::int16_t* other = &records_[w][position * width(w)];
    const Product product =
        complex_product(&query.records[place_of(w)], &query.turned[place_of(w)], other, width(w));
    left -= energy_in(other, width(w));
    add_wave(most.data(), cosines_[w].data(), sines_[w].data(), num_sectors_, unit * product.real,
             unit * product.imaginary);
  }
  const float rest = std::sqrt(with_rounding(query.left.back()) * with_rounding(left)) + slack_;
  for (float& sum : most) sum += rest;
  return most;
}

}  // namespace adit
