/* SPDX-License-Identifier: Apache-2.0 */
/* starguard verify: checks results independently of the code that made them. */
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "model.h"
#include "report.h"
#include "scene.h"
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
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        cli_say(session, "  not checked: %s\n", verdict->not_checked[i].text);
}

/* Reports a verdict and adds it to the results; takes over `result`, the keys specific to its
 * kind. */
static void tell_verdict(cli_session *session, const char *file, const starg_verdict *verdict,
                         json_t *result, json_t *results) {
    cli_say(session, "%s\n", file);
    tell_claims(session, verdict);
    cli_say(session, "  %s\n", verdict->passed ? "verified" : "NOT verified");
    json_t *claims = json_array();
    for (size_t i = 0; i < verdict->count; i++)
        cli_append(session, claims,
                   json_pack("{s:o, s:b}", "claim", cli_json_text(verdict->claims[i].text), "holds",
                             (int)verdict->claims[i].holds));
    json_t *unchecked = json_array();
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        cli_append(session, unchecked, cli_json_text(verdict->not_checked[i].text));
    cli_put(session, result, "file", cli_json_text(file));
    cli_put(session, result, "passed", json_boolean(verdict->passed));
    cli_put(session, result, "claims", claims);
    cli_put(session, result, "not_checked", unchecked);
    cli_append(session, results, result);
    if (!verdict->passed)
        session->outcome = CLI_EXIT_FAILED;
}

/* ---- input ---- */

/* The model: a surface, or a tetrahedral mesh. */
typedef struct model {
    starg_mesh *mesh; /* of a tetrahedral mesh: its boundary */
    starg_tetmesh *tetmesh;
} model;

static starg_status read_model(cli_session *session, model *out) {
    starg_status status = cli_shape_read(session, session->operands[0], &out->mesh, &out->tetmesh);
    if (status == STARG_OK && out->tetmesh != NULL)
        status = starg_tetmesh_surface(session->context, out->tetmesh, &out->mesh, NULL);
    return status;
}

/* Reads all results before verifying the first, so that a bad name is reported at once. */
static starg_status read_results(cli_session *session, starg_result **results) {
    starg_status status = STARG_OK;
    size_t last = session->operand_count - 1;
    CLI_TRY(starg_result_read(session->context, session->operands[last], &results[last]));
    if (results[last]->solid_map != NULL)
        goto done; /* before it stand models */
    for (size_t i = 1; i < last; i++)
        CLI_TRY(starg_result_read(session->context, session->operands[i], &results[i]));
done:
    return status;
}

/* A certificate must follow the guards or pieces that it belongs to. */
static starg_status check_certificates(cli_session *session, starg_result *const *results) {
    for (size_t i = 1; i < session->operand_count; i++)
        if (results[i]->certificate != NULL && (i == 1 || results[i - 1]->certificate != NULL))
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "'%.200s' is a certificate; it belongs behind its GUARDS.json, or "
                            "behind PIECES.json and PIECES.vtk",
                            session->operands[i]);
    return STARG_OK;
}

/* The certificate directly behind an operand, or 0. */
static size_t certificate_behind(const cli_session *session, starg_result *const *results,
                                 size_t operand) {
    bool certified = operand != 0 && operand + 1 < session->operand_count &&
                     results[operand + 1]->certificate != NULL;
    return certified ? operand + 1 : 0;
}

/* The files of a decomposition: operand numbers, 0 if missing. */
typedef struct decomposition {
    size_t pieces, report, certificate;
} decomposition;

static starg_status find_decomposition(cli_session *session, starg_result *const *results,
                                       decomposition *found) {
    *found = (decomposition){0};
    for (size_t i = 1; i < session->operand_count; i++) {
        size_t *place = results[i]->pieces != NULL   ? &found->pieces
                        : results[i]->report != NULL ? &found->report
                                                     : NULL;
        if (place == NULL)
            continue;
        if (*place != 0)
            return cli_fail(
                session, STARG_ERROR_ARGUMENT,
                "'%.200s' and '%.200s' belong to two decompositions; verify them separately",
                session->operands[*place], session->operands[i]);
        *place = i;
    }
    const size_t behind[2] = {certificate_behind(session, results, found->pieces),
                              certificate_behind(session, results, found->report)};
    found->certificate = behind[0] != 0 ? behind[0] : behind[1];
    if (found->certificate != 0 && found->report == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "'%.200s' is a certificate of the bound in PIECES.json, which is missing",
                        session->operands[found->certificate]);
    if (found->report != 0 && found->pieces == 0)
        return cli_fail(session, STARG_ERROR_READ,
                        "'%.200s' is a report without tetrahedra; add its PIECES.vtk",
                        session->operands[found->report]);
    if (found->pieces != 0 && found->report == 0)
        cli_warn(
            session,
            "'%.200s' has no PIECES.json: checking only its tetrahedra, not guards and numbers",
            session->operands[found->pieces]);
    return STARG_OK;
}

