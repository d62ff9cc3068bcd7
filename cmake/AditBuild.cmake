# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
# A compiler cache where there is one; CCACHE_DISABLE=1 in the environment keeps it out of measured times.
option(ADIT_COMPILER_CACHE "Compile through ccache where it is installed" ON)
find_program(CCACHE_PROGRAM ccache)
mark_as_advanced(CCACHE_PROGRAM)
if(ADIT_COMPILER_CACHE AND CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    # What ccache asks for before it caches files that use a precompiled header.
    list(PREPEND CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros)
    add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  endif()
endif()

# Eight files of a room at a time: what they instantiate alike is compiled once (decision 0023). Files that a developer
# works on compile faster on their own.
option(ADIT_UNITY_BUILD "Compile the files of a library or a test program eight at a time" OFF)

option(ADIT_WARNINGS_AS_ERRORS "Refuse code that the compiler warns of: for developers, whose compiler is known" OFF)
# Flags of adit's own targets; nothing here reaches programs that link to adit.
foreach(flags adit_flags adit_test_flags)
  add_library(${flags} INTERFACE)
  target_compile_options(${flags} INTERFACE -Wall -Wextra -Wconversion -Wshadow)
  if(ADIT_WARNINGS_AS_ERRORS)
    target_compile_options(${flags} INTERFACE -Werror)
  endif()
  if(ADIT_UNITY_BUILD)
    # Meant for headers that use an unnamed namespace; files that one file includes are none.
    target_compile_options(${flags} INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  # GCC 12 takes moved and concatenated strings for overlapping copies, and for uninitialized (its bugs 105329, 105651, 105562).
  target_compile_options(${flags} INTERFACE
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-maybe-uninitialized>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(${flags} INTERFACE -march=x86-64-v2 -mtune=generic)
  endif()
  # Same bytes from every compiler setting: a fused multiply-add would round differently where the machine has one.
  target_compile_options(${flags} INTERFACE -ffp-contract=off)
endforeach()
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(adit_flags INTERFACE -O3)
  # Tests run for seconds, on a library that has its own optimization.
  target_compile_options(adit_test_flags INTERFACE -O1)
endif()

if(ADIT_SANITIZE)
  # A fault that is only printed would pass its test: undefined behaviour ends the program, as the others' faults do.
  add_compile_options(-fsanitize=${ADIT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${ADIT_SANITIZE})
  if(ADIT_SANITIZE MATCHES "^address,undefined")
    # The address sanitizer ends the program where most of these would, and they are nearly a third of the time that a file
    # of the library takes; the readers have them when they are fuzzed. Tests are looked through for faults of memory only.
    add_compile_options(-fno-sanitize=null,vptr,object-size,pointer-overflow,alignment)
    target_compile_options(adit_test_flags INTERFACE -fno-sanitize=undefined)
  endif()
endif()

# Nobody looks at errno or at floating-point traps, which keep square roots and choices out of vector registers.
function(adit_no_errno_or_traps TARGET)
  target_compile_options(${TARGET} PRIVATE -fno-math-errno -fno-trapping-math)
endfunction()
include(AditPrecompiled)

# adit_test_program(NAME PREFIX ctest_prefix SOURCES files... LIBRARIES targets... [TIMEOUT seconds]): a GoogleTest program
# each of whose tests ctest runs on its own.
function(adit_test_program NAME)
  cmake_parse_arguments(ARG "" "PREFIX;TIMEOUT" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${NAME} ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE adit_test_flags adit_test_support ${ARG_LIBRARIES} GTest::gtest_main)
  target_precompile_headers(${NAME} REUSE_FROM adit_precompiled_test)
  set_target_properties(${NAME} PROPERTIES UNITY_BUILD ${ADIT_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 8)
  set(properties)
  if(ARG_TIMEOUT)
    set(properties PROPERTIES TIMEOUT ${ARG_TIMEOUT})
  endif()
  gtest_discover_tests(${NAME} TEST_PREFIX ${ARG_PREFIX} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 ${properties})
endfunction()

# adit_module(NAME [NO_ERRNO_OR_TRAPS] DEPENDS modules... PRIVATE third parties...): one folder with its rooms
# (subfolders), one library `adit::NAME`; files that end in _test.cpp go into the program `adit_NAME_test`.
function(adit_module NAME)
  cmake_parse_arguments(ARG "NO_ERRNO_OR_TRAPS" "" "DEPENDS;PUBLIC;PRIVATE;TEST_LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB_RECURSE tests CONFIGURE_DEPENDS *_test.cpp)
  if(tests)
    list(REMOVE_ITEM sources ${tests})
  endif()
  list(TRANSFORM ARG_DEPENDS PREPEND adit::)
  if(sources)
    add_library(adit_${NAME} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(adit_${NAME} PRIVATE $<BUILD_INTERFACE:adit_flags> ${ARG_PRIVATE})
    target_compile_definitions(adit_${NAME} PRIVATE ADIT_VERSION="${PROJECT_VERSION}")
    set_target_properties(adit_${NAME} PROPERTIES UNITY_BUILD ${ADIT_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 8)
    if(ARG_NO_ERRNO_OR_TRAPS)
      adit_no_errno_or_traps(adit_${NAME})
      target_precompile_headers(adit_${NAME} REUSE_FROM adit_precompiled_kernels)
    else()
      target_precompile_headers(adit_${NAME} REUSE_FROM adit_precompiled)
    endif()
  else()
    add_library(adit_${NAME} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(adit_${NAME} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(adit_${NAME} ${scope} cxx_std_20)
  target_link_libraries(adit_${NAME} ${scope} ${ARG_DEPENDS} ${ARG_PUBLIC})
  set_target_properties(adit_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  add_library(adit::${NAME} ALIAS adit_${NAME})
  set_property(GLOBAL APPEND PROPERTY ADIT_MODULES adit_${NAME})
  if(ADIT_BUILD_TESTS AND tests)
    adit_test_program(adit_${NAME}_test PREFIX ${NAME}. SOURCES ${tests} LIBRARIES adit::${NAME} ${ARG_TEST_LIBRARIES})
  endif()
endfunction()

# adit_shared_library(modules...): `adit`, which holds all modules. Its users need what its headers include, nothing else.
function(adit_shared_library)
  add_library(adit SHARED ${PROJECT_SOURCE_DIR}/cmake/shared.cpp)
  target_link_libraries(adit PRIVATE ${ARGN} PUBLIC Eigen3::Eigen)
  # All of every archive; CMake 3.25's WHOLE_ARCHIVE would take those twice that depend on one another.
  list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE archives)
  list(JOIN archives "," archives)
  target_link_options(adit PRIVATE -Wl,--whole-archive,${archives},--no-whole-archive)
  target_include_directories(adit PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                         $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(adit PUBLIC cxx_std_20)
  # Until 1.0 every minor version may break.
  set_target_properties(adit PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  # Calls within the library stay within it, as in the static ones.
  target_link_options(adit PRIVATE -Wl,-Bsymbolic-functions -Wl,--no-undefined)
endfunction()

if(ADIT_BUILD_TESTS)
  # Where tests look for the real data sets; a test whose file is absent says SKIPPED.
  add_library(adit_test_support INTERFACE)
  target_include_directories(adit_test_support INTERFACE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(adit_test_support INTERFACE ADIT_SHARED_DATA="${ADIT_DATA_DIR}")
endif()
