// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

/// ADIT_WIDE_VECTORS before a function definition: the compiler makes two versions of it, one for AVX2, and
/// the program takes the widest that the machine has. Meant for plain loops over arrays without aliasing;
/// only where each output is computed on its own (no reordered sums) are the bytes the same on all machines.
/// Sanitizers do not survive the resolver functions that run before them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ADIT_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define ADIT_WIDE_VECTORS
#endif
