# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
include(CMakePackageConfigHelpers)

install(TARGETS adit ${modules} EXPORT aditTargets)
install(TARGETS adit_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/adit DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp"
        PATTERN "test_*.hpp" EXCLUDE PATTERN "made_up_*.hpp" EXCLUDE)  # those serve tests alone
install(EXPORT aditTargets NAMESPACE adit:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit)
configure_package_config_file(cmake/aditConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/aditConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/aditConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/aditConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/aditConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit)
