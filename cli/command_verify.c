/* SPDX-License-Identifier: Apache-2.0 */
/* starguard verify: checks results independently of the code that made them. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "scene.h"
#include "starguard/verify.h"

typedef struct values {
    bool verbose;
    const char *keep, *table, *summary, *curve; /* beside one GUARDS.json */
} values;

static const cli_option options[] = {
    CLI_FLAG_OPTION("verbose", verbose, "List every claim, and what is not checked of any result."),
    CLI_INPUT_OPTION("keep", keep, "FILE",
                     "Poses that were given to 'guard --keep': they are in the result, first and "
                     "unchanged."),
    CLI_INPUT_OPTION("table", table, "FILE.csv", "Table of 'guard --table', of one GUARDS.json."),
    CLI_INPUT_OPTION("summary", summary, "FILE.csv",
                     "Table of 'guard --summary', of one GUARDS.json."),
    CLI_INPUT_OPTION("curve", curve, "FILE.csv", "Table of 'guard --curve', of one GUARDS.json."),
};

/* How many claims hold; with --verbose each of them, else those that do not. */
static void tell_claims(cli_session *session, const starg_verdict *verdict, bool verbose) {
    FILE *stream = stdout;
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        if (verbose || !claim->holds)
            cli_say(session, "  %s%s%s %s\n",
                    cli_style_on(stream, claim->holds ? CLI_GREEN : CLI_RED),
                    claim->holds ? "ok    " : "FAILED", cli_style_off(stream), claim->text);
        if (!claim->holds && session->common.quiet)
            cli_warn(session, "FAILED %s", claim->text);
    }
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        if (verbose)
            cli_say(session, "  not checked: %s\n", verdict->not_checked[i].text);
}

/* What holds, and what is left open: of results that were made to have it each of it, else how
 * much. */
static void tell_summary(cli_session *session, const starg_verdict *verdict, const char *holds,
                         bool verbose) {
    size_t failed = 0, routine = 0;
    for (size_t i = 0; i < verdict->count; i++)
        failed += !verdict->claims[i].holds;
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        routine += !verdict->not_checked[i].asked;
    if (verdict->passed)
        cli_say(session, "  verified: %s; %zu claims checked\n", holds, verdict->count);
    else
        cli_say(session, "  NOT verified: %zu of %zu claims do not hold\n", failed, verdict->count);
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        if (!verbose && verdict->not_checked[i].asked)
            cli_say(session, "  not checked: %s\n", verdict->not_checked[i].text);
    if (!verbose && routine > 0)
        cli_say(session, "  %s not checked in any such result (--verbose lists %s)\n",
                cli_count_of(routine, "statement is", "statements are").text,
                routine == 1 ? "it" : "them");
}

/* Where verdicts go. */
typedef struct telling {
    json_t *results;
    bool verbose;
    const values *options;
} telling;

/* Reports a verdict and adds it to the results; takes it over, and `result`, the keys specific to
 * its kind. `holds` says what a passed verdict means. */
static void tell_verdict(cli_session *session, const char *file, starg_verdict *verdict,
                         const char *holds, json_t *result, const telling *to) {
    cli_say(session, "%s\n", file);
    tell_claims(session, verdict, to->verbose);
    tell_summary(session, verdict, holds, to->verbose);
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
    cli_append(session, to->results, result);
    if (!verdict->passed)
        session->outcome = CLI_EXIT_FAILED;
    starg_verdict_free(session->context, verdict);
}

/* ---- input ---- */

/* What an operand is, by its beginning: models go first. */
typedef enum operand_kind { SURFACE, TETRAHEDRA, RESULT, UNKNOWN } operand_kind;

static bool has_text(const char *head, const char *text) {
    return strstr(head, text) != NULL;
}

/* A tetrahedral mesh may be either; what cannot be read twice is not looked at. */
static operand_kind kind_of(const char *name) {
    char head[1024] = "";
    struct stat about;
    if (stat(name, &about) != 0)
        return UNKNOWN;
    if (S_ISDIR(about.st_mode))
        return RESULT;
    FILE *file = S_ISREG(about.st_mode) ? fopen(name, "rb") : NULL;
    if (file == NULL)
        return UNKNOWN;
    size_t size = fread(head, 1, sizeof head - 1, file);
    head[size] = '\0';
    fclose(file);
    if (strncmp(head, "starguard-certificate", 21) == 0 ||
        (head[strspn(head, " \t\r\n")] == '{' && has_text(head, "\"starguard-")) ||
        has_text(head, "type=\"UnstructuredGrid\""))
        return RESULT;
    return has_text(head, "DATASET UNSTRUCTURED_GRID") ? TETRAHEDRA : SURFACE;
}

