# SPDX-License-Identifier: Apache-2.0
# Documentation that is made while building, in ${STARGUARD_DOCS}: schemas and tables of the field
# tables, the C reference of the headers, the Python reference of the docstrings. It is installed among
# docs/. A cross build cannot run what it has built, and a sanitizer's run time is not in Python.
set(STARGUARD_DOCS ${PROJECT_BINARY_DIR}/docs)
file(MAKE_DIRECTORY ${STARGUARD_DOCS}/schema)
if(CMAKE_CROSSCOMPILING)
    return()
endif()

set(made ${STARGUARD_DOCS}/fields.md)
add_custom_command(OUTPUT ${STARGUARD_DOCS}/fields.md VERBATIM
    COMMAND starguard_fields schemas ${STARGUARD_DOCS}/schema
    COMMAND starguard_fields page ${STARGUARD_DOCS}/fields.md
    DEPENDS starguard_fields)
if(STARGUARD_PYTHON)
    file(GLOB headers CONFIGURE_DEPENDS include/starguard/*.h)
    list(APPEND made ${STARGUARD_DOCS}/c-api.md)
    add_custom_command(OUTPUT ${STARGUARD_DOCS}/c-api.md VERBATIM
        COMMAND ${STARGUARD_PYTHON} -B ${PROJECT_SOURCE_DIR}/scripts/c-api.py ${STARGUARD_DOCS}/c-api.md
        DEPENDS scripts/c-api.py ${headers})
endif()
if(STARGUARD_PYTHON_RUNS AND NOT STARGUARD_SANITIZE AND NOT STARGUARD_FUZZ)
    list(APPEND made ${STARGUARD_DOCS}/python-api.md)
    add_custom_command(OUTPUT ${STARGUARD_DOCS}/python-api.md VERBATIM
        COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_BINARY_DIR}/python ${STARGUARD_PYTHON} -B
            ${PROJECT_SOURCE_DIR}/python/tools/make_reference.py ${STARGUARD_DOCS}/python-api.md
        DEPENDS python/tools/make_reference.py ${STARGUARD_PYTHON_FILES})
endif()
add_custom_target(starguard_docs ALL DEPENDS ${made})
if(STARGUARD_PYTHON_RUNS)
    add_dependencies(starguard_docs starguard_python)
endif()
install(DIRECTORY ${STARGUARD_DOCS}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT program)
