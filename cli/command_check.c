/* SPDX-License-Identifier: Apache-2.0 */
/* starguard check: is a model a usable solid, and if not, what is wrong where? */
#include <stdlib.h>

#include "commands.h"
#include "starguard/picture.h"

CLI_DROP(starg_check, starg_check)

typedef struct values {
    const char *marks;
} values;

static const cli_option options[] = {
    CLI_TEXT_OPTION(
        "marks", marks, "FILE.ply|.vtp",
        "Write the model with one colour per kind of finding, also for unusable models."),
};

/* Elements are listed one by one ("3, 8, 9") or in pairs ("3-7, 8-9"). */
static bool is_paired(starg_finding_kind kind, const starg_finding *finding) {
    return finding->element == STARG_ELEMENT_EDGE || kind == STARG_FINDING_SELF_INTERSECTION ||
           kind == STARG_FINDING_SELF_CONTACT;
}

static const char *element_word(starg_element element) {
    return element == STARG_ELEMENT_EDGE   ? "edges (by vertices)"
           : element == STARG_ELEMENT_FACE ? "faces"
                                           : "vertices";
}

static void print_finding(cli_session *session, starg_finding_kind kind,
                          const starg_finding *finding) {
    bool paired = is_paired(kind, finding);
    size_t step = paired ? 2 : 1, listed = finding->shown / step;
    cli_say(session, "  %8zu %-24s %s", finding->count, starg_finding_name(kind),
            element_word(finding->element));
    for (size_t i = 0; i + step <= finding->shown; i += step) {
        cli_say(session, "%s%llu", i == 0 ? " " : ", ", (unsigned long long)finding->first[i]);
        if (paired)
            cli_say(session, "-%llu", (unsigned long long)finding->first[i + 1]);
    }
    cli_say(session, "%s\n", finding->count > listed ? ", ..." : "");
}

static const char *yes_no(bool value) {
    return value ? "yes" : "no";
}

static void print_check(cli_session *session, const starg_check *check) {
    cli_say(session, "usable      %s\n", yes_no(check->usable));
    cli_say(session, "closed      %s\n", yes_no(check->closed));
    cli_say(session, "manifold    %s\n", yes_no(check->manifold));
    cli_say(session, "oriented    %s\n", yes_no(check->oriented));
    cli_say(session, "embedded    %s\n", yes_no(check->embedded));
    cli_say(session, "vertices    %zu\n", check->vertices);
    cli_say(session, "edges       %zu\n", check->edges);
    cli_say(session, "faces       %zu\n", check->faces);
    cli_say(session, "components  %zu\n", check->components);
    cli_say(session, "cavities    %zu\n", check->cavities);
    if (check->genus >= 0)
        cli_say(session, "genus       %lld\n", (long long)check->genus);
    cli_say(session, "area        %.6g\n", check->area);
    if (check->usable)
        cli_say(session, "volume      %.6g\n", check->volume);
    cli_say(session, "diagonal    %.6g\n", check->diagonal);
    cli_say(session, "shortest    %.6g\n", check->shortest_edge);
    if (check->coarse)
        cli_say(session, "steps       %.3g %.3g %.3g\n", check->grid[0], check->grid[1],
                check->grid[2]);
    bool any = false;
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        any |= check->findings[kind].count > 0;
    cli_say(session, "findings    %s\n", any ? "" : "none");
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        if (check->findings[kind].count > 0)
            print_finding(session, (starg_finding_kind)kind, &check->findings[kind]);
}

/* ---- JSON ---- */

/* JSON keys of the findings, in the order of their kinds. */
static const char *const keys[STARG_FINDING_KINDS] = {
    "open_edges",         "nonmanifold_edges", "nonmanifold_vertices", "inconsistent_edges",
    "repeated_corners",   "inward_components", "degenerate_faces",     "duplicate_faces",
    "duplicate_vertices", "isolated_vertices", "self_intersections",   "self_contacts",
};

static json_t *finding_json(cli_session *session, starg_finding_kind kind,
                            const starg_finding *finding) {
    json_t *first = json_array();
    size_t step = is_paired(kind, finding) ? 2 : 1;
    for (size_t i = 0; i + step <= finding->shown; i += step) {
        json_int_t a = (json_int_t)finding->first[i];
        if (step == 2)
            cli_append(session, first, json_pack("[II]", a, (json_int_t)finding->first[i + 1]));
        else
            cli_append(session, first, json_integer(a));
    }
    return json_pack("{s:I, s:s, s:o}", "count", (json_int_t)finding->count, "element",
                     finding->element == STARG_ELEMENT_EDGE   ? "edge"
                     : finding->element == STARG_ELEMENT_FACE ? "face"
                                                              : "vertex",
                     "first", first);
}