/* Moves the operand `from` to the place `to` before it; those between keep their order. */
static void move_operand(cli_session *session, size_t from, size_t to) {
    char *name = session->operands[from];
    memmove(session->operands + to + 1, session->operands + to,
            (from - to) * sizeof *session->operands);
    session->operands[to] = name;
}

/* If results are given before the model, or before A and B, these are moved to the front. A
 * tetrahedral mesh is the model only where there is no surface. */
static void put_models_first(cli_session *session) {
    size_t count = session->operand_count, models = 0;
    for (size_t i = 0; i < count; i++)
        if (kind_of(session->operands[i]) == UNKNOWN)
            return;
    for (int kind = SURFACE; kind < RESULT && models == 0; kind++)
        for (size_t i = 0; i < count && (kind == SURFACE || models == 0); i++)
            if ((int)kind_of(session->operands[i]) == kind)
                move_operand(session, i, models++);
}

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

/* The frames of a morph, and its report if there is one. */
typedef struct folder {
    starg_mesh **frames;
    size_t count;
    starg_result *report;
} folder;

/* What the operands name, by operand; the first is the model. */
typedef struct inputs {
    starg_result **results; /* NULL: a folder, or B */
    folder *folders;
    starg_mesh *target; /* B, if the results are of two models: the second operand */
} inputs;

static void inputs_free(cli_session *session, inputs *given) {
    for (size_t i = 1; i < session->operand_count; i++) {
        if (given->results != NULL)
            starg_result_free(session->context, given->results[i]);
        folder *own = given->folders != NULL ? &given->folders[i] : NULL;
        for (size_t k = 0; own != NULL && k < own->count; k++)
            starg_mesh_free(own->frames[k]);
        if (own != NULL) {
            starg_result_free(session->context, own->report);
            free(own->frames);
        }
    }
    free(given->results);
    free(given->folders);
    starg_mesh_free(given->target);
}

static bool is_folder(const char *name) {
    struct stat about;
    return stat(name, &about) == 0 && S_ISDIR(about.st_mode);
}

static bool exists(const char *name) {
    struct stat about;
    return stat(name, &about) == 0;
}

/* The name of a file in a folder, to be freed; NULL when out of memory. */
static char *name_in(const char *folder_name, const char *file) {
    size_t size = strlen(folder_name) + strlen(file) + 2;
    char *name = malloc(size);
    if (name != NULL)
        snprintf(name, size, "%s/%s", folder_name, file);
    return name;
}

static starg_status read_frame(cli_session *session, const char *name, folder *out, bool *found) {
    starg_status status = STARG_OK;
    *found = exists(name);
    if (!*found)
        return STARG_OK;
    starg_mesh **longer = realloc(out->frames, (out->count + 1) * sizeof(starg_mesh *));
    if (longer == NULL)
        return cli_fail_memory(session);
    out->frames = longer;
    status = starg_mesh_read(session->context, name, &out->frames[out->count]);
    out->count += status == STARG_OK;
    return status;
}

/* frame_0000.off and so on, or .ply, and morph.json. */
static starg_status read_folder(cli_session *session, const char *name, folder *out) {
    bool found = true;
    SCOPED char *path = NULL;
    SCOPED char *off = name_in(name, "frame_0000.off");
    SCOPED char *ply = name_in(name, "frame_0000.ply");
    if (off == NULL || ply == NULL)
        return cli_fail_memory(session);
    if (exists(off) && exists(ply))
        return cli_fail(session, STARG_ERROR_READ,
                        "'%.200s' has frames of two morphs, as OFF and as PLY: remove one's", name);
    const char *format = exists(ply) ? "ply" : "off";
    while (found) {
        char file[32];
        snprintf(file, sizeof file, "frame_%04zu.%s", out->count, format);
        free(path);
        path = name_in(name, file);
        if (path == NULL)
            return cli_fail_memory(session);
        TRY(read_frame(session, path, out, &found));
    }
    free(path);
    path = name_in(name, "morph.json");
    if (path == NULL)
        return cli_fail_memory(session);
    if (exists(path))
        TRY(starg_result_read(session->context, path, &out->report));
    if (out->count < 2)
        return cli_fail(session, STARG_ERROR_READ,
                        "'%.200s' holds no morph: frame_0000.off and frame_0001.off at least",
                        name);
    if (out->report != NULL && out->report->morph == NULL)
        return cli_fail(session, STARG_ERROR_READ, "'%.200s' is no report of a morph", path);
    return STARG_OK;
}

