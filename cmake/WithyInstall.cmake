# What `cmake --install` puts where, and the package that find_package(withy) finds. Everything is relative: an
# installed tree can be moved.
include(CMakePackageConfigHelpers)

# What a program needs at run time, if nothing else is said; `development`, `program` and `python` are the other parts.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME libraries)

# Programs are in bin; libraries beside each other.
# The build tree is laid out as it is installed, and libraries are found alike. CMake's own paths for a build tree end in
# an empty one, which is the working folder: libraries would be looked for, and taken, there.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
file(RELATIVE_PATH to_libraries /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
set(CMAKE_INSTALL_RPATH "$ORIGIN/${to_libraries}")

# withy_install_library(TARGET EXPORT_NAME name): installs a shared library, found as withy::name.
function(withy_install_library target)
  cmake_parse_arguments(ARG "" "EXPORT_NAME" "" ${ARGN})
  # A library's uses of its own functions, virtual tables and constants are bound as it is linked: a short run spends a
  # quarter of its time in the look-up of symbols otherwise. None of the libraries shows data that change, which
  # scripts/check_symbolic.py checks.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_link_options(${target} PRIVATE -Wl,-Bsymbolic)
  endif()
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${ARG_EXPORT_NAME} INSTALL_RPATH "$ORIGIN"
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  install(TARGETS ${target} EXPORT withy LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT development
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# withy_host_library(TARGET EXPORT_NAME name): installs a shared library that hosts link: all its names are visible.
function(withy_host_library target)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET default VISIBILITY_INLINES_HIDDEN OFF)
  withy_install_library(${target} ${ARGN})
endfunction()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/withy)
install(EXPORT withy NAMESPACE withy:: DESTINATION ${package} COMPONENT development)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/withy-config.cmake.in
  ${PROJECT_BINARY_DIR}/withy-config.cmake INSTALL_DESTINATION ${package})
# Before 1.0 every minor version may change the interfaces.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/withy-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/withy-config.cmake ${PROJECT_BINARY_DIR}/withy-config-version.cmake
              ${PROJECT_SOURCE_DIR}/cmake/WithyPlugin.cmake
        DESTINATION ${package} COMPONENT development)
