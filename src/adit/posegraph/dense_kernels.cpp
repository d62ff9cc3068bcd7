// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "adit/core/parallel.hpp"
#include "adit/core/simd.hpp"

namespace adit::dense {
namespace {

constexpr std::size_t kPanelColumns = 24;  // columns that are factorized together before the rest is updated

template <std::size_t kWidth>
using VectorOf = simd::Unaligned<double, kWidth>;

// Written once, compiled for several vector widths: always inlined into a function of each instruction set.
#define ADIT_INLINE [[gnu::always_inline]] inline

// C -= A B^T for one strip of kStrip rows and kColumns columns. `b` points at the first of the columns inside
// its strip. The sums stay in registers: kStrip * kColumns / kWidth of them, eight for each instruction set,
// which hides the latency of the additions.
template <std::size_t kWidth, std::size_t kColumns, Into kInto>
ADIT_INLINE void update_columns(double* c, std::size_t stride, const double* a, const double* b,
                                std::size_t depth) {
  using Vector = typename VectorOf<kWidth>::Type;
  constexpr std::size_t kVectors = kStrip / kWidth;
  Vector sum[kColumns][kVectors] = {};
  for (std::size_t k = 0; k < depth; ++k, a += kStrip, b += kStrip) {
    const Vector* row = reinterpret_cast<const Vector*>(a);
    for (std::size_t j = 0; j < kColumns; ++j) {
      for (std::size_t v = 0; v < kVectors; ++v) sum[j][v] += row[v] * b[j];
    }
  }
  for (std::size_t j = 0; j < kColumns; ++j) {
    Vector* to = reinterpret_cast<Vector*>(c + j * stride);
    for (std::size_t v = 0; v < kVectors; ++v)
      to[v] = kInto == Into::replace ? -sum[j][v] : to[v] - sum[j][v];
  }
}

// A tile of kStrip x kStrip elements.
template <std::size_t kWidth, std::size_t kColumns, Into kInto>
ADIT_INLINE void update_tile(double* c, std::size_t stride, const double* a, const double* b,
                             std::size_t depth) {
  for (std::size_t j = 0; j < kStrip; j += kColumns)
    update_columns<kWidth, kColumns, kInto>(c + j * stride, stride, a, b + j, depth);
}

// y -= X f for four columns of X, `stride` apart, with factors `step` apart.
template <std::size_t kWidth>
ADIT_INLINE void subtract_four_columns(double* y, const double* x, std::size_t stride, const double* factor,
                                       std::size_t step, std::size_t n) {
  using Vector = typename VectorOf<kWidth>::Type;
  const double f0 = factor[0];
  const double f1 = factor[step];
  const double f2 = factor[2 * step];
  const double f3 = factor[3 * step];
  std::size_t i = 0;
  for (; i + kWidth <= n; i += kWidth, x += kWidth) {
    Vector& to = *reinterpret_cast<Vector*>(y + i);
    to = (((to - f0 * *reinterpret_cast<const Vector*>(x)) -
           f1 * *reinterpret_cast<const Vector*>(x + stride)) -
          f2 * *reinterpret_cast<const Vector*>(x + 2 * stride)) -
         f3 * *reinterpret_cast<const Vector*>(x + 3 * stride);
  }
  for (; i < n; ++i, ++x)
    y[i] = (((y[i] - f0 * x[0]) - f1 * x[stride]) - f2 * x[2 * stride]) - f3 * x[3 * stride];
}

// Products of four columns of X with y; each sum in eight parts, so that every width takes the same order.
template <std::size_t kWidth>
ADIT_INLINE void dot_four_columns(double* out, const double* x, std::size_t stride, const double* y,
                                  std::size_t n) {
  using Vector = typename VectorOf<kWidth>::Type;
  constexpr std::size_t kParts = 8 / kWidth;
  for (std::size_t j = 0; j < 4; ++j, x += stride) {
    Vector sum[kParts] = {};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8) {
      for (std::size_t v = 0; v < kParts; ++v)
        sum[v] += *reinterpret_cast<const Vector*>(x + i + v * kWidth) *
                  *reinterpret_cast<const Vector*>(y + i + v * kWidth);
    }
    double rest = 0.0;
    for (; i < n; ++i) rest += x[i] * y[i];
    double parts[8];
    for (std::size_t v = 0; v < kParts; ++v) {
      for (std::size_t q = 0; q < kWidth; ++q) parts[v * kWidth + q] = sum[v][q];
    }
    out[j] = ((parts[0] + parts[1]) + (parts[2] + parts[3])) +
             ((parts[4] + parts[5]) + (parts[6] + parts[7])) + rest;
  }
}

using Tile = void (*)(double* c, std::size_t stride, const double* a, const double* b, std::size_t depth);
using SubtractColumns = void (*)(double* y, const double* x, std::size_t stride, const double* factor,
                                 std::size_t step, std::size_t n);
using DotColumns = void (*)(double* out, const double* x, std::size_t stride, const double* y, std::size_t n);

#if defined(__x86_64__)
template <Into kInto>
[[gnu::target("avx2")]] void tile_avx2(double* c, std::size_t stride, const double* a, const double* b,
                                       std::size_t depth) {
  update_tile<4, 4, kInto>(c, stride, a, b, depth);
}
[[gnu::target("avx2")]] void subtract_columns_avx2(double* y, const double* x, std::size_t stride,
                                                   const double* factor, std::size_t step, std::size_t n) {
  subtract_four_columns<4>(y, x, stride, factor, step, n);
}
[[gnu::target("avx2")]] void dot_columns_avx2(double* out, const double* x, std::size_t stride,
                                              const double* y, std::size_t n) {
  dot_four_columns<4>(out, x, stride, y, n);
}
template <Into kInto>
[[gnu::target("avx512f")]] void tile_avx512(double* c, std::size_t stride, const double* a, const double* b,
                                            std::size_t depth) {
  update_tile<8, 8, kInto>(c, stride, a, b, depth);
}
#endif
template <Into kInto>
void tile_baseline(double* c, std::size_t stride, const double* a, const double* b, std::size_t depth) {
  update_tile<2, 2, kInto>(c, stride, a, b, depth);
}
void subtract_columns_baseline(double* y, const double* x, std::size_t stride, const double* factor,
                               std::size_t step, std::size_t n) {
  subtract_four_columns<2>(y, x, stride, factor, step, n);
}
void dot_columns_baseline(double* out, const double* x, std::size_t stride, const double* y, std::size_t n) {
  dot_four_columns<2>(out, x, stride, y, n);
}

// One binary, the widest vectors of the machine it runs on.
struct Kernels {
  Tile tile[2];  // by Into
  SubtractColumns subtract_columns;
  DotColumns dot_columns;
};
Kernels widest_kernels() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f"))
    return {
        {tile_avx512<Into::subtract>, tile_avx512<Into::replace>}, subtract_columns_avx2, dot_columns_avx2};
  if (__builtin_cpu_supports("avx2"))
    return {{tile_avx2<Into::subtract>, tile_avx2<Into::replace>}, subtract_columns_avx2, dot_columns_avx2};
#endif
  return {{tile_baseline<Into::subtract>, tile_baseline<Into::replace>},
          subtract_columns_baseline,
          dot_columns_baseline};
}
const Kernels kKernels = widest_kernels();

