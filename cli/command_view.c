/* SPDX-License-Identifier: Apache-2.0 */
/* starguard view: a page to look at results. */
#include "commands.h"
#include "database.h"
#include "model.h"
#include "report.h"
#include "show.h"

typedef struct values {
    const char *output, *model;
    int distance;
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("PAGE.html", "Where to write the page; '-' writes to standard output."),
    CLI_INPUT_OPTION("model", model, "FILE",
                     "The model that results are about. By default the one that they name, from "
                     "where you stand or beside the result."),
    CLI_DISTANCE_OPTION,
};

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    CLI_TRY(cli_announce_needed(session, v->output, "PAGE.html"));
    if (!starg_page_available()) /* the library says how to get the viewer */
        CLI_TRY(starg_page_write(session->context, &(const starg_page){0}, v->output));
done:
    return status;
}

/* What there is to see, as the page's tabs name it. */
static void tell(cli_session *session, const values *v, const starg_page *page) {
    const struct {
        const char *name, *key;
        size_t count;
    } parts[] = {{"guards", "guards", page->guards != NULL ? page->guards->count : 0},
                 {"pieces", "pieces", page->report != NULL ? page->report->piece_count : 0},
                 {"tetrahedra", "tetrahedra", page->pieces != NULL ? page->pieces->count : 0},
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

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    cli_show show = {0};
    CLI_TRY(cli_show_read(session, v->model, v->distance, &show));
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
    .summary = "a page to look at results, for any browser",
    .description =
        "Writes one HTML file with everything in it; it opens in any browser, without network. The "
        "content of each file tells what it is, and any mix will do, one of each kind:\n"
        "GUARDS.json: guards in the half transparent model, what each sees when it is clicked, and "
        "the coverage curve. The model is the one that the file names.\n"
        "PIECES.vtk and PIECES.json: pieces in colours of their own, which can be moved apart.\n"
        "A skeleton (.obj, .cg, .vtk of 'starguard skeleton'), with its radii.\n"
        "A morph (the folder of 'starguard morph', or its .glb), with a slider for the time.\n"
        "A database, or a table of 'starguard db matrix': distances, names and small pictures.\n"
        "A model by itself is shown as well. In the page, press ? for the keys.",
    .examples = "# guards and what they see\n"
                "starguard guard horse.off -o guards.json\n"
                "starguard view guards.json -o guards.html\n"
                "# guards and star-shaped pieces of a model, and its skeleton, in one page\n"
                "starguard view guards.json pieces.vtk pieces.json skeleton.vtk -o horse.html\n"
                "# a morph; the shapes of a database\n"
                "starguard view frames -o morph.html\n"
                "starguard view shapes.db -o shapes.html --distance star",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, SIZE_MAX),
    .prepare = prepare,
    .run = run,
};
