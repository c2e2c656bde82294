/* SPDX-License-Identifier: Apache-2.0 */
#include "tetrahedra.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/delaunay.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"
#include "starguard/sample.h"
#include "starguard/solid.h"
#include "support.h"

starg_tetmesh *random_tetmesh(starg_context *context, uint64_t seed, size_t points, bool lattice,
                              double scale) {
    starg_rng rng = starg_rng_make(seed, 11, 0);
    double coordinates[3 * 100];
    delaunay *d = NULL;
    starg_tetmesh *mesh = NULL;
    assert_true(points <= 100);
    for (size_t i = 0; i < 3 * points; i++)
        coordinates[i] =
            scale * (lattice ? (double)starg_rng_below(&rng, 4) : starg_rng_unit(&rng));
    test_ok(context, delaunay_create(context, coordinates, points, &d));
    uint32_t *kept = malloc(16 * d->count + 16);
    assert_non_null(kept);
    size_t count = 0;
    for (size_t t = 0; t < d->count; t++)
        if (starg_rng_below(&rng, 8) > 0)
            memcpy(kept + 4 * count++, d->tetrahedra[t], 16);
    assert_true(count > 0);
    test_ok(context, starg_tetmesh_create(context, coordinates, points, kept, count, NULL, &mesh));
    free(kept);
    delaunay_free(d);
    return mesh;
}

starg_tetmesh *sample_tetmesh(starg_context *context, const char *name, size_t target) {
    starg_sample_options sample;
    starg_tetra_options options;
    starg_mesh *surface = NULL;
    starg_solid *solid = NULL;
    starg_tetmesh *mesh = NULL;
    starg_sample_options_default(&sample);
    starg_tetra_options_default(&options);
    sample.vertex_count = 600;
    options.generator = STARG_TETRA_STUFFING;
    options.target = target;
    test_ok(context, starg_sample_create(context, name, &sample, &surface));
    test_ok(context, starg_solid_create(context, surface, &solid));
    test_ok(context, starg_tetmesh_from_solid(context, solid, &options, NULL, &mesh));
    starg_solid_free(solid);
    starg_mesh_free(surface);
    return mesh;
}

/* Is p within `near` of the triangle's plane, and in it by its areas with the corners? */
static bool is_on_triangle(const double *p, const double *const corner[3], double near) {
    double whole = vec3_triangle_area(corner[0], corner[1], corner[2]), parts = 0, length = 0;
    double normal[3], offset[3];
    vec3_triangle_normal(corner[0], corner[1], corner[2], normal);
    vec3_subtract(p, corner[0], offset);
    if (fabs(vec3_dot(normal, offset)) > near * vec3_length(normal))
        return false;
    for (int k = 0; k < 3; k++) {
        parts += vec3_triangle_area(p, corner[k], corner[(k + 1) % 3]);
        length += vec3_distance(corner[k], corner[(k + 1) % 3]);
    }
    return parts - whole < near * length;
}

void assert_subdivides(const starg_mesh *surface, const starg_mesh *a, const double *positions) {
    size_t count = a->vertex_count;
    double area = 0, near = 0;
    assert_true(surface->vertex_count >= count);
    assert_memory_equal(surface->vertices, positions, 3 * count * sizeof *positions);
    for (size_t i = 0; i < 3 * count; i++)
        near = fmax(near, 1e-9 * fabs(positions[i]));
    for (size_t v = count; v < surface->vertex_count; v++) {
        bool found = false;
        for (size_t f = 0; f < a->face_count && !found; f++) {
            const double *corner[3];
            for (size_t k = 0; k < 3; k++)
                corner[k] = positions + 3 * (size_t)a->faces[3 * f + k];
            found = is_on_triangle(surface->vertices + 3 * v, corner, near);
        }
        if (!found)
            fail_msg("vertex %zu of the boundary is not on the surface", v);
    }
    for (size_t f = 0; f < a->face_count; f++)
        area += vec3_triangle_area(positions + 3 * (size_t)a->faces[3 * f],
                                   positions + 3 * (size_t)a->faces[3 * f + 1],
                                   positions + 3 * (size_t)a->faces[3 * f + 2]);
    assert_true(fabs(starg_mesh_area(surface) - area) < 1e-9 * area);
}
