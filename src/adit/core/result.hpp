// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace adit {

/// What went wrong with the data: one line that names the file (or item), the place in it, and the remedy.
struct Error {
  std::string message;  ///< The line.
};

/// Either a value or an Error; it cannot be dropped unseen.
/// `if (!result) return tl::unexpected(result.error());` or, shorter, `return result.map(...)`.
template <class T = void>
using Result = tl::expected<T, Error>;

/// An error with that line, to be returned.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

/// The same error with where it happened put in front: "map.ply: line 3: ...".
[[nodiscard]] inline tl::unexpected<Error> fail(const std::string& where, const Error& error) {
  return fail(where + ": " + error.message);
}

}  // namespace adit
