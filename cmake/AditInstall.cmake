# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
include(CMakePackageConfigHelpers)

set(libraries adit)
if(NOT BUILD_SHARED_LIBS)
  list(APPEND libraries ${modules})
endif()
# Components are Debian packages (AditPackage.cmake).
install(TARGETS ${libraries} EXPORT aditTargets
        LIBRARY COMPONENT library NAMELINK_COMPONENT development
        ARCHIVE COMPONENT development)
install(TARGETS adit_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
# The manual page and the completions are what the program says of itself.
if(NOT CMAKE_CROSSCOMPILING)
  set(described ${CMAKE_CURRENT_BINARY_DIR}/described)
  file(MAKE_DIRECTORY ${described})
  foreach(form man bash zsh)
    add_custom_command(OUTPUT ${described}/${form} COMMAND adit_program describe ${form} > ${described}/${form} DEPENDS adit_program)
  endforeach()
  add_custom_command(OUTPUT ${described}/adit.1.gz COMMAND gzip -9nc ${described}/man > ${described}/adit.1.gz DEPENDS ${described}/man)
  add_custom_target(adit_described ALL DEPENDS ${described}/adit.1.gz ${described}/bash ${described}/zsh)
  install(FILES ${described}/adit.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  install(FILES ${described}/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME adit COMPONENT tools)
  install(FILES ${described}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _adit COMPONENT tools)
endif()
install(DIRECTORY src/adit DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.hpp"
        PATTERN "test_*.hpp" EXCLUDE PATTERN "made_up_*.hpp" EXCLUDE  # those serve tests alone
        PATTERN "format.hpp" EXCLUDE PATTERN "far_out.hpp" EXCLUDE PATTERN "gnc_search.hpp" EXCLUDE PATTERN "loop_trials.hpp" EXCLUDE)  # and those .cpp files
install(EXPORT aditTargets NAMESPACE adit:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit COMPONENT development)
configure_package_config_file(cmake/aditConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/aditConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/aditConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/aditConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/aditConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adit COMPONENT development)
