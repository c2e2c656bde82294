/* SPDX-License-Identifier: Apache-2.0 */
/* starguard kernel: decides whether a solid is star-shaped, and finds its kernel. */
#include "commands.h"
#include "starguard/kernel.h"

static const char *const verdict_words[] = {
    [STARG_KERNEL_INTERIOR] = "interior",
    [STARG_KERNEL_EMPTY] = "empty",
    [STARG_KERNEL_UNDECIDED] = "undecided",
};

static void tell(cli_session *session, const starg_kernel_result *result) {
    switch (result->verdict) {
    case STARG_KERNEL_INTERIOR:
        cli_say(session, "star-shaped: one point sees all of it (proven)\n");
        cli_say(session, "guard   %.17g,%.17g,%.17g\n", result->guard[0], result->guard[1],
                result->guard[2]);
        cli_say(session, "radius  %.6g  of the largest ball in the kernel\n", result->radius);
        break;
    case STARG_KERNEL_EMPTY:
        cli_say(session, "not star-shaped: no point sees all of it (proven)\n");
        if (result->witness_count == 0)
            cli_say(session, "the surface winds more than once around every point that is on the "
                             "inner side of all faces\n");
        else
            cli_say(session, "no point is strictly on the inner side of all these faces:");
        for (size_t i = 0; i < result->witness_count; i++)
            cli_say(session, " %lu", (unsigned long)result->witness[i]);
        if (result->witness_count > 0)
            cli_say(session, "\n");
        break;
    case STARG_KERNEL_UNDECIDED:
        cli_say(session, "undecided: the kernel is empty or as small as rounding errors\n");
        break;
    }
}

static void report(cli_session *session, const starg_kernel_result *result) {
    bool decided = result->verdict != STARG_KERNEL_UNDECIDED;
    bool star = result->verdict == STARG_KERNEL_INTERIOR;
    cli_put(session, session->report, "verdict", json_string(verdict_words[result->verdict]));
    cli_put(session, session->report, "star", decided ? json_boolean(star) : json_null());
    cli_put(session, session->report, "guard", star ? cli_json_point(result->guard) : json_null());
    cli_put(session, session->report, "radius", cli_json_real(result->radius));
    cli_put(session, session->report, "witness",
            cli_json_indices(session, result->witness, result->witness_count));
}

static starg_status run(cli_session *session, void *data) {
    (void)data;
    starg_kernel_result result;
    TRY(starg_kernel(session->context, starg_solid_mesh(session->solid), NULL, &result));
    tell(session, &result);
    if (session->report != NULL)
        report(session, &result);
    return STARG_OK;
}

const cli_command cli_command_kernel = {
    .name = "kernel",
    .usage = "MODEL [options]",
    .summary = "test whether a solid is star-shaped and find its kernel",
    .description = "Computes the kernel of a solid (the set of points that see all of it) and the "
                   "largest ball inside it. Exact arithmetic proves either answer: the solid is "
                   "star-shaped if a guard is strictly on the inner side of every face, and not "
                   "star-shaped if up to four faces have no point strictly on the inner side of "
                   "all of them. Exit status 0 in both cases.",
    .examples = "# test a model\n"
                "starguard kernel model.off\n"
                "# print the guard, for a script\n"
                "starguard kernel model.off --json | jq .guard",
    CLI_OPERANDS(1, 1),
    .input = CLI_INPUT_SOLID,
    .run = run,
};
