/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the command, reads its options, runs it. */
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "session.h"
#include "starguard/version.h"

/* Ends a run that only printed text. */
static int finish_text(void) {
    if (fflush(stdout) == 0 && ferror(stdout) == 0)
        return CLI_EXIT_DONE;
    fputs("starguard: cannot write standard output\n", stderr);
    return CLI_EXIT_UNFINISHED;
}

static int print_version(void) {
    printf("starguard %s\n", starg_version());
    return finish_text();
}

static int reject(const char *kind, const char *word, const char *best) {
    fprintf(stderr, "starguard: unknown %s '%.100s'", kind, word);
    if (best != NULL)
        fprintf(stderr, "; did you mean '%s'?", best);
    fputs("\nTry 'starguard --help'.\n", stderr);
    return CLI_EXIT_USAGE;
}

static int reject_command(const cli_command *const *table, const char *word) {
    cli_suggestion near;
    cli_suggest_begin(&near, word);
    for (size_t i = 0; table[i] != NULL; i++)
        cli_suggest_try(&near, cli_command_word(table[i]));
    if (table == cli_commands)
        cli_suggest_try(&near, "help");
    return reject("command", word, near.best);
}

/* Before a command only options without a command are allowed. */
static int reject_option(const char *word) {
    cli_suggestion near;
    cli_suggest_begin(&near, word);
    cli_suggest_try(&near, "--help");
    cli_suggest_try(&near, "--version");
    const cli_option *o;
    for (size_t i = 0; (o = cli_command_option(NULL, i)) != NULL; i++) {
        if (strncmp(word, "--", 2) == 0 && strcmp(word + 2, o->option) == 0) {
            fprintf(stderr, "starguard: options follow the command: starguard COMMAND %s\n", word);
            return CLI_EXIT_USAGE;
        }
    }
    return reject("option", word, near.best);
}

/* The command named by the words of `help`; NULL for the program. False with an error. */
static bool find_topic(int argc, char **argv, const cli_command **command, int *result) {
    *command = argc > 0 ? cli_command_find(cli_commands, argv[0]) : NULL;
    if (argc == 2 && *command != NULL && (*command)->members != NULL) {
        const cli_command *group = *command;
        *command = cli_command_find(group->members, argv[1]);
        if (*command == NULL)
            *result = reject_command(group->members, argv[1]);
        return *command != NULL;
    }
    if (argc > 1) {
        fputs("starguard help: takes one command\n", stderr);
        *result = CLI_EXIT_USAGE;
        return false;
    }
    if (argc == 0 || *command != NULL || strcmp(argv[0], "help") == 0 ||
        strcmp(argv[0], "--help") == 0)
        return true;
    *result = reject_command(cli_commands, argv[0]);
    return false;
}

static int print_table(int argc) {
    if (argc > 0) {
        fputs("starguard help --json: takes no further argument\n", stderr);
        return CLI_EXIT_USAGE;
    }
    if (!cli_help_json(stdout)) {
        fputs("starguard help: cannot write the table of commands\n", stderr);
        return CLI_EXIT_UNFINISHED;
    }
    return finish_text();
}

/* The manual page of a command, or of the program (NULL): "db add" is in starguard-db-add.1. */
static int print_manual(const cli_command *command) {
    char file[128];
    snprintf(file, sizeof file, "man/man1/starguard%s%s.1", command != NULL ? "-" : "",
             command != NULL ? command->name : "");
    for (char *c = file; *c != '\0'; c++)
        if (*c == ' ')
            *c = '-';
    char *text = cli_installed_text(file);
    if (text == NULL) {
        fprintf(stderr, "starguard help: there is no %s in '%s' or beside this program\n", file,
                STARGUARD_SHARE);
        return CLI_EXIT_INPUT;
    }
    fputs(text, stdout);
    free(text);
    return finish_text();
}

/* Is the last word of `help` a part of the help of the command before? */
static bool is_part(int argc, char **argv, const char *word) {
    const cli_command *command = cli_command_find(cli_commands, argv[0]);
    if (command != NULL && command->members != NULL && argc > 1)
        command = cli_command_find(command->members, argv[1]);
    return command != NULL && cli_help_has_part(command, word);
}

/* help [--man] [COMMAND [PART]], help --json */
static int print_help(int argc, char **argv) {
    const cli_command *command;
    const char *part = argc > 1 ? argv[argc - 1] : NULL;
    int result = CLI_EXIT_DONE;
    if (argc > 0 && strcmp(argv[0], "--json") == 0)
        return print_table(argc - 1);
    bool manual = argc > 0 && strcmp(argv[0], "--man") == 0;
    if (part != NULL && !manual && is_part(argc - 1, argv, part))
        argc--;
    else
        part = NULL;
    if (!find_topic(argc - manual, argv + manual, &command, &result))
        return result;
    if (manual)
        return print_manual(command);
    if (command != NULL)
        cli_help_command(stdout, command, part);
    else
        cli_help_program(stdout);
    return finish_text();
}

static starg_status check_operands(cli_session *session) {
    const cli_command *command = session->command;
    if (session->operand_count < command->least_operands)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "too few arguments; usage: starguard %s %s",
                        command->name, command->usage);
    if (session->operand_count > command->most_operands)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "one argument too many: '%.100s'",
                        session->operands[command->most_operands]);
    return STARG_OK;
}

/* A command line that cannot be parsed may still ask for errors as JSON. */
static bool wants_json(int argc, char **argv) {
    for (int i = 0; i < argc; i++)
        if (strcmp(argv[i], "--json") == 0)
            return true;
    return false;
}

