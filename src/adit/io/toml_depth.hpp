// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What has to be looked at in a TOML text before toml++ parses it.
#pragma once

#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// Fails, with the line, where keys, tables and lists lie inside one another more than 64 deep: one line
/// `a.a.a.a = 1` can nest as many tables as it has dots, which toml++ makes and destroys by recursion. All
/// that parse a text of others call this first. Says nothing of other mistakes.
Result<> check_toml_depth(std::string_view text);

}  // namespace adit
