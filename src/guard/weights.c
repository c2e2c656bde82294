/* SPDX-License-Identifier: Apache-2.0 */
/* Weights of a pool's columns: a coverage below 1 refers to area, so each face weighs its share of
 * the total area in units of 2^-40, at least one, because the cover works on integers; vertices
 * weigh one unit each. Importance weights of faces (starg_space_weigh) multiply their areas; what
 * is not a target weighs nothing. */
#include "guard/candidates.h"

#include <math.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

static const char STAGE[] = "guard";

/* The binary exponent of the largest coordinate. */
static int find_exponent(const starg_mesh *mesh) {
    double most = 0;
    int exponent = 0;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        most = fmax(most, fabs(mesh->vertices[i]));
    frexp(most, &exponent);
    return exponent;
}

/* Areas of the model scaled to unit size by a power of two: ratios are unchanged, and areas of tiny
 * or huge models neither underflow nor overflow. */
static starg_status measure_areas(starg_context *context, const starg_solid *solid,
                                  column_weights *out) {
    const starg_mesh *mesh = solid->mesh;
    int exponent = find_exponent(mesh);
    NEW(context, STAGE, out->areas, solid_patch_count(solid));
    for (size_t f = 0; f < mesh->face_count; f++) {
        size_t first = solid_first_patch(solid, f), end = solid_first_patch(solid, f + 1);
        double corner[3][3];
        for (size_t k = 0; k < 9; k++)
            corner[k / 3][k % 3] =
                ldexp(mesh->vertices[3 * (size_t)mesh->faces[3 * f + k / 3] + k % 3], -exponent);
        double area = vec3_triangle_area(corner[0], corner[1], corner[2]);
        if (solid->importance != NULL)
            area *= solid->importance[f];
        for (size_t j = first; j < end; j++)
            out->areas[j] = solid->patches != NULL ? area * solid->patches->share.data[j] : area;
        out->faces += solid_is_target(solid, false, f);
        out->area += area;
    }
    return STARG_OK;
}

starg_status column_weights_create(starg_context *context, const starg_solid *solid,
                                   starg_target target, column_weights *out) {
    bool vertices = target == STARG_TARGET_VERTICES, faces = target == STARG_TARGET_FACES;
    size_t columns = target_columns(solid, target);
    *out = (column_weights){0};
    TRY(measure_areas(context, solid, out));
    NEW(context, STAGE, out->weights, columns);
    for (size_t j = 0; j < columns; j++) {
        size_t index = faces ? solid_patch_face(solid, j) : vertices ? j : j / 3;
        if (!solid_wants(solid, vertices, index, j)) {
            out->weights[j] = 0;
            continue;
        }
        double share = !faces || !(out->area > 0) ? 0 : out->areas[j] / out->area;
        uint64_t weight = (uint64_t)llround(share * 0x1p40);
        out->weights[j] = weight > 0 ? weight : 1;
        out->total += out->weights[j];
    }
    return STARG_OK;
}

void column_weights_free(column_weights *weights) {
    RELEASE(weights->areas);
    RELEASE(weights->weights);
    *weights = (column_weights){0};
}
