# What `cmake --install` lays down: libraries and headers, the CMake package (find_package) and the
# pkg-config file. Nothing of it names the prefix, so that an installed tree may be moved.
#
# The CMake package has two parts. starguard::starguard, the shared library, needs nothing but itself;
# starguard::starguard_static (COMPONENTS static) needs the development files of what it links.
# For the same reason the pkg-config file has the libraries under Libs.private, not Requires.private:
# pkg-config insists on the .pc files of the latter even when the shared library is asked for.
include(CMakePackageConfigHelpers)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/starguard DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS starguard_shared EXPORT starguard_shared
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS starguard_static EXPORT starguard_static
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# ---- find_package(starguard) ----

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/starguard)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/starguardConfig.cmake.in
    ${PROJECT_BINARY_DIR}/starguardConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/starguardConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/starguardConfig.cmake
    ${PROJECT_BINARY_DIR}/starguardConfigVersion.cmake DESTINATION ${package_folder})
foreach(kind shared static)
    install(EXPORT starguard_${kind} NAMESPACE starguard:: DESTINATION ${package_folder}
        FILE starguard-${kind}.cmake)
endforeach()

# ---- pkg-config ----

# What the static library links, as linker flags.
set(private_libraries "")
foreach(module JANSSON CBC SQLITE ARPACK)
    foreach(library ${${module}_STATIC_LIBRARIES})
        list(APPEND private_libraries -l${library})
    endforeach()
endforeach()
list(APPEND private_libraries -lldl -lamd -lz -lpthread -lstdc++ -lm)
list(REMOVE_DUPLICATES private_libraries)
list(JOIN private_libraries " " private_libraries)

set(prefix ${CMAKE_INSTALL_PREFIX})
cmake_path(RELATIVE_PATH prefix
    BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig OUTPUT_VARIABLE prefix_from_pkgconfig)
foreach(folder LIBDIR INCLUDEDIR)
    cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_${folder}
        BASE_DIRECTORY ${prefix} OUTPUT_VARIABLE ${folder}_from_prefix)
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/starguard.pc.in ${PROJECT_BINARY_DIR}/starguard.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/starguard.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# ---- documentation ----

install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN benchmarks EXCLUDE)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
