# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# cmake -D BUILD_DIR=... -D SOURCE_DIR=... -D WORK_DIR=... -D VERSION=... [-D SANITIZE=...] -D COMPILER=... -P run.cmake
# Installs adit, then configures, builds and runs the program beside this file against what was installed.
function(run)
  execute_process(COMMAND ${ARGV} OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: ${result}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})

file(GLOB_RECURSE headers RELATIVE ${prefix}/include ${prefix}/include/*)
foreach(header ${headers})
  if(header MATCHES "_test|/test_|made_up")
    message(FATAL_ERROR "${header} serves tests alone and was installed")
  endif()
endforeach()

set(flags)
if(SANITIZE)
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR} -B ${WORK_DIR}/build -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_PREFIX_PATH=${prefix} ${flags})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/consumer)
if(NOT output MATCHES "adit ${VERSION}, at \\(1, 2\\)")
  message(FATAL_ERROR "the consumer said: ${output}")
endif()
run(${prefix}/bin/adit --version)