/* Reads all results before verifying the first, so that a bad name is reported at once. Results of
 * two models show that the second operand is one of these. */
static starg_status read_inputs(cli_session *session, inputs *given) {
    size_t count = session->operand_count, last = count - 1;
    given->results = calloc(count, sizeof(starg_result *));
    given->folders = calloc(count, sizeof *given->folders);
    if (given->results == NULL || given->folders == NULL)
        return cli_fail_memory(session);
    bool paired = false;
    for (size_t i = last; i > 0; i--) {
        if (i == 1 && paired) {
            TRY(starg_mesh_read(session->context, session->operands[1], &given->target));
        } else if (is_folder(session->operands[i])) {
            TRY(read_folder(session, session->operands[i], &given->folders[i]));
            paired = true;
        } else {
            TRY(starg_result_read(session->context, session->operands[i], &given->results[i]));
            paired =
                paired || given->results[i]->map != NULL || given->results[i]->solid_map != NULL;
            if (given->results[i]->morph != NULL)
                return cli_fail(session, STARG_ERROR_ARGUMENT,
                                "'%.200s' is the report of a morph; name the folder that it is in",
                                session->operands[i]);
        }
    }
    bool shape = last == 1 && given->results[1] != NULL && given->results[1]->solid_map != NULL;
    if (paired && given->target == NULL && !shape)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "maps and morphs are of two models: verify A B %.200s",
                        session->operands[last]);
    return STARG_OK;
}

/* A certificate must follow the guards or pieces that it belongs to. */
static starg_status check_certificates(cli_session *session, starg_result *const *results) {
    for (size_t i = 1; i < session->operand_count; i++)
        if (results[i] != NULL && results[i]->certificate != NULL &&
            (i == 1 || results[i - 1] == NULL || results[i - 1]->certificate != NULL))
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
                     results[operand + 1] != NULL && results[operand + 1]->certificate != NULL;
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
        size_t *place = results[i] == NULL           ? NULL
                        : results[i]->pieces != NULL ? &found->pieces
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
                                  starg_result *const *results, const telling *to) {
    starg_status status = STARG_OK;
    starg_verdict *verdict = NULL;
    starg_mesh **obstacles = NULL, **zones = NULL;
    starg_poses keep = {0};
    starg_face_groups groups = {0};
    bool grouped = false;
    const starg_guards *guards = results[operand]->guards;
    const values *v = to->options;
    size_t behind = certificate_behind(session, results, operand);
    if (v->keep != NULL)
        CLI_TRY(starg_poses_read(session->context, v->keep, &keep));
    if (v->table != NULL || v->summary != NULL)
        CLI_TRY(
            cli_groups_read(session, session->operands[0], guards->face_count, &groups, &grouped));
    CLI_TRY(cli_scene_read_obstacles(session, guards, &obstacles));
    CLI_TRY(cli_scene_read_zones(session, guards, &zones));
    const starg_guards_evidence evidence = {.obstacles = (const starg_mesh *const *)obstacles,
                                            .obstacle_count = guards->obstacle_count,
                                            .zones = (const starg_mesh *const *)zones,
                                            .certificate =
                                                behind != 0 ? results[behind]->certificate : NULL,
                                            .keep = v->keep != NULL ? &keep : NULL,
                                            .table = v->table,
                                            .summary = v->summary,
                                            .curve = v->curve,
                                            .groups = grouped ? &groups : NULL};
    CLI_TRY(starg_verify_guards_with(session->context, given->mesh, &evidence, guards, &verdict));
    json_t *entry = json_object();
    if (behind != 0)
        cli_put(session, entry, "certificate", cli_json_text(session->operands[behind]));
    tell_verdict(session, session->operands[operand], verdict,
                 "guards stand where they may, and see what is told", entry, to);
done:
    cli_scene_free_obstacles(obstacles, guards->obstacle_count);
    cli_scene_free_obstacles(zones, guards->zone_count);
    starg_poses_free(session->context, &keep);
    cli_groups_free(&groups);
    return status;
}

