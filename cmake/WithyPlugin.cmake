# withy_plugin(NAME SOURCE... PROVIDES kind/id...)
# Builds one plugin library and its manifest into lib/withy/plugins.
function(withy_plugin name)
  cmake_parse_arguments(ARG "" "" "PROVIDES;LIBRARIES" ${ARGN})
  string(REPLACE "-" "_" symbol ${name})
  add_library(withy-plugin-${name} MODULE ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(withy-plugin-${name} PRIVATE withy-core withy-options ${ARG_LIBRARIES})
  set_target_properties(withy-plugin-${name} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${WITHY_PLUGIN_DIRECTORY}
    INSTALL_RPATH "$ORIGIN/../..")
  list(JOIN ARG_PROVIDES " " provides)
  file(CONFIGURE OUTPUT ${WITHY_PLUGIN_DIRECTORY}/${name}.plugin
       CONTENT "library = ${name}.so\nentry = withy_plugin_${symbol}\nprovides = ${provides}\n" @ONLY)
  install(TARGETS withy-plugin-${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/withy/plugins)
  install(FILES ${WITHY_PLUGIN_DIRECTORY}/${name}.plugin DESTINATION ${CMAKE_INSTALL_LIBDIR}/withy/plugins)
endfunction()
