// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Bytes of what two robots decided, for wire.cpp.
#pragma once

#include "adit/fleet/sync/protocol.hpp"
#include "adit/transport/wire_bytes.hpp"

namespace adit::wire {

/// Appends them.
void put(Writer& out, const MergeChecks& checks);
/// Refuses what no check can be: outcomes that are none, numbers that are not finite, more places that passed
/// than were checked.
void get(Reader& in, MergeChecks& checks);

}  // namespace adit::wire