/* ---- verification ---- */

/* A certificate directly follows its guards. */
static starg_status verify_guards(cli_session *session, const model *given, size_t operand,
                                  starg_result *const *results, json_t *list) {
    starg_status status = STARG_OK;
    starg_verdict *verdict = NULL;
    starg_mesh **obstacles = NULL;
    const starg_guards *guards = results[operand]->guards;
    size_t behind = certificate_behind(session, results, operand);
    CLI_TRY(cli_scene_read_obstacles(session, guards, &obstacles));
    const starg_guards_evidence evidence = {.obstacles = (const starg_mesh *const *)obstacles,
                                            .obstacle_count = guards->obstacle_count,
                                            .certificate =
                                                behind != 0 ? results[behind]->certificate : NULL};
    CLI_TRY(starg_verify_guards_with(session->context, given->mesh, &evidence, guards, &verdict));
    json_t *entry = json_object();
    if (behind != 0)
        cli_put(session, entry, "certificate", cli_json_text(session->operands[behind]));
    tell_verdict(session, session->operands[operand], verdict, entry, list);
done:
    cli_scene_free_obstacles(obstacles, guards->obstacle_count);
    starg_verdict_free(session->context, verdict);
    return status;
}

static starg_status verify_pieces(cli_session *session, const model *given, decomposition found,
                                  starg_result *const *results, json_t *list) {
    starg_verdict *verdict = NULL;
    const starg_pieces_mesh *pieces = results[found.pieces]->pieces;
    const starg_pieces_report *report = found.report != 0 ? results[found.report]->report : NULL;
    const starg_certificate *why =
        found.certificate != 0 ? results[found.certificate]->certificate : NULL;
    if (given->tetmesh != NULL && why != NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "'%.200s' is a certificate, and such are of surfaces; '%.200s' is a "
                        "tetrahedral mesh",
                        session->operands[found.certificate], session->operands[0]);
    starg_status status = given->tetmesh != NULL
                              ? starg_verify_pieces_of_tetmesh(session->context, given->tetmesh,
                                                               pieces, report, &verdict)
                              : starg_verify_pieces_with(session->context, given->mesh, why, pieces,
                                                         report, &verdict);
    if (status != STARG_OK)
        return status;
    json_t *entry = json_object();
    if (why != NULL)
        cli_put(session, entry, "certificate", cli_json_text(session->operands[found.certificate]));
    cli_put(session, entry, "tetrahedra", json_integer((json_int_t)pieces->count));
    if (report != NULL) {
        cli_put(session, entry, "report", cli_json_text(session->operands[found.report]));
        cli_put(session, entry, "pieces", json_integer((json_int_t)report->piece_count));
        cli_put(session, entry, "strictly_star", json_integer((json_int_t)report->strictly_star));
    }
    tell_verdict(session, session->operands[found.pieces], verdict, entry, list);
    starg_verdict_free(session->context, verdict);
    return STARG_OK;
}

/* Of the operands A, B and MAP.vtu; or A and MAP.vtu. */
static starg_status verify_solid_map(cli_session *session, const model *given,
                                     const starg_solid_map *map, json_t *list) {
    starg_status status = STARG_OK;
    starg_mesh *target = NULL;
    starg_verdict *verdict = NULL;
    size_t last = session->operand_count - 1;
    if (last > 2)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "'%.200s' is a map between solids; give A, B and the map",
                        session->operands[last]);
    if (last == 2)
        CLI_TRY(starg_mesh_read(session->context, session->operands[1], &target));
    CLI_TRY(starg_verify_solid_map(session->context, given->mesh, target, map, &verdict));
    json_t *entry = json_object();
    if (target != NULL)
        cli_put(session, entry, "target", cli_json_text(session->operands[1]));
    cli_put(session, entry, "tetrahedra", json_integer((json_int_t)map->count));
    cli_put(session, entry, "pieces", json_integer((json_int_t)map->piece_count));
    tell_verdict(session, session->operands[last], verdict, entry, list);
