/* SPDX-License-Identifier: Apache-2.0 */
/* starguard completion: prints shell completion scripts. tools/manual.py makes them, and the manual
 * pages, from the table of commands; they lie where shells look for them below share/, which is
 * beside the program's folder once it is installed, and inside of it where it is built. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"

static const char *const shells[] = {"bash", "zsh", "fish"};
static const char *const scripts[] = {"bash-completion/completions/starguard",
                                      "zsh/site-functions/_starguard",
                                      "fish/vendor_completions.d/starguard.fish"};
enum { SHELLS = sizeof shells / sizeof *shells };

static const char *shell_word(size_t index) {
    return index < SHELLS ? shells[index] : NULL;
}

/* All of a file as a text on the heap, or NULL. */
static char *read_text(const char *path) {
    char *text = NULL, part[4096];
    size_t size, got;
    FILE *from = fopen(path, "rb"), *to = from != NULL ? open_memstream(&text, &size) : NULL;
    while (to != NULL && (got = fread(part, 1, sizeof part, from)) > 0)
        fwrite(part, 1, got, to);
    const bool whole = to != NULL && !ferror(from) && !ferror(to);
    if (from != NULL)
        fclose(from);
    if (to != NULL && (fclose(to) != 0 || !whole)) {
        free(text);
        text = NULL;
    }
    return text;
}

char *cli_installed_text(const char *name) {
    static const char *const places[] = {"../share", "share"};
    char program[4096], path[5000], *text = NULL;
    ssize_t size = readlink("/proc/self/exe", program, sizeof program - 1);
    while (size > 0 && program[size - 1] != '/')
        size--;
    for (size_t i = 0; size > 0 && i < 2 && text == NULL; i++) {
        snprintf(path, sizeof path, "%.*s%s/%s", (int)size, program, places[i], name);
        text = read_text(path);
    }
    if (text != NULL)
        return text;
    snprintf(path, sizeof path, "%s/%s", STARGUARD_SHARE, name);
    return read_text(path);
}

static starg_status run(cli_session *session, void *values) {
    (void)values;
    const char *word = session->operands[0];
    size_t shell = 0;
    while (shell < SHELLS && strcmp(word, shells[shell]) != 0)
        shell++;
    if (shell == SHELLS)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "completion supports bash, zsh and fish, not '%.100s'", word);
    char *script = cli_installed_text(scripts[shell]);
    if (script == NULL)
        return cli_fail(session, STARG_ERROR_READ, "there is no %s in '%s' or beside this program",
                        scripts[shell], STARGUARD_SHARE);
    if (session->report != NULL) {
        cli_report_head(session, "starguard-completion", NULL, NULL);
        cli_put(session, session->report, "shell", json_string(word));
        cli_put(session, session->report, "script", json_string(script));
    } else {
        session->stdout_taken = true;
        fputs(script, stdout);
    }
    free(script);
    return STARG_OK;
}

const cli_command cli_command_completion = {
    .name = "completion",
    .usage = "bash|zsh|fish",
    .summary = "write a completion script for a shell",
    .description =
        "Writes a script that completes commands, options and their values. An installed starguard "
        "needs it only for shells that do not search the installation folder.",
    .examples = "# in the current bash\n"
                "source <(starguard completion bash)\n"
                "# in every fish session\n"
                "starguard completion fish > ~/.config/fish/completions/starguard.fish",
    CLI_OPERANDS(1, 1),
    .operand_word = shell_word,
    .run = run,
};
