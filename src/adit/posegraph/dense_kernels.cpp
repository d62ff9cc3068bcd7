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

constexpr std::size_t kBlock = 8;  // columns of a tile, and columns that are factorized together
// Columns that are factorized before all columns right of them are updated: a multiple of kBlock and kStrip.
constexpr std::size_t kPanelColumns = 48;

template <class Real, std::size_t kWidth>
struct Lanes {
  using Type = typename simd::Unaligned<Real, kWidth>::Type;
};
template <class Real>
struct Lanes<Real, 1> {
  using Type = Real;
};
template <class Real, std::size_t kWidth>
using VectorOf = typename Lanes<Real, kWidth>::Type;

// Written once, compiled for several vector widths: always inlined into a function of each instruction set.
#define ADIT_INLINE [[gnu::always_inline]] inline

// C -= A B^T for one strip of rows and kColumns columns. `b` points at the first of the columns inside its
// strip. The sums stay in registers, eight for each instruction set, which hides the latency of the
// additions.
template <class Real, std::size_t kWidth, std::size_t kColumns, Into kInto>
ADIT_INLINE void update_columns(Real* c, std::size_t stride, const Real* a, const Real* b,
                                std::size_t depth) {
  using Vector = VectorOf<Real, kWidth>;
  constexpr std::size_t kVectors = kStrip<Real> / kWidth;
  Vector sum[kColumns][kVectors] = {};
  for (std::size_t k = 0; k < depth; ++k, a += kStrip<Real>, b += kStrip<Real>) {
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

// A tile of kStrip x kBlock elements.
template <class Real, std::size_t kWidth, std::size_t kColumns, Into kInto>
ADIT_INLINE void update_tile(Real* c, std::size_t stride, const Real* a, const Real* b, std::size_t depth) {
  for (std::size_t j = 0; j < kBlock; j += kColumns)
    update_columns<Real, kWidth, kColumns, kInto>(c + j * stride, stride, a, b + j, depth);
}

// The lower triangle of a factorized block, row by row, and the inverses of its diagonal.
template <class Real>
struct Triangle {
  Real row[kBlock][kBlock];
  Real inverse[kBlock];
  std::size_t columns;
};

// kWidth rows below the triangle: X <- X L^-T. All columns of a row are in registers at a time.
template <class Real, std::size_t kWidth>
ADIT_INLINE void eliminate_row(Real* x, std::size_t stride, const Triangle<Real>& l) {
  using Vector = VectorOf<Real, kWidth>;
  Vector column[kBlock];
#pragma GCC unroll 8
  for (std::size_t q = 0; q < kBlock; ++q) {
    if (q >= l.columns) return;
    Vector& own = *reinterpret_cast<Vector*>(x + q * stride);
    Vector value = own;
#pragma GCC unroll 8
    for (std::size_t p = 0; p < q; ++p) value -= l.row[q][p] * column[p];
    column[q] = value * l.inverse[q];
    own = column[q];
  }
}
template <class Real, std::size_t kWidth>
ADIT_INLINE void eliminate_all_rows(Real* x, std::size_t stride, const Triangle<Real>& l, std::size_t n) {
  std::size_t i = 0;
  for (; i + kWidth <= n; i += kWidth) eliminate_row<Real, kWidth>(x + i, stride, l);
  for (; i < n; ++i) eliminate_row<Real, 1>(x + i, stride, l);
}

// y -= X f for four columns of X, `stride` apart.
template <class Real, std::size_t kWidth>
ADIT_INLINE void subtract_four_columns(Real* y, const Real* x, std::size_t stride, const Real* f,
                                       std::size_t n) {
  using Vector = VectorOf<Real, kWidth>;
  std::size_t i = 0;
  for (; i + kWidth <= n; i += kWidth, x += kWidth) {
    Vector& to = *reinterpret_cast<Vector*>(y + i);
    to = (((to - f[0] * *reinterpret_cast<const Vector*>(x)) -
           f[1] * *reinterpret_cast<const Vector*>(x + stride)) -
          f[2] * *reinterpret_cast<const Vector*>(x + 2 * stride)) -
         f[3] * *reinterpret_cast<const Vector*>(x + 3 * stride);
  }
  for (; i < n; ++i, ++x)
    y[i] = (((y[i] - f[0] * x[0]) - f[1] * x[stride]) - f[2] * x[2 * stride]) - f[3] * x[3 * stride];
}

// Products of four columns of X with y; each sum in kStrip parts, so that every width takes the same order.
template <class Real, std::size_t kWidth>
ADIT_INLINE void dot_four_columns(Real* out, const Real* x, std::size_t stride, const Real* y,
                                  std::size_t n) {
  using Vector = VectorOf<Real, kWidth>;
  constexpr std::size_t kVectors = kStrip<Real> / kWidth;
  for (std::size_t j = 0; j < 4; ++j, x += stride) {
    Vector sum[kVectors] = {};
    std::size_t i = 0;
    for (; i + kStrip<Real> <= n; i += kStrip<Real>) {
      for (std::size_t v = 0; v < kVectors; ++v)
        sum[v] += *reinterpret_cast<const Vector*>(x + i + v * kWidth) *
                  *reinterpret_cast<const Vector*>(y + i + v * kWidth);
    }
    Real rest = 0;
    for (; i < n; ++i) rest += x[i] * y[i];
    Real parts[kStrip<Real>];
    for (std::size_t v = 0; v < kVectors; ++v) {
      for (std::size_t q = 0; q < kWidth; ++q) parts[v * kWidth + q] = sum[v][q];
    }
    for (std::size_t left = kStrip<Real> / 2; left > 0; left /= 2) {
      for (std::size_t q = 0; q < left; ++q) parts[q] = parts[2 * q] + parts[2 * q + 1];
    }
    out[j] = parts[0] + rest;
  }
}

// One binary, the widest vectors of the machine it runs on.
template <class Real>
struct Kernels {
  using Tile = void (*)(Real* c, std::size_t stride, const Real* a, const Real* b, std::size_t depth);
  Tile tile[2];  // by Into
  void (*eliminate_rows)(Real* x, std::size_t stride, const Triangle<Real>& l, std::size_t n);
  void (*subtract_columns)(Real* y, const Real* x, std::size_t stride, const Real* factors, std::size_t n);
  void (*dot_columns)(Real* out, const Real* x, std::size_t stride, const Real* y, std::size_t n);
};

// The kernels for one instruction set, with vectors of `bytes` and tiles of so many columns at a time.
// NOLINTBEGIN(bugprone-macro-parentheses): attributes, types and names take none
#define ADIT_KERNELS(name, attribute, bytes, columns)                                                       \
  template <class Real>                                                                                     \
  struct name {                                                                                             \
    static constexpr std::size_t kWidth = bytes / sizeof(Real);                                             \
    template <Into kInto>                                                                                   \
    attribute static void tile(Real* c, std::size_t stride, const Real* a, const Real* b,                   \
                               std::size_t depth) {                                                         \
      update_tile<Real, kWidth, columns, kInto>(c, stride, a, b, depth);                                    \
    }                                                                                                       \
    attribute static void eliminate_rows(Real* x, std::size_t stride, const Triangle<Real>& l,              \
                                         std::size_t n) {                                                   \
      eliminate_all_rows<Real, kWidth>(x, stride, l, n);                                                    \
    }                                                                                                       \
    attribute static void subtract_columns(Real* y, const Real* x, std::size_t stride, const Real* factors, \
                                           std::size_t n) {                                                 \
      subtract_four_columns<Real, kWidth>(y, x, stride, factors, n);                                        \
    }                                                                                                       \
    attribute static void dot_columns(Real* out, const Real* x, std::size_t stride, const Real* y,          \
                                      std::size_t n) {                                                      \
      dot_four_columns<Real, kWidth>(out, x, stride, y, n);                                                 \
    }                                                                                                       \
    static constexpr Kernels<Real> kAll{                                                                    \
        {tile<Into::subtract>, tile<Into::replace>}, eliminate_rows, subtract_columns, dot_columns};        \
  };
// NOLINTEND(bugprone-macro-parentheses)
ADIT_KERNELS(Baseline, , 16, 2)
#if defined(__x86_64__)
ADIT_KERNELS(Avx2, [[gnu::target("avx2")]], 32, 4)
ADIT_KERNELS(Avx512, [[gnu::target("avx512f")]], 64, 8)
#endif
#undef ADIT_KERNELS

template <class Real>
Kernels<Real> widest_kernels() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f")) return Avx512<Real>::kAll;
  if (__builtin_cpu_supports("avx2")) return Avx2<Real>::kAll;
#endif
  return Baseline<Real>::kAll;
}
template <class Real>
const Kernels<Real> kKernels = widest_kernels<Real>();

// The square of `l.columns` columns at `a`, and `l` from it. Returns the first column without a pivot.
template <class Real>
std::size_t factorize_square(Real* a, std::size_t stride, const Real* min_pivot, Triangle<Real>& l) {
  for (std::size_t i = 0; i < l.columns; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Real value = a[j * stride + i];
      for (std::size_t k = 0; k < j; ++k) value -= l.row[i][k] * l.row[j][k];
      if (i > j) {
        l.row[i][j] = value * l.inverse[j];
      } else {
        if (!(value > min_pivot[i])) return i;
        l.row[i][i] = std::sqrt(value);
        l.inverse[i] = Real{1} / l.row[i][i];
      }
      a[j * stride + i] = l.row[i][j];
    }
  }
  return l.columns;
}

