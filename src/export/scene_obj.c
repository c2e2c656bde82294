/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as OBJ: an object for each part, whose vertices are numbered from 1 through the file. A
 * guard is a point element, the skeleton lines. */
#include "export/export.h"
#include "mesh/formats/io.h"

static const char STAGE[] = "scene";

static void put_vertex(FILE *stream, const double p[3]) {
    fprintf(stream, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
}

static void put_face(FILE *stream, const uint32_t *corners, size_t base) {
    fprintf(stream, "f %zu %zu %zu\n", base + corners[0], base + corners[1], base + corners[2]);
}

/* Each gives the number of the next vertex. */
static size_t put_model(FILE *stream, const scene_job *job, size_t base) {
    const starg_mesh *mesh = job->scene->model;
    if (job->model_vertices == 0)
        return base;
    fputs("o model\n", stream);
    for (size_t i = 0; i < job->model_vertices; i++)
        put_vertex(stream, starg_mesh_vertices(mesh) + 3 * i);
    for (size_t f = 0; f < job->model_faces; f++)
        put_face(stream, starg_mesh_faces(mesh) + 3 * f, base);
    return base + job->model_vertices;
}

static size_t put_pieces(FILE *stream, const scene_job *job, size_t base) {
    const starg_piece_surfaces *s = &job->surfaces;
    for (size_t i = 0; i < s->vertex_count; i++)
        put_vertex(stream, scene_piece_vertex(job, i));
    for (size_t p = 0; p < s->piece_count; p++) {
        fprintf(stream, "o piece_%04zu\n", p);
        for (size_t f = s->first_face[p]; f < s->first_face[p + 1]; f++)
            put_face(stream, s->faces + 3 * f, base);
    }
    return base + s->vertex_count;
}

static size_t put_guards(FILE *stream, const scene_job *job, size_t base) {
    for (size_t g = 0; g < job->guards; g++) {
        fprintf(stream, "o guard_%04zu\n", g);
        put_vertex(stream, job->scene->guards->positions + 3 * g);
        fprintf(stream, "p %zu\n", base + g);
    }
    return base + job->guards;
}

static void put_skeleton(FILE *stream, const scene_job *job, size_t base) {
    const starg_skeleton *s = job->scene->skeleton;
    if (job->nodes == 0)
        return;
    fputs("o skeleton\n", stream);
    for (size_t i = 0; i < job->nodes; i++)
        put_vertex(stream, s->positions + 3 * i);
    for (size_t e = 0; e < job->edges; e++)
        fprintf(stream, "l %zu %zu\n", base + s->edges[2 * e], base + s->edges[2 * e + 1]);
}

starg_status scene_write_obj(starg_context *context, const scene_job *job, const char *path) {
    starg_output output;
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_c_locale_enter(context, &locale));
    TRY(starg_output_open(context, STAGE, path, &output));
    size_t base = put_model(output.stream, job, 1);
    base = put_pieces(output.stream, job, base);
    base = put_guards(output.stream, job, base);
    put_skeleton(output.stream, job, base);
    return starg_output_commit(&output);
}
