/* SPDX-License-Identifier: Apache-2.0 */
/* Polyhedra whose triangles are subdivided into n^2 each: the sphere and the shell (projected to
 * spheres), and the spiky star (flat).
 *
 * Vertices are identified by their place: a corner, an edge and the step along it, or a face and
 * the two steps in it; neighbouring triangles share those on their common edge. */

#include "geometry/vec3.h"
#include "sample/solids.h"

enum { CORNERS = 12, FACES = 20, MAX_POINTS = CORNERS + FACES };

static const double GOLDEN = 1.61803398874989485;

/* The icosahedron: corners on a sphere of radius sqrt(1 + GOLDEN^2); outward faces. */
static void icosahedron_corner(uint32_t i, double p[3]) {
    int axis = (int)(i / 4);
    p[axis] = 0;
    p[(axis + 1) % 3] = i & 1 ? 1 : -1;
    p[(axis + 2) % 3] = i & 2 ? GOLDEN : -GOLDEN;
    double length = vec3_length(p);
    for (int k = 0; k < 3; k++)
        p[k] /= length;
}

/* Finds the faces as triples of corners at mutual edge distance. */
static void icosahedron_faces(uint32_t faces[FACES][3]) {
    double p[CORNERS][3];
    size_t count = 0;
    for (uint32_t i = 0; i < CORNERS; i++)
        icosahedron_corner(i, p[i]);
    const double near = 1.2 * 1.2; /* edges measure 1.05, other distances 1.7 and 2 */
    for (uint32_t a = 0; a < CORNERS; a++)
        for (uint32_t b = a + 1; b < CORNERS; b++)
            for (uint32_t c = b + 1; c < CORNERS && count < FACES; c++) {
                if (vec3_distance_squared(p[a], p[b]) > near ||
                    vec3_distance_squared(p[b], p[c]) > near ||
                    vec3_distance_squared(p[a], p[c]) > near)
                    continue;
                bool outward = vec3_triple(p[a], p[b], p[c]) > 0;
                faces[count][0] = a;
                faces[count][1] = outward ? b : c;
                faces[count][2] = outward ? c : b;
                count++;
            }
}

/* One triangle of a polyhedron, to be cut into n x n. */
typedef struct patch {
    uint32_t names[3]; /* of the corners, below MAX_POINTS */
    double corners[3][3];
    uint32_t number; /* of the triangle */
    uint32_t n;
    double radius;    /* of the sphere that it is projected to, or 0: flat */
    double center[3]; /* of that sphere */
    bool inward;      /* orientation reversed */
    uint64_t shell;   /* separates the names of different surfaces */
} patch;

/* The name of the point with weights w (summing to n). */
static uint64_t point_name(const patch *t, const uint32_t w[3]) {
    uint64_t kind = 0, where = 0, step = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        if (w[k] == t->n) {
            where = t->names[k];
            return t->shell << 62 | where;
        }
        if (w[k] == 0 && w[u] != 0 && w[v] != 0) {
            bool ordered = t->names[u] < t->names[v];
            kind = 1;
            where = (uint64_t)(ordered ? t->names[u] : t->names[v]) * MAX_POINTS +
                    (ordered ? t->names[v] : t->names[u]);
            step = ordered ? w[v] : w[u];
        }
    }
    if (kind == 0) {
        kind = 2;
        where = t->number;
        step = (uint64_t)w[1] << 20 | w[2];
    }
    return t->shell << 62 | kind << 60 | where << 42 | step;
}