// C -= A B^T by the first `depth` columns of A, for up to kBlock columns of C from `begin` on.
template <class Real>
void subtract_block(Real* c, std::size_t stride, const PackedPanel<Real>& a, std::size_t begin,
                    std::size_t width, std::size_t depth, Into into) {
  constexpr std::size_t kRows = kStrip<Real>;
  const auto whole_tile = kKernels<Real>.tile[static_cast<int>(into)];
  const auto into_copy = kKernels<Real>.tile[static_cast<int>(Into::replace)];
  const Real* b = a.strip(begin / kRows) + begin % kRows;
  for (std::size_t s = begin / kRows; s * kRows < a.rows(); ++s) {
    Real* to = c + begin * stride + s * kRows;
    const std::size_t height = std::min(kRows, a.rows() - s * kRows);
    if (width == kBlock && height == kRows) {
      whole_tile(to, stride, a.strip(s), b, depth);
      continue;
    }
    Real tile[kRows * kBlock];
    into_copy(tile, kRows, a.strip(s), b, depth);
    for (std::size_t q = 0; q < width; ++q) {
      for (std::size_t i = 0; i < height; ++i) {
        Real& element = to[q * stride + i];
        element = (into == Into::replace ? Real{0} : element) + tile[q * kRows + i];
      }
    }
  }
}

