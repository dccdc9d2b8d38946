# Copies what docs/extending.md shows of a first plugin to FOLDER, builds it against the package in PREFIX, and runs its
# scene with PROGRAM.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
file(GLOB shown ${SOURCES}/first/*)
file(COPY ${shown} ${SOURCES}/project/rod.cpp DESTINATION ${FOLDER})
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} -G ${GENERATOR} -B build -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build build)
run(${PROGRAM} run scene.yaml --plugins build/lib/withy/plugins --out run)
