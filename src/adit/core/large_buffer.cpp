// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/large_buffer.hpp"

#include <cstdlib>
#include <limits>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace adit {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kMostBytes = std::numeric_limits<std::size_t>::max() / 2;
constexpr std::size_t kHugePage = std::size_t{2} << 20U;

std::size_t rounded_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

}  // namespace

template <class Real>
BasicLargeBuffer<Real>::BasicLargeBuffer(std::size_t size) : size_(size) {
  if (size == 0) return;
  if (size > kMostBytes / sizeof(Real)) throw std::bad_alloc();
  const std::size_t bytes = size * sizeof(Real);
  const std::size_t alignment = bytes < kHugePage ? kCacheLine : kHugePage;
  const std::size_t room = rounded_up(bytes, alignment);
  data_.reset(static_cast<Real*>(std::aligned_alloc(alignment, room)));
  if (data_ == nullptr) throw std::bad_alloc();
#ifdef __linux__
  // A wish: where it is not granted, pages are small.
  if (alignment == kHugePage) (void)madvise(data_.get(), room, MADV_HUGEPAGE);
#endif
}

template <class Real>
void BasicLargeBuffer<Real>::Free::operator()(Real* data) const noexcept {
  std::free(data);
}

template class BasicLargeBuffer<double>;
template class BasicLargeBuffer<float>;

}  // namespace adit
