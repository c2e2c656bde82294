/* SPDX-License-Identifier: Apache-2.0 */
#include "commands.h"

#include <string.h>

const cli_command *const cli_commands[] = {
    &cli_command_sample,   &cli_command_check,  &cli_command_repair,     &cli_command_skeleton,
    &cli_command_visible,  &cli_command_kernel, &cli_command_guard,      &cli_command_decompose,
#ifndef STARGUARD_WITHOUT_SHAPES /* what the library starguard-shapes does */
    &cli_command_describe, &cli_command_match,
#endif
    &cli_command_verify,
#ifndef STARGUARD_WITHOUT_SHAPES
    &cli_command_map,      &cli_command_morph,  &cli_command_db,
#endif
    &cli_command_view,     &cli_command_export, &cli_command_completion, NULL,
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

const cli_option *cli_command_option(const cli_command *command, size_t index) {
    cli_group groups[CLI_GROUPS];
    int first = command != NULL ? CLI_OWN : CLI_COMMON;
    int last = command != NULL ? CLI_FROM_LIBRARY : CLI_COMMON;
    cli_command_groups(command != NULL ? command : &(const cli_command){0}, NULL, NULL, groups);
    for (int g = first; g <= last; g++)
        for (size_t i = 0; i < groups[g].count; i++)
            if (groups[g].options[i].option != NULL && index-- == 0)
                return &groups[g].options[i];
    return NULL;
}

void cli_command_groups(const cli_command *command, void *values, void *common,
                        cli_group groups[CLI_GROUPS]) {
    groups[CLI_OWN] = (cli_group){command->options, command->option_count, values};
    groups[CLI_FROM_LIBRARY] = (cli_group){0};
    if (command->library != NULL)
        groups[CLI_FROM_LIBRARY] =
            (cli_group){command->library()->fields, command->library()->count,
                        values != NULL ? (char *)values + command->library_offset : NULL};
    groups[CLI_COMMON] = (cli_group){cli_common_options, cli_common_option_count, common};
}
