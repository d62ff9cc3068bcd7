# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Debian packages, one for each component of AditInstall.cmake: `make package`. The versions that they depend on are those
# of the machine that builds them (dpkg-shlibdeps).
if(NOT BUILD_SHARED_LIBS)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL library development tools)
if(ADIT_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_PACKAGE_CONTACT "The adit authors <adit@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})  # libadit itself, which is a component

set(so_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(same_library "libadit${so_version} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libadit${so_version})
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Multi-robot LiDAR SLAM for tunnels, mines and caves (library)")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/triggers)
file(WRITE ${PROJECT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libadit-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Multi-robot LiDAR SLAM for tunnels, mines and caves (development files)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What its headers include.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${same_library}, libeigen3-dev, libexpected-dev")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME adit)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "Multi-robot LiDAR SLAM for tunnels, mines and caves (program)")
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${same_library}")

if(ADIT_BUILD_PYTHON)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-adit)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Multi-robot LiDAR SLAM for tunnels, mines and caves (Python module)")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "${same_library}, python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
endif()
include(CPack)
