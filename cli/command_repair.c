/* SPDX-License-Identifier: Apache-2.0 */
/* starguard repair: turns a nearly closed mesh into a solid. */
#include <math.h>
#include <string.h>

#include "commands.h"
#include "starguard/repair.h"

typedef struct values {
    const char *output, *origin;
    starg_repair_options wanted;
    starg_mesh_write_options writing; /* the format from the name of the output */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("FILE.off|.obj|.ply|.stl|.vtp",
                      "Repaired mesh; '-' writes OFF to standard output."),
    CLI_TEXT_OPTION("origin", origin, "X,Y,Z|auto",
                    "Subtract this point from all vertices, as binary STL needs it at map "
                    "coordinates; 'auto' takes a round one near the middle. It is printed, and "
                    "stands in a comment of .ply, .obj and .stl. Default: nothing is subtracted."),
};

/* Reports what was done, as text and JSON. */
static void tell(cli_session *session, const starg_repair_report *r) {
    const struct {
        const char *key, *text;
        size_t count;
    } lines[] = {
        {"vertices_merged", "vertices merged", r->vertices_merged},
        {"vertices_dropped", "vertices dropped", r->vertices_dropped},
        {"vertices_split", "vertices split", r->vertices_split},
        {"vertices_moved", "vertices moved", r->vertices_moved},
        {"vertices_added", "vertices added", r->vertices_added},
        {"faces_dropped", "faces dropped", r->faces_dropped},
        {"faces_turned", "faces turned", r->faces_turned},
        {"faces_added", "faces added", r->faces_added},
        {"holes_filled", "holes filled", r->holes_filled},
        {"faces_divided", "faces divided", r->faces_divided},
        {"components_dropped", "components dropped", r->components_dropped},
        {"intersections_before", "intersections before", r->intersections_before},
        {"intersections_after", "intersections after", r->intersections_after},
        {"faces_cut", "faces cut", r->faces_cut},
        {"union_rounds", "rounds of the union", r->union_rounds},
    };
    json_t *report = json_object();
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        cli_put(session, report, lines[i].key, json_integer((json_int_t)lines[i].count));
        cli_say(session, "%-22s %zu\n", lines[i].text, lines[i].count);
    }
    cli_put(session, report, "largest_move", cli_json_real(r->largest_move));
    cli_say(session, "%-22s %.6g\n", "largest move", r->largest_move);
    cli_put(session, report, "conforming", cli_json_real(r->conforming));
    cli_put(session, report, "volume_before",
            r->closed_before ? cli_json_real(r->enclosed_before) : json_null());
    cli_put(session, report, "volume_after", cli_json_real(r->enclosed_after));
    if (r->closed_before)
        cli_say(session, "%-22s %.9g\n", "volume before", r->enclosed_before);
    cli_say(session, "%-22s %.9g\n", "volume after", r->enclosed_after);
    cli_put(session, report, "rounding", cli_json_real(r->rounding));
    if (r->union_rounds > 0)
        cli_say(session, "%-22s %.3g\n", "rounding", r->rounding);
    if (session->report != NULL)
        cli_put(session, session->report, "repair", report);
    else
        json_decref(report);
}

static starg_status fail_in_vain(cli_session *session, const starg_repair_report *r) {
    return cli_fail(session, STARG_ERROR_MESH, "%s of faces intersect, no fewer than before; %s",
                    cli_count_of(r->intersections_after, "pair", "pairs").text,
                    r->grid[0] != '\0' ? r->grid
                                       : "--union cuts them and keeps what bounds the solid");
}

static void warn(cli_session *session, const starg_repair_report *r) {
    double change = r->enclosed_after - r->enclosed_before;
    if (r->closed_before && r->union_rounds == 0 && fabs(change) > 1e-9 * r->enclosed_before)
        cli_warn(session, "warning: the volume was %.6g, and is %.6g now (%+.3g %%)",
                 r->enclosed_before, r->enclosed_after, 100 * change / r->enclosed_before);
    if (r->grid[0] != '\0')
        cli_warn(session, "warning: %s", r->grid);
    else if (r->intersections_after > 0)
        cli_warn(session, "warning: %s of faces intersect (%zu before); --union cuts them",
                 cli_count_of(r->intersections_after, "pair", "pairs").text,
                 r->intersections_before);
}

static bool is_auto(const values *v) {
    return v->origin != NULL && strcmp(v->origin, "auto") == 0;
}

static void tell_origin(cli_session *session, const double origin[3]) {
    cli_say(session, "%-22s %.17g,%.17g,%.17g\n", "origin", origin[0], origin[1], origin[2]);
    if (session->report != NULL)
        cli_put(session, session->report, "origin",
                json_pack("[o, o, o]", cli_json_real(origin[0]), cli_json_real(origin[1]),
                          cli_json_real(origin[2])));
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    TRY(cli_announce_needed(session, v->output, "FILE"));
    starg_mesh_write_options_default(&v->writing);
    TRY(cli_mesh_format(session, v->output, &v->writing.format));
    if (v->origin != NULL && !is_auto(v) && !cli_number_list(v->origin, v->writing.origin, 3))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--origin takes X,Y,Z (three numbers, no spaces) or auto, not '%.100s'",
                        v->origin);
    return STARG_OK;
}

static starg_status run(cli_session *session, void *data) {
    values *v = data;
    const starg_mesh *mesh = session->mesh;
    SCOPED_BY(starg_mesh_drop) starg_mesh *mended = NULL;
    starg_repair_report report;
    TRY(starg_mesh_repair(session->context, mesh, &v->wanted, &mended, &report));
    if (report.in_vain)
        return fail_in_vain(session, &report);
    if (is_auto(v))
        starg_mesh_origin(mended, v->writing.origin);
    TRY(cli_mesh_write_with(session, mended, &v->writing, v->output));
    cli_say(session, "%zu vertices, %zu faces in; %zu vertices, %zu faces out\n",
            starg_mesh_vertex_count(mesh), starg_mesh_face_count(mesh),
            starg_mesh_vertex_count(mended), starg_mesh_face_count(mended));
    tell(session, &report);
    warn(session, &report);
    if (v->origin != NULL)
        tell_origin(session, v->writing.origin);
    if (session->report != NULL)
        cli_put(session, session->report, "result",
                json_pack("{s:o, s:I, s:I}", "file", cli_json_text(v->output), "vertices",
                          (json_int_t)starg_mesh_vertex_count(mended), "faces",
                          (json_int_t)starg_mesh_face_count(mended)));
    return STARG_OK;
}

const cli_command cli_command_repair = {
    .name = "repair",
    .usage = "MODEL -o FILE [options]",
    .summary = "turn a defective model into a usable solid",
    .description =
        "Merges and drops vertices, drops degenerate and duplicate faces, flips faces, fills holes "
        "and resolves local self-intersections. Reports all changes and the largest move of a "
        "vertex. Exit status 2, without output, if the result is not a usable solid, or if a solid "
        "intersects itself as often as before (--union cuts what intersects).",
    .examples =
        "# repair, then list remaining defects\n"
        "starguard repair scan.stl -o solid.off\n"
        "starguard check solid.off\n"
        "# close gaps of up to 0.001 of the diagonal, keep large holes open\n"
        "starguard repair scan.ply -o solid.ply --merge-distance 0.001 --max-hole-edges 50\n"
        "# binary STL of a building at map coordinates\n"
        "starguard repair scan.ply -o solid.stl --origin auto",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    CLI_LIBRARY(starg_repair_options_fields, wanted),
    .input = CLI_INPUT_MESH,
    .in_place = true,
    .prepare = prepare,
    .run = run,
};
