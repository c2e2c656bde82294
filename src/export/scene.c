/* SPDX-License-Identifier: Apache-2.0 */
/* A model with results about it in one file: what fits together, what is made of it, and which
 * writer takes it.
 *
 * Stages: the parts are compared with one another; the surfaces of the pieces are found; each face
 * of the model learns which guard sees it first; the box of all that is shown gives the centre that
 * single precision counts from, and the size of what stands for a guard. Cost: that of the output,
 * and of sorting the faces of pieces. */
#include "export/export.h"

#include <math.h>

#include "mesh/formats/io.h"
#include "starguard/picture.h"

static const char STAGE[] = "scene";

const uint8_t SCENE_NEUTRAL[3] = {190, 195, 200}, SCENE_UNSEEN[3] = {139, 0, 0},
              SCENE_CURVE[3] = {200, 30, 30}, SCENE_IN_THE_WAY[3] = {150, 125, 95};

/* ---- checks ---- */

static starg_status check_guards(starg_context *context, const starg_scene *s) {
    const starg_guards *g = s->guards;
    if (g != NULL && s->model != NULL &&
        (g->face_count != starg_mesh_face_count(s->model) ||
         g->vertex_count != starg_mesh_vertex_count(s->model)))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the guards belong to a model with %zu vertices and %zu faces, but this "
                          "one has %zu and %zu; give the right model",
                          g->vertex_count, g->face_count, starg_mesh_vertex_count(s->model),
                          starg_mesh_face_count(s->model));
    if (s->seen != NULL && (g == NULL || s->model == NULL || starg_bits_rows(s->seen) != g->count ||
                            starg_bits_columns(s->seen) != starg_mesh_face_count(s->model)))
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "visibility needs one row per guard and one column per face of the model");
    if (s->groups != NULL &&
        (s->model == NULL || s->groups->face_count != starg_mesh_face_count(s->model)))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "groups need a model with as many faces");
    return STARG_OK;
}

static starg_status check_report(starg_context *context, const scene_job *job) {
    const starg_pieces_report *report = job->scene->report;
    if (report == NULL)
        return STARG_OK;
    if (job->scene->pieces == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a pieces report needs its tetrahedra");
    if (report->piece_count != job->surfaces.piece_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the report has %zu pieces, the tetrahedra have %zu; give two files of "
                          "the same decomposition",
                          report->piece_count, job->surfaces.piece_count);
    return STARG_OK;
}

static starg_status check_skeleton(starg_context *context, const scene_job *job) {
    for (size_t i = 0; i < 2 * job->edges; i++)
        if (job->scene->skeleton->edges[i] >= job->nodes)
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "edge %zu of the skeleton names node %lu, of %zu", i / 2,
                              (unsigned long)job->scene->skeleton->edges[i], job->nodes);
    return STARG_OK;
}

static starg_status check(starg_context *context, const scene_job *job) {
    if (job->model_vertices + job->guards + job->surfaces.vertex_count + job->nodes == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "nothing to write: no model, guards, pieces or skeleton");
    TRY(check_guards(context, job->scene));
    TRY(check_report(context, job));
    return check_skeleton(context, job);
}

/* ---- what is made of the parts ---- */

static starg_status find_viewers(starg_context *context, scene_job *job) {
    if (job->scene->seen == NULL)
        return STARG_OK;
    NEW(context, STAGE, job->viewer, job->model_faces);
    memset(job->viewer, 0xff, job->model_faces * sizeof *job->viewer);
    for (size_t g = job->guards; g-- > 0;)
        for (size_t f = 0; f < job->model_faces; f++)
            if (starg_bits_test(job->scene->seen, g, f))
                job->viewer[f] = (int32_t)g;
    return STARG_OK;
}

/* What no guard sees and nobody misses need not be seen. */
static starg_status count_times(starg_context *context, scene_job *job) {
    const starg_guards *g = job->scene->guards;
    if (job->scene->seen == NULL)
        return STARG_OK;
    NEW_ZERO(context, STAGE, job->times, job->model_faces);
    for (size_t f = 0; f < job->model_faces; f++)
        for (size_t i = 0; i < job->guards && job->times[f] < SCENE_MOST_TIMES; i++)
            job->times[f] += starg_bits_test(job->scene->seen, i, f);
    for (size_t f = 0, next = 0; f < job->model_faces; f++) {
        while (next < g->uncovered_count && g->uncovered[next] < f)
            next++;
        bool missed = next < g->uncovered_count && g->uncovered[next] == f;
        if (job->times[f] == 0 && !missed)
            job->times[f] = SCENE_NOT_WANTED;
    }
    return STARG_OK;
}

void scene_count_color(size_t times, uint8_t rgb[3]) {
    static const uint8_t colors[SCENE_TIMES][3] = {
        {178, 24, 43}, {253, 219, 150}, {146, 197, 222}, {67, 132, 190}, {205, 209, 214}};
    memcpy(rgb, colors[times], 3);
}

typedef struct box {
    double lower[3], upper[3];
} box;

static void cover(box *b, const double *points, size_t count) {
    for (size_t i = 0; i < 3 * count; i++) {
        b->lower[i % 3] = fmin(b->lower[i % 3], points[i]);
        b->upper[i % 3] = fmax(b->upper[i % 3], points[i]);
    }
}

