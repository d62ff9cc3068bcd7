// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/left_out.hpp"

#include "adit/core/format.hpp"

namespace adit {

void LeftOut::leave(const Error& reason) {
  if (num_++ == 0) first_ = format("the first, {}: {}", num_all_, reason.message);
  ++num_all_;
}

std::optional<std::string> LeftOut::sentence() const {
  if (num_ == 0) return std::nullopt;
  return format("{} of {} {} are left out; {}", num_, num_all_, things_, first_);
}

Result<> LeftOut::unless_all() const {
  if (num_ > 0 && num_ == num_all_) return fail(*sentence());
  return {};
}

}  // namespace adit
