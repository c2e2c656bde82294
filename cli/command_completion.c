/* SPDX-License-Identifier: Apache-2.0 */
/* starguard completion: prints shell completion scripts. */
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "completion.h"
#include "report.h"

static const char *const shells[] = {[CLI_BASH] = "bash", [CLI_ZSH] = "zsh", [CLI_FISH] = "fish"};
enum { SHELLS = sizeof shells / sizeof *shells };

static const char *shell_word(size_t index) {
    return index < SHELLS ? shells[index] : NULL;
}

static starg_status run(cli_session *session, void *values) {
    (void)values;
    const char *word = session->operands[0];
    char *script = NULL;
    size_t shell = 0, size;
    while (shell < SHELLS && strcmp(word, shells[shell]) != 0)
        shell++;
    if (shell == SHELLS)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "completion supports bash, zsh and fish, not '%.100s'", word);
    FILE *stream = open_memstream(&script, &size);
    if (stream == NULL)
        return cli_fail_memory(session);
    cli_completion_write(stream, (cli_shell)shell);
    bool complete = fclose(stream) == 0;
    if (complete && session->report != NULL) {
        cli_report_head(session, "starguard-completion", NULL, NULL);
        cli_put(session, session->report, "shell", json_string(word));
        cli_put(session, session->report, "script", json_string(script));
    } else if (complete) {
        session->stdout_taken = true;
        fputs(script, stdout);
    }
    free(script);
    return complete ? STARG_OK : cli_fail_memory(session);
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
