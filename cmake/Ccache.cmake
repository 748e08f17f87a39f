# ccache where present. Precompiled headers need the two pch settings; see ccache's manual, "Precompiled headers".
# Paths below the checkout are hashed as relative ones and the folder itself not at all: a clean checkout elsewhere
# finds what was built here.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1
      ${CCACHE_PROGRAM})
  add_compile_options(-fpch-preprocess)
endif()