static void find_box(scene_job *job) {
    const starg_scene *s = job->scene;
    box b = {.lower = {INFINITY, INFINITY, INFINITY}, .upper = {-INFINITY, -INFINITY, -INFINITY}};
    if (s->model != NULL)
        cover(&b, starg_mesh_vertices(s->model), job->model_vertices);
    if (s->obstacles != NULL)
        cover(&b, starg_mesh_vertices(s->obstacles), job->obstacle_vertices);
    for (size_t i = 0; i < job->surfaces.vertex_count; i++)
        cover(&b, scene_piece_vertex(job, i), 1);
    if (s->guards != NULL)
        cover(&b, s->guards->positions, job->guards);
    if (s->skeleton != NULL)
        cover(&b, s->skeleton->positions, job->nodes);
    job->size = 0;
    for (int k = 0; k < 3; k++) {
        job->center[k] = 0.5 * b.lower[k] + 0.5 * b.upper[k];
        job->size = fmax(job->size, b.upper[k] - b.lower[k]);
    }
    if (!(job->size > 0))
        job->size = 1;
}

static starg_status prepare(starg_context *context, scene_job *job) {
    const starg_scene *s = job->scene;
    job->model_vertices = s->model != NULL ? starg_mesh_vertex_count(s->model) : 0;
    job->model_faces = s->model != NULL ? starg_mesh_face_count(s->model) : 0;
    job->obstacle_vertices = s->obstacles != NULL ? starg_mesh_vertex_count(s->obstacles) : 0;
    job->obstacle_faces = s->obstacles != NULL ? starg_mesh_face_count(s->obstacles) : 0;
    job->guards = s->guards != NULL ? s->guards->count : 0;
    job->nodes = s->skeleton != NULL ? s->skeleton->node_count : 0;
    job->edges = s->skeleton != NULL ? s->skeleton->edge_count : 0;
    if (s->pieces != NULL)
        TRY(starg_piece_surfaces_create(context, s->pieces, &job->surfaces));
    TRY(check(context, job));
    TRY(find_viewers(context, job));
    TRY(count_times(context, job));
    find_box(job);
    return STARG_OK;
}

/* The surfaces of pieces hold the model's, and drawn at the same place neither is seen well. Data
 * are not drawn. */
static void leave_out_covered(scene_job *job, starg_scene_format format) {
    if (job->surfaces.piece_count == 0 || format == STARG_SCENE_VTU)
        return;
    job->model_vertices = 0;
    job->model_faces = 0;
}

/* ---- what the writers ask ---- */

void scene_face_color(const scene_job *job, size_t face, uint8_t rgb[3]) {
    if (job->viewer == NULL)
        memcpy(rgb, SCENE_NEUTRAL, sizeof SCENE_NEUTRAL);
    else if (job->viewer[face] < 0)
        memcpy(rgb, SCENE_UNSEEN, sizeof SCENE_UNSEEN);
    else
        starg_distinct_color((size_t)job->viewer[face], rgb);
}

const double *scene_piece_vertex(const scene_job *job, size_t index) {
    return job->scene->pieces->vertices + 3 * (size_t)job->surfaces.vertices[index];
}

double scene_ball_radius(const scene_job *job) {
    return 0.015 * job->size;
}

/* ---- writing ---- */

static starg_scene_format format_of(const char *path) {
    static const char *const extensions[] = {[STARG_SCENE_GLB] = ".glb",
                                             [STARG_SCENE_VTU] = ".vtu",
                                             [STARG_SCENE_PLY] = ".ply",
                                             [STARG_SCENE_OBJ] = ".obj",
                                             [STARG_SCENE_3MF] = ".3mf"};
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (extensions[i] != NULL && starg_has_extension(path, extensions[i]))
            return (starg_scene_format)i;
    return STARG_SCENE_AUTO;
}

static starg_status choose_format(starg_context *context, const char *path,
                                  starg_scene_format *format) {
    if (*format == STARG_SCENE_AUTO)
        *format = format_of(path);
    if (*format != STARG_SCENE_AUTO)
        return STARG_OK;
    return starg_fail(
        context, STARG_ERROR_ARGUMENT, STAGE,
        "'%.300s' has no known format; use a name that ends in .glb, .vtu, .ply, .obj or .3mf",
        path);
}

static starg_status write_as(starg_context *context, const scene_job *job, const char *path,
                             starg_scene_format format) {
    switch (format) {
    case STARG_SCENE_GLB:
        return scene_write_glb(context, job, path);
    case STARG_SCENE_VTU:
        return scene_write_vtu(context, job, path);
    case STARG_SCENE_PLY:
        return scene_write_ply(context, job, path);
    case STARG_SCENE_OBJ:
        return scene_write_obj(context, job, path);
    case STARG_SCENE_3MF:
        return scene_write_3mf(context, job, path);
    case STARG_SCENE_AUTO:
        break;
    }
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "unknown format %d", (int)format);
}

starg_status starg_scene_write(starg_context *context, const starg_scene *scene, const char *path,
                               starg_scene_format format) {
    starg_status status = STARG_OK;
    scene_job job = {.scene = scene};
    STARG_TRY(choose_format(context, path, &format));
    STARG_TRY(prepare(context, &job));
    STARG_TRY(starg_check_cancel(context, STAGE));
    leave_out_covered(&job, format);
    STARG_TRY(write_as(context, &job, path, format));
done:
    starg_piece_surfaces_free(&job.surfaces);
    RELEASE(job.viewer, job.times);
    return status;
}
