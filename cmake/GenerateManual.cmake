# SPDX-License-Identifier: Apache-2.0
# Has the program write its manual pages and completion scripts.
# Usage: cmake -DPROGRAM=... -DOUTPUT=FOLDER -P GenerateManual.cmake
file(REMOVE_RECURSE ${OUTPUT})
file(MAKE_DIRECTORY ${OUTPUT}/man1)

function(write file)
    execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_FILE ${OUTPUT}/${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

execute_process(COMMAND ${PROGRAM} help --json OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
string(JSON count LENGTH ${table} commands)
math(EXPR last "${count} - 1")
write(man1/starguard.1 help --man)
foreach(index RANGE ${last})
    string(JSON name GET ${table} commands ${index} name)
    string(REPLACE " " "-" page ${name})
    separate_arguments(words UNIX_COMMAND ${name})
    write(man1/starguard-${page}.1 help --man ${words})
endforeach()

# Under the names by which each shell finds them.
write(starguard completion bash)
write(_starguard completion zsh)
write(starguard.fish completion fish)
