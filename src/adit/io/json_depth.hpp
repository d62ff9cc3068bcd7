// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What has to be looked at in a JSON or CBOR file before it is parsed.
#pragma once

#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// Fails, with the byte, where lists and objects lie inside one another more than 100 deep: copying, printing
/// and, of CBOR, reading them is recursion. Says nothing of other mistakes.
///@{
Result<> check_json_depth(std::string_view text);
/// Of CBOR (RFC 8949), where texts in chunks and tags can nest, too.
Result<> check_cbor_depth(std::string_view bytes);
///@}

}  // namespace adit