// The first `columns` columns at `a`; `packed` takes them where anything right of them needs them. Returns
// the first column without a pivot.
template <class Real>
std::size_t factorize_columns(Real* a, std::size_t stride, std::size_t rows, std::size_t columns,
                              const Real* min_pivot, PackedPanel<Real>& packed) {
  Triangle<Real> l;
  for (std::size_t j = 0; j < columns; j += kBlock) {
    l.columns = std::min(kBlock, columns - j);
    if (j > 0) subtract_block(a, stride, packed, j, l.columns, j, Into::subtract);
    Real* square = a + j * stride + j;
    const std::size_t done = factorize_square(square, stride, min_pivot + j, l);
    if (done < l.columns) return j + done;
    kKernels<Real>.eliminate_rows(square + l.columns, stride, l, rows - j - l.columns);
    packed.pack_columns(a, stride, j, l.columns);
  }
  return columns;
}

}  // namespace

template <class Real>
void PackedPanel<Real>::resize(std::size_t rows, std::size_t depth) {
  rows_ = rows;
  depth_ = depth;
  data_.resize((rows + kStrip<Real> - 1) / kStrip<Real> * depth * kStrip<Real>);
}

template <class Real>
void PackedPanel<Real>::pack_columns(const Real* a, std::size_t stride, std::size_t first,
                                     std::size_t count) {
  constexpr std::size_t kRows = kStrip<Real>;
  for (std::size_t s = first / kRows; s * kRows < rows_; ++s) {
    const std::size_t height = std::min(kRows, rows_ - s * kRows);
    Real* to = data_.data() + (s * depth_ + first) * kRows;
    for (std::size_t k = first; k < first + count; ++k, to += kRows) {
      const Real* from = a + s * kRows + k * stride;
      if (height == kRows) {
        std::memcpy(to, from, kRows * sizeof(Real));
      } else {
        for (std::size_t i = 0; i < kRows; ++i) to[i] = i < height ? from[i] : Real{0};
      }
    }
  }
}

