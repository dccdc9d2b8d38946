# Packages for Debian: `cpack -G DEB` in the build tree makes libwithy0, libwithy-dev, withy and, where the Python module
# is built, python3-withy. scripts/packages.sh makes, checks and tries them. Included last: it asks what there is.
set(packages ${PROJECT_SOURCE_DIR}/cmake/packages)

# For builds without CMake: pkg-config --cflags --libs withy (C++), withy-c (C).
file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" to_prefix ${to_prefix})
foreach(module withy withy-c)
  configure_file(${packages}/${module}.pc.in ${PROJECT_BINARY_DIR}/pkgconfig/${module}.pc @ONLY)
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/pkgconfig DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)

set(WITHY_MAINTAINER "The Withy authors <authors@withy.invalid>" CACHE STRING "Who answers for the packages: Name <address>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME withy)
set(CPACK_PACKAGE_CONTACT ${WITHY_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL libraries development program)
if(TARGET withy-python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Parts of one version: they share types of C++, not only the interface in C.
set(same_libraries "libwithy0 (= ${PROJECT_VERSION})")
# withy_debian_package(COMPONENT NAME SECTION SUMMARY TEXT [DEPENDS])
macro(withy_debian_package component name section summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${text}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${ARGN}")
endmacro()
set(what "Withy computes the motion of trees of rigid and flexible bodies:
space manipulators, spacecraft with booms, robots. The linearization
of the flexible bodies is named, its error is measured beside its cost,
and each run says whether it was valid.
")
withy_debian_package(libraries libwithy0 libs "dynamics of trees of rigid and flexible bodies - libraries"
  "${what}\nThis package has the libraries for C++ and C, and the plugins.")
withy_debian_package(development libwithy-dev libdevel "dynamics of trees of rigid and flexible bodies - headers"
  "${what}\nThis package has the headers and the files for CMake and pkg-config."
  "${same_libraries}, libeigen3-dev, nlohmann-json3-dev")
withy_debian_package(program withy science "dynamics of trees of rigid and flexible bodies - program"
  "${what}\nThis package has the program." ${same_libraries})
# One interpreter, as the extension module is built for one.
set(next_python 0)
if(WITHY_PYTHON_VERSION MATCHES "^3\\.([0-9]+)")
  math(EXPR next_python "${CMAKE_MATCH_1} + 1")
  set(this_python ${CMAKE_MATCH_1})
endif()
withy_debian_package(python python3-withy python "dynamics of trees of rigid and flexible bodies - Python"
  "${what}\nThis package has the module for Python."
  "${same_libraries}, python3 (>= 3.${this_python}~), python3 (<< 3.${next_python}), python3-numpy")

# A program that was linked with one minor version finds no other, before 1.0 (docs/versions.md).
string(REGEX MATCH "^[0-9]+\\.[0-9]+" interface ${PROJECT_VERSION})
math(EXPR next_minor "${PROJECT_VERSION_MINOR} + 1")
set(shlibs "")
foreach(library c campaign core host plugin-host results scene study sweeps)
  string(APPEND shlibs "libwithy-${library} ${interface} libwithy0 (>= ${PROJECT_VERSION}), libwithy0 (<< ${PROJECT_VERSION_MAJOR}.${next_minor})\n")
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/shlibs CONTENT "${shlibs}" @ONLY)
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/shlibs ${packages}/triggers)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${packages}/postinst ${packages}/prerm)

configure_file(${packages}/finish.cmake.in ${PROJECT_BINARY_DIR}/finish_packages.cmake @ONLY)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/finish_packages.cmake)
include(CPack)
