# The viewer of pages: Node.js and npm bundle the sources in viewer/ into one text, which becomes a C
# file. Packages are fetched when CMake runs, into the build directory; a build that cannot have
# them goes on without the viewer, and `starguard view` says so.
#
# Sets STARGUARD_VIEWER_SOURCE to the C file to compile, STARGUARD_NODE to node if it was found.
option(STARGUARD_VIEWER "bundle the viewer (needs Node.js and npm, and fetches packages)" ON)

set(viewer ${PROJECT_SOURCE_DIR}/viewer)
set(STARGUARD_VIEWER_MODULES ${PROJECT_BINARY_DIR}/viewer)
set(STARGUARD_VIEWER_SOURCE ${PROJECT_SOURCE_DIR}/src/export/viewer_missing.c)
set(missing "")

# Leaves the packages of the lock file in the build directory; once for each lock file.
function(starguard_fetch_packages)
    file(SHA256 ${viewer}/package-lock.json wanted)
    set(stamp ${STARGUARD_VIEWER_MODULES}/fetched)
    set(fetched "")
    if(EXISTS ${stamp})
        file(READ ${stamp} fetched)
    endif()
    if(fetched STREQUAL wanted)
        return()
    endif()
    message(STATUS "Fetching the packages of the viewer")
    file(COPY ${viewer}/package.json ${viewer}/package-lock.json
        DESTINATION ${STARGUARD_VIEWER_MODULES})
    execute_process(
        COMMAND ${STARGUARD_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
            --loglevel=error --fetch-retries=1
        WORKING_DIRECTORY ${STARGUARD_VIEWER_MODULES} TIMEOUT 300
        RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE complaint)
    if(result EQUAL 0)
        file(WRITE ${stamp} ${wanted})
    else()
        string(REGEX REPLACE "\n.*" "" complaint "${complaint}")
        set(missing "npm could not fetch packages: ${complaint}" PARENT_SCOPE)
    endif()
endfunction()

if(STARGUARD_VIEWER)
    find_program(STARGUARD_NODE NAMES node nodejs)
    find_program(STARGUARD_NPM NAMES npm)
    if(STARGUARD_NODE AND STARGUARD_NPM)
        starguard_fetch_packages()
    else()
        set(missing "Node.js or npm is not installed")
    endif()
    if(missing)
        message(WARNING "The build has no viewer, and 'starguard view' will say so: ${missing}")
    else()
        set(STARGUARD_VIEWER_SOURCE ${PROJECT_BINARY_DIR}/viewer/viewer.c)
        file(GLOB viewer_sources CONFIGURE_DEPENDS
            ${viewer}/*.js ${viewer}/*.mjs ${viewer}/*.css ${viewer}/*.html)
        add_custom_command(OUTPUT ${STARGUARD_VIEWER_SOURCE}
            COMMAND ${STARGUARD_NODE} ${viewer}/build.mjs ${STARGUARD_VIEWER_MODULES}
                ${STARGUARD_VIEWER_SOURCE}
            DEPENDS ${viewer_sources} ${viewer}/package-lock.json
            COMMENT "Bundling the viewer" VERBATIM)
    endif()
endif()
