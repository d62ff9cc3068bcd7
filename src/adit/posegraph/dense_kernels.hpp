// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Dense kernels of the multifrontal Cholesky factorization and of solving with it. Matrices are
/// column-major: element (i, j) of A is a[i + j * stride].
///
/// Each output element is one sum in a fixed order, with separate multiplications and additions, whatever the
/// vector width: machines with and without AVX give the same bytes. `Real` is double or float.
#pragma once

#include <cstddef>
#include <vector>

namespace adit::dense {

/// Rows per packed strip, as the update kernel reads them: 64 bytes.
template <class Real>
constexpr std::size_t kStrip = 64 / sizeof(Real);
/// Columns per parallel task: a multiple of every kStrip.
constexpr std::size_t kStripe = 96;

/// A panel of rows x depth, cut into strips of kStrip rows that each lie in memory depth by depth, padded
/// with zeros.
template <class Real>
class PackedPanel {
 public:
  /// Copies a panel, column-major at `a`.
  void pack(const Real* a, std::size_t stride, std::size_t rows, std::size_t depth);
  /// The same in parts: room for a panel, then some of its columns from the strip of row `first` on, which is
  /// where the lower trapezoid has them. `a` is the whole panel.
  ///@{
  void resize(std::size_t rows, std::size_t depth);
  void pack_columns(const Real* a, std::size_t stride, std::size_t first, std::size_t count);
  ///@}
  /// Strip number i: rows from i kStrip on, kStrip numbers for each column in turn.
  [[nodiscard]] const Real* strip(std::size_t i) const { return data_.data() + i * depth_ * kStrip<Real>; }
  /// Rows and columns of the panel, padding not counted.
  ///@{
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t depth() const { return depth_; }
  ///@}

 private:
  std::vector<Real> data_;
  std::size_t rows_ = 0;
  std::size_t depth_ = 0;
};

/// C -= A B^T, or C = -A B^T.
enum class Into { subtract, replace };
/// Lower trapezoid of C -= A B^T, or of C = -A B^T, where B is the first `columns` rows of A: columns [begin,
/// end) of it, rows from the strip that holds the diagonal downwards; `begin` is a multiple of 8. A few
/// elements just above the diagonal are overwritten as well.
template <class Real>
void subtract_outer_product(Real* c, std::size_t stride, const PackedPanel<Real>& a, std::size_t begin,
                            std::size_t end, Into into = Into::subtract);

/// Factorizes the first `columns` columns of a symmetric positive definite matrix of `rows` rows, given by
/// its lower trapezoid: the top square becomes L11, what is below L21 = A21 L11^-T. Returns the first column
/// whose pivot is not above `min_pivot[column]`, or `columns` when all is well.
template <class Real>
std::size_t factorize_panel(Real* a, std::size_t stride, std::size_t rows, std::size_t columns,
                            const Real* min_pivot);

/// x <- L^-1 x for the top square of a panel of `rows` rows as `factorize_panel` leaves it; what follows, the
/// other rows of x, has L21 x subtracted.
template <class Real>
void solve_lower(const Real* panel, std::size_t rows, std::size_t columns, Real* x);

/// x <- L11^-T (x - L21^T y), where y are the rows of x below the square.
template <class Real>
void solve_lower_transposed(const Real* panel, std::size_t rows, std::size_t columns, Real* x);

}  // namespace adit::dense