static starg_status verify_pieces(cli_session *session, const model *given, decomposition found,
                                  starg_result *const *results, const telling *to) {
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
    TRY(given->tetmesh != NULL ? starg_verify_pieces_of_tetmesh(session->context, given->tetmesh,
                                                                pieces, report, &verdict)
                               : starg_verify_pieces_with(session->context, given->mesh, why,
                                                          pieces, report, &verdict));
    json_t *entry = json_object();
    if (why != NULL)
        cli_put(session, entry, "certificate", cli_json_text(session->operands[found.certificate]));
    cli_put(session, entry, "tetrahedra", json_integer((json_int_t)pieces->count));
    char holds[160] = "tetrahedra fill the model, once";
    if (report != NULL) {
        snprintf(holds, sizeof holds, "%zu of %zu pieces are star-shaped, and together they %s",
                 report->strictly_star, report->piece_count,
                 report->approximated ? "approximate the model" : "fill the model");
        cli_put(session, entry, "report", cli_json_text(session->operands[found.report]));
        cli_put(session, entry, "pieces", json_integer((json_int_t)report->piece_count));
        cli_put(session, entry, "strictly_star", json_integer((json_int_t)report->strictly_star));
    }
    tell_verdict(session, session->operands[found.pieces], verdict, holds, entry, to);
    return STARG_OK;
}

/* A verdict on a result of two models; B is missing if a solid was mapped to a ball or a cube. */
static json_t *entry_of_pair(cli_session *session, const inputs *from) {
    json_t *entry = json_object();
    if (from->target != NULL)
        cli_put(session, entry, "target", cli_json_text(session->operands[1]));
    return entry;
}

static starg_status verify_map(cli_session *session, const model *given, const inputs *from,
                               size_t operand, const telling *to) {
    starg_verdict *verdict = NULL;
    TRY(starg_verify_map(session->context, given->mesh, from->target, from->results[operand]->map,
                         &verdict));
    tell_verdict(session, session->operands[operand], verdict,
                 "points of A are where the map has them on B", entry_of_pair(session, from), to);
    return STARG_OK;
}

static starg_status verify_morph(cli_session *session, const model *given, const inputs *from,
                                 size_t operand, const telling *to) {
    starg_verdict *verdict = NULL;
    const folder *own = &from->folders[operand];
    if (own->report == NULL)
        cli_warn(session,
                 "'%.200s' has no morph.json (morph --report): checking only the frames' ends",
                 session->operands[operand]);
    TRY(starg_verify_morph(session->context, given->mesh, from->target,
                           (const starg_mesh *const *)own->frames, own->count,
                           own->report != NULL ? own->report->morph : NULL, &verdict));
    json_t *entry = entry_of_pair(session, from);
    cli_put(session, entry, "frames", json_integer((json_int_t)own->count));
    tell_verdict(session, session->operands[operand], verdict, "frames lead from A to B", entry,
                 to);
    return STARG_OK;
}

static starg_status verify_solid_map(cli_session *session, const model *given, const inputs *from,
                                     size_t operand, const telling *to) {
    starg_verdict *verdict = NULL;
    const starg_solid_map *map = from->results[operand]->solid_map;
    TRY(starg_verify_solid_map(session->context, given->mesh, from->target, map, &verdict));
    json_t *entry = entry_of_pair(session, from);
    cli_put(session, entry, "tetrahedra", json_integer((json_int_t)map->count));
    cli_put(session, entry, "pieces", json_integer((json_int_t)map->piece_count));
    tell_verdict(session, session->operands[operand], verdict,
                 from->target == NULL ? "tetrahedra fill A and a ball or a cube, one to one"
                 : map->compared      ? "tetrahedra fill A, and end near B as told"
                                      : "tetrahedra fill A and B, one to one",
                 entry, to);
    return STARG_OK;
}

static void report(cli_session *session, const starg_mesh *mesh, json_t *results) {
    cli_report_head(session, "starguard-verify", session->operands[0], mesh);
    cli_put(session, session->report, "passed", json_boolean(session->outcome == CLI_EXIT_DONE));
    cli_put(session, session->report, "results", json_incref(results));
}

