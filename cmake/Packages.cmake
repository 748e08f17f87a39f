# Third-party libraries, each found once. Debian 12 packages only
# (scripts/install_packages.sh). What has no CMake config is found by name.
# Their headers are SYSTEM: our warnings are for our own code.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d video dnn)
# Debian's Ceres and SuiteSparse name ATLAS, where it is installed, beside the system's BLAS, and would
# run on it: several times slower.
set(BLA_VENDOR Generic)
find_package(Ceres 2.1 REQUIRED)
get_target_property(ceres_links Ceres::ceres INTERFACE_LINK_LIBRARIES)
list(FILTER ceres_links EXCLUDE REGEX "/lib(f77blas|atlas)\\.so$")
set_property(TARGET Ceres::ceres PROPERTY INTERFACE_LINK_LIBRARIES ${ceres_links})
find_package(nlohmann_json 3.11 REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(LibArchive REQUIRED)
find_package(ZLIB REQUIRED)
find_package(BZip2 REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(CURL 7.87 REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(protobuf REQUIRED IMPORTED_TARGET protobuf)
pkg_check_modules(turbojpeg REQUIRED IMPORTED_TARGET libjpeg)
if(PARKADE_VIDEO)
  pkg_check_modules(avcodec REQUIRED IMPORTED_TARGET libavcodec libavutil libswscale)
endif()
pkg_check_modules(geographiclib REQUIRED IMPORTED_TARGET geographiclib)
# The -D flags of Debian's compiled cpp-httplib decide its class layout: only
# pkg-config knows them.
pkg_check_modules(httplib REQUIRED IMPORTED_TARGET cpp-httplib)

# parkade_imported(NAME LIBRARIES a b [INCLUDE header-to-find SUBDIRS dirs])
function(parkade_imported name)
  cmake_parse_arguments(A "" "HEADER" "LIBRARIES;SUBDIRS" ${ARGN})
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  foreach(library ${A_LIBRARIES})
    find_library(${library}_LIBRARY ${library} REQUIRED)
    target_link_libraries(${name} INTERFACE ${${library}_LIBRARY})
  endforeach()
  if(A_HEADER)
    find_path(${name}_INCLUDE ${A_HEADER} PATH_SUFFIXES ${A_SUBDIRS} REQUIRED)
    target_include_directories(${name} SYSTEM INTERFACE ${${name}_INCLUDE})
  endif()
endfunction()

# find_package(PCL) drags VTK and MPI and fails: its VTK-free parts by name.
parkade_imported(Pcl HEADER pcl/point_types.h SUBDIRS pcl-1.13
                 LIBRARIES pcl_common pcl_kdtree pcl_search pcl_octree pcl_sample_consensus
                           pcl_filters pcl_features pcl_segmentation flann_cpp lz4)
parkade_imported(Cholmod HEADER cholmod.h SUBDIRS suitesparse LIBRARIES cholmod)
parkade_imported(Tinygltf HEADER tiny_gltf.h LIBRARIES tinygltf)
parkade_imported(GeoTiff HEADER geotiffio.h SUBDIRS geotiff LIBRARIES geotiff tiffxx tiff)
parkade_imported(Draco HEADER draco/compression/encode.h LIBRARIES draco)
parkade_imported(Pugixml HEADER pugixml.hpp LIBRARIES pugixml)
parkade_imported(Fastcdr HEADER fastcdr/Cdr.h LIBRARIES fastcdr)
parkade_imported(Embree HEADER embree3/rtcore.h LIBRARIES embree3)

# CGAL's own config adds flags to every target; headers and GMP/MPFR are enough.
parkade_imported(Cgal HEADER CGAL/version.h LIBRARIES gmp mpfr)
target_compile_definitions(Cgal INTERFACE CGAL_NDEBUG)

# parkade_header_version(NAME FILE TEXT): NAME_VERSION, of what has it in a header alone, behind TEXT.
function(parkade_header_version name file text)
  file(STRINGS ${${name}_INCLUDE}/${file} line REGEX "${text}[^0-9]*[0-9.]+" LIMIT_COUNT 1)
  string(REGEX REPLACE ".*${text}[^0-9]*([0-9.]+).*" "\\1" version "${line}")
  set(${name}_VERSION ${version} PARENT_SCOPE)
endfunction()
parkade_header_version(Pcl pcl/pcl_config.h PCL_VERSION_PRETTY)
parkade_header_version(Cgal CGAL/version.h "define CGAL_VERSION ")
parkade_header_version(Draco draco/core/draco_version.h "kDracoVersion")
