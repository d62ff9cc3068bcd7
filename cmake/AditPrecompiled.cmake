# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Precompiled headers: reading Eigen and the standard library takes one to two seconds per file
# (docs/decisions/0023-quick-to-build.md). They are read once for each set of flags: the library and the
# program, its kernels, and, with GoogleTest, the tests. They save time only: each file includes what it uses, and
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds the same program without them.
#
# CLI11 and nlohmann/json stay out: their inline functions ask for templates that GCC would instantiate in every file.
set(ADIT_PRECOMPILED
  <algorithm> <array> <bit> <charconv> <chrono> <cmath> <cstdint> <cstring> <deque> <filesystem> <functional> <limits>
  <map> <memory> <mutex> <numbers> <numeric> <optional> <ranges> <set> <span> <sstream> <stdexcept> <string>
  <string_view> <tuple> <unordered_map> <utility> <variant> <vector>
  <Eigen/Dense> <fmt/format.h> <tl/expected.hpp>)

add_library(adit_precompiled OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
target_link_libraries(adit_precompiled PRIVATE adit_flags Eigen3::Eigen)
target_precompile_headers(adit_precompiled PRIVATE ${ADIT_PRECOMPILED})

add_library(adit_precompiled_kernels OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
adit_no_errno_or_traps(adit_precompiled_kernels)
target_link_libraries(adit_precompiled_kernels PRIVATE adit_flags Eigen3::Eigen)
target_precompile_headers(adit_precompiled_kernels PRIVATE ${ADIT_PRECOMPILED})

if(ADIT_BUILD_TESTS)
  add_library(adit_precompiled_test OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
  # Compiled as part of a program, as the tests are: GCC takes a precompiled header only where -fPIE and -fPIC agree.
  set_target_properties(adit_precompiled_test PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(adit_precompiled_test PRIVATE -fPIE)
  target_link_libraries(adit_precompiled_test PRIVATE adit_test_flags Eigen3::Eigen GTest::gtest)
  target_precompile_headers(adit_precompiled_test PRIVATE ${ADIT_PRECOMPILED} <gtest/gtest.h>)
endif()
