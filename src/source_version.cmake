# SPDX-License-Identifier: MIT
# Writes ${output}: the state of the sources at build time as a Fortran module. Run at every build;
# the file changes only when the answer does.
find_package(Git QUIET)
set(source "unknown")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=12
    WORKING_DIRECTORY ${folder} OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE
    RESULT_VARIABLE trouble ERROR_QUIET)
  if(trouble EQUAL 0)
    string(REGEX REPLACE "[^A-Za-z0-9._-]" "" source "${answer}")
  endif()
endif()
file(CONFIGURE OUTPUT ${output} @ONLY CONTENT
"!> Where the program was built from; written at every build.
module source_version_m
  implicit none
  private
  public :: source_version

  character(len=*), parameter :: source_version = '@source@' !! commit, -dirty where files differ from it
end module source_version_m
")