static void report_check(cli_session *session, const starg_check *check) {
    json_t *report = session->report;
    if (report == NULL)
        return;
    const struct {
        const char *key;
        json_t *value;
    } entries[] = {
        {"usable", json_boolean(check->usable)},
        {"closed", json_boolean(check->closed)},
        {"manifold", json_boolean(check->manifold)},
        {"oriented", json_boolean(check->oriented)},
        {"embedded", json_boolean(check->embedded)},
        {"edges", json_integer((json_int_t)check->edges)},
        {"components", json_integer((json_int_t)check->components)},
        {"cavities", json_integer((json_int_t)check->cavities)},
        {"genus", check->genus < 0 ? json_null() : json_integer((json_int_t)check->genus)},
        {"area", cli_json_real(check->area)},
        {"volume", check->usable ? cli_json_real(check->volume) : json_null()},
        {"diagonal", cli_json_real(check->diagonal)},
        {"shortest_edge", cli_json_real(check->shortest_edge)},
        {"grid", json_pack("[o, o, o]", cli_json_real(check->grid[0]),
                           cli_json_real(check->grid[1]), cli_json_real(check->grid[2]))},
        {"coarse", json_boolean(check->coarse)},
    };
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
        cli_put(session, report, entries[i].key, entries[i].value);
    json_t *findings = json_object();
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        if (check->findings[kind].count > 0)
            cli_put(session, findings, keys[kind],
                    finding_json(session, (starg_finding_kind)kind, &check->findings[kind]));
    cli_put(session, report, "findings", findings);
}

/* ---- marks ---- */

static void print_legend(cli_session *session, const starg_check *check) {
    bool used[STARG_FINDING_KINDS + 1] = {false};
    for (size_t i = 0; i < check->faces; i++)
        used[check->face_marks[i]] = true;
    cli_say(session, "colours\n");
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++) {
        uint8_t rgb[3];
        if (!used[kind + 1])
            continue;
        starg_distinct_color((size_t)kind, rgb);
        cli_say(session, "  #%02X%02X%02X  %s\n", rgb[0], rgb[1], rgb[2],
                starg_finding_name((starg_finding_kind)kind));
    }
    cli_say(session, "  grey     nothing found\n");
}

static starg_status write_marks(cli_session *session, const starg_mesh *mesh,
                                const starg_check *check, const char *name) {
    uint8_t *colors = cli_colors_create(mesh);
    int32_t *marks = malloc((check->faces + 1) * sizeof *marks);
    starg_status status = STARG_OK;
    if (colors == NULL || marks == NULL)
        status = cli_fail_memory(session);
    for (size_t i = 0; i < check->faces && status == STARG_OK; i++) {
        marks[i] = (int32_t)check->face_marks[i] - 1;
        if (marks[i] >= 0)
            starg_distinct_color((size_t)marks[i], colors + 3 * i);
    }
    if (status == STARG_OK)
        status = cli_marks_write(session, mesh, colors, marks, NULL, name);
    free(colors);
    free(marks);
    if (status == STARG_OK)
        print_legend(session, check);
    return status;
}

/* ---- verdict ---- */

/* One line for standard error: why the model is not a solid, or a warning. */
static void judge(cli_session *session, const starg_check *check) {
    static const starg_finding_kind serious[] = {
        STARG_FINDING_OPEN_EDGE, STARG_FINDING_NONMANIFOLD_EDGE, STARG_FINDING_NONMANIFOLD_VERTEX,
        STARG_FINDING_INCONSISTENT_EDGE, STARG_FINDING_REPEATED_CORNER};
    const char *name = session->operands[0];
    char list[256] = "";
    size_t used = 0;
    char grid[256];
    starg_check_describe_grid(check, grid, sizeof grid);
    if (check->coarse)
        cli_warn(session, "warning: '%s': %s", name, grid);
    else if (check->usable && check->findings[STARG_FINDING_SELF_INTERSECTION].count > 0)
        cli_warn(session, "warning: '%s' is closed but intersects itself", name);
    if (check->usable)
        return;
    for (size_t i = 0; i < sizeof serious / sizeof *serious && used < sizeof list; i++) {
        size_t count = check->findings[serious[i]].count;
        if (count > 0)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s (%zu)",
                                     used == 0 ? "" : ", ", starg_finding_name(serious[i]), count);
    }
    cli_warn(session, "'%s' is not a usable solid: %s; %s", name,
             used > 0            ? list
             : check->underflows ? "its area or volume underflows"
                                 : "it encloses no volume",
             starg_check_advice(check));
    session->outcome = CLI_EXIT_INPUT;
}

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    return cli_announce_marks(session, "--marks", v->marks);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    SCOPED_BY(starg_check_drop) starg_check *check = NULL;
    TRY(starg_mesh_check(session->context, session->mesh, &check));
    report_check(session, check);
    print_check(session, check);
    if (v->marks != NULL)
        TRY(write_marks(session, session->mesh, check, v->marks));
    judge(session, check);
    return STARG_OK;
}

const cli_command cli_command_check = {
    .name = "check",
    .usage = "MODEL [--marks FILE.ply|.vtp] [options]",
    .summary = "test whether a model is a usable solid and list its defects",
    .description =
        "Tests whether a mesh is closed, manifold, consistently oriented and free of "
        "self-intersections, degenerate and duplicate parts. Reports each kind of defect with its "
        "count and the first indices (from 0). All tests are exact, without tolerances.\n"
        "Exit status 0 if the model is a usable solid (with a warning if it intersects itself), 2 "
        "if not.",
    .examples = "# list the defects\n"
                "starguard check model.obj\n"
                "# show them in a mesh viewer\n"
                "starguard check model.obj --marks findings.ply\n"
                "# for a script\n"
                "starguard check model.obj --json | jq .findings",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
};
