/* SPDX-License-Identifier: Apache-2.0 */
/* starguard repair: turns a nearly closed mesh into a solid. */
#include "commands.h"
#include "session.h"
#include "starguard/repair.h"

typedef struct values {
    const char *output;
    starg_repair_options wanted;
    starg_mesh_format format; /* from the name of the output */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("FILE.off|.obj|.ply|.stl",
                      "Repaired mesh; '-' writes OFF to standard output."),
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
    cli_put(session, report, "rounding", cli_json_real(r->rounding));
    if (r->union_rounds > 0)
        cli_say(session, "%-22s %.3g\n", "rounding", r->rounding);
    if (session->report != NULL)
        cli_put(session, session->report, "repair", report);
    else
        json_decref(report);
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    starg_status status = STARG_OK;
    CLI_TRY(cli_announce_needed(session, v->output, "FILE"));
    CLI_TRY(cli_mesh_format(session, v->output, &v->format));
done:
    return status;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    const starg_mesh *mesh = session->mesh;
    starg_status status = STARG_OK;
    starg_mesh *mended = NULL;
    starg_repair_report report;
    CLI_TRY(starg_mesh_repair(session->context, mesh, &v->wanted, &mended, &report));
    CLI_TRY(cli_mesh_write(session, mended, v->format, NULL, v->output));
    cli_say(session, "%zu vertices, %zu faces in; %zu vertices, %zu faces out\n",
            starg_mesh_vertex_count(mesh), starg_mesh_face_count(mesh),
            starg_mesh_vertex_count(mended), starg_mesh_face_count(mended));
    tell(session, &report);
    if (session->report != NULL)
        cli_put(session, session->report, "result",
                json_pack("{s:o, s:I, s:I}", "file", cli_json_text(v->output), "vertices",
                          (json_int_t)starg_mesh_vertex_count(mended), "faces",
                          (json_int_t)starg_mesh_face_count(mended)));
done:
    starg_mesh_free(mended);
    return status;
}

const cli_command cli_command_repair = {
    .name = "repair",
    .usage = "MODEL -o FILE [options]",
    .summary = "turn a defective model into a usable solid",
    .description =
        "Merges and drops vertices, drops degenerate and duplicate faces, flips faces, fills holes "
        "and resolves local self-intersections. Reports all changes and the largest move of a "
        "vertex. Exit status 2, without output, if the result is not a usable solid.",
    .examples = "# repair, then list remaining defects\n"
                "starguard repair scan.stl -o solid.off\n"
                "starguard check solid.off\n"
                "# close gaps of up to 0.001 of the diagonal, keep large holes open\n"
                "starguard repair scan.ply -o solid.ply --merge-distance 0.001 --max-hole-edges 50",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    CLI_LIBRARY(starg_repair_options_fields, wanted),
    .input = CLI_INPUT_MESH,
    .in_place = true,
    .prepare = prepare,
    .run = run,
};
