# cmake -DBASELINE=objects -DV3=objects -DOUTPUT=file.o -DFOLDER=scratch -DCC=… -DLD=… -DOBJCOPY=… -DREADELF=… -P
#
# Both builds of the sweeps in one object, for a library that is to be one file: the dynamic linker takes the functions
# of this machine's instruction set as it takes the library in glibc-hwcaps/. Every symbol but the few that the sweeps
# show is local to its build, so that no inline function of one takes the place of the other's, or of the rest of the
# library. Without BASELINE there is one build, and nothing to choose.
set(ENV{LC_ALL} C)
function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE out ERROR_VARIABLE err RESULT_VARIABLE status)
  if(status)
    message(FATAL_ERROR "${ARGN}: ${err}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

set(builds V3)
if(BASELINE)
  list(PREPEND builds BASELINE)
endif()
foreach(build ${builds})
  run(${LD} -r --force-group-allocation -o ${FOLDER}/${build}.o ${${build}})
endforeach()
run(${READELF} --symbols --wide ${FOLDER}/V3.o)
string(REGEX MATCHALL "FUNC +GLOBAL +DEFAULT +[0-9]+ [^\n]+" shown "${out}")
list(TRANSFORM shown REPLACE "^.* " "")
if(NOT shown)
  message(FATAL_ERROR "the sweeps show no function")
endif()
string(JOIN "\n" names ${shown})
file(WRITE ${FOLDER}/shown "${names}\n")
foreach(build ${builds})
  # Unique symbols, as those of static members of templates, cannot become local as they are: they are made weak first.
  run(${READELF} --symbols --wide ${FOLDER}/${build}.o)
  string(REGEX MATCHALL "OBJECT +UNIQUE +[A-Z]+ +[0-9]+ [^\n]+" unique "${out}")
  list(TRANSFORM unique REPLACE "^.* " "")
  string(JOIN "\n" names ${unique})
  file(WRITE ${FOLDER}/unique "${names}\n")
  run(${OBJCOPY} --weaken-symbols=${FOLDER}/unique ${FOLDER}/${build}.o)
  run(${OBJCOPY} --keep-global-symbols=${FOLDER}/shown ${FOLDER}/${build}.o)
endforeach()
if(NOT BASELINE)
  file(RENAME ${FOLDER}/V3.o ${OUTPUT})
  return()
endif()

foreach(build ${builds})
  set(renamed "")
  foreach(name ${shown})
    list(APPEND renamed --redefine-sym ${name}=${build}_${name})
  endforeach()
  run(${OBJCOPY} ${renamed} ${FOLDER}/${build}.o)
endforeach()
set(code ".section .note.GNU-stack,\"\",@progbits\n.text\n")
foreach(name ${shown})
  string(APPEND code "
.globl ${name}
.hidden ${name}, BASELINE_${name}, V3_${name}
.type ${name}, @gnu_indirect_function
${name}:
  subq $8, %rsp
  call withy_has_x86_64_v3
  addq $8, %rsp
  testl %eax, %eax
  leaq BASELINE_${name}(%rip), %rcx
  leaq V3_${name}(%rip), %rax
  cmove %rcx, %rax
  ret
")
endforeach()
file(WRITE ${FOLDER}/dispatch.s "${code}")
file(WRITE ${FOLDER}/processor.c "
__attribute__((visibility(\"hidden\"))) int withy_has_x86_64_v3(void) {
  __builtin_cpu_init();
  return __builtin_cpu_supports(\"x86-64-v3\") != 0;
}
")
run(${CC} -c -O1 -fPIC -o ${FOLDER}/dispatch.o ${FOLDER}/dispatch.s)
run(${CC} -x c -c -O1 -fPIC -o ${FOLDER}/processor.o ${FOLDER}/processor.c)
run(${LD} -r -o ${OUTPUT} ${FOLDER}/dispatch.o ${FOLDER}/processor.o ${FOLDER}/BASELINE.o ${FOLDER}/V3.o)
