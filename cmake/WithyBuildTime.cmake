# What keeps a build from nothing short; the one place that says which rooms are compiled otherwise than the rest.
#
# Sources that begin with the same headers get them precompiled, once for a group of targets with the same flags:
#
#   group      who                                                        headers
#   core       core/ but the sweeps                                       precompiled/engine.hpp
#   plugins    bodies, loads, integrators, modes, formulations, fem       precompiled/engine.hpp
#   programs   scene, study, results, campaign, program, apps                     precompiled/programs.hpp
#   tests      tests but for benchmarks and bad plugins with flags of their own   precompiled/tests.hpp
#   computing-tests  those of them that compute much themselves           the same
#
# They all also declare Eigen's decompositions and products as compiled elsewhere (eigen_instances.cpp), for a source
# with one eigenvalue problem instantiates all that this calls: core/simulation/diagnosis.cpp takes 10 s instead of 24 s.
# That asks for arguments that are matrices: a decomposition of an expression is instantiated anew. Products of
# matrices with three rows, or of numbers with derivatives, are written with lazyProduct: Eigen's way with great ones takes
# a source a second or two a kind to compile (core/reference 33 s of CPU time, and 24 s so); three rows run in 0.6 to 1.1
# times the time so.
#
# Plugins are compiled twelve sources at a time, programs and tests forty, which most rooms do not have: a room's sources
# instantiate the same, apps took 292 s of CPU time and take 150 s, tests/cli 231 s and 76 s; tests that take 140 s took
# 182 s at twelve a time. Of the core rooms of small sources are one source each (simulation took 51 s and takes 34 s);
# core/analysis and core/tangents share too little and take longer as one.
# Names in unnamed namespaces must then differ within a room.
#
# Programs hold no loop that time is spent in: a release build compiles them at -O1. Most tests ask libraries and other
# programs: at -O0 they take 0.6 to 0.7 of the time to compile. Those of mode families spend 0.7 of their own running time
# in themselves, those of dynamics 0.1: they are at -O1. Precompiled headers keep the level that they were compiled at and
# impose it on all who use them, whatever their own flags say: a group has one.
#
# The sweeps are compiled without precompiled headers, which two sets of flags would need twice; benchmarks and
# plugins with flags of their own file by file. A build with a cache of objects (ccache, which passes by sources with
# precompiled headers) goes without: sources include all they need, and there a missing #include is an error. So does
# clang, but for the preset that fuzzes: it would be 516 commands, each of which instruments anew what it
# instantiates, and is 125.
set(WITHY_PRECOMPILE_HEADERS "" CACHE STRING "ON or OFF; if empty, ON for g++ without a compiler launcher")
set(precompile ${WITHY_PRECOMPILE_HEADERS})
if(WITHY_PRECOMPILE_HEADERS STREQUAL "")
  set(precompile OFF)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(precompile ON)
  endif()
endif()

# Who works on a room changes one source at a time: -DWITHY_UNITE_SOURCES=OFF compiles file by file.
option(WITHY_UNITE_SOURCES "Compile several sources of a room as one" ON)

add_library(withy-precompiled INTERFACE)
# Names of one source's unnamed namespace and of another's function are two things, but not where both are one source.
target_compile_options(withy-precompiled INTERFACE -Wno-shadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Warnings that follow the flow through inlined functions of the library: false ones (GCC bug 105651 and its like),
  # which g++ 12 keeps to itself where it reads the headers as text. There they are errors as all others are.
  target_compile_options(withy-precompiled INTERFACE -Wno-stringop-overflow -Wno-stringop-overread
    -Wno-error=maybe-uninitialized -Wno-error=free-nonheap-object -Wno-error=dangling-pointer -Wno-error=nonnull
    -Wno-error=invalid-pch)
endif()

# The decompositions and products that the headers declare as compiled elsewhere: hidden in each library that has them.
# Without precompiled headers there are none to link, and clang-tidy alone reads the source.
set(eigen_instances withy-eigen-instances)
if(NOT precompile)
  set(eigen_instances withy-eigen-instances-read)
endif()
add_library(${eigen_instances} STATIC EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/cmake/precompiled/eigen_instances.cpp)
target_link_libraries(${eigen_instances} PRIVATE Eigen3::Eigen withy-options)
target_compile_features(${eigen_instances} PRIVATE cxx_std_20)

# withy_unite(TARGET [COUNT]): compiles its sources twelve (COUNT) at a time.
function(withy_unite target)
  if(precompile AND WITHY_UNITE_SOURCES)
    set(count 12)
    if(ARGC GREATER 1)
      set(count ${ARGV1})
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${count})
  endif()
