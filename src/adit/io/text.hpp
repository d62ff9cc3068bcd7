// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Lines, words and numbers of text formats.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Steps through the lines of a text, numbered from 1; "\n" and "\r\n" both end one.
class LineReader {
 public:
  /// `text` must outlive the reader and its lines.
  explicit LineReader(std::string_view text) : text_(text) {}
  /// False at the end of the text.
  bool next();
  /// That to which `next` went, without its end.
  [[nodiscard]] std::string_view line() const { return line_; }
  /// Of that line; 0 before the first `next`.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Where the next line starts.
  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  std::string_view text_;
  std::string_view line_;
  std::size_t offset_ = 0;
  std::size_t number_ = 0;
};

/// The lines that are not empty.
[[nodiscard]] std::vector<std::string> lines_of(std::string_view text);

/// The parts between blanks.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view line);

/// The whole word as a number, with an optional leading +; "nan" and "inf" count.
[[nodiscard]] std::optional<double> parse_double(std::string_view word);
/// The whole word as a non-negative whole number.
[[nodiscard]] std::optional<std::size_t> parse_size(std::string_view word);

/// ASCII letters in lower case.
[[nodiscard]] std::string lower_case(std::string_view text);

/// As a POSIX shell takes it for one word; in single quotes only where it has to be.
[[nodiscard]] std::string shell_quoted(const std::string& text);

}  // namespace adit
