# withy_plugin(NAME SOURCE... PROVIDES kind/id... [LIBRARIES lib...] [DIRECTORY dir] [NOT_STATIC])
#
# Builds one plugin library, `withy-plugin-NAME`, and its manifest into lib/withy/plugins of the build tree, and installs
# both there. The same in this project and in one that found the package. One of the sources has
# WITHY_PLUGIN(NAME, ...), with '_' for '-' in NAME. With DIRECTORY they are built into that directory and not installed.
# With NOT_STATIC it is no part of a static build.
function(withy_plugin name)
  cmake_parse_arguments(ARG "NOT_STATIC" "DIRECTORY" "PROVIDES;LIBRARIES" ${ARGN})
  if(NOT name MATCHES "^[a-z0-9-]+$" OR NOT ARG_UNPARSED_ARGUMENTS OR NOT ARG_PROVIDES)
    message(FATAL_ERROR "withy_plugin(${name}): needs a name of a-z, 0-9 and '-', sources, and PROVIDES kind/id...")
  endif()
  string(REPLACE "-" "_" symbol ${name})
  set(directory ${PROJECT_BINARY_DIR}/lib/withy/plugins)
  if(ARG_DIRECTORY)
    set(directory ${ARG_DIRECTORY})
  endif()

  # Compiled once; the objects also go into a static build.
  add_library(withy-plugin-objects-${name} OBJECT ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(withy-plugin-objects-${name} PRIVATE withy::core withy::sweeps ${ARG_LIBRARIES})
  if(TARGET withy-options)
    target_link_libraries(withy-plugin-objects-${name} PRIVATE withy-options)
  endif()
  set_target_properties(withy-plugin-objects-${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(COMMAND withy_precompile AND NOT ARG_DIRECTORY)
    withy_precompile(plugins withy-plugin-objects-${name})
  endif()

  # The descriptor is all a library shows: nothing in it can take the place of what another library means.
  set(exports ${CMAKE_CURRENT_BINARY_DIR}/${name}.exports)
  file(CONFIGURE OUTPUT ${exports} CONTENT "{ global: withy_plugin_${symbol}; local: *; };\n" @ONLY)
  add_library(withy-plugin-${name} MODULE $<TARGET_OBJECTS:withy-plugin-objects-${name}>)
  target_link_libraries(withy-plugin-${name} PRIVATE withy::core withy::sweeps ${ARG_LIBRARIES})
  if(TARGET withy-eigen-instances AND NOT ARG_DIRECTORY)
    target_link_libraries(withy-plugin-${name} PRIVATE withy-eigen-instances)
  endif()
  target_link_options(withy-plugin-${name} PRIVATE LINKER:--version-script=${exports} LINKER:--as-needed)
  file(RELATIVE_PATH to_libraries /lib/withy/plugins /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(withy-plugin-${name} PROPERTIES
    LINKER_LANGUAGE CXX PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${directory} LINK_DEPENDS ${exports}
    INSTALL_RPATH "$ORIGIN/${to_libraries}")
  list(JOIN ARG_PROVIDES " " provides)
  set(version ${PROJECT_VERSION})
  if(NOT version)
    set(version 0)
  endif()
  file(CONFIGURE OUTPUT ${directory}/${name}.plugin @ONLY CONTENT
"[withy-plugin]
library = ${name}${CMAKE_SHARED_MODULE_SUFFIX}
entry = withy_plugin_${symbol}
provides = ${provides}
version = ${version}
")
  if(NOT ARG_DIRECTORY)
    install(TARGETS withy-plugin-${name} LIBRARY DESTINATION lib/withy/plugins)
    install(FILES ${directory}/${name}.plugin DESTINATION lib/withy/plugins)
    if(ARG_NOT_STATIC)
      set_property(GLOBAL APPEND PROPERTY WITHY_PLUGINS_NOT_STATIC ${name})
    else()
      set_property(GLOBAL APPEND PROPERTY WITHY_PLUGINS ${name})
      set_property(GLOBAL APPEND PROPERTY WITHY_PLUGIN_LIBRARIES ${ARG_LIBRARIES})
    endif()
  endif()
endfunction()
