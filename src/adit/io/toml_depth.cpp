// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/toml_depth.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "adit/core/format.hpp"

namespace adit {
namespace {

/// Far above any file of adit's, and far below what the stack holds.
constexpr std::size_t kMaxTomlDepth = 64;

/// Counts how deep the text nests. It need not see what is wrong with a text: toml++ stops there, and nothing
/// after it is made.
class DepthScanner {
 public:
  explicit DepthScanner(std::string_view text) : text_(text) {}

  Result<> scan() {
    while (at_ < text_.size()) {
      take(text_[at_]);
      if (around_.back() + dots_ > kMaxTomlDepth)
        return fail(
            format("line {}: more than {} keys, tables or lists inside one another; shorten the key that has "
                   "so many dots, or take the brackets apart",
                   line_, kMaxTomlDepth));
    }
    return {};
  }

 private:
  void take(char c) {
    if (c == '"' || c == '\'') return skip_string(c);
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
      return;
    }
    ++at_;
    if (c == '.') ++dots_;
    if (c == '[' || c == '{') {
      around_.push_back(around_.back() + dots_ + 1);
      dots_ = 0;
    }
    if ((c == ']' || c == '}') && around_.size() > 1) around_.pop_back();
    // What follows has a key of its own.
    if (c == ',' || c == ']' || c == '}' || c == '\n') dots_ = 0;
    line_ += c == '\n' ? 1 : 0;
  }

  void skip_string(char quote) {
    const std::size_t num_quotes = text_.substr(at_).starts_with(std::string(3, quote)) ? 3 : 1;
    const std::string end(num_quotes, quote);
    at_ += num_quotes;
    while (at_ < text_.size() && !text_.substr(at_).starts_with(end)) {
      if (num_quotes == 1 && text_[at_] == '\n') return;  // not closed
      // An escaped character may be a quote; in single quotes there are no escapes.
      if (quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      line_ += text_[at_] == '\n' ? 1 : 0;
      ++at_;
    }
    at_ = std::min(at_ + num_quotes, text_.size());
    // Up to two quotes may stand before the three that close a text of several lines.
    for (int i = 0; num_quotes == 3 && i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t dots_ = 0;                   ///< Of the key since the last bracket, comma or line.
  std::vector<std::size_t> around_ = {0};  ///< Levels around the present place, one entry per open bracket.
};

}  // namespace

Result<> check_toml_depth(std::string_view text) { return DepthScanner(text).scan(); }

}  // namespace adit
