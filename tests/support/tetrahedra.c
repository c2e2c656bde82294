/* SPDX-License-Identifier: Apache-2.0 */
#include "tetrahedra.h"

#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/delaunay.h"
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
