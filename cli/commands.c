#include "commands.h"

#include <string.h>

const cli_command *const cli_commands[] = {
    &cli_command_sample,  &cli_command_check,
    &cli_command_repair,  &cli_command_skeleton,
    &cli_command_visible, &cli_command_kernel,
    &cli_command_guard,   &cli_command_decompose,
    &cli_command_verify,  NULL,
};

const cli_command *cli_command_find(const char *name) {
    for (size_t i = 0; cli_commands[i] != NULL; i++)
        if (strcmp(cli_commands[i]->name, name) == 0)
            return cli_commands[i];
    return NULL;
}
