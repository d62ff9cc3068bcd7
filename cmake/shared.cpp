// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The one source of the shared library, which is made of the modules' archives: CMake asks for one.
