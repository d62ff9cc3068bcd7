// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

// One binary, the widest vectors of the machine it runs on. Sanitizers do not survive the resolver functions
// that run before them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ADIT_WIDEST_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ADIT_WIDEST_VECTORS
#endif

namespace adit::dense {
namespace {

constexpr std::size_t kTileColumns = 6;    // 6 x 8 sums fit the 16 registers of AVX2
constexpr std::size_t kPanelColumns = 24;  // columns that are factorized together before the rest is updated

using Strip =
    double __attribute__((vector_size(kStrip * sizeof(double)), aligned(alignof(double)), may_alias));

// sum[j] = the products of one strip of A with row j of B, for kTileColumns rows of B that may cross two
// strips.
struct TileColumn {
  const double* b;  // element of the first depth; the next ones follow kStrip apart
};

ADIT_WIDEST_VECTORS void multiply_tile(const double* a, const TileColumn* columns, std::size_t depth,
                                       double* out) {
  Strip sum[kTileColumns] = {};
  for (std::size_t k = 0; k < depth; ++k) {
    const Strip strip = *reinterpret_cast<const Strip*>(a + k * kStrip);
    for (std::size_t j = 0; j < kTileColumns; ++j) sum[j] += strip * columns[j].b[k * kStrip];
  }
  for (std::size_t j = 0; j < kTileColumns; ++j) *reinterpret_cast<Strip*>(out + j * kStrip) = sum[j];
}

ADIT_WIDEST_VECTORS void subtract_scaled(double* y, const double* x, double factor, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) y[i] -= factor * x[i];
}

ADIT_WIDEST_VECTORS void subtract_scaled_4(double* y, const double* x, std::size_t stride,
                                           const double* factor, std::size_t n) {
  const double f0 = factor[0];
  const double f1 = factor[stride];
  const double f2 = factor[2 * stride];
  const double f3 = factor[3 * stride];
  for (std::size_t i = 0; i < n; ++i) {
    y[i] = (((y[i] - f0 * x[i]) - f1 * x[i + stride]) - f2 * x[i + 2 * stride]) - f3 * x[i + 3 * stride];
  }
}

// Columns [first, last) of the panel, everything left of `first` having been subtracted already.
std::size_t factorize_columns(double* a, std::size_t stride, std::size_t rows, std::size_t first,
                              std::size_t last, const double* min_pivot) {
  for (std::size_t j = first; j < last; ++j) {
    double* column = a + j * stride + j;
    std::size_t p = first;
    for (; p + 4 <= j; p += 4) {
      const double* x = a + p * stride + j;
      subtract_scaled_4(column, x, stride, x, rows - j);
    }
    for (; p < j; ++p) {
      const double* x = a + p * stride + j;
      subtract_scaled(column, x, *x, rows - j);
    }
    if (!(*column > min_pivot[j])) return j;
    const double pivot = std::sqrt(*column);
    const double inverse = 1.0 / pivot;
    *column = pivot;
    for (std::size_t i = 1; i < rows - j; ++i) column[i] *= inverse;
  }
  return last;
}

}  // namespace

void PackedPanel::pack(const double* a, std::size_t stride, std::size_t rows, std::size_t depth) {
  rows_ = rows;
  depth_ = depth;
  const std::size_t strips = (rows + kStrip - 1) / kStrip;
  data_.resize(strips * depth * kStrip);
  for (std::size_t s = 0; s < strips; ++s) {
    const std::size_t height = std::min(kStrip, rows - s * kStrip);
    double* to = data_.data() + s * depth * kStrip;
    for (std::size_t k = 0; k < depth; ++k, to += kStrip) {
      const double* from = a + s * kStrip + k * stride;
      if (height == kStrip) {
        std::memcpy(to, from, kStrip * sizeof(double));
      } else {
        for (std::size_t i = 0; i < kStrip; ++i) to[i] = i < height ? from[i] : 0.0;
      }
    }
  }
}

void subtract_outer_product(double* c, std::size_t stride, const PackedPanel& a, std::size_t begin,
                            std::size_t end) {
  alignas(64) double tile[kTileColumns * kStrip];
  TileColumn columns[kTileColumns];
  for (std::size_t j = begin; j < end; j += kTileColumns) {
    const std::size_t width = std::min(kTileColumns, end - j);
    for (std::size_t q = 0; q < kTileColumns; ++q) {
      const std::size_t row = std::min(j + q, end - 1);
      columns[q].b = a.strip(row / kStrip) + row % kStrip;
    }
    for (std::size_t s = j / kStrip; s * kStrip < a.rows(); ++s) {
      multiply_tile(a.strip(s), columns, a.depth(), tile);
      const std::size_t height = std::min(kStrip, a.rows() - s * kStrip);
      for (std::size_t q = 0; q < width; ++q) {
        double* to = c + (j + q) * stride + s * kStrip;
        const double* from = tile + q * kStrip;
        if (height == kStrip) {
          for (std::size_t i = 0; i < kStrip; ++i) to[i] -= from[i];
        } else {
          for (std::size_t i = 0; i < height; ++i) to[i] -= from[i];
        }
      }
    }
  }
}

std::size_t factorize_panel(double* a, std::size_t stride, std::size_t rows, std::size_t columns,
                            const double* min_pivot) {
  PackedPanel packed;
  for (std::size_t first = 0; first < columns; first += kPanelColumns) {
    const std::size_t last = std::min(columns, first + kPanelColumns);
    const std::size_t done = factorize_columns(a, stride, rows, first, last, min_pivot);
    if (done < last) return done;
    if (last == columns) break;
    packed.pack(a + first * stride + last, stride, rows - last, last - first);
    subtract_outer_product(a + last * stride + last, stride, packed, 0, columns - last);
  }
  return columns;
}

}  // namespace adit::dense
