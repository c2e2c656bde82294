/* SPDX-License-Identifier: Apache-2.0 */
/* starguard view: writes a page that shows results. */
#include "commands.h"
#include "scene.h"
#include "show.h"

typedef struct values {
    const char *output, *model;
    int distance;
    bool report;
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("PAGE.html", "Page; '-' writes to standard output."),
    CLI_INPUT_OPTION("model", model, "FILE",
                     "Model of the results. Default: the model that they name, relative to the "
                     "current folder or to the result."),
    CLI_FLAG_OPTION("report", report,
                    "A sheet about the cameras of a GUARDS.json, to be printed and handed over, in "
                    "place of an interactive page: the plan from above, a picture through each "
                    "lens, tables, and poses with pan, tilt and roll."),
    CLI_DISTANCE_OPTION,
};

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    TRY(cli_announce_needed(session, v->output, "PAGE.html"));
    if (!v->report && !starg_page_available()) /* the library says how to get the viewer */
        TRY(starg_page_write(session->context, &(const starg_page){0}, v->output));
    return STARG_OK;
}

/* Lists the contents, named like the page's tabs. */
static void tell(cli_session *session, const values *v, const starg_page *page) {
    const struct {
        const char *name, *key;
        size_t count;
    } parts[] = {{"guards", "guards", page->guards != NULL ? page->guards->count : 0},
                 {"pieces", "pieces", page->report != NULL ? page->report->piece_count : 0},
                 {"tetrahedra", "tetrahedra", page->pieces != NULL ? page->pieces->count : 0},
                 {"pieces of map", "map_pieces", page->map != NULL ? page->map->piece_count : 0},
                 {"skeleton nodes", "skeleton_nodes",
                  page->skeleton != NULL ? page->skeleton->node_count : 0},
                 {"morph frames", "morph_frames", page->frame_count},
                 {"shapes", "shapes", page->shape_count}};
    json_t *shown = json_object();
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i].count == 0)
            continue;
        cli_say(session, "%-14s %zu\n", parts[i].name, parts[i].count);
        cli_put(session, shown, parts[i].key, json_integer((json_int_t)parts[i].count));
    }
    if (session->report == NULL) {
        json_decref(shown);
        return;
    }
    cli_report_head(session, "starguard-view", page->model_name, page->model);
    cli_put(session, session->report, "output", cli_json_text(v->output));
    cli_put(session, session->report, "shown", shown);
}

static starg_status write_sheet(cli_session *session, const values *v, const cli_show *show) {
    SCOPED_BY(cli_groups_free) starg_face_groups groups = {0};
    bool any = false;
    const starg_page *page = &show->page;
    if (show->guards == NULL || page->report != NULL || page->pieces != NULL || page->map != NULL ||
        page->skeleton != NULL || page->frame_count > 0 || page->shape_count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--report makes a sheet about cameras: give one GUARDS.json and nothing "
                        "else, or leave out --report");
    TRY(cli_groups_read(session, show->model_file, show->guards->face_count, &groups, &any));
    const starg_sheet sheet = {.title = page->title,
                               .command = page->command,
                               .scene = show->solid,
                               .guards = show->guards,
                               .obstacles = page->obstacles,
                               .groups = any ? &groups : NULL};
    return starg_sheet_write(session->context, &sheet,
                             cli_outputs_place(&session->outputs, v->output));
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    cli_show show = {0};
    CLI_TRY(cli_show_read(session, v->model, v->distance, &show));
    if (v->report)
        CLI_TRY(write_sheet(session, v, &show));
    else
        CLI_TRY(starg_page_write(session->context, &show.page,
                                 cli_outputs_place(&session->outputs, v->output)));
    tell(session, v, &show.page);
done:
    cli_show_free(session, &show);
    return status;
}

const cli_command cli_command_view = {
    .name = "view",
    .usage = "RESULT... [--model FILE] -o PAGE.html [options]",
    .summary = "write an interactive page of results for any browser",
    .description =
        "Writes one self-contained HTML file; it needs no network. Inputs are recognized by "
        "content, at most one of each kind:\n"
        "GUARDS.json: guards in the translucent model; click one to see what it covers; the "
        "coverage curve. The file names its model.\n"
        "The certificate of its bound: the faces that prove it, and where guards may see their "
        "share of them.\n"
        "PIECES.vtk and PIECES.json: coloured pieces, which can be exploded.\n"
        "MAP.vtu: both solids of 'starguard map --solid' side by side, in the colours of their "
        "pieces, or with a checker or coordinate lines carried over.\n"
        "A skeleton (.obj, .cg, .vtk, .swc of 'starguard skeleton') with its radii.\n"
        "A morph (the folder of 'starguard morph', or its .glb) with a time slider; with its "
        "report (--report) the page names both shapes.\n"
        "A database, or a table of 'starguard db matrix': distances, names and thumbnails.\n"
        "A model alone. In the page, press ? for the keys.\n"
        "With --report a sheet of GUARDS.json that prints well.",
    .examples = "# guards and what they see\n"
                "starguard guard horse.off -o guards.json\n"
                "starguard view guards.json -o guards.html\n"
                "# guards, star-shaped pieces and skeleton of a model in one page\n"
                "starguard view guards.json pieces.vtk pieces.json skeleton.vtk -o horse.html\n"
                "# a sheet of the cameras to hand over\n"
                "starguard view guards.json --report -o sheet.html\n"
                "# a morph; a map between solids; the shapes of a database\n"
                "starguard view frames -o morph.html\n"
                "starguard view map.vtu -o map.html\n"
                "starguard view shapes.db -o shapes.html --distance star",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, SIZE_MAX),
    .prepare = prepare,
    .run = run,
};
