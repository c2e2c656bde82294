/* SPDX-License-Identifier: Apache-2.0 */
/* starguard describe: computes a shape descriptor from guards and what they see. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "starguard/picture.h"

CLI_DROP(starg_descriptor, starg_descriptor)
CLI_DROP(starg_descriptor_points, double)

typedef struct values {
    const char *output, *reconstruct, *picture, *histograms;
    starg_descriptor_options wanted;
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("FILE.json", "Descriptor (docs/formats.md); '-' writes to standard output."),
    CLI_TEXT_OPTION("reconstruct", reconstruct, "FILE.ply",
                    "Boundary as sampled by the descriptor: one point per ray."),
    CLI_TEXT_OPTION("picture", picture, "FILE.png", "Picture of the model and its guards."),
    CLI_TEXT_OPTION("histograms", histograms, "FILE.svg",
                    "Chart of the eight largest pieces: the fraction of directions in which the "
                    "boundary is nearer than a given distance."),
};

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    TRY(cli_announce_needed(session, v->output, "FILE.json"));
    TRY(cli_announce_with_extension(session, "--reconstruct", v->reconstruct, ".ply"));
    TRY(cli_announce_with_extension(session, "--picture", v->picture, ".png"));
    return cli_announce_with_extension(session, "--histograms", v->histograms, ".svg");
}

/* ---- report ---- */

static void tell(cli_session *session, const starg_descriptor *d, const starg_reconstruction *r) {
    cli_say(session, "guards        %zu, joined by %zu edges\n", d->guard_count, d->edge_count);
    cli_say(session, "directions    %zu\n", d->direction_count);
    cli_say(session,
            "points        within %.3g %% of the diagonal of the surface, %.3g %% on average\n",
            100 * r->to_largest, 100 * r->to_mean);
    cli_say(session,
            "surface       within %.3g %% of the diagonal of a point, %.3g %% on average\n",
            100 * r->from_largest, 100 * r->from_mean);
    if (d->time_limited)
        cli_say(session, "time limit    reached; other runs may differ\n");
}

/* Reports the file's contents and data about the run. */
static starg_status report(cli_session *session, const starg_descriptor *d,
                           const starg_reconstruction *r, const values *v) {
    char *text;
    size_t size;
    TRY(starg_descriptor_write_memory(session->context, d, session->operands[0], &text, &size));
    cli_report_take(session, text, size);
    cli_put(session, session->report, "output", cli_json_text(v->output));
    cli_put(session, session->report, "reconstruction",
            json_pack("{s:I, s:I, s:f, s:f, s:f, s:f}", "points", (json_int_t)r->points, "samples",
                      (json_int_t)r->samples, "to_mean", r->to_mean, "to_largest", r->to_largest,
                      "from_mean", r->from_mean, "from_largest", r->from_largest));
    return STARG_OK;
}

/* ---- points and guards ---- */

static starg_status write_points(cli_session *session, const starg_descriptor *d,
                                 const char *name) {
    starg_context *context = session->context;
    SCOPED_BY(starg_descriptor_points_drop) double *points = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *cloud = NULL;
    TRY(starg_descriptor_points(context, d, &points));
    TRY(starg_mesh_create(context, points, d->guard_count * d->direction_count, NULL, 0, &cloud));
    return cli_mesh_write(session, cloud, STARG_MESH_PLY_BINARY, name);
}

static starg_status draw(cli_session *session, const starg_descriptor *d, const char *name) {
    starg_picture_options picture;
    starg_picture_options_default(&picture);
    double *guards = malloc(3 * d->guard_count * sizeof *guards);
    if (guards == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < d->guard_count; i++)
        memcpy(guards + 3 * i, d->guards[i].position, 3 * sizeof *guards);
    picture.points = guards;
    picture.point_count = d->guard_count;
    picture.point_numbers = true;
    starg_status status = starg_picture_write(session->context, session->mesh, &picture,
                                              cli_outputs_place(&session->outputs, name));
    free(guards);
    return status;
}

/* ---- histograms ---- */

enum { CURVES = 8 };

