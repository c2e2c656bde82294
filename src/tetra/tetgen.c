/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra by the program TetGen [Si 2015], run as a child process, which keeps its licence and
 * its crashes separate.
 *
 * Stages: number the vertices used by faces; write the surface as .smesh to a private folder,
 * scaled to unit size by a power of two; run; read .node and .ele; drop regions outside the solid
 * (cavities); check all requirements.
 *
 * TetGen prints 16 digits, one too few: input vertices keep their own coordinates. Nothing in its
 * output is trusted: orientation, neighbours and the boundary are checked exactly, and any
 * deviation is an error. */
#include <stdio.h>
#include <stdlib.h>

#include "geometry/vec3.h"
#include "tetra/generate.h"
#include "tetra/io.h"

static const char STAGE[] = TETRA_STAGE;

typedef struct run {
    starg_context *context;
    const starg_solid *solid;
    const starg_tetra_options *options;
    int exponent;      /* of the mesh: coordinates are written times 2^-exponent */
    uint32_t *numbers; /* of the solid's vertices; UINT32_MAX: not used */
    size_t used;
    char *folder;
    char *surface, *points, *elements; /* paths */
    tet_builder builder;
} run;

/* ---- input ---- */

static starg_status number_vertices(run *r) {
    const starg_mesh *mesh = r->solid->mesh;
    NEW(r->context, STAGE, r->numbers, mesh->vertex_count);
    memset(r->numbers, 0xff, mesh->vertex_count * sizeof *r->numbers);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        r->numbers[mesh->faces[i]] = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (r->numbers[v] == 0)
            r->numbers[v] = (uint32_t)r->used++;
    return STARG_OK;
}

static starg_status join_path(run *r, const char *name, char **out) {
    size_t folder = strlen(r->folder), tail = strlen(name);
    NEW(r->context, STAGE, *out, folder + tail + 1);
    memcpy(*out, r->folder, folder);
    memcpy(*out + folder, name, tail + 1);
    return STARG_OK;
}

static starg_status make_paths(run *r) {
    TRY(starg_scratch_create(r->context, STAGE, &r->folder));
    TRY(join_path(r, "/solid.smesh", &r->surface));
    TRY(join_path(r, "/solid.1.node", &r->points));
    return join_path(r, "/solid.1.ele", &r->elements);
}

static void write_surface(const run *r, FILE *stream) {
    const starg_mesh *mesh = r->solid->mesh;
    fprintf(stream, "%zu 3 0 0\n", r->used);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->vertices + 3 * v;
        if (r->numbers[v] != UINT32_MAX)
            fprintf(stream, "%lu %.17g %.17g %.17g\n", (unsigned long)r->numbers[v],
                    ldexp(p[0], -r->exponent), ldexp(p[1], -r->exponent),
                    ldexp(p[2], -r->exponent));
    }
    fprintf(stream, "%zu 0\n", mesh->face_count);
    for (size_t f = 0; f < mesh->face_count; f++)
        fprintf(stream, "3 %lu %lu %lu\n", (unsigned long)r->numbers[mesh->faces[3 * f]],
                (unsigned long)r->numbers[mesh->faces[3 * f + 1]],
                (unsigned long)r->numbers[mesh->faces[3 * f + 2]]);
    fputs("0\n0\n", stream); /* no holes, no regions: those are determined afterwards */
}

static starg_status write_input(run *r) {
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    TRY(starg_output_open(r->context, STAGE, r->surface, &output));
    write_surface(r, output.stream);
    return starg_output_commit(&output);
}

/* p: from a surface, Y: keep its faces, q: no needles, a: largest volume, A: label regions, F: no
 * face files, Q: quiet. */
static starg_status run_program(run *r, double volume) {
    char switches[64];
    const char *program = r->options->tetgen != NULL ? r->options->tetgen : "tetgen";
    if (volume > 0)
        snprintf(switches, sizeof switches, "-pYq1.414AFQa%.17g", ldexp(volume, -3 * r->exponent));
    else
        snprintf(switches, sizeof switches, "-pYAFQ");
    const char *const arguments[] = {program, switches, r->surface, NULL};
    return starg_process_run(r->context, STAGE, arguments, r->options->tetgen_limit);
}

