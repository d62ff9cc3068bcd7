// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The one source of the targets that hold the precompiled headers (AditPrecompiled.cmake): CMake asks for
// one.
