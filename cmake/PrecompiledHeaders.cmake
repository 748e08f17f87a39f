# The precompiled headers, each made once: to make one takes as long as to read it some ten times.
#
#   parkade_precompiled(target)          cmake/precompiled.h
#   parkade_precompiled(target gtest)    the same and GoogleTest
#
# g++ takes a header that was precompiled without definitions in targets that have some, as long as the header does not
# read them; and warns where it does not take it (-Winvalid-pch).
find_package(GTest REQUIRED)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "// A target needs a source.\n")
foreach(kind "" _gtest)
  add_library(parkade_headers${kind} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(parkade_headers${kind}
    PRIVATE parkade_options Eigen3::Eigen opencv_core opencv_imgproc nlohmann_json::nlohmann_json)
  target_precompile_headers(parkade_headers${kind} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled.h)
endforeach()
target_precompile_headers(parkade_headers_gtest PRIVATE <gtest/gtest.h>)
target_link_libraries(parkade_headers_gtest PRIVATE GTest::gtest)

function(parkade_precompiled target)
  set(headers parkade_headers)
  if("gtest" IN_LIST ARGN)
    set(headers parkade_headers_gtest)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()
