# The page of reports: made of web/ with npm, and put into the library of results. Without npm, or where npm cannot
# install what web/package-lock.json lists, runs write a picture in its place.
set(WITHY_REPORT AUTO CACHE STRING "Whether runs write report.html, which takes npm to build: ON, OFF, or AUTO, ON where it can be")
set(web ${PROJECT_SOURCE_DIR}/web)
set(missing "")
if(NOT WITHY_REPORT)
  set(missing "WITHY_REPORT is ${WITHY_REPORT}")
else()
  find_program(WITHY_NODE node)
  find_program(WITHY_NPM npm)
  if(NOT WITHY_NODE OR NOT WITHY_NPM)
    set(missing "node and npm were not found; on Debian: apt install nodejs npm")
  elseif(NOT EXISTS ${web}/node_modules/.package-lock.json OR ${web}/package-lock.json IS_NEWER_THAN ${web}/node_modules/.package-lock.json)
    # Without a network npm would try again for a minute and more.
    execute_process(COMMAND ${WITHY_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1
      --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=1000 WORKING_DIRECTORY ${web}
      RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE said TIMEOUT 120)
    if(failed)
      string(REGEX MATCH "npm error[^\n]*" said "${said}")
      set(missing "npm ci failed in web/ (${said})")
    else()
      file(TOUCH ${web}/node_modules/.package-lock.json)
    endif()
  endif()
endif()
if(missing AND WITHY_REPORT STREQUAL "ON")
  message(FATAL_ERROR "report.html cannot be built: ${missing}")
elseif(missing)
  message(NOTICE "withy run writes results.svg, not report.html: ${missing}")
else()
  set(WITHY_HAS_REPORT ON PARENT_SCOPE)
  set(page ${PROJECT_BINARY_DIR}/web/report.html)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(OUTPUT ${page} COMMAND ${WITHY_NODE} ${web}/build.mjs ${page}
    DEPENDS ${sources} ${web}/build.mjs ${web}/package-lock.json VERBATIM)
  set_source_files_properties(${PROJECT_SOURCE_DIR}/results/report/report_page.S PROPERTIES
    OBJECT_DEPENDS ${page} COMPILE_DEFINITIONS "WITHY_REPORT_PAGE=\"${page}\"")
endif()
