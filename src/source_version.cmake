# SPDX-License-Identifier: MIT
# Writes ${output}: the state of the sources at build time as a Fortran module. Run at every build;
# the file changes only when the answer does.
# In an archive that git has made its commit stands in the next line (.gitattributes).
set(archived "$Format:%H$")
find_package(Git QUIET)
set(source "unknown")
if(archived MATCHES "^[0-9a-f]+$")
  string(SUBSTRING ${archived} 0 12 source)
elseif(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --abbrev=12
    WORKING_DIRECTORY ${folder} OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE
    RESULT_VARIABLE trouble ERROR_QUIET)
  if(trouble EQUAL 0)
    string(REGEX REPLACE "[^A-Za-z0-9._-]" "" source "${answer}")
    # A page that a benchmark has written anew makes no other program.
    execute_process(COMMAND ${GIT_EXECUTABLE} diff --quiet HEAD -- src CMakeLists.txt
      WORKING_DIRECTORY ${folder} RESULT_VARIABLE changed ERROR_QUIET)
    if(NOT changed EQUAL 0)
      string(APPEND source "-dirty")
    endif()
  endif()
endif()
configure_file(${folder}/src/source_version.f90.in ${output} @ONLY)
