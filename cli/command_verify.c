/* starguard verify: checks results by other means than those that made them. */
#include <stdlib.h>

#include "commands.h"
#include "model.h"
#include "report.h"
#include "starguard/verify.h"
#include "terminal.h"

static void tell_claims(cli_session *session, const starg_verdict *verdict) {
    FILE *stream = stdout;
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        cli_say(session, "  %s%s%s %s\n", cli_style_on(stream, claim->holds ? CLI_GREEN : CLI_RED),
                claim->holds ? "ok    " : "FAILED", cli_style_off(stream), claim->text);
        if (!claim->holds && session->common.quiet)
            cli_warn(session, "FAILED %s", claim->text);
    }
}

static void tell_verdict(cli_session *session, const char *file, const starg_verdict *verdict,
                         json_t *results) {
    cli_say(session, "%s\n", file);
    tell_claims(session, verdict);
    cli_say(session, "  %s\n", verdict->passed ? "verified" : "NOT verified");
    json_t *claims = json_array(), *result = json_object();
    for (size_t i = 0; i < verdict->count; i++)
        cli_append(session, claims,
                   json_pack("{s:o, s:b}", "claim", cli_json_text(verdict->claims[i].text), "holds",
                             (int)verdict->claims[i].holds));
    cli_put(session, result, "file", cli_json_text(file));
    cli_put(session, result, "passed", json_boolean(verdict->passed));
    cli_put(session, result, "claims", claims);
    cli_append(session, results, result);
}

static starg_status verify_one(cli_session *session, const starg_mesh *mesh, const char *file,
                               const starg_guards *guards, json_t *results) {
    starg_verdict *verdict = NULL;
    starg_status status = starg_verify_guards(session->context, mesh, guards, &verdict);
    if (status != STARG_OK)
        return status;
    tell_verdict(session, file, verdict, results);
    if (!verdict->passed)
        session->outcome = CLI_EXIT_FAILED;
    starg_verdict_free(session->context, verdict);
    return STARG_OK;
}

/* All results are read before the first is verified: a bad name shows at once. */
static starg_status read_results(cli_session *session, starg_guards **results) {
    starg_status status = STARG_OK;
    for (size_t i = 1; i < session->operand_count && status == STARG_OK; i++)
        status = starg_guards_read(session->context, session->operands[i], &results[i]);
    return status;
}

static void report(cli_session *session, json_t *results) {
    cli_put(session, session->report, "passed", json_boolean(session->outcome == CLI_EXIT_DONE));
    cli_put(session, session->report, "results", json_incref(results));
}

static starg_status run(cli_session *session, void *data) {
    (void)data;
    starg_status status = STARG_OK;
    json_t *list = json_array();
    starg_guards **results = calloc(session->operand_count, sizeof(starg_guards *));
    if (results == NULL || list == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    CLI_TRY(read_results(session, results));
    for (size_t i = 1; i < session->operand_count; i++)
        CLI_TRY(verify_one(session, session->mesh, session->operands[i], results[i], list));
    if (session->report != NULL)
        report(session, list);
done:
    for (size_t i = 1; results != NULL && i < session->operand_count; i++)
        starg_guards_free(session->context, results[i]);
    free(results);
    json_decref(list);
    return status;
}

const cli_command cli_command_verify = {
    .name = "verify",
    .usage = "MODEL RESULT... [options]",
    .summary = "check results by independent means",
    .description =
        "Reads results of 'starguard guard' and checks what they claim about the model with code "
        "that shares nothing with the code that made them: every guard is inside, sees as many "
        "faces as it says, the coverage and the uncovered faces are right, and counts and bounds "
        "agree. Slow and simple on purpose. Exit status 4 if a claim does not hold.",
    .examples = "# check one result\n"
                "starguard verify model.off guards.json\n"
                "# several at once, for a script\n"
                "starguard verify model.off ilp.json greedy.json --quiet && echo all good",
    CLI_OPERANDS(2, SIZE_MAX),
    .input = CLI_INPUT_MESH,
    .run = run,
};
