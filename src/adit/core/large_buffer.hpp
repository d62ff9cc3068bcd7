// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>

namespace adit {

/// `size` uninitialised numbers, double or float. Large buffers come in huge pages where the system has them:
/// the first touch of each 4 kB page costs as much as computing with it.
template <class Real>
class BasicLargeBuffer {
 public:
  BasicLargeBuffer() = default;
  /// Begins at a cache line, from 2 MB on at a huge page. Throws std::bad_alloc.
  explicit BasicLargeBuffer(std::size_t size);

  [[nodiscard]] std::size_t size() const { return size_; }  ///< In numbers, not in bytes.
  /// The first number; null where the size is 0.
  ///@{
  [[nodiscard]] Real* data() { return data_.get(); }
  [[nodiscard]] const Real* data() const { return data_.get(); }
  ///@}

 private:
  struct Free {
    void operator()(Real* data) const noexcept;
  };
  std::unique_ptr<Real[], Free> data_;
  std::size_t size_ = 0;
};
/// Of double precision.
using LargeBuffer = BasicLargeBuffer<double>;

}  // namespace adit
