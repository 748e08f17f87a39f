# The Debian package,
#   cmake --build --preset release --target package
# parkade_<version>_amd64.deb in the build folder: what is installed, and what maintainer scripts do (packaging/debian). The
# libraries that it depends on are read from the program.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The authors of Parkade <parkade@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Mapping server for automated valet parking")
set(CPACK_PACKAGE_DESCRIPTION "Takes logs of drives through car parks and makes maps of them: free
space, heights, parking slots and a textured mesh, with a viewer in the
browser, and as files for other programs.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/DebianPackageCheck.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Debian's Ceres would otherwise run on ATLAS, which is several times slower.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "adduser, libopenblas0-pthread")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS nginx)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(scripts ${PROJECT_SOURCE_DIR}/packaging/debian)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm ${scripts}/postrm ${scripts}/conffiles)

# Debian wants its own kind of changelog, and that it is packed.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${PROJECT_BINARY_DIR}/changelog "parkade (${PROJECT_VERSION}) unstable; urgency=medium

  * What is new stands in the CHANGELOG.md of the source.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/changelog)

set(documents share/doc/parkade)
install(FILES README.md docs/operate.md docs/service.md packaging/copyright ${PROJECT_BINARY_DIR}/changelog.gz
        DESTINATION ${documents})
install(FILES packaging/nginx.conf DESTINATION ${documents}/examples)
install(FILES packaging/parkade.default DESTINATION /etc/default RENAME parkade)

include(CPack)
