# A ctest test per suite of a GoogleTest program, instead of one per test case: a process that has 160 shared libraries
# to load takes half a second to start, and there are 1700 cases.
#
#   parkade_discover_suites(target LABEL unit)
function(parkade_discover_suites target)
  cmake_parse_arguments(A "" "LABEL" "" ${ARGN})
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM BYPRODUCTS ${file}
    COMMAND ${CMAKE_COMMAND} -Dprogram=$<TARGET_FILE:${target}> -Dfile=${file} -Dlabel=${A_LABEL}
            -Dfolder=${PROJECT_SOURCE_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/WriteSuites.cmake)
  # What was not built has no tests: as GoogleTest's own module has it, its absence is said when ctest runs.
  set(include_file ${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake)
  file(WRITE ${include_file}
    "if(EXISTS \"${file}\")\n  include(\"${file}\")\nelse()\n  add_test(${target}_NOT_BUILT ${target}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include_file})
endfunction()
