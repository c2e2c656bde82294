# SPDX-License-Identifier: Apache-2.0
# The Debian packages: `cpack -G DEB` in a build configured with -DCMAKE_INSTALL_PREFIX=/usr.
#   starguard             the program, its manual and completion, documentation
#   libstarguard          the shared library
#   libstarguard-shapes   the shared library of descriptors, databases, maps and morphs
#   libstarguard-dev      headers, static libraries, what CMake and pkg-config ask for
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME starguard)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The starguard maintainers <maintainers@starguard.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program starguard shapes development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(same "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME starguard)
set(CPACK_DEBIAN_STARGUARD_PACKAGE_NAME libstarguard)
set(CPACK_DEBIAN_SHAPES_PACKAGE_NAME libstarguard-shapes)
set(CPACK_DEBIAN_SHAPES_PACKAGE_DEPENDS "libstarguard ${same}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libstarguard-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libstarguard ${same}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libstarguard-shapes ${same}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "coinor-libcbc-dev, libjansson-dev, libsqlite3-dev, \
libsuitesparse-dev, zlib1g-dev")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "fewest guards inside a 3D solid, and star-shaped pieces
Places the fewest guards inside a closed triangle mesh that together see its
whole boundary, with exact visibility and a proven bound; cuts solids into few
star-shaped pieces; compares and morphs shapes by both.")
set(CPACK_COMPONENT_STARGUARD_DESCRIPTION "fewest guards inside a 3D solid (library)
Guards, exact visibility, skeletons and star-shaped pieces.")
set(CPACK_COMPONENT_SHAPES_DESCRIPTION "comparing and morphing 3D solids (library)
Descriptors, a database of shapes, maps between surfaces, and morphs.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "fewest guards inside a 3D solid (development)
Headers, static libraries, and files for CMake and pkg-config.")
include(CPack)
