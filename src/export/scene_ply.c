/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as binary PLY: faces in the colours of guards and pieces, edges for the skeleton. The
 * vertices of the parts follow one another: model, surfaces of pieces, balls for guards, views of
 * those that look one way, nodes. */
#include "core/file.h"
#include "core/memory.h"
#include "export/export.h"
#include "starguard/picture.h"

static const char STAGE[] = "scene";

typedef struct ply_scene {
    const scene_job *job;
    scene_ball ball;
    size_t piece_faces;
    size_t view_sides, view_corners; /* of a guard */
} ply_scene;

static void put_header(FILE *stream, const ply_scene *s) {
    const scene_job *job = s->job;
    size_t vertices = job->model_vertices + job->surfaces.vertex_count +
                      job->guards * (BALL_VERTICES + s->view_corners) + job->nodes;
    size_t faces = job->model_faces + s->piece_faces + job->guards * (BALL_FACES + s->view_sides);
    fprintf(stream,
            "ply\nformat binary_little_endian 1.0\n"
            "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
            "element face %zu\nproperty list uchar uint vertex_indices\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n",
            vertices, faces);
    if (job->edges > 0)
        fprintf(stream,
                "element edge %zu\nproperty int vertex1\nproperty int vertex2\n"
                "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                job->edges);
    fputs("end_header\n", stream);
}

/* ---- vertices ---- */

static void put_points(FILE *stream, const double *points, size_t count) {
    for (size_t i = 0; i < 3 * count; i++)
        little_put_double(stream, points[i]);
}

static void put_ball(FILE *stream, const ply_scene *s, const double center[3]) {
    double radius = scene_ball_radius(s->job);
    for (size_t i = 0; i < (size_t)3 * BALL_VERTICES; i++)
        little_put_double(stream, center[i % 3] + radius * s->ball.vertices[i]);
}

static void put_vertices(FILE *stream, const ply_scene *s) {
    const scene_job *job = s->job;
    if (job->model_vertices > 0)
        put_points(stream, starg_mesh_vertices(job->scene->model), job->model_vertices);
    for (size_t i = 0; i < job->surfaces.vertex_count; i++)
        put_points(stream, scene_piece_vertex(job, i), 1);
    for (size_t g = 0; g < job->guards; g++)
        put_ball(stream, s, job->scene->guards->positions + 3 * g);
    for (size_t i = 0; i < job->guards * s->view_corners; i++) {
        double p[3];
        scene_view_corner(job, i / s->view_corners, i % s->view_corners, p);
        put_points(stream, p, 1);
    }
    if (job->nodes > 0)
        put_points(stream, job->scene->skeleton->positions, job->nodes);
}

/* ---- faces and edges ---- */

static void put_face(FILE *stream, const uint32_t *corners, size_t base, const uint8_t rgb[3]) {
    fputc(3, stream);
    for (int k = 0; k < 3; k++)
        little_put_word(stream, (uint32_t)(base + corners[k]));
    fwrite(rgb, 1, 3, stream);
}

static void put_faces(FILE *stream, const ply_scene *s) {
    const scene_job *job = s->job;
    const starg_piece_surfaces *pieces = &job->surfaces;
    uint8_t rgb[3];
    for (size_t f = 0; f < job->model_faces; f++) {
        scene_face_color(job, f, rgb);
        put_face(stream, starg_mesh_faces(job->scene->model) + 3 * f, 0, rgb);
    }
    size_t base = job->model_vertices;
    for (size_t p = 0; p < pieces->piece_count; p++) {
        starg_distinct_color(p, rgb);
        for (size_t f = pieces->first_face[p]; f < pieces->first_face[p + 1]; f++)
            put_face(stream, pieces->faces + 3 * f, base, rgb);
    }
    base += pieces->vertex_count;
    for (size_t g = 0; g < job->guards; g++, base += BALL_VERTICES) {
        starg_distinct_color(g, rgb);
        for (size_t f = 0; f < BALL_FACES; f++)
            put_face(stream, s->ball.faces + 3 * f, base, rgb);
    }
    for (size_t f = 0; f < job->guards * s->view_sides; f++) {
        uint32_t corners[3];
        scene_view_face(job, f, corners);
        starg_distinct_color(f / s->view_sides, rgb);
        put_face(stream, corners, base, rgb);
    }
}

static void put_edges(FILE *stream, const ply_scene *s) {
    const scene_job *job = s->job;
    size_t base = job->model_vertices + job->surfaces.vertex_count +
                  job->guards * (BALL_VERTICES + s->view_corners);
    for (size_t i = 0; i < job->edges; i++) {
        const uint32_t *ends = job->scene->skeleton->edges + 2 * i;
        little_put_word(stream, (uint32_t)(base + ends[0]));
        little_put_word(stream, (uint32_t)(base + ends[1]));
        fwrite(SCENE_CURVE, 1, 3, stream);
    }
}

starg_status scene_write_ply(starg_context *context, const scene_job *job, const char *path) {
    starg_output output;
    const starg_piece_surfaces *pieces = &job->surfaces;
    ply_scene s = {.job = job};
    if (pieces->piece_count > 0)
        s.piece_faces = pieces->first_face[pieces->piece_count];
    scene_ball_make(&s.ball);
    s.view_sides = scene_view_sides(job);
    s.view_corners = s.view_sides > 0 ? s.view_sides + 1 : 0;
    TRY(starg_output_open(context, STAGE, path, &output));
    put_header(output.stream, &s);
    put_vertices(output.stream, &s);
    put_faces(output.stream, &s);
    put_edges(output.stream, &s);
    return starg_output_commit(&output);
}