template <class Real>
void PackedPanel<Real>::pack(const Real* a, std::size_t stride, std::size_t rows, std::size_t depth) {
  resize(rows, depth);
  pack_columns(a, stride, 0, depth);
}

template <class Real>
void subtract_outer_product(Real* c, std::size_t stride, const PackedPanel<Real>& a, std::size_t begin,
                            std::size_t end, Into into) {
  for (std::size_t j = begin; j < end; j += kBlock)
    subtract_block(c, stride, a, j, std::min(kBlock, end - j), a.depth(), into);
}

template <class Real>
std::size_t factorize_panel(Real* a, std::size_t stride, std::size_t rows, std::size_t columns,
                            const Real* min_pivot) {
  PackedPanel<Real> packed;
  for (std::size_t first = 0; first < columns; first += kPanelColumns) {
    const std::size_t count = std::min(columns - first, kPanelColumns);
    Real* corner = a + first * stride + first;
    packed.resize(rows - first, count);
    const std::size_t done =
        factorize_columns(corner, stride, rows - first, count, min_pivot + first, packed);
    if (done < count) return first + done;
    if (first + count == columns) break;
    // A wide front is shared between threads by columns; each element is still one sum in one order.
    parallel_for(columns - first - count, kStripe, [&](std::size_t begin, std::size_t end) {
      subtract_outer_product(corner, stride, packed, count + begin, count + end);
    });
  }
  return columns;
}

template <class Real>
void solve_lower(const Real* panel, std::size_t rows, std::size_t columns, Real* x) {
  std::size_t j = 0;
  for (; j + 4 <= columns; j += 4) {
    const Real* a = panel + j * rows;
    for (std::size_t p = j; p < j + 4; ++p) {
      for (std::size_t q = j; q < p; ++q) x[p] -= panel[q * rows + p] * x[q];
      x[p] /= panel[p * rows + p];
    }
    kKernels<Real>.subtract_columns(x + j + 4, a + j + 4, rows, x + j, rows - j - 4);
  }
  for (; j < columns; ++j) {
    x[j] /= panel[j * rows + j];
    for (std::size_t i = j + 1; i < rows; ++i) x[i] -= panel[j * rows + i] * x[j];
  }
}

template <class Real>
void solve_lower_transposed(const Real* panel, std::size_t rows, std::size_t columns, Real* x) {
  std::size_t j = columns;
  for (; j % 4 != 0; --j) {
    const Real* a = panel + (j - 1) * rows;
    for (std::size_t i = j; i < rows; ++i) x[j - 1] -= a[i] * x[i];
    x[j - 1] /= a[j - 1];
  }
  for (; j > 0; j -= 4) {
    const Real* a = panel + (j - 4) * rows;
    Real sum[4];
    kKernels<Real>.dot_columns(sum, a + j, rows, x + j, rows - j);
    for (std::size_t p = 4; p-- > 0;) {
      Real& own = x[j - 4 + p];
      own -= sum[p];
      for (std::size_t q = p + 1; q < 4; ++q) own -= a[p * rows + j - 4 + q] * x[j - 4 + q];
      own /= a[p * rows + j - 4 + p];
    }
  }
}

template class PackedPanel<double>;
template class PackedPanel<float>;
// NOLINTBEGIN(bugprone-macro-parentheses): a type takes none
#define ADIT_INSTANTIATE(Real)                                                                     \
  template void subtract_outer_product(Real*, std::size_t, const PackedPanel<Real>&, std::size_t,  \
                                       std::size_t, Into);                                         \
  template std::size_t factorize_panel(Real*, std::size_t, std::size_t, std::size_t, const Real*); \
  template void solve_lower(const Real*, std::size_t, std::size_t, Real*);                         \
  template void solve_lower_transposed(const Real*, std::size_t, std::size_t, Real*);
// NOLINTEND(bugprone-macro-parentheses)
ADIT_INSTANTIATE(double)
ADIT_INSTANTIATE(float)
#undef ADIT_INSTANTIATE

}  // namespace adit::dense
