# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` installs: libraries and headers, the CMake package (find_package) and the
# pkg-config files. None of them names the prefix, so that an installed tree may be moved.
#
# The CMake package: starguard::starguard and starguard::starguard-shapes, the shared libraries, need
# nothing but themselves; starguard::starguard_static (COMPONENTS static) and
# starguard::starguard_shapes_static (COMPONENTS static shapes) need the development files of what
# they link. For the same reason the pkg-config files have the libraries under Libs.private, not
# Requires.private: pkg-config insists on the .pc files of the latter even for shared libraries.
#
# Install components, which become Debian packages: program, starguard, shapes, development.
include(CMakePackageConfigHelpers)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/starguard DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    COMPONENT development)
set(starguard_component starguard)
set(starguard_shapes_component shapes)
foreach(library starguard starguard_shapes)
    install(TARGETS ${library}_shared EXPORT starguard_shared
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${${library}_component}
        NAMELINK_COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    install(TARGETS ${library}_static EXPORT ${library}_static
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()

# ---- find_package(starguard) ----

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/starguard)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/starguardConfig.cmake.in
    ${PROJECT_BINARY_DIR}/starguardConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/starguardConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/starguardConfig.cmake
    ${PROJECT_BINARY_DIR}/starguardConfigVersion.cmake DESTINATION ${package_folder}
    COMPONENT development)
foreach(kind shared static shapes_static)
    install(EXPORT starguard_${kind} NAMESPACE starguard:: DESTINATION ${package_folder}
        FILE starguard-${kind}.cmake COMPONENT development)
endforeach()

# ---- pkg-config ----

set(prefix ${CMAKE_INSTALL_PREFIX})
cmake_path(RELATIVE_PATH prefix
    BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig OUTPUT_VARIABLE prefix_from_pkgconfig)
foreach(folder LIBDIR INCLUDEDIR)
    cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_${folder}
        BASE_DIRECTORY ${prefix} OUTPUT_VARIABLE ${folder}_from_prefix)
endforeach()

# A file for a library: what the static one links are the libraries of some modules and others.
function(starguard_add_pkgconfig name description requires modules)
    set(private_libraries "")
    foreach(module ${modules})
        foreach(library ${${module}_STATIC_LIBRARIES})
            list(APPEND private_libraries -l${library})
        endforeach()
    endforeach()
    list(APPEND private_libraries ${ARGN})
    list(REMOVE_DUPLICATES private_libraries)
    list(JOIN private_libraries " " private_libraries)
    configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/starguard.pc.in
        ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT development)
endfunction()
starguard_add_pkgconfig(starguard "Fewest guards inside a solid, and star-shaped pieces" ""
    "JANSSON;CBC" -lz -lpthread -lstdc++ -lm)
starguard_add_pkgconfig(starguard-shapes "Compares and morphs shapes by guards and star-shaped pieces"
    "starguard = ${PROJECT_VERSION}" "SQLITE" -lldl -lamd -lstdc++ -lm)

# ---- documentation ----

install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program RENAME copyright)