static starg_status parse(cli_session *session, const cli_group *groups, int argc, char **argv) {
    cli_parse_error error;
    bool json = wants_json(argc, argv);
    int operands = cli_options_parse(groups, CLI_GROUPS, argc, argv, &error);
    if (operands < 0) {
        if (json)
            cli_report_begin(session);
        return cli_fail(session, STARG_ERROR_ARGUMENT, "%s", error.text);
    }
    session->operands = argv;
    session->operand_count = (size_t)operands;
    return STARG_OK;
}

/* --help and --version, which need no operands and no run. */
static int print_about(const cli_session *session) {
    const char *part = NULL;
    for (size_t i = 0; i < session->operand_count && part == NULL; i++)
        if (cli_help_has_part(session->command, session->operands[i]))
            part = session->operands[i];
    if (session->common.help)
        cli_help_command(stdout, session->command, part);
    else
        printf("starguard %s\n", starg_version());
    return finish_text();
}

static bool is_word(const cli_option *o, const char *value) {
    size_t size;
    for (const char *at = o->value, *word; (word = cli_option_next_word(&at, &size)) != NULL;)
        if (strlen(value) == size && strncmp(value, word, size) == 0)
            return true;
    return false;
}

static starg_status name_input(cli_session *session, const cli_option *o, const char *value) {
    return value == NULL || is_word(o, value) ? STARG_OK : cli_name_input(session, value);
}

/* Registers all files that the command line names for reading. */
static starg_status name_inputs(cli_session *session, const char *values) {
    const cli_command *command = session->command;
    for (size_t i = 0; i < session->operand_count && command->operand_word == NULL; i++)
        TRY(cli_name_input(session, session->operands[i]));
    for (size_t i = 0; i < command->option_count; i++) {
        const cli_option *o = &command->options[i];
        const void *member = values + o->offset;
        const starg_texts *texts = member;
        if (!(o->flags & STARG_FIELD_INPUT))
            continue;
        if (o->kind == STARG_FIELD_TEXT)
            TRY(name_input(session, o, *(const char *const *)member));
        for (size_t k = 0; o->kind == STARG_FIELD_TEXTS && k < texts->count; k++)
            TRY(name_input(session, o, texts->values[k]));
    }
    return STARG_OK;
}

/* The frame of every command: mistakes are reported before the model is read, and the model's
 * before the work. */
static starg_status perform(cli_session *session, void *values) {
    const cli_command *command = session->command;
    starg_status status = STARG_OK;
    CLI_TRY(check_operands(session));
    CLI_TRY(name_inputs(session, values));
    CLI_TRY(cli_check_extensions(session, values));
    if (command->prepare != NULL)
        CLI_TRY(command->prepare(session, values));
    CLI_TRY(cli_input_read(session));
    CLI_TRY(command->run(session, values));
done:
    if (command->release != NULL)
        command->release(session, values);
    return status;
}

static int run(const cli_command *command, int argc, char **argv) {
    starg_status status = STARG_OK;
    int result = CLI_EXIT_DONE;
    cli_session session;
    cli_group groups[CLI_GROUPS];
    cli_session_init(&session, command);
    void *values = calloc(1, command->values_size + 1);
    if (values == NULL) {
        status = cli_fail_memory(&session);
        goto done;
    }
    cli_command_groups(command, values, &session.common, groups);
    for (int i = 0; i < CLI_GROUPS; i++)
        cli_options_default(&groups[i]);
    CLI_TRY(parse(&session, groups, argc, argv));
    if (session.common.help || session.common.version) {
        result = print_about(&session);
        goto free_values;
    }
    CLI_TRY(cli_session_start(&session));
    CLI_TRY(perform(&session, values));
done:
    result = cli_session_finish(&session, status);
free_values:
    if (values != NULL)
        cli_options_free(&groups[CLI_OWN]);
    free(values);
    return result;
}

/* A command of a group: "db add ...". */
static int run_member(const cli_command *group, int argc, char **argv) {
    const char *word = argc > 0 ? argv[0] : NULL;
    if (word == NULL) {
        cli_help_command(stderr, group, NULL);
        return CLI_EXIT_USAGE;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        cli_help_command(stdout, group, NULL);
        return finish_text();
    }
    if (strcmp(word, "--version") == 0)
        return print_version();
    if (word[0] == '-')
        return reject_option(word);
    const cli_command *member = cli_command_find(group->members, word);
    return member != NULL ? run(member, argc - 1, argv + 1) : reject_command(group->members, word);
}

static int run_program(int argc, char **argv) {
    if (argc < 2) {
        cli_help_short(stderr);
        return CLI_EXIT_USAGE;
    }
    const char *word = argv[1];
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
        return print_help(argc - 2, argv + 2);
    if (strcmp(word, "--version") == 0)
        return print_version();
    const cli_command *command = cli_command_find(cli_commands, word);
    if (command == NULL)
        return word[0] == '-' ? reject_option(word) : reject_command(cli_commands, word);
    if (command->members != NULL)
        return run_member(command, argc - 2, argv + 2);
    return run(command, argc - 2, argv + 2);
}

int main(int argc, char **argv) {
    cli_ranks_begin(&argc, &argv);
    if (cli_ranks() != NULL && cli_ranks()->rank > 0)
        return cli_ranks_serve();
    return cli_ranks_end(run_program(argc, argv));
}
