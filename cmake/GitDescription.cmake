# cmake -DSOURCE=... -DOUTPUT=... -P GitDescription.cmake: writes OUTPUT with the description of the commit of SOURCE, and
# touches it only where that has changed, so that nothing else is built anew.
set(description "")
find_program(git git)
if(git AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --tags --dirty
    OUTPUT_VARIABLE description OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "#include \"withy/results/git_description.hpp\"\nconst char* const withy::git_description = \"${description}\";\n")
set(written "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} written)
endif()
if(NOT written STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