static starg_status patch_point(mesh_builder *builder, const patch *t, uint32_t i, uint32_t j,
                                uint32_t *vertex) {
    const uint32_t w[3] = {t->n - i - j, i, j};
    double p[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        vec3_along(p, (double)w[k] / t->n, t->corners[k], p);
    if (t->radius > 0) {
        double length = vec3_length(p);
        vec3_along(t->center, t->radius / length, p, p);
    }
    return builder_vertex(builder, point_name(t, w), p, vertex);
}

static starg_status patch_triangle(mesh_builder *builder, const patch *t, uint32_t a, uint32_t b,
                                   uint32_t c) {
    return t->inward ? builder_triangle(builder, a, c, b) : builder_triangle(builder, a, b, c);
}

static starg_status add_patch(mesh_builder *builder, const patch *t) {
    TRY(starg_check_cancel(builder->context, "sample"));
    for (uint32_t i = 0; i < t->n; i++)
        for (uint32_t j = 0; i + j < t->n; j++) {
            uint32_t a, b, c, d;
            TRY(patch_point(builder, t, i, j, &a));
            TRY(patch_point(builder, t, i + 1, j, &b));
            TRY(patch_point(builder, t, i, j + 1, &c));
            TRY(patch_triangle(builder, t, a, b, c));
            if (i + j + 1 == t->n)
                continue;
            TRY(patch_point(builder, t, i + 1, j + 1, &d));
            TRY(patch_triangle(builder, t, b, d, c));
        }
    return STARG_OK;
}

static uint32_t nearest_subdivision(double triangles_by_two, size_t vertex_count) {
    double n = sqrt(((double)vertex_count - 2) / triangles_by_two);
    return n < 1.5 ? 1 : (uint32_t)(n + 0.5);
}

static starg_status add_sphere(mesh_builder *builder, const double center[3], double radius,
                               uint32_t n, bool inward) {
    uint32_t faces[FACES][3];
    icosahedron_faces(faces);
    for (uint32_t f = 0; f < FACES; f++) {
        patch t = {.number = f, .n = n, .radius = radius, .inward = inward, .shell = inward};
        vec3_copy(center, t.center);
        for (int k = 0; k < 3; k++) {
            t.names[k] = faces[f][k];
            icosahedron_corner(faces[f][k], t.corners[k]);
        }
        TRY(add_patch(builder, &t));
    }
    return STARG_OK;
}

starg_status solid_sphere(starg_context *context, size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    const double center[3] = {0, 0, 0};
    TRY(add_sphere(&builder, center, 1, nearest_subdivision(10, vertex_count), false));
    return builder_finish(&builder, out);
}

/* A ball with a ball-shaped cavity off its centre. */
starg_status solid_shell(starg_context *context, size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    const double center[3] = {0, 0, 0}, cavity[3] = {0.22, 0.1, 0.12}, radius = 0.58;
    uint32_t outer = nearest_subdivision(10 * (1 + radius * radius), vertex_count);
    size_t rest = vertex_count > 10 * (size_t)outer * outer + 2
                      ? vertex_count - 10 * (size_t)outer * outer - 2
                      : 0;
    uint32_t inner = rest < 42 ? 2 : nearest_subdivision(10, rest);
    TRY(add_sphere(&builder, center, 1, outer, false));
    TRY(add_sphere(&builder, cavity, radius, inner, true));
    return builder_finish(&builder, out);
}

/* The icosahedron with a tall pyramid on every face. */
starg_status solid_star(starg_context *context, size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    uint32_t faces[FACES][3], n = nearest_subdivision(30, vertex_count);
    const double core = 0.5, tip = 1.35; /* tip: in units of the face's centre at core radius 1 */
    icosahedron_faces(faces);
    for (uint32_t f = 0; f < FACES; f++) {
        double corners[3][3], apex[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            icosahedron_corner(faces[f][k], corners[k]);
            vec3_along(apex, tip / 3, corners[k], apex);
            for (int c = 0; c < 3; c++)
                corners[k][c] *= core;
        }
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3;
            patch t = {.number = 3 * f + (uint32_t)k, .n = n};
            t.names[0] = faces[f][k];
            t.names[1] = faces[f][l];
            t.names[2] = CORNERS + f;
            vec3_copy(corners[k], t.corners[0]);
            vec3_copy(corners[l], t.corners[1]);
            vec3_copy(apex, t.corners[2]);
            TRY(add_patch(&builder, &t));
        }
    }
    return builder_finish(&builder, out);
}
