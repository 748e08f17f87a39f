# Asks `program` for its suites and writes `file`, a test each, with `label` and the program's name as labels, run in
# `folder` (DiscoverSuites.cmake).
cmake_path(GET program FILENAME name)
set(labels "${label}")
if(NOT name MATCHES "system") # `ctest -LE system` goes by parts of labels
  list(APPEND labels ${name})
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." lines "${listing}")
set(script "")
foreach(line IN LISTS lines)
  string(STRIP "${line}" suite)
  string(REGEX REPLACE "\\.$" "" suite "${suite}")
  string(APPEND script
    "add_test([=[${suite}]=] [=[${program}]=] [=[--gtest_filter=${suite}.*]=])\n"
    "set_tests_properties([=[${suite}]=] PROPERTIES LABELS [=[${labels}]=] TIMEOUT 1800 WORKING_DIRECTORY [=[${folder}]=]\n"
    "  ENVIRONMENT [=[OPENBLAS_NUM_THREADS=1;TSAN_OPTIONS=suppressions=${folder}/tests/tsan.supp;LSAN_OPTIONS=suppressions=${folder}/tests/lsan.supp]=])\n")
endforeach()
file(WRITE ${file} "${script}")
