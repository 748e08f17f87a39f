# Run by CPack before it packs: a package without the viewer is none.
if(NOT EXISTS ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share/parkade/web/index.html)
  message(FATAL_ERROR "the package has no viewer: run scripts/build_web.sh first")
endif()
