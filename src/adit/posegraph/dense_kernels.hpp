// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Dense kernels of the multifrontal Cholesky factorization and of solving with it. Matrices are
/// column-major: element (i, j) of A is a[i + j * stride].
///
/// Each output element is one sum in a fixed order, with separate multiplications and additions, whatever the
/// vector width: machines with and without AVX give the same bytes.
#pragma once

#include <cstddef>
#include <vector>

namespace adit::dense {

/// Rows per packed strip, as the update kernel reads them.
constexpr std::size_t kStrip = 8;
/// Columns per parallel task: a multiple of kStrip.
constexpr std::size_t kStripe = 96;

/// A panel of rows x depth, cut into strips of kStrip rows that each lie in memory depth by depth, padded
/// with zeros.
class PackedPanel {
 public:
  void pack(const double* a, std::size_t stride, std::size_t rows, std::size_t depth);
  [[nodiscard]] const double* strip(std::size_t i) const { return data_.data() + i * depth_ * kStrip; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t depth() const { return depth_; }

 private:
  std::vector<double> data_;
  std::size_t rows_ = 0;
  std::size_t depth_ = 0;
};

/// Lower trapezoid of C -= A B^T, or of C = -A B^T, where B is the first `columns` rows of A: columns [begin,
/// end) of it, rows from the strip that holds the diagonal downwards; `begin` is a multiple of kStrip. A few
/// elements just above the diagonal are overwritten as well.
enum class Into { subtract, replace };
void subtract_outer_product(double* c, std::size_t stride, const PackedPanel& a, std::size_t begin,
                            std::size_t end, Into into = Into::subtract);

/// Factorizes the first `columns` columns of a symmetric positive definite matrix of `rows` rows, given by
/// its lower trapezoid: the top square becomes L11, what is below L21 = A21 L11^-T. Returns the first column
/// whose pivot is not above `min_pivot[column]`, or `columns` when all is well.
std::size_t factorize_panel(double* a, std::size_t stride, std::size_t rows, std::size_t columns,
                            const double* min_pivot);

/// x <- L^-1 x for the top square of a panel of `rows` rows as `factorize_panel` leaves it; what follows, the
/// other rows of x, has L21 x subtracted.
void solve_lower(const double* panel, std::size_t rows, std::size_t columns, double* x);

/// x <- L11^-T (x - L21^T y), where y are the rows of x below the square.
void solve_lower_transposed(const double* panel, std::size_t rows, std::size_t columns, double* x);

}  // namespace adit::dense