endfunction()

# withy_unite_rooms(TARGET ROOM...): compiles the sources of each of these folders as one.
function(withy_unite_rooms target)
  if(precompile AND WITHY_UNITE_SOURCES)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    foreach(room ${ARGN})
      file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cpp)
      set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${room})
    endforeach()
  endif()
endfunction()

# Of a group, in a release build.
set(optimization_programs -O1)
set(optimization_computing-tests -O1)
set(optimization_tests -O0)
set(optimized_little $<$<CONFIG:Release>:-O1>)

# withy_precompile(GROUP TARGET...): these targets use the headers of the group. The core makes them for
# itself; the other groups share those of an empty library with the same flags.
function(withy_precompile group)
  if(NOT precompile)
    return()
  endif()
  foreach(target ${ARGN})
    target_link_libraries(${target} PRIVATE withy-precompiled)
    if(group STREQUAL "core")
      target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled/engine.hpp)
    else()
      target_precompile_headers(${target} REUSE_FROM withy-precompiled-${group})
    endif()
    if(group STREQUAL "programs" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      # It refuses headers that were compiled for names of another visibility, where g++ takes them.
      set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET default VISIBILITY_INLINES_HIDDEN OFF)
    endif()
    if(group MATCHES "programs|tests")
      withy_unite(${target} 40)
    elseif(NOT group STREQUAL "core")
      withy_unite(${target})
    endif()
    if(optimization_${group})
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${optimization_${group}}>)
    endif()
    target_link_libraries(${target} PRIVATE withy-eigen-instances)
  endforeach()
endfunction()

# withy_precompiled_group(GROUP HEADER LIBRARY...)
function(withy_precompiled_group group header)
  if(NOT precompile)
    return()
  endif()
  set(empty ${PROJECT_BINARY_DIR}/precompiled_${group}.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "" @ONLY)
  add_library(withy-precompiled-${group} OBJECT ${empty})
  target_link_libraries(withy-precompiled-${group} PRIVATE withy-core withy-options withy-precompiled ${ARGN})
  target_precompile_headers(withy-precompiled-${group} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled/${header})
  if(optimization_${group})
    target_compile_options(withy-precompiled-${group} PRIVATE $<$<CONFIG:Release>:${optimization_${group}}>)
  endif()
endfunction()

withy_precompiled_group(plugins engine.hpp)
withy_precompiled_group(programs programs.hpp fmt::fmt nlohmann_json::nlohmann_json)
if(TARGET withy-precompiled-programs)
  # Libraries of hosts show their names: types of precompiled headers must not hide theirs.
  set_target_properties(withy-precompiled-programs PROPERTIES CXX_VISIBILITY_PRESET default VISIBILITY_INLINES_HIDDEN OFF)
endif()
if(WITHY_TESTS)
  foreach(group tests computing-tests)
    withy_precompiled_group(${group} tests.hpp GTest::gmock)
    if(TARGET withy-precompiled-${group})
      # As programs are, not libraries: the headers are those of one kind of code.
      set_target_properties(withy-precompiled-${group} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
      target_compile_options(withy-precompiled-${group} PRIVATE -fPIE)
    endif()
  endforeach()
endif()