/* What stands beside guards is of one file of them. */
static starg_status check_tables(cli_session *session, const values *v,
                                 starg_result *const *results) {
    size_t guards = 0;
    for (size_t i = 1; i < session->operand_count; i++)
        guards += results[i] != NULL && results[i]->guards != NULL;
    if (guards == 1 ||
        (v->keep == NULL && v->table == NULL && v->summary == NULL && v->curve == NULL))
        return STARG_OK;
    return cli_fail(
        session, STARG_ERROR_ARGUMENT,
        "--keep, --table, --summary and --curve belong to one GUARDS.json; here are %zu", guards);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    model given = {0};
    decomposition found;
    const telling to = {.results = json_array(), .verbose = v->verbose, .options = v};
    inputs from = {0};
    put_models_first(session);
    CLI_TRY(read_model(session, &given));
    CLI_TRY(read_inputs(session, &from));
    CLI_TRY(check_tables(session, v, from.results));
    CLI_TRY(check_certificates(session, from.results));
    CLI_TRY(find_decomposition(session, from.results, &found));
    starg_result *const *results = from.results;
    for (size_t i = 1; i < session->operand_count; i++) {
        if (from.folders[i].count > 0)
            CLI_TRY(verify_morph(session, &given, &from, i, &to));
        else if (results[i] == NULL)
            continue;
        else if (results[i]->map != NULL)
            CLI_TRY(verify_map(session, &given, &from, i, &to));
        else if (results[i]->solid_map != NULL)
            CLI_TRY(verify_solid_map(session, &given, &from, i, &to));
        else if (results[i]->guards != NULL)
            CLI_TRY(verify_guards(session, &given, i, results, &to));
        else if (i == found.pieces)
            CLI_TRY(verify_pieces(session, &given, found, results, &to));
    }
    if (session->report != NULL)
        report(session, given.mesh, to.results);
done:
    inputs_free(session, &from);
    json_decref(to.results);
    starg_mesh_free(given.mesh);
    starg_tetmesh_free(given.tetmesh);
    return status;
}

const cli_command cli_command_verify = {
    .name = "verify",
    .usage = "MODEL [B] RESULT... [options]",
    .summary = "check results independently",
    .description =
        "Checks the claims of result files with independent geometry and exact signs; "
        "only the readers of the model and of GUARDS.json are shared with the solver. "
        "Files are recognized by content, and may come in any order but that of A and B. Tells "
        "what "
        "holds, what does not, and what is open; --verbose lists every claim. Exit status 4 if a "
        "claim is false.\n"
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
        "Results of two models A and B: MAP.json of 'starguard map', which must be a bijection by "
        "its directions or its overlay, exactly, and meet its landmarks; and the folder of "
        "'starguard morph', whose first and last frames must be A and B. With 'morph --report' "
        "crossings, volumes and areas of all frames are checked as well.\n"
        "MAP.vtu of 'starguard map --solid', behind A and B (behind A alone for a ball or a cube): "
        "tetrahedra are positive in both and fill both, pieces are star-shaped in both, and no "
        "tetrahedron of a morph is ever inverted.",
    .examples = "# check one result\n"
                "starguard verify model.off guards.json\n"
                "# and that no fewer guards would do, wherever they stand\n"
                "starguard guard model.off --prove --certificate why.txt -o guards.json\n"
                "starguard verify model.off guards.json why.txt\n"
                "# its tables, and that cameras that stay are as they were given\n"
                "starguard guard room.off --keep stay.txt --effort quick \\\n"
                "    -o more.json --table faces.csv\n"
                "starguard verify room.off more.json --keep stay.txt --table faces.csv\n"
                "# several at once, for a script\n"
                "starguard verify model.off ilp.json greedy.json --quiet && echo verified\n"
                "# a star decomposition\n"
                "starguard verify model.off pieces.json pieces.vtk\n"
                "# a map and a morph\n"
                "starguard map cat.off dog.off --overlay -o cat_dog.json\n"
                "starguard morph cat.off dog.off --map cat_dog.json --frames 5 -o frames --report\n"
                "starguard verify cat.off dog.off cat_dog.json frames\n"
                "# a map between two solids\n"
                "starguard map --solid horse_0.off horse_1.off -o horse.vtu\n"
                "starguard verify horse_0.off horse_1.off horse.vtu",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, SIZE_MAX),
    .run = run,
};