static int compare_reals(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* The guards of the largest pieces, largest first, ties by number. */
static size_t choose_guards(const starg_descriptor *d, size_t chosen[CURVES]) {
    size_t count = 0;
    for (size_t i = 0; i < d->guard_count; i++) {
        size_t place = count;
        while (place > 0 && d->guards[chosen[place - 1]].volume < d->guards[i].volume)
            place--;
        if (place == CURVES)
            continue;
        count += count < CURVES;
        for (size_t k = count - 1; k > place; k--)
            chosen[k] = chosen[k - 1];
        chosen[place] = i;
    }
    return count;
}

/* Sorted distances relative to the largest, and the cumulative fraction of directions. */
static void make_curve(const starg_descriptor *d, size_t guard, double largest, double *x,
                       double *y) {
    memcpy(x, d->distances + guard * d->direction_count, d->direction_count * sizeof *x);
    qsort(x, d->direction_count, sizeof *x, compare_reals);
    for (size_t i = 0; i < d->direction_count; i++) {
        x[i] = largest > 0 ? x[i] / largest : 0;
        y[i] = (double)(i + 1) / (double)d->direction_count;
    }
}

static starg_status draw_histograms(cli_session *session, const starg_descriptor *d,
                                    const char *name) {
    size_t chosen[CURVES] = {0}, count = choose_guards(d, chosen), width = d->direction_count;
    starg_curve curves[CURVES];
    char names[CURVES][32];
    double largest = 0, *numbers = malloc(2 * CURVES * width * sizeof *numbers);
    if (numbers == NULL)
        return cli_fail_memory(session);
    for (size_t c = 0; c < count; c++)
        for (size_t i = 0; i < width; i++)
            largest = fmax(largest, d->distances[chosen[c] * width + i]);
    for (size_t c = 0; c < count; c++) {
        double *x = numbers + 2 * c * width;
        make_curve(d, chosen[c], largest, x, x + width);
        snprintf(names[c], sizeof names[c], "guard %zu", chosen[c]);
        curves[c] = (starg_curve){.name = names[c], .x = x, .y = x + width, .count = width};
    }
    starg_status status =
        starg_chart_write(session->context, curves, count, "distance relative to the largest",
                          "directions", cli_outputs_place(&session->outputs, name));
    free(numbers);
    return status;
}

/* ---- files ---- */

static starg_status write_files(cli_session *session, const starg_descriptor *d, const values *v) {
    if (v->reconstruct != NULL)
        TRY(write_points(session, d, v->reconstruct));
    if (v->picture != NULL)
        TRY(draw(session, d, v->picture));
    if (v->histograms != NULL)
        TRY(draw_histograms(session, d, v->histograms));
    return starg_descriptor_write(session->context, d, session->operands[0],
                                  cli_outputs_place(&session->outputs, v->output));
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_context *context = session->context;
    SCOPED_BY(starg_descriptor_drop) starg_descriptor *descriptor = NULL;
    starg_reconstruction reconstruction;
    TRY(starg_descriptor_create(context, session->mesh, &v->wanted, &descriptor));
    TRY(starg_descriptor_reconstruct(context, descriptor, session->mesh, &reconstruction));
    TRY(write_files(session, descriptor, v));
    tell(session, descriptor, &reconstruction);
    if (session->report != NULL)
        TRY(report(session, descriptor, &reconstruction, v));
    return STARG_OK;
}

const cli_command cli_command_describe = {
    .name = "describe",
    .usage = "MODEL -o FILE.json [options]",
    .summary = "compute a shape descriptor from guards and what they see",
    .description = "Computes a fast star decomposition and stores its guards, the adjacency of its "
                   "pieces, and the distance from each guard to the boundary in all directions. "
                   "'starguard match' compares descriptors. Reports the distance between the "
                   "sampled points and the surface, both ways.",
    .examples =
        "# a descriptor and its samples of the surface\n"
        "starguard describe model.off -o model.json --reconstruct points.ply\n"
        "# a finer one\n"
        "starguard describe model.off -o model.json --detail 0 --directions 2048 --effort 2000",
    .input = CLI_INPUT_MESH,
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    .prepare = prepare,
    CLI_LIBRARY(starg_descriptor_options_fields, wanted),
    .run = run,
};
