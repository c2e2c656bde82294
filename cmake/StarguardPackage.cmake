# The Debian package: `cpack -G DEB` in a build configured with -DCMAKE_INSTALL_PREFIX=/usr.
# One package holds all: who builds it wants the program, and the library with it. What it depends on
# is what its binaries are linked with; the development files that the static library asks for are
# suggested only.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME starguard)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The starguard maintainers <maintainers@starguard.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "fewest guards inside a 3D solid, and star-shaped pieces")
set(CPACK_PACKAGE_DESCRIPTION
"Places the fewest guards inside a closed triangle mesh that together see its
whole boundary, with exact visibility and a proven bound; cuts solids into few
star-shaped pieces; compares and morphs shapes by both. Program, C library,
manual pages, completion for shells and documentation.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS tetgen)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "coinor-libcbc-dev, libjansson-dev, libsqlite3-dev, \
libarpack2-dev, libsuitesparse-dev, zlib1g-dev")
include(CPack)
