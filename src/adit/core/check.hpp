// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace adit {

/// Thrown when the caller broke a documented contract. It is a bug in the program, not a property of the
/// data: data errors are values of type `Result`.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws ContractViolation with the place, `message` and the condition that does not hold. For ADIT_CHECK.
[[noreturn]] inline void fail_check(const char* condition, const char* message, const char* file, int line) {
  throw ContractViolation(std::string(file) + ":" + std::to_string(line) + ": " + message + " (" + condition +
                          ")");
}

}  // namespace adit

/// Always on, in release builds too.
#define ADIT_CHECK(condition, message) \
  ((condition) ? static_cast<void>(0) : ::adit::fail_check(#condition, message, __FILE__, __LINE__))
