# Compile options of our own code, and one static library per folder.
#
#   parkade_library(slam ROOMS tracking factors LINKS parkade_core PRIVATE_LINKS Ceres::ceres)
#
# takes every .cpp of the current folder and of its ROOMS, which are listed from the lowest to the highest. PRIVATE_LINKS
# is the wall: what is linked privately cannot be included by another folder.

add_library(parkade_options INTERFACE)
target_compile_options(parkade_options INTERFACE
  -Wall -Wextra -Wconversion
  # False reports of g++ 12 on inlined std::string code (GCC bugs 105329, 105651).
  -Wno-restrict -Wno-stringop-overflow -Wno-array-bounds
  $<$<BOOL:${PARKADE_WERROR}>:-Werror>
  # Several sources as one (UnityGroups.cmake): a class of a .cpp may have members of that file's own types.
  $<$<BOOL:${PARKADE_UNITY}>:-Wno-subobject-linkage>
  # g++ collects garbage from 128 MB on: a fifth of its time.
  --param=ggc-min-heapsize=600000 --param=ggc-min-expand=100)
if(PARKADE_SANITIZE)
  # Under ASan Eigen takes to an allocator of its own, and what Debian's PCL has allocated could not be freed.
  target_compile_definitions(parkade_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_compile_options(parkade_options INTERFACE
    -fsanitize=${PARKADE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(parkade_options INTERFACE -fsanitize=${PARKADE_SANITIZE})
endif()

# Every .cpp of the current folder and of `rooms` below it.
function(parkade_sources result rooms)
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  foreach(room IN LISTS rooms)
    file(GLOB sources_of_room CONFIGURE_DEPENDS ${room}/*.cpp)
    list(APPEND sources ${sources_of_room})
  endforeach()
  set(${result} "${sources}" PARENT_SCOPE)
endfunction()

function(parkade_library name)
  cmake_parse_arguments(A "" "" "ROOMS;LINKS;PRIVATE_LINKS;EXCLUDE" ${ARGN})
  parkade_sources(sources "${A_ROOMS}")
  foreach(excluded ${A_EXCLUDE})
    cmake_path(ABSOLUTE_PATH excluded)
    list(REMOVE_ITEM sources ${excluded})
  endforeach()
  if(NOT sources)
    add_library(parkade_${name} INTERFACE)
    return()
  endif()
  add_library(parkade_${name} STATIC ${sources})
  target_include_directories(parkade_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(parkade_${name} PUBLIC ${A_LINKS} PRIVATE ${A_PRIVATE_LINKS} parkade_options)
  parkade_precompiled(parkade_${name})
endfunction()