// Columns [first, last) of the panel, everything left of `first` having been subtracted already.
std::size_t factorize_columns(double* a, std::size_t stride, std::size_t rows, std::size_t first,
                              std::size_t last, const double* min_pivot) {
  for (std::size_t j = first; j < last; ++j) {
    double* column = a + j * stride + j;
    std::size_t p = first;
    for (; p + 4 <= j; p += 4) {
      const double* x = a + p * stride + j;
      kKernels.subtract_columns(column, x, stride, x, stride, rows - j);
    }
    for (; p < j; ++p) {
      const double* x = a + p * stride + j;
      const double factor = *x;
      for (std::size_t i = 0; i < rows - j; ++i) column[i] -= factor * x[i];
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
                            std::size_t end, Into into) {
  const Tile whole_tile = kKernels.tile[static_cast<int>(into)];
  const Tile into_copy = kKernels.tile[static_cast<int>(Into::replace)];
  for (std::size_t j = begin; j < end; j += kStrip) {
    const std::size_t width = std::min(kStrip, end - j);
    const double* b = a.strip(j / kStrip);
    for (std::size_t s = j / kStrip; s * kStrip < a.rows(); ++s) {
      double* to = c + j * stride + s * kStrip;
      const std::size_t height = std::min(kStrip, a.rows() - s * kStrip);
      if (width == kStrip && height == kStrip) {
        whole_tile(to, stride, a.strip(s), b, a.depth());
        continue;
      }
      double tile[kStrip * kStrip];
      into_copy(tile, kStrip, a.strip(s), b, a.depth());
      for (std::size_t q = 0; q < width; ++q) {
        for (std::size_t i = 0; i < height; ++i) {
          double& element = to[q * stride + i];
          element = (into == Into::replace ? 0.0 : element) + tile[q * kStrip + i];
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
    // A wide front is shared between threads by columns; each element is still one sum in one order.
    parallel_for(columns - last, kStripe, [&](std::size_t begin, std::size_t end) {
      subtract_outer_product(a + last * stride + last, stride, packed, begin, end);
    });
  }
  return columns;
}

void solve_lower(const double* panel, std::size_t rows, std::size_t columns, double* x) {
  std::size_t j = 0;
  for (; j + 4 <= columns; j += 4) {
    const double* a = panel + j * rows;
    for (std::size_t p = j; p < j + 4; ++p) {
      for (std::size_t q = j; q < p; ++q) x[p] -= panel[q * rows + p] * x[q];
      x[p] /= panel[p * rows + p];
    }
    kKernels.subtract_columns(x + j + 4, a + j + 4, rows, x + j, 1, rows - j - 4);
  }
  for (; j < columns; ++j) {
    x[j] /= panel[j * rows + j];
    for (std::size_t i = j + 1; i < rows; ++i) x[i] -= panel[j * rows + i] * x[j];
  }
}

void solve_lower_transposed(const double* panel, std::size_t rows, std::size_t columns, double* x) {
  std::size_t j = columns;
  for (; j % 4 != 0; --j) {
    const double* a = panel + (j - 1) * rows;
    for (std::size_t i = j; i < rows; ++i) x[j - 1] -= a[i] * x[i];
    x[j - 1] /= a[j - 1];
  }
  for (; j > 0; j -= 4) {
    const double* a = panel + (j - 4) * rows;
    double sum[4];
    kKernels.dot_columns(sum, a + j, rows, x + j, rows - j);
    for (std::size_t p = 4; p-- > 0;) {
      double& own = x[j - 4 + p];
      own -= sum[p];
      for (std::size_t q = p + 1; q < 4; ++q) own -= a[p * rows + j - 4 + q] * x[j - 4 + q];
      own /= a[p * rows + j - 4 + p];
    }
  }
}

}  // namespace adit::dense