/* ---- output ---- */

static starg_status refuse(run *r, const char *what) {
    return starg_fail(r->context, STARG_ERROR_SOLVER, STAGE, "TetGen's result was rejected: %s",
                      what);
}

static starg_status read_output(run *r, starg_source *points, starg_source *elements) {
    char *bytes = NULL;
    *points = (starg_source){.context = r->context, .name = "solid.1.node"};
    *elements = (starg_source){.context = r->context, .name = "solid.1.ele"};
    TRY(starg_file_read(r->context, STAGE, r->points, &bytes, &points->size));
    points->bytes = bytes;
    TRY(starg_file_read(r->context, STAGE, r->elements, &bytes, &elements->size));
    elements->bytes = bytes;
    r->builder.points.source = points;
    return tet_tetgen_read(&r->builder, elements);
}

/* Undoes the scaling; input vertices get their own coordinates again. */
static starg_status restore_vertices(run *r) {
    const starg_mesh *mesh = r->solid->mesh;
    double *out = r->builder.points.vertices.data;
    size_t count = r->builder.points.vertices.count;
    if (count < 3 * r->used)
        return refuse(r, "vertices are missing");
    for (size_t i = 0; i < count; i++)
        out[i] = ldexp(out[i], r->exponent);
    double extent = ldexp(1, r->exponent);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        if (r->numbers[v] == UINT32_MAX)
            continue;
        double *place = out + 3 * (size_t)r->numbers[v];
        const double *own = mesh->vertices + 3 * v;
        for (int k = 0; k < 3; k++)
            if (fabs(place[k] - own[k]) > 1e-12 * (extent + fabs(own[k])))
                return refuse(r, "vertices of the surface have moved");
        vec3_copy(own, place);
    }
    return STARG_OK;
}

static double corner_volume(const tet_builder *b, size_t t, double center[3]) {
    double p[4][3], edge[3][3];
    for (size_t k = 0; k < 4; k++)
        vec3_copy(b->points.vertices.data + 3 * (size_t)b->tetrahedra.data[4 * t + k], p[k]);
    for (int k = 0; k < 3; k++) {
        vec3_subtract(p[k + 1], p[0], edge[k]);
        center[k] = 0.25 * p[0][k] + 0.25 * p[1][k] + 0.25 * p[2][k] + 0.25 * p[3][k];
    }
    return fabs(vec3_triple(edge[0], edge[1], edge[2]));
}

/* The largest tetrahedron of each region decides whether the region is in the solid. Regions are
 * numbered from 1; drops tetrahedra outside. */
static starg_status drop_cavities(run *r) {
    tet_builder *b = &r->builder;
    size_t count = tet_builder_count(b), kept = 0;
    SCOPED double *largest = NULL;
    SCOPED bool *inside = NULL;
    NEW_ZERO(r->context, STAGE, largest, count + 1);
    NEW_ZERO(r->context, STAGE, inside, count + 1);
    for (size_t t = 0; t < count; t++) {
        double center[3];
        int32_t region = b->regions.data[t];
        double volume = corner_volume(b, t, center);
        if (region < 0 || (size_t)region > count)
            return refuse(r, "unexpected region numbers");
        if (volume > largest[region]) {
            largest[region] = volume;
            inside[region] = starg_solid_contains(r->solid, center);
        }
    }
    for (size_t t = 0; t < count; t++)
        if (inside[b->regions.data[t]])
            memmove(b->tetrahedra.data + 4 * kept++, b->tetrahedra.data + 4 * t,
                    4 * sizeof *b->tetrahedra.data);
    b->tetrahedra.count = 4 * kept;
    if (kept == 0)
        return refuse(r, "no tetrahedra in the solid");
    return STARG_OK;
}

/* ---- comparison of the boundary with the surface ---- */

/* A face rotated to start with its lowest vertex. */
typedef struct turned_face {
    uint32_t v[3];
} turned_face;

static turned_face turn_face(uint32_t a, uint32_t b, uint32_t c) {
    if (a < b && a < c)
        return (turned_face){{a, b, c}};
    return b < c ? (turned_face){{b, c, a}} : (turned_face){{c, a, b}};
}

