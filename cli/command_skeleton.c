/* SPDX-License-Identifier: Apache-2.0 */
/* starguard skeleton: computes the curve skeleton of a solid. */
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "starguard/picture.h"
#include "starguard/skeleton.h"

CLI_DROP(starg_skeleton, starg_skeleton)

typedef struct values {
    const char *output, *picture;
    starg_skeleton_options wanted;
    starg_skeleton_format format; /* from the name of the output */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION(
        "FILE.obj|.cg|.vtk|.swc",
        "Skeleton; the extension selects OBJ lines, a curve graph, VTK with radii, or "
        "SWC, which holds no loops (docs/formats.md); '-' writes VTK to standard output."),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Picture of the translucent model with its skeleton."),
};

static starg_status choose_format(cli_session *session, const char *name,
                                  starg_skeleton_format *format) {
    static const cli_extension known[] = {{".obj", STARG_SKELETON_OBJ},
                                          {".cg", STARG_SKELETON_CG},
                                          {".vtk", STARG_SKELETON_VTK},
                                          {".swc", STARG_SKELETON_SWC}};
    int found;
    starg_status status = cli_format_by_extension(
        session, name, known, sizeof known / sizeof *known, STARG_SKELETON_VTK, &found);
    *format = (starg_skeleton_format)found;
    return status;
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    TRY(cli_announce_needed(session, v->output, "FILE.obj, .cg, .vtk or .swc"));
    TRY(choose_format(session, v->output, &v->format));
    return cli_announce_with_extension(session, "--picture", v->picture, ".png");
}

/* Draws nodes as small balls, ends and joints in their own colours. */
static starg_status write_picture(cli_session *session, const starg_solid *solid,
                                  const starg_skeleton *s, const char *name) {
    static const uint8_t curve[3] = {200, 30, 30}, joint[3] = {20, 60, 200}, end[3] = {0, 130, 60};
    starg_picture_options picture;
    starg_picture_options_default(&picture);
    SCOPED uint8_t *colors = calloc(s->node_count + 1, 3);
    SCOPED uint32_t *degrees = calloc(s->node_count + 1, sizeof *degrees);
    if (colors == NULL || degrees == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < 2 * s->edge_count; i++)
        degrees[s->edges[i]]++;
    for (size_t i = 0; i < s->node_count; i++)
        memcpy(colors + 3 * i, degrees[i] > 2 ? joint : degrees[i] == 1 ? end : curve, 3);
    picture.points = s->positions;
    picture.point_count = s->node_count;
    picture.point_colors = colors;
    picture.point_radius = 0.004;
    return starg_picture_write(session->context, starg_solid_mesh(solid), &picture,
                               cli_outputs_place(&session->outputs, name));
}

static void say_skeleton(cli_session *session, const starg_skeleton *s) {
    cli_say(session, "nodes         %zu\n", s->node_count);
    cli_say(session, "edges         %zu\n", s->edge_count);
    cli_say(session, "components    %zu\n", s->components);
    cli_say(session, "loops         %zu\n", s->loops);
    cli_say(session, "joints        %zu\n", s->joints);
    cli_say(session, "ends          %zu\n", s->ends);
    cli_say(session, "homotopic     %s\n", s->homotopic ? "yes" : "no");
}

static void report_skeleton(cli_session *session, const starg_skeleton *s, const char *output) {
    json_t *report = session->report;
    const struct {
        const char *key;
        size_t value;
    } counts[] = {{"nodes", s->node_count}, {"edges", s->edge_count}, {"components", s->components},
                  {"loops", s->loops},      {"joints", s->joints},    {"ends", s->ends},
                  {"cuts", s->cuts},        {"mends", s->mends}};
    cli_put(session, report, "output", cli_json_text(output));
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        cli_put(session, report, counts[i].key, json_integer((json_int_t)counts[i].value));
    cli_put(session, report, "homotopic", json_boolean(s->homotopic));
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *skeleton = NULL;
    TRY(starg_skeleton_create(session->context, session->solid, &v->wanted, &skeleton));
    if (v->picture != NULL)
        TRY(write_picture(session, session->solid, skeleton, v->picture));
    TRY(starg_skeleton_write(session->context, skeleton,
                             cli_outputs_place(&session->outputs, v->output), v->format));
    say_skeleton(session, skeleton);
    if (session->report != NULL)
        report_skeleton(session, skeleton, v->output);
    return STARG_OK;
}

const cli_command cli_command_skeleton = {
    .name = "skeleton",
    .usage = "MODEL -o FILE.obj|.cg|.vtk|.swc [options]",
    .summary = "compute the curve skeleton of a solid",
    .description =
        "Computes the curve skeleton by eroding the medial axis: a graph of interior points with "
        "as many components and loops as the solid. A solid with cavities has no such curve and "
        "gets a warning. Each node has its distance from the surface.",
    .examples =
        "# for a mesh viewer\n"
        "starguard skeleton horse.off -o horse.obj\n"
        "# few nodes, only long branches, and a picture\n"
        "starguard skeleton horse.off -o horse.vtk --nodes 100 --prune 3 --picture horse.png\n"
        "# components, loops, joints and ends as JSON\n"
        "starguard skeleton horse.off -o horse.cg --json",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    .input = CLI_INPUT_SOLID,
    .prepare = prepare,
    CLI_LIBRARY(starg_skeleton_options_fields, wanted),
    .run = run,
};