done:
    starg_verdict_free(session->context, verdict);
    starg_mesh_free(target);
    return status;
}

static starg_status verify_all(cli_session *session, const model *given,
                               starg_result *const *results, json_t *list) {
    starg_status status = STARG_OK;
    decomposition found;
    const starg_solid_map *map = results[session->operand_count - 1]->solid_map;
    if (map != NULL)
        return verify_solid_map(session, given, map, list);
    for (size_t i = 1; i < session->operand_count; i++)
        if (results[i]->solid_map != NULL)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "'%.200s' is a map between solids; it belongs last, behind A and B",
                            session->operands[i]);
    CLI_TRY(check_certificates(session, results));
    CLI_TRY(find_decomposition(session, results, &found));
    for (size_t i = 1; i < session->operand_count; i++) {
        if (results[i]->guards != NULL)
            CLI_TRY(verify_guards(session, given, i, results, list));
        else if (i == found.pieces)
            CLI_TRY(verify_pieces(session, given, found, results, list));
    }
done:
    return status;
}

static void report(cli_session *session, const starg_mesh *mesh, json_t *results) {
    cli_report_head(session, "starguard-verify", session->operands[0], mesh);
    cli_put(session, session->report, "passed", json_boolean(session->outcome == CLI_EXIT_DONE));
    cli_put(session, session->report, "results", json_incref(results));
}

static starg_status run(cli_session *session, void *data) {
    (void)data;
    starg_status status = STARG_OK;
    model given = {0};
    json_t *list = json_array();
    starg_result **results = calloc(session->operand_count, sizeof(starg_result *));
    if (results == NULL || list == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    CLI_TRY(read_model(session, &given));
    CLI_TRY(read_results(session, results));
    CLI_TRY(verify_all(session, &given, results, list));
    if (session->report != NULL)
        report(session, given.mesh, list);
done:
    for (size_t i = 1; results != NULL && i < session->operand_count; i++)
        starg_result_free(session->context, results[i]);
    free(results);
    json_decref(list);
    starg_mesh_free(given.mesh);
    starg_tetmesh_free(given.tetmesh);
    return status;
}

const cli_command cli_command_verify = {
    .name = "verify",
    .usage = "MODEL RESULT... [options]",
    .summary = "check results independently",
    .description =
        "Checks the claims of result files with independent geometry and exact signs; "
        "only the readers of the model and of GUARDS.json are shared with the solver. "
        "Files are recognized by content. Exit status 4 if a claim is false.\n"
        "GUARDS.json of 'starguard guard': every guard is inside and sees as many faces "
        "as stated; coverage, uncovered faces, counts and bounds are right. Claims about "
        "candidates are refuted by counterexamples; otherwise they are listed as not "
        "checked. With the certificate of 'starguard guard --prove --certificate' behind it, the "
        "bound for guards anywhere is checked as well: every reason, and every sum.\n"
        "PIECES.vtk and PIECES.json of 'starguard decompose', in any order: tetrahedra "
        "are positive, conforming and labelled, fill the model and do not overlap; each "
        "piece is connected, has the stated size and contacts, and is star-shaped about "
        "its guard where this is stated. MODEL may also be a tetrahedral mesh. For "
        "PIECES.vtk alone, guards are not checked. With the certificate of 'starguard decompose "
        "--prove --certificate' behind them, it is checked that no fewer pieces are possible.\n"
        "MAP.vtu of 'starguard map --solid', behind A and B: tetrahedra are positive in both and "
        "fill "
        "both, pieces are star-shaped in both, and no tetrahedron of a morph is ever inverted.",
    .examples = "# check one result\n"
                "starguard verify model.off guards.json\n"
                "# and that no fewer guards would do, wherever they stand\n"
                "starguard guard model.off --prove --certificate why.txt -o guards.json\n"
                "starguard verify model.off guards.json why.txt\n"
                "# several at once, for a script\n"
                "starguard verify model.off ilp.json greedy.json --quiet && echo verified\n"
                "# a star decomposition\n"
                "starguard verify model.off pieces.json pieces.vtk\n"
                "# a map between two solids\n"
                "starguard verify a.off b.off map.vtu",
    CLI_OPERANDS(2, SIZE_MAX),
    .run = run,
};
