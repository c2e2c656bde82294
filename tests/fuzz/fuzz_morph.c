/* SPDX-License-Identifier: Apache-2.0 */
/* Two small surfaces are mapped onto one another, and the shapes between them made by every method:
 * a map is written and read without loss, frames begin with the one surface and end with the other,
 * and are finite in between. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/morph.h"
#include "support.h"

/* ---- maps ---- */

static void check_map(starg_context *context, const starg_map *map, const starg_mesh *a,
                      const starg_mesh *b) {
    starg_map *again = NULL;
    const char *path = fuzz_path(".json");
    fuzz_require_ok(context, starg_map_write(context, map, path), "a map can be written");
    fuzz_require_ok(context, starg_map_read(context, path, a, b, &again), "and read");
    fuzz_require(map->vertex_count == again->vertex_count &&
                     memcmp(map->faces, again->faces, map->vertex_count * sizeof *map->faces) ==
                         0 &&
                     memcmp(map->coordinates, again->coordinates,
                            3 * map->vertex_count * sizeof *map->coordinates) == 0,
                 "without loss");
    starg_map_free(context, again);
}

/* The images of a's vertices, by a map where there is one, else those vertices of b that have the
 * same number. */
static void choose_images(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                          double *images) {
    starg_map *map = NULL;
    starg_status status = starg_map_create(context, a, b, NULL, &map);
    size_t known = starg_mesh_vertex_count(b);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_MESH || status == STARG_ERROR_SOLVER,
                 "surfaces are mapped or cannot be");
    if (map != NULL) {
        check_map(context, map, a, b);
        starg_map_positions(map, b, images);
    } else {
        for (size_t i = 0; i < 3 * starg_mesh_vertex_count(a); i++)
            images[i] = starg_mesh_vertices(b)[3 * (i / 3 % known) + i % 3];
    }
    starg_map_free(context, map);
}

/* ---- frames ---- */

static void check_frames(starg_context *context, const starg_morph *morph, const starg_mesh *a,
                         const double *images) {
    static const double times[] = {0, 0.3, 1};
    size_t bytes = 3 * starg_mesh_vertex_count(a) * sizeof(double);
    double frame[3 * FUZZ_VERTICES];
    for (size_t i = 0; i < 3; i++) {
        starg_frame_measures measures;
        fuzz_require_ok(context, starg_morph_frame(morph, times[i], frame), "frames are made");
        for (size_t k = 0; k < bytes / sizeof(double); k++)
            fuzz_require(isfinite(frame[k]), "frames are finite");
        fuzz_require_ok(context, starg_morph_measure(morph, times[i], frame, &measures),
                        "frames are measured");
        if (i != 1)
            fuzz_require(memcmp(frame, i == 0 ? starg_mesh_vertices(a) : images, bytes) == 0,
                         "a morph begins and ends as it was told");
    }
}

static void morph_by(starg_context *context, const starg_mesh *a, const double *images,
                     starg_morph_method method) {
    starg_morph_options options;
    starg_morph *morph = NULL;
    starg_morph_options_default(&options);
    options.method = method;
    options.candidates = 20;
    starg_status status = starg_morph_create(context, a, images, &options, &morph);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_MESH || status == STARG_ERROR_SOLVER,
                 "surfaces are morphed or cannot be");
    if (morph != NULL)
        check_frames(context, morph, a, images);
    starg_morph_free(morph);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    starg_morph_method method = (starg_morph_method)fuzz_below(&in, 4);
    shape from = fuzz_shape(&in), to = fuzz_shape(&in);
    starg_mesh *a = fuzz_mesh(context, &from), *b = fuzz_mesh(context, &to);
    double images[3 * FUZZ_VERTICES];
    choose_images(context, a, b, images);
    morph_by(context, a, images, method);
    starg_mesh_free(a);
    starg_mesh_free(b);
    shape_free(&from);
    shape_free(&to);
    fuzz_context_end(context);
    return 0;
}
