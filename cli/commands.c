/* SPDX-License-Identifier: Apache-2.0 */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
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

void cli_command_default(const cli_command *command, void *values) {
    cli_group groups[CLI_GROUPS];
    cli_command_groups(command, values, NULL, groups);
    cli_options_default(&groups[CLI_OWN]);
    cli_options_default(&groups[CLI_FROM_LIBRARY]);
}

starg_status cli_command_print(cli_session *session, const cli_command *command, void *values,
                               uint64_t seed, const char *model, const char *output, char **line) {
    cli_common common = {0};
    cli_group groups[CLI_GROUPS];
    size_t size;
    FILE *stream = open_memstream(line, &size);
    if (stream == NULL)
        return cli_fail_memory(session);
    cli_command_groups(command, values, &common, groups);
    cli_options_default(&groups[CLI_COMMON]);
    common.seed = seed;
    fprintf(stream, "starguard %s ", command->name);
    cli_word_print(model != NULL ? model : "MODEL", stream);
    fputs(" -o ", stream);
    cli_word_print(output, stream);
    for (int i = 0; i < CLI_GROUPS; i++)
        cli_options_print(&groups[i], stream);
    return fclose(stream) == 0 ? STARG_OK : cli_fail_memory(session);
}
