#include "commands.h"

#include <string.h>

const cli_command *const cli_commands[] = {
    &cli_command_sample,   &cli_command_check,      &cli_command_repair,
    &cli_command_skeleton, &cli_command_visible,    &cli_command_kernel,
    &cli_command_guard,    &cli_command_decompose,  &cli_command_describe,
    &cli_command_match,    &cli_command_verify,     &cli_command_map,
    &cli_command_morph,    &cli_command_db,         &cli_command_view,
    &cli_command_export,   &cli_command_completion, NULL,
};

const char *cli_command_word(const cli_command *command) {
    const char *space = strrchr(command->name, ' ');
    return space != NULL ? space + 1 : command->name;
}

const cli_command *cli_command_find(const cli_command *const *table, const char *word) {
    for (size_t i = 0; table[i] != NULL; i++)
        if (strcmp(cli_command_word(table[i]), word) == 0)
            return table[i];
    return NULL;
}