static int compare_faces(const void *left, const void *right) {
    const turned_face *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->v[k] != b->v[k])
            return a->v[k] < b->v[k] ? -1 : 1;
    return 0;
}

static starg_status compare_surfaces(run *r, const starg_mesh *boundary, const uint32_t *map) {
    const starg_mesh *mesh = r->solid->mesh;
    SCOPED turned_face *ours = NULL, *theirs = NULL;
    size_t count = mesh->face_count;
    if (boundary->face_count != count)
        return refuse(r, "its boundary and the surface differ in the number of faces");
    NEW(r->context, STAGE, ours, count);
    NEW(r->context, STAGE, theirs, count);
    for (size_t f = 0; f < count; f++) {
        const uint32_t *a = mesh->faces + 3 * f, *b = boundary->faces + 3 * f;
        ours[f] = turn_face(r->numbers[a[0]], r->numbers[a[1]], r->numbers[a[2]]);
        theirs[f] = turn_face(map[b[0]], map[b[1]], map[b[2]]);
    }
    qsort(ours, count, sizeof *ours, compare_faces);
    qsort(theirs, count, sizeof *theirs, compare_faces);
    if (memcmp(ours, theirs, count * sizeof *ours) != 0)
        return refuse(r, "its boundary differs from the surface");
    return STARG_OK;
}

static starg_status check_boundary(run *r, const starg_tetmesh *mesh) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *boundary = NULL;
    SCOPED uint32_t *map = NULL;
    TRY(starg_tetmesh_surface(r->context, mesh, &boundary, &map));
    return compare_surfaces(r, boundary, map);
}

/* Positive tetrahedra with an embedded boundary cannot overlap, so the overlap check is skipped;
 * adjacency is checked. */
static starg_status adopt(run *r, starg_tetmesh **out) {
    tet_builder *b = &r->builder;
    TRY(tetmesh_adopt(r->context, b->points.vertices.data, b->points.vertices.count / 3,
                      b->tetrahedra.data, b->tetrahedra.count / 4, NULL, true, out));
    b->points.vertices.data = NULL;
    b->tetrahedra.data = NULL;
    return check_boundary(r, *out);
}

/* Everything but memory, time and cancellation counts as a failure of the program. */
static starg_status as_solver_error(run *r, starg_status status) {
    char message[384];
    if (status == STARG_OK || status == STARG_ERROR_MEMORY || status == STARG_ERROR_CANCELLED ||
        status == STARG_ERROR_TIME || status == STARG_ERROR_SOLVER)
        return status;
    snprintf(message, sizeof message, "%.380s", starg_context_error(r->context)->message);
    return refuse(r, message);
}

static void clean_up(run *r, const starg_source *points, const starg_source *elements) {
    union { /* blocks filled here and read-only since */
        const char *read;
        char *owned;
    } blocks[2] = {{.read = points->bytes}, {.read = elements->bytes}};
    if (r->builder.points.source != NULL)
        tet_builder_free(&r->builder);
    starg_scratch_remove(r->context, r->folder);
    RELEASE(blocks[0].owned, blocks[1].owned, r->surface, r->points, r->elements, r->numbers);
}

starg_status tetra_by_tetgen(starg_context *context, const starg_solid *solid, double volume,
                             const starg_tetra_options *options, starg_tetmesh **out) {
    starg_status status = STARG_OK;
    run r = {.context = context,
             .solid = solid,
             .options = options,
             .exponent = starg_mesh_exponent(solid->mesh)};
    starg_source points = {0}, elements = {0};
    starg_c_locale locale = {0};
    *out = NULL;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(number_vertices(&r));
    STARG_TRY(make_paths(&r));
    STARG_TRY(write_input(&r));
    STARG_TRY(run_program(&r, volume));
    STARG_TRY(read_output(&r, &points, &elements));
    STARG_TRY(restore_vertices(&r));
    STARG_TRY(drop_cavities(&r));
    STARG_TRY(adopt(&r, out));
done:
    if (status != STARG_OK) {
        starg_tetmesh_free(*out);
        *out = NULL;
    }
    clean_up(&r, &points, &elements);
    starg_c_locale_leave(&locale);
    return as_solver_error(&r, status);
}
