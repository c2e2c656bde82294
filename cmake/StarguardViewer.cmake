# SPDX-License-Identifier: Apache-2.0
# The viewer of pages: Node.js and npm bundle the sources in viewer/ into one text, which becomes a C
# file. Packages are fetched when CMake runs, into the build directory; a build that cannot have
# them goes on without the viewer, and `starguard view` says so.
#
# Gives starguard_add_viewer(TARGET), and to the tests STARGUARD_NODE and STARGUARD_VIEWER_MODULES,
# the folder of the packages.
option(STARGUARD_VIEWER "bundle the viewer (needs Node.js and npm, and fetches packages)" ON)
find_program(STARGUARD_NODE NAMES node nodejs)
find_program(STARGUARD_NPM NAMES npm)
set(STARGUARD_VIEWER_MODULES ${PROJECT_BINARY_DIR}/viewer)

# Leaves the packages of the lock file in the build directory, once for each lock file. `reason`
# receives why not.
function(starguard_fetch_packages reason)
    file(SHA256 ${PROJECT_SOURCE_DIR}/viewer/package-lock.json wanted)
    set(stamp ${STARGUARD_VIEWER_MODULES}/fetched)
    set(fetched "")
    if(EXISTS ${stamp})
        file(READ ${stamp} fetched)
    endif()
    if(fetched STREQUAL wanted)
        return()
    endif()
    message(STATUS "Fetching the packages of the viewer")
    file(COPY ${PROJECT_SOURCE_DIR}/viewer/package.json ${PROJECT_SOURCE_DIR}/viewer/package-lock.json
        DESTINATION ${STARGUARD_VIEWER_MODULES})
    execute_process(
        COMMAND ${STARGUARD_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
            --loglevel=error --fetch-retries=1
        WORKING_DIRECTORY ${STARGUARD_VIEWER_MODULES} TIMEOUT 300
        RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE errors)
    if(result EQUAL 0)
        file(WRITE ${stamp} ${wanted})
    else()
        string(REGEX REPLACE "\n.*" "" first "${errors}")
        set(${reason} "npm could not fetch packages: ${first}" PARENT_SCOPE)
    endif()
endfunction()

# Adds the viewer to a target of the calling folder, or what stands in for it.
function(starguard_add_viewer target)
    set(sources ${PROJECT_SOURCE_DIR}/viewer)
    set(bundle ${PROJECT_BINARY_DIR}/viewer/viewer.c)
    set(reason "")
    if(STARGUARD_VIEWER AND STARGUARD_NODE AND STARGUARD_NPM)
        starguard_fetch_packages(reason)
    elseif(STARGUARD_VIEWER)
        set(reason "Node.js or npm is not installed")
    endif()
    if(reason)
        message(WARNING "This build has no viewer, as 'starguard view' will say: ${reason}")
    endif()
    if(reason OR NOT STARGUARD_VIEWER)
        target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/export/viewer_missing.c)
        return()
    endif()
    file(GLOB parts CONFIGURE_DEPENDS
        ${sources}/*.js ${sources}/*.mjs ${sources}/*.css ${sources}/*.html)
    add_custom_command(OUTPUT ${bundle}
        COMMAND ${STARGUARD_NODE} ${sources}/build.mjs ${STARGUARD_VIEWER_MODULES} ${bundle}
        DEPENDS ${parts} ${sources}/package-lock.json
        COMMENT "Bundling the viewer" VERBATIM)
    target_sources(${target} PRIVATE ${bundle})
endfunction()
